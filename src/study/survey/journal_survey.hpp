// Surveys a journal record by record: which parts are intact and which are damaged. Unlike
// read_journal(), it continues behind damage. It does not change the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_result.hpp"
#include "study/survey/index_set.hpp"

namespace armwright {

// A stretch of bytes that hold no intact record, followed by an intact one.
struct DamagedStretch {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  // Number of intact records before it, which is also the number (from 0) of the first damaged one.
  std::uint64_t records_before = 0;
  std::uint64_t records_behind = 0;  // intact ones, up to the next damaged stretch
  std::string fault;                 // fault of the first damaged record
};

struct JournalSurvey {
  std::uint64_t bytes = 0;
  std::uint64_t records = 0;  // number of intact ones, of every kind
  std::vector<DamagedStretch> damage;
  std::uint64_t torn_offset = 0;
  std::uint64_t torn_bytes = 0;  // bytes at the end that no intact record follows
  std::string torn_fault;
  IndexSet evaluations;  // indices of the training evaluations
  RunCounts counts;      // counts of the training evaluations, each counted once
  std::uint64_t judgements = 0;
  std::uint64_t repeated_judgements = 0;  // judgements recorded again with the same content
  // Requests of judgements (as encode_request() returns them) that are recorded with different
  // contents. None of their records is used.
  std::set<std::string> contradictory_judgements;
  // Whether a validation has objectives, so that a run that has ended has a winner and its test.
  bool has_validation = false;
  bool has_test = false;
  std::uint64_t repeated = 0;  // evaluations recorded again with the same content
  // Evaluations that are recorded with different contents. None of their records is used.
  std::vector<std::uint64_t> contradictory;
  std::optional<EndRecord> end;  // nothing if the run has gone on with a larger budget
  bool is_continued = false;     // it has a ContinueRecord
  std::uint64_t records_behind_end = 0;

  // Returns the evaluations that were recorded once and are missing now. If the run has ended, its
  // end record tells how many there were. Otherwise these are the gaps, if the journal is damaged.
  std::vector<IndexRange> list_lost() const;
  // Returns the gaps that an interruption left: evaluations that were being simulated.
  std::vector<IndexRange> list_gaps() const;
  // Returns whether the run has ended, and its winner's test is missing.
  bool lacks_test() const { return end && has_validation && !has_test; }
  // Returns whether a run can use the journal only after a repair.
  bool is_damaged() const;
};

// Returns the design and the cases of a judgement as bytes.
std::string encode_request(const EvaluationRecord& judgement);

// Surveys the journal. Calls `look` once for each intact training or judgement record, in the order
// of the file. Throws Error{io} if the file cannot be read or is not a regular file.
JournalSurvey survey_journal(const std::filesystem::path& file,
                             const std::function<void(const EvaluationRecord&)>& look = {});

// The numbers of records and bytes that repair_journal() kept and dropped.
struct JournalRepair {
  std::uint64_t records_kept = 0;
  std::uint64_t records_dropped = 0;  // intact ones that are no longer valid
  std::uint64_t bytes_dropped = 0;
};

// Writes a journal with which the run can be resumed to `target` (a new file, open for writing). It
// has the intact records of `file` without contradictory ones. The end record is left out, because
// lost evaluations must be simulated again. Throws Error{io}.
JournalRepair repair_journal(const std::filesystem::path& file, const JournalSurvey& survey,
                             int target);

}  // namespace armwright
