// What is intact in a journal and what is not, record by record. Unlike read_journal() it goes on
// behind damage; it changes nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_result.hpp"
#include "study/survey/index_set.hpp"

namespace armwright {

// Bytes that are no record, with an intact one behind them.
struct DamagedStretch {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t records_before = 0;  // intact ones; the first damaged record has this number
  std::uint64_t records_behind = 0;  // intact ones, up to the next damaged stretch
  std::string fault;                 // of the first damaged record
};

struct JournalSurvey {
  std::uint64_t bytes = 0;
  std::uint64_t records = 0;  // intact, of every kind
  std::vector<DamagedStretch> damage;
  std::uint64_t torn_offset = 0;
  std::uint64_t torn_bytes = 0;  // at the end, with no intact record behind
  std::string torn_fault;
  IndexSet evaluations;  // of the training set
  RunCounts counts;      // of the training records, each evaluation once
  std::uint64_t judgements = 0;
  std::uint64_t repeated = 0;  // evaluations that are there again, alike
  // Evaluations that are there with different content: none of the records can be believed.
  std::vector<std::uint64_t> contradictory;
  std::optional<EndRecord> end;
  std::uint64_t records_behind_end = 0;

  // Evaluations that once were there. Of a run that has ended those that its end record counts,
  // otherwise gaps, if there is damage that explains them.
  std::vector<IndexRange> list_lost() const;
  // Gaps that an interruption leaves: evaluations that were under way.
  std::vector<IndexRange> list_gaps() const;
  // Whether the journal must be written anew to be of use.
  bool is_damaged() const;
};

// `look` is shown each intact training or judgement record once, in the order of the file.
// Error{io} if the file cannot be read or is no regular one.
JournalSurvey survey_journal(const std::filesystem::path& file,
                             const std::function<void(const EvaluationRecord&)>& look = {});

// What repair_journal() kept and left out.
struct JournalRepair {
  std::uint64_t records_kept = 0;
  std::uint64_t records_dropped = 0;  // intact ones, which say what cannot be true any more
  std::uint64_t bytes_dropped = 0;
};

// Writes to `target` (a new file, open for writing) a journal of the intact records of `file` that
// can be gone on with: without contradictory ones and without its end, as what is lost must be
// evaluated again. Error{io}.
JournalRepair repair_journal(const std::filesystem::path& file, const JournalSurvey& survey,
                             int target);

}  // namespace armwright
