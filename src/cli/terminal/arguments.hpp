// Values on the command line, and the flags that several subcommands share. Values are read
// strictly: each refusal is an Error{usage} that names the flag, the value found and the values
// allowed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/read_limit.hpp"
#include "problems/config/problem_loader.hpp"

namespace CLI {
class App;
}

namespace armwright {

class StopSignal;
struct Session;

// Returns the integer in `text`. Throws Error{usage} if it is not from `lower` to `upper`.
std::int64_t parse_count(std::string_view flag, std::string_view text, std::int64_t lower,
                         std::int64_t upper);
// Returns the seconds that "90", "90s", "10m" or "1.5h" stand for. Throws Error{usage} unless they
// are above 0.
double parse_duration_s(std::string_view flag, std::string_view text);
// Reads "60s,4GiB", "60s" or "4GiB", the value of --read-limit. What the text leaves out keeps its
// default. Throws Error{usage}.
ReadLimit parse_read_limit(std::string_view text);
// Reads the value of --schedule (kScheduleForms). Throws Error{usage}.
Schedule parse_schedule(std::string_view text);
// Reads the value of --racing. Throws Error{usage}.
Racing parse_racing(std::string_view text);

// The last line of every command's --help. Manual pages leave it out, as they have a section with
// the exit codes.
inline constexpr std::string_view kSeeExitCodes =
    "\n\nExit codes and environment: armwright --help";

// Adds a subcommand with --color and with `examples` below its help. The parser owns the
// subcommand.
CLI::App* add_command(CLI::App& parent, Session& session, const std::string& name,
                      const std::string& description, const std::string& examples);

// Adds --jobs, which $ARMWRIGHT_JOBS can replace. `jobs` must live as long as the parser.
// `fallback` is the default as the help names it.
void add_jobs_flag(CLI::App& command, std::string& jobs, const std::string& fallback = "all cores");
// Returns the number of threads that --jobs names, or all cores of this process if the flag was not
// given. Throws Error{usage}.
unsigned parse_jobs(std::string_view text);
// The same, but returns 1 if the flag was not given.
unsigned parse_jobs_or_one(std::string_view text);

// Adds --time-limit. `time_limit` must live as long as the parser.
void add_time_limit_flag(CLI::App& command, std::string& time_limit);
// Sets the deadline of `stop` to now plus the time limit, if there is one. Throws Error{usage}.
void apply_time_limit(std::string_view time_limit, StopSignal& stop);

// Adds --trust. `trust` must live as long as the parser.
void add_trust_flag(CLI::App& command, bool& trust);
// Returns what answers questions about plugins: yes with --trust, otherwise what the user says on
// the terminal, and no without a terminal.
std::function<bool(const std::string& question)> make_asker(bool trust);

// The flags --out and --new, which choose the folder of a run, study or reproduction.
struct FolderOptions {
  std::string out;
  bool another = false;
  // `what` is the thing that the folder holds, for example "run". `fallback` is the default folder
  // as the help names it.
  void add_to(CLI::App& command, const std::string& what, const std::string& fallback);
  // Returns the folder that --out names, or results/NAME without --out. With --new, the result is
  // the first of NAME, NAME-002, NAME-003, ... that does not exist.
  std::filesystem::path choose(const std::string& name) const;
};

// Adds the argument DESIGN. `design` must live as long as the parser.
void add_design_argument(CLI::App& command, std::string& design);

// The flags that choose the physics engine. Each stands for a setting of the problem's table
// [physics].
struct EngineFlags {
  std::string engine;
  std::string judging_engine;
  std::string precision;
  std::string simd;
  bool trains = false;

  // A command that trains also has --judging-engine and --precision. In other commands, --engine
  // sets the engine that judges.
  void add_to(CLI::App& command, bool with_training);
  // Returns the settings as KEY=VALUE texts. Throws Error{usage} for an unknown name.
  std::vector<std::string> get() const;
};

// Adds --base, --tip and --package, which say how a robot's file is read. The values must live as
// long as the parser. `has_set`: the command has --set, so that the help names the settings.
void add_robot_flags(CLI::App& command, std::string& base, std::string& tip,
                     std::vector<std::string>& packages, bool has_set);
// Returns the values NAME=DIR of --package with absolute folders. Throws Error{usage} for a value of
// another form and for a folder that does not exist.
std::vector<std::string> make_absolute_packages(std::span<const std::string> packages);

// All flags that change the problem: --set, those of the engine, and --robot, --plant, --base, --tip
// and --package, which stand for settings of the table [robot].
struct OverrideOptions {
  std::vector<std::string> set;
  EngineFlags engines;
  std::string robot;
  std::string plant;
  std::string base;
  std::string tip;
  std::vector<std::string> packages;

  void add_to(CLI::App& command, bool with_training = false);
  // Returns the changes as KEY=VALUE texts, those of --set first. Throws Error{usage} if --set and
  // another flag change the same setting, for an unknown engine, and if the robot's file is
  // missing.
  std::vector<std::string> get() const;
  // Returns the name of the problem: as typed, or "robot" if none was typed and --robot was given.
  // The result is empty if neither was given.
  std::string choose_problem(const std::string& typed) const;

 private:
  std::vector<std::string> list_flag_overrides() const;
};
// Returns the part of a KEY=VALUE text before the '=', without blanks around it.
std::string_view get_override_key(std::string_view assignment);
// Returns the texts of `own` whose keys `changes` do not have, and then the changes.
std::vector<std::string> replace_overrides(std::vector<std::string> own,
                                           const std::vector<std::string>& changes);

// The flags --test-set, --test-cases and --cases, which choose the cases that a design is evaluated
// on.
struct CaseOptions {
  std::string test_set;
  std::string test_cases;
  std::string cases;
  void add_to(CLI::App& command);
};

}  // namespace armwright
