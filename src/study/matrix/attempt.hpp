// Attempts at a cell of a study by processes anywhere that see its folder. Nothing here relies on a
// lock between machines: an attempt owns the folder of its token,
//
//   STUDY/attempts/PROBLEM/OPTIMIZER/rNN/001, 002, ...
//
// which it alone has made (mkdir is atomic, on network file systems too), and writes nowhere else
// until it publishes (publication.hpp). The highest token is the valid one.
//
//   attempt.json   who: host, process, job, when begun
//   alive          sign of life, rewritten every ten seconds with the cases done; removed at an
//                  orderly end
//   error.txt      why it broke
//   run/           the cell as an ordinary run; as a whole it becomes cells/PROBLEM/OPTIMIZER/rNN
//   aside/         an unfinished cell that lay where run/ had to go
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

inline constexpr const char* kAttemptsFolder = "attempts";

std::filesystem::path make_attempts_path(const StudyPlan& plan, const Cell& cell,
                                         const std::filesystem::path& study);

// Of the attempts in such a folder, ascending; none if it is not there.
std::vector<int> list_tokens(const std::filesystem::path& attempts);
std::filesystem::path make_token_path(const std::filesystem::path& attempts, int token);

// Who made an attempt.
struct AttemptRecord {
  std::string host;
  std::int64_t pid = 0;
  std::string job;                   // "slurm 12_3", "pbs 7.head"; empty outside of a batch system
  std::string started;               // UTC
  std::int64_t process_begun_s = 0;  // Unix time at which the process began, perhaps at other cells
};
AttemptRecord describe_this_process(std::int64_t begun_s);
std::string to_json(const AttemptRecord& record);
// Error{bad_data}.
AttemptRecord parse_attempt(const std::string& text, const std::filesystem::path& file);

class Attempt {
 public:
  // Takes the next free token and says who it is. Error{io}.
  Attempt(const std::filesystem::path& attempts, std::int64_t process_begun_s);

  int token() const { return token_; }
  std::filesystem::path run() const { return path_ / "run"; }
  std::filesystem::path aside() const { return path_ / "aside"; }

  // "superseded by attempt 3"; empty while nobody came after us.
  std::string find_successor() const;

  void tell_alive(std::uint64_t cases) const;
  void end_in_order() const;  // no sign of life is expected any more
  void record_error(const std::string& error) const;

 private:
  std::filesystem::path attempts_;
  int token_ = 0;
  std::filesystem::path path_;
  std::string record_;  // attempt.json
};

// What an attempt's folder shows to others, whatever state it is in.
struct AttemptState {
  int token = 0;
  std::optional<AttemptRecord> record;  // nothing if it has none, or none that can be read
  std::optional<double> silence_s;      // since the last sign of life, while one is expected
  std::optional<std::uint64_t> cases;   // done at that time
  std::string error;                    // empty unless it broke
};
AttemptState read_attempt(const std::filesystem::path& attempts, int token);

// Whether the newest attempt is of the same job of a batch system in a later life: then a process
// that began at `begun_s` is what a lost node has left of an earlier one, between two cells, and
// must not begin another. Names the attempt: "superseded by attempt 3"; empty if it is not so.
std::string find_later_life(const std::filesystem::path& attempts, std::int64_t begun_s);

// Signs of life come every ten seconds, and network file systems may show them late.
inline constexpr double kLongestSilence_s = 60;

}  // namespace armwright
