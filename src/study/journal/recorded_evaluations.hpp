// The training evaluations of a journal, in the order of their indices. They stay on the disk, as a
// run may have more of them than fit into the memory: held are 16 bytes each, their places in the
// file, and one is read when it is asked for.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>

#include "base/file_descriptor.hpp"
#include "study/journal/evaluation_record.hpp"

namespace armwright {

class RecordedEvaluations {
 public:
  // Where an evaluation's record begins.
  struct Place {
    std::uint64_t index = 0;
    std::uint64_t offset = 0;
    auto operator<=>(const Place&) const = default;
  };
  class Iterator;

  RecordedEvaluations() = default;  // none
  // In any order; all whole records end at `end_offset`. Of one written twice the first counts;
  // Error{bad_data} if both differ.
  RecordedEvaluations(FileDescriptor journal, const std::filesystem::path& file,
                      std::deque<Place> places, std::uint64_t end_offset);

  std::size_t size() const { return source_ ? get_places().size() : 0; }
  bool empty() const { return size() == 0; }
  // By place among those that are there, from 0: a kill can leave gaps near the end, and repaired
  // damage anywhere. Error{io} or Error{bad_data} if the file has changed since.
  EvaluationRecord operator[](std::size_t number) const;
  EvaluationRecord front() const { return (*this)[0]; }
  EvaluationRecord back() const { return (*this)[size() - 1]; }
  std::uint64_t get_index(std::size_t number) const { return get_places()[number].index; }
  // The number of the first whose index is at least `index`; size() if there is none.
  std::size_t find_number(std::uint64_t index) const;
  // The one of that index, or nothing.
  std::optional<EvaluationRecord> find(std::uint64_t index) const;
  Iterator begin() const;
  Iterator end() const;

 private:
  struct Source;
  const std::deque<Place>& get_places() const;

  std::shared_ptr<Source> source_;  // copies read the same file
};

// Reads the evaluations one after another. What it points to lives until it moves on.
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
