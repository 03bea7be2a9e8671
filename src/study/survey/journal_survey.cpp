#include "study/survey/journal_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "base/hash.hpp"
#include "study/journal/journal_file.hpp"
#include "study/journal/journal_format.hpp"
#include "study/journal/journal_reader.hpp"

namespace armwright {
namespace {

using journal_format::kMagic;
using journal_format::Record;

struct Place {
  std::uint64_t offset = 0;
  std::uint64_t end = 0;
};

// Visits a journal from begin to end. `on_record` gets each intact record and its place. `on_gap`
// gets each stretch between records with its fault. `on_end` gets the stretch behind the last one.
template <class OnRecord, class OnGap, class OnEnd>
void visit_records(JournalWindow& window, OnRecord on_record, OnGap on_gap, OnEnd on_end) {
  const auto begin_bytes = std::min<std::uint64_t>(window.size(), kMagic.size());
  std::uint64_t offset = kMagic.size();
  window.begin_search();
  if (window.view(0, begin_bytes) != kMagic.substr(0, begin_bytes)) {
    const bool begins_well = window.size() > offset && read_record(window, offset).record;
    const auto next = begins_well ? std::optional(offset) : find_intact_record(window, 0);
    if (!next) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: holds no intact record and is not an armwright journal (one "
                              "begins with the bytes {})",
                              window.file().string(), kMagic));
    }
    on_gap(Place{0, *next}, fmt::format("the journal does not begin with the bytes {}", kMagic));
    offset = *next;
  } else if (begin_bytes < kMagic.size()) {
    on_end(Place{0, begin_bytes}, "the first bytes are cut short");
    return;
  }
  while (offset < window.size()) {
    RecordAttempt attempt = read_record(window, offset);
    if (attempt.record) {
      on_record(*attempt.record, Place{offset, attempt.end});
      offset = attempt.end;
      continue;
    }
    const auto next = find_intact_record(window, offset);
    if (window.has_given_up()) {
      on_gap(Place{offset, window.size()}, fmt::format("{}, and {}", attempt.fault, kGivenUp));
      return;
    }
    if (!next) {
      on_end(Place{offset, window.size()}, attempt.fault);
      return;
    }
    on_gap(Place{offset, *next}, attempt.fault);
    offset = *next;
  }
}

class JournalSurveyor {
 public:
  JournalSurveyor(const std::filesystem::path& file,
                  const std::function<void(const EvaluationRecord&)>& look)
      : file_(open_to_read(file)), window_(file_.get(), file), look_(look) {}

  JournalSurvey run() {
    survey_.bytes = window_.size();
    visit_records(
        window_, [&](const Record& record, Place place) { add_record(record, place); },
        [&](Place place, std::string fault) {
          survey_.damage.push_back({.offset = place.offset,
                                    .bytes = place.end - place.offset,
                                    .records_before = survey_.records,
                                    .fault = std::move(fault)});
        },
        [&](Place place, std::string fault) {
          survey_.torn_offset = place.offset;
          survey_.torn_bytes = place.end - place.offset;
          survey_.torn_fault = std::move(fault);
        });
    compare_repeated();
    return std::move(survey_);
  }

 private:
  void add_record(const Record& record, Place place) {
    ++survey_.records;
    if (!survey_.damage.empty()) {
      ++survey_.damage.back().records_behind;
    }
    if (std::holds_alternative<ContinueRecord>(record)) {
      survey_.end.reset();
      survey_.is_continued = true;
      return;
    }
    if (survey_.end) {
      ++survey_.records_behind_end;
    }
    if (const auto* end = std::get_if<EndRecord>(&record)) {
      survey_.end = *end;
      return;
    }
    if (std::holds_alternative<LateRecommendations>(record)) {
      return;
    }
    const auto& evaluation = std::get<EvaluationRecord>(record);
    if (evaluation.cases.role != CaseRole::training) {
      add_judgement(evaluation);
    } else if (survey_.evaluations.insert(evaluation.index)) {
      survey_.counts.add(evaluation);
    } else {
      repeated_[evaluation.index].push_back(place);
      return;
    }
    if (look_) {
      look_(evaluation);
    }
  }

  void add_judgement(const EvaluationRecord& judgement) {
    ++survey_.judgements;
    const bool is_test = judgement.cases.role == CaseRole::test;
    survey_.has_test = survey_.has_test || is_test;
    survey_.has_validation =
        survey_.has_validation || (!is_test && !judgement.evaluation.objectives.empty());
    std::string content;
    journal_format::encode(judgement, content);
    const std::string request = encode_request(judgement);
    const auto [first, is_new] = judgements_.emplace(request, calc_sha256_hex(content));
    if (is_new) {
      return;
    }
    if (first->second == calc_sha256_hex(content)) {
      ++survey_.repeated_judgements;
    } else {
      survey_.contradictory_judgements.insert(request);
    }
  }

  std::string read(Place place) {
    return std::string(window_.view(place.offset, place.end - place.offset));
  }

  // Reads the journal again to find the first record of every repeated evaluation. The first pass
  // keeps only places of repeated records, to save memory.
  void compare_repeated() {
    if (repeated_.empty()) {
      return;
    }
    std::set<std::uint64_t> differing;
    std::set<std::uint64_t> seen;
    visit_records(
        window_,
        [&](const Record& record, Place place) {
          const auto* evaluation = std::get_if<EvaluationRecord>(&record);
          if (evaluation == nullptr || evaluation->cases.role != CaseRole::training) {
            return;
          }
          const auto again = repeated_.find(evaluation->index);
          if (again == repeated_.end() || !seen.insert(evaluation->index).second) {
            return;
          }
          const std::string first = read(place);
          for (const Place other : again->second) {
            if (read(other) != first) {
              differing.insert(evaluation->index);
            }
          }
        },
        [](Place, const std::string&) {}, [](Place, const std::string&) {});
    survey_.contradictory.assign(differing.begin(), differing.end());
    survey_.repeated = repeated_.size() - differing.size();
  }

  FileDescriptor file_;
  JournalWindow window_;
  const std::function<void(const EvaluationRecord&)>& look_;
  JournalSurvey survey_;
  std::map<std::string, std::string> judgements_;         // request -> SHA-256 of its first record
  std::map<std::uint64_t, std::vector<Place>> repeated_;  // by evaluation, without its first record
};

}  // namespace

std::vector<IndexRange> JournalSurvey::list_lost() const {
  if (end) {
    return evaluations.list_missing(end->evaluations);
  }
  return damage.empty() ? std::vector<IndexRange>() : evaluations.list_missing(evaluations.end());
}

std::vector<IndexRange> JournalSurvey::list_gaps() const {
  return end || !damage.empty() ? std::vector<IndexRange>()
                                : evaluations.list_missing(evaluations.end());
}

bool JournalSurvey::is_damaged() const {
  return !damage.empty() || !contradictory.empty() || !contradictory_judgements.empty() ||
         records_behind_end > 0 || lacks_test() || (end && !list_lost().empty());
}

std::string encode_request(const EvaluationRecord& judgement) {
  EvaluationRecord request;
  request.x = judgement.x;
  request.cases = judgement.cases;
  std::string bytes;
  journal_format::encode(request, bytes);
  return bytes;
}

JournalSurvey survey_journal(const std::filesystem::path& file,
                             const std::function<void(const EvaluationRecord&)>& look) {
  return JournalSurveyor(file, look).run();
}

JournalRepair repair_journal(const std::filesystem::path& file, const JournalSurvey& survey,
                             int target) {
  constexpr std::size_t kBuffer_bytes = std::size_t{1} << 20;
  const FileDescriptor source = open_to_read(file);
  JournalWindow window(source.get(), file);
  JournalRepair repair;
  std::string buffer(kMagic);
  const auto write = [&] {
    if (const int error = write_fully(target, buffer).error; error != 0) {
      fail_io(file, "write its repaired copy", error);
    }
    buffer.clear();
  };
  const auto drop = [&](Place place, const std::string&) {
    repair.bytes_dropped += place.end - place.offset;
  };
  visit_records(
      window,
      [&](const Record& record, Place place) {
        const auto* evaluation = std::get_if<EvaluationRecord>(&record);
        const bool is_kept =
            std::holds_alternative<LateRecommendations>(record) ||
            std::holds_alternative<ContinueRecord>(record) ||
            (evaluation != nullptr &&
             (evaluation->cases.role != CaseRole::training
                  ? !survey.contradictory_judgements.contains(encode_request(*evaluation))
                  : !std::ranges::binary_search(survey.contradictory, evaluation->index)));
        if (!is_kept) {
          ++repair.records_dropped;
          return;
        }
        ++repair.records_kept;
        buffer += window.view(place.offset, place.end - place.offset);
        if (buffer.size() >= kBuffer_bytes) {
          write();
        }
      },
      drop, drop);
  write();
  return repair;
}

}  // namespace armwright
