// The record of one evaluation, and all training evaluations of a journal (journal.hpp) in the
// order of their indices. A run may have more evaluations than fit into the memory, so they stay on
// the disk: the memory holds 16 bytes per evaluation, its place in the file.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "base/file_descriptor.hpp"
#include "optimizers/interface/evaluator.hpp"
#include "problems/interface/problem.hpp"

namespace armwright {

// One evaluation: the request and the answer.
struct EvaluationRecord {
  // Returns the charge to the budget, in cases.
  std::uint64_t calc_charge() const {
    return cases.numbers.size() *
           (with_jacobian ? static_cast<std::uint64_t>(calc_jacobian_charge(x.size())) : 1);
  }

  std::uint64_t index = 0;       // place among the evaluations of its role, from 0
  std::uint64_t generation = 0;  // 0 for optimizers without generations
  std::vector<double> x;         // as evaluated, inside the bounds
  bool clipped = false;          // the optimizer asked for a point outside the bounds
  // As the optimizer asked, within the bounds that it was given. Empty if that is x.
  std::vector<double> proposed = {};
  bool with_jacobian = false;  // the optimizer asked for exact derivatives
  CaseBlock cases;
  Evaluation evaluation;
};

// Copies read the same file. Not thread-safe, also not across copies.
class RecordedEvaluations {
 public:
  struct Place {
    std::uint64_t index = 0;   // of the evaluation
    std::uint64_t offset = 0;  // of its record in the file
    auto operator<=>(const Place&) const = default;
  };
  class Iterator;

  RecordedEvaluations() = default;  // empty
  // Takes the places in any order; all whole records end at `end_offset`. If an evaluation is
  // recorded twice the first record counts; throws Error{bad_data} if they differ.
  RecordedEvaluations(FileDescriptor journal, const std::filesystem::path& file,
                      std::deque<Place> places, std::uint64_t end_offset);

  std::size_t size() const { return source_ ? get_places().size() : 0; }
  bool empty() const { return size() == 0; }
  // Reads the evaluation with this number: its place among the recorded ones, from 0. Numbers
  // differ from indices where evaluations are missing: a kill can leave gaps near the end, and a
  // repair anywhere. Throws Error{io} or Error{bad_data} if the file has changed since.
  EvaluationRecord operator[](std::size_t number) const;
  EvaluationRecord front() const { return (*this)[0]; }
  EvaluationRecord back() const { return (*this)[size() - 1]; }
  std::uint64_t get_index(std::size_t number) const { return get_places()[number].index; }
  // Returns the number of the first evaluation whose index is at least `index`, or size() if there
  // is none.
  std::size_t find_number(std::uint64_t index) const;
  // Reads the evaluation with this index, or returns nothing if it is not recorded.
  std::optional<EvaluationRecord> find(std::uint64_t index) const;
  Iterator begin() const;
  Iterator end() const;

 private:
  struct Source;
  const std::deque<Place>& get_places() const;

  std::shared_ptr<Source> source_;
};

// Reads one evaluation after the other. The record that it points to is valid until the iterator
// moves on.
class RecordedEvaluations::Iterator {
 public:
  using iterator_concept = std::input_iterator_tag;
  using iterator_category = std::input_iterator_tag;
  using value_type = EvaluationRecord;
  using difference_type = std::ptrdiff_t;
  using pointer = const EvaluationRecord*;
  using reference = const EvaluationRecord&;

  Iterator() = default;
  Iterator(const RecordedEvaluations& evaluations, std::size_t number);

  reference operator*() const { return *record_; }
  pointer operator->() const { return &*record_; }
  Iterator& operator++();
  Iterator operator++(int);
  std::size_t number() const { return number_; }
  bool operator==(const Iterator& other) const { return number_ == other.number_; }

 private:
  void read();

  RecordedEvaluations evaluations_;
  std::size_t number_ = 0;
  std::optional<EvaluationRecord> record_;
};

}  // namespace armwright
