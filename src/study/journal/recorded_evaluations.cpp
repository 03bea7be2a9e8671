#include "study/journal/recorded_evaluations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "study/journal/journal_format.hpp"
#include "study/journal/journal_reader.hpp"

namespace armwright {
namespace {

EvaluationRecord read_evaluation(JournalWindow& window, const RecordedEvaluations::Place& place) {
  RecordAttempt attempt = read_record(window, place.offset);
  auto* const record = attempt.record ? std::get_if<EvaluationRecord>(&*attempt.record) : nullptr;
  if (record == nullptr || record->index != place.index) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: evaluation {} at byte {} is not there any more; is another "
                            "process changing this journal?",
                            window.file().string(), place.index, place.offset));
  }
  return std::move(*record);
}

bool has_same_content(const EvaluationRecord& a, const EvaluationRecord& b) {
  std::string bytes_a;
  std::string bytes_b;
  journal_format::encode(a, bytes_a);
  journal_format::encode(b, bytes_b);
  return bytes_a == bytes_b;
}

// Sorts by index and drops repeated records. Throws Error{bad_data} if repeated ones differ.
void sort_places(std::deque<RecordedEvaluations::Place>& places, JournalWindow& window) {
  using Place = RecordedEvaluations::Place;
  if (!std::ranges::is_sorted(places)) {
    std::ranges::sort(places);
  }
  const auto repeats = [&](const Place& first, const Place& second) {
    if (first.index != second.index) {
      return false;
    }
    if (!has_same_content(read_evaluation(window, first), read_evaluation(window, second))) {
      throw Error(
          ErrorKind::bad_data,
          fmt::format("{}: evaluation {} is recorded twice with different content; two "
                      "processes may have written this journal. {}",
                      window.file().string(), first.index, advise_on_damage(window.file())));
    }
    return true;
  };
  places.erase(std::unique(places.begin(), places.end(), repeats), places.end());
}

}  // namespace

struct RecordedEvaluations::Source {
  FileDescriptor journal;
  JournalWindow window;
  std::deque<Place> places;
};

RecordedEvaluations::RecordedEvaluations(FileDescriptor journal, const std::filesystem::path& file,
                                         std::deque<Place> places, std::uint64_t end_offset) {
  JournalWindow window(journal.get(), file);
  window.end_at(end_offset);
  sort_places(places, window);
  source_ =
      std::make_shared<Source>(Source{std::move(journal), std::move(window), std::move(places)});
}

const std::deque<RecordedEvaluations::Place>& RecordedEvaluations::get_places() const {
  return source_->places;
}

EvaluationRecord RecordedEvaluations::operator[](std::size_t number) const {
  return read_evaluation(source_->window, get_places()[number]);
}

std::size_t RecordedEvaluations::find_number(std::uint64_t index) const {
  if (empty()) {
    return 0;
  }
  const auto found = std::ranges::lower_bound(get_places(), index, {}, &Place::index);
  return static_cast<std::size_t>(found - get_places().begin());
}

std::optional<EvaluationRecord> RecordedEvaluations::find(std::uint64_t index) const {
  const std::size_t number = find_number(index);
  if (number == size() || get_index(number) != index) {
    return std::nullopt;
  }
  return (*this)[number];
}

RecordedEvaluations::Iterator RecordedEvaluations::begin() const {
  return {*this, 0};
}

RecordedEvaluations::Iterator RecordedEvaluations::end() const {
  return {*this, size()};
}

RecordedEvaluations::Iterator::Iterator(const RecordedEvaluations& evaluations, std::size_t number)
    : evaluations_(evaluations), number_(number) {
  read();
}

RecordedEvaluations::Iterator& RecordedEvaluations::Iterator::operator++() {
  ++number_;
  read();
  return *this;
}

RecordedEvaluations::Iterator RecordedEvaluations::Iterator::operator++(int) {
  Iterator before = *this;
  ++*this;
  return before;
}

void RecordedEvaluations::Iterator::read() {
  record_ = number_ < evaluations_.size() ? std::optional(evaluations_[number_]) : std::nullopt;
}

}  // namespace armwright
