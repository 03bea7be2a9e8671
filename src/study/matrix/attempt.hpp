// Attempts at a cell of a study by processes on any machines that see the study's folder. No lock
// between machines is needed. Each attempt owns one numbered folder; the number is its token:
//
//   STUDY/attempts/PROBLEM/OPTIMIZER/rNN/001, 002, ...
//
// Only one process can create a token's folder (mkdir is atomic, also on network file systems). An
// attempt writes only in its own folder until it publishes the finished cell. The attempt with the
// highest token is the valid one.
//
//   attempt.json   the owner: host, process, job, start time
//   alive          sign of life with the number of simulated cases; rewritten every ten seconds and
//                  removed at an orderly end
//   error.txt      the error that ended the attempt
//   run/           the cell as an ordinary run; published as cells/PROBLEM/OPTIMIZER/rNN
//   aside/         an unfinished cell that was moved away from there
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

inline constexpr const char* kAttemptsFolder = "attempts";

std::filesystem::path make_attempts_path(const StudyPlan& plan, const Cell& cell,
                                         const std::filesystem::path& study);

// Returns the tokens of the attempts in such a folder, ascending; none if the folder is missing.
std::vector<int> list_tokens(const std::filesystem::path& attempts);
std::filesystem::path make_token_path(const std::filesystem::path& attempts, int token);

// The owner of an attempt.
struct AttemptRecord {
  std::string host;
  std::int64_t pid = 0;
  std::string job;                   // "slurm 12_3", "pbs 7.head"; empty outside of a batch system
  std::string started;               // UTC
  std::int64_t process_begun_s = 0;  // Unix time; the process may have run other cells before
};
AttemptRecord describe_this_process(std::int64_t begun_s);
std::string to_json(const AttemptRecord& record);
// Throws Error{bad_data} with the name of `file`.
AttemptRecord parse_attempt(const std::string& text, const std::filesystem::path& file);

// An attempt of this process.
class Attempt {
 public:
  // Takes the next free token in `attempts`, which lies in the folder of a study, and writes
  // attempt.json. Throws Error{io}, and Error{bad_data} if a link is in the way (Folder::make).
  Attempt(const std::filesystem::path& attempts, const std::filesystem::path& study,
          std::int64_t process_begun_s);

  int token() const { return token_; }
  std::filesystem::path run() const { return folder_.path() / "run"; }
  std::filesystem::path aside() const { return folder_.path() / "aside"; }

  // Returns "superseded by attempt 3", or an empty text while this attempt is the newest.
  std::string find_successor() const;

  // Writes the sign of life.
  void tell_alive(std::uint64_t cases) const;
  // Removes the sign of life: other processes then expect none.
  void end_in_order() const;
  void record_error(const std::string& error) const;

 private:
  std::filesystem::path attempts_;
  int token_ = 0;
  Folder folder_;
  std::string record_;  // text of attempt.json
};

// The state of an attempt as other processes see it in its folder.
struct AttemptState {
  int token = 0;
  std::optional<AttemptRecord> record;  // empty if it is missing or cannot be read
  std::optional<double> silence_s;      // time since the last sign of life, while one is expected
  std::optional<std::uint64_t> cases;   // simulated until the last sign of life
  std::string error;                    // empty unless an error ended the attempt
};
AttemptState read_attempt(const std::filesystem::path& attempts, int token);

// Returns "superseded by attempt 3" if the newest attempt belongs to a later start of this
// process's batch job, otherwise an empty text. A process that began at `begun_s` was then left
// behind by a lost node and must not begin another cell.
std::string find_later_life(const std::filesystem::path& attempts, std::int64_t begun_s);

// Moves the finished cell in `run` to its place, cells/PROBLEM/OPTIMIZER/rNN. Uses one rename,
// which fails if a finished cell is there, so exactly one of several finished ones is published.
// Returns false if another one was there before; cells are deterministic, so it is equally good. An
// unfinished cell in the place is moved to `aside` first. `run` must be on the study's file system.
// Throws Error{busy} if a local comparison is writing the cell, Error{bad_data} if another cell's
// record is there, or Error{io}.
bool publish_cell(const StudyPlan& plan, const Cell& cell, const std::filesystem::path& study,
                  const std::filesystem::path& run, const std::filesystem::path& aside);

// Longest time without a sign of life until an attempt counts as silent. Signs of life are written
// every ten seconds, and network file systems may show them late.
inline constexpr double kLongestSilence_s = 60;

}  // namespace armwright
