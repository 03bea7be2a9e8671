// Values on the command line, read strictly: every refusal names the flag, what was found and what
// is allowed (Error{usage}). And the flags that several subcommands share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "problems/config/problem_loader.hpp"

namespace CLI {
class App;
}

namespace armwright {

class StopSignal;
struct Session;

std::int64_t parse_count(std::string_view flag, std::string_view text, std::int64_t lower,
                         std::int64_t upper);
// "90", "90s", "10m", "1.5h"
double parse_duration_s(std::string_view flag, std::string_view text);
// "fresh:K", "fixed:K" or "coevolution:K"
Schedule parse_schedule(std::string_view text);
Racing parse_racing(std::string_view text);

// Behind every command's examples; manual pages have a section of their own instead.
inline constexpr std::string_view kSeeExitCodes =
    "\n\nExit codes and environment: armwright --help";

// A new subcommand with what all have: --color, and examples below its help.
CLI::App* add_command(CLI::App& parent, Session& session, const std::string& name,
                      const std::string& description, const std::string& examples);

// --jobs and $ARMWRIGHT_JOBS.
struct JobsOption {
  std::string text;
  // `fallback`: as help says it.
  void add_to(CLI::App& command, const std::string& fallback = "all cores");
  unsigned get() const;  // all cores unless told otherwise
  unsigned get_or(unsigned fallback) const { return text.empty() ? fallback : get(); }
};

// --time-limit: a run that is stopped by it can be gone on with.
struct TimeLimitOption {
  std::string text;
  void add_to(CLI::App& command);
  void apply(StopSignal& stop) const;  // from now on
};

// --out and --new: where what is made goes.
struct FolderOptions {
  std::string out;
  bool another = false;
  // `what`: "run"; `fallback`: the folder if none is named, as help says it.
  void add_to(CLI::App& command, const std::string& what, const std::string& fallback);
  // results/NAME unless told otherwise.
  std::filesystem::path choose(const std::string& name) const;
};

// The argument DESIGN.
void add_design_argument(CLI::App& command, std::string& design);

// Which physics engine, and how: short for settings of the problem's table [physics].
struct EngineFlags {
  std::string engine;
  std::string judging_engine;
  std::string precision;
  std::string simd;
  bool trains = false;

  // A command that trains knows --judging-engine and --precision besides. In others there is one
  // engine, and --engine means it.
  void add_to(CLI::App& command, bool with_training);
  // As KEY=VALUE texts. Error{usage} for a name that does not exist.
  std::vector<std::string> get() const;
};

// --robot, --base and --tip: the user's own arm, short for settings of the table [robot].
struct RobotFlags {
  std::string robot;
  std::string base;
  std::string tip;

  void add_to(CLI::App& command);
  // As KEY=VALUE texts. Error{usage} if there is no such file.
  std::vector<std::string> get() const;
};

// --set and the flags above: what is changed about a problem.
struct OverrideOptions {
  std::vector<std::string> set;
  EngineFlags engines;
  RobotFlags robot;
  void add_to(CLI::App& command, bool with_training = false);
  // Error{usage} where --set and another flag set the same.
  std::vector<std::string> get() const;
  // The problem as typed; with --robot the one for any arm, where none is.
  std::string choose_problem(const std::string& typed) const;
};
// The part before the '=' of a KEY=VALUE text, without blanks around it.
std::string_view get_override_key(std::string_view assignment);

// --test-set, --test-cases and --cases: what a design is evaluated on.
struct CaseOptions {
  std::string test_set;
  std::string test_cases;
  std::string cases;
  void add_to(CLI::App& command);
};

}  // namespace armwright
