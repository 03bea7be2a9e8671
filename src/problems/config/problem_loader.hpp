// Loads problems: from a shipped name, a TOML file or the record of a run to a problem that is
// ready to run, with the settings that belong to it. Every setting is checked here, before the
// first evaluation. Messages name file, line, field, value and what is allowed. Files that a
// problem names by a relative path are looked for beside the problem's file first.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/setting.hpp"
#include "problems/analytic/analytic.hpp"
#include "problems/interface/problem.hpp"
#include "problems/interface/schedule.hpp"
#include "problems/tracking/tracking_problem.hpp"
#include "problems/user/case_server.hpp"
#include "sim/engines/engine_table.hpp"

namespace armwright {

// The names of the three sets of test cases, and how many cases are judged.
struct CaseSets {
  std::string training = "train/1";
  std::string validation = "validation/1";
  std::string test = "test/2";
  int validation_cases = 100;
  int test_cases = 500;
  // How many training cases there are. 0: as many as a schedule asks for.
  std::int64_t training_cases = 0;
};

// The result that the source of a problem reports for its winner. The numbers are left out if the
// problem has another value of a setting of `set`.
struct PublishedWinner {
  std::optional<double> error_m;
  std::optional<double> total_torque_n_m;
  std::string design;
  std::string where;
  std::vector<std::string> set = {};  // KEY=VALUE texts
  std::string difference = {};        // why the numbers are left out; empty if they are not
};

// A sweep: one design is evaluated at several values of one setting, without optimization.
struct SweepPlan {
  std::string parameter;  // the setting, "task.speed_m_per_s"
  std::vector<double> values;
  std::string design;
};

struct LoadedProblem {
  std::string name;   // folders of its runs have it too
  std::string title;  // one line
  std::shared_ptr<const Problem> problem;
  // Returns the tracking problem; null for an analytic function. Valid as long as `problem`.
  const TrackingProblem* tracking() const { return problem->tracking(); }
  std::optional<FunctionChoice> function;  // of an analytic function
  // The program of a user's problem, as the user typed it: "exec:python3 motor.py"; else empty.
  std::string program;
  bool is_deterministic = true;  // false: the same case of the same design can have other results
  Schedule schedule;
  int fixed_cases = 5;  // K for optimizers without generations, if the schedule needs generations
  Racing racing;
  CaseSets sets;
  std::string optimizer;    // default of `armwright optimize`
  std::int64_t budget = 0;  // the same, in training cases
  PublishedWinner published;
  std::optional<SweepPlan> sweep;
  // The whole configuration as JSON, with inheritance, overrides and settled values: the SIMD level
  // of engines with SIMD, the contents of a perturbation preset, and what is proposed for a robot.
  std::string resolved_json;
  std::map<std::string, std::string>
      input_hashes;  // file name -> SHA-256 of every file that the configuration refers to
};

// Where the programs of users' problems come from.
struct ProgramSource {
  bool may_describe = true;  // false: a program needs a recorded description
  bool may_simulate = true;  // false: no simulation can start a program
  // Problems that the calling program computes itself, by name: "python:motor".
  std::vector<UserProgram> hosts = {};
};

// Loads a shipped problem by name, a file, or a problem that a user has written by its program:
// "exec:python3 motor.py". `overrides` are KEY=VALUE texts that replace values
// of the file ("task.speed_m_per_s=2"). `engines` are the engines to choose from. Throws
// Error{usage} for a wrong setting, Error{bad_data} for a wrong file that a setting names,
// Error{io} for a file that cannot be read.
LoadedProblem load_problem(std::string_view name_or_path,
                           std::span<const std::string> overrides = {},
                           std::span<const EngineRow> engines = engine_table(),
                           const ProgramSource& programs = {});

// Returns whether load_problem() starts a program that describes the problem, or opens a library. A
// problem with a recorded description needs none. Throws Error{usage} if there is no such problem or
// its file is not valid, Error{io} if the file cannot be read.
bool needs_program(std::string_view name_or_path, std::span<const std::string> overrides);

// Returns the settings with which a problem keeps what was proposed for its robot: workspace, speed,
// control period and start, as `resolved`, a recorded or loaded configuration of any version, has
// them.
std::vector<std::string> list_proposals(nlohmann::json resolved);

// Loads the problem that a run recorded as LoadedProblem::resolved_json, also of a replicate
// (make_replicate). It does not read the problem's file and starts no program. Files that the configuration names by a
// relative path are looked for in `beside` first; the caller must compare input_hashes to see
// whether they have changed. Throws Error as load_problem(), and Error{bad_data} for other texts.
LoadedProblem load_recorded_problem(const std::string& resolved_json, const std::string& name,
                                    const std::filesystem::path& beside);

// Returns the problem as one replicate of a comparison has it: with another training set
// ("train/NAME") and another start (one value per variable, within the bounds). A function with an
// instance per replicate gets the instance of replicate number `replicate` >= 1. Everything else
// that decides what a design is worth is the same. The resolved configuration holds the changes as
// "sets.training", "replicate.start" and "function.instance". Throws Error{usage} if the function
// has no instance with that number.
LoadedProblem make_replicate(const LoadedProblem& problem, int replicate,
                             const std::string& training_set, const std::vector<double>& start);

struct ProblemTitle {
  std::string name;
  std::string title;
};
// Returns the shipped problems, by name.
std::vector<ProblemTitle> list_problems();

// Returns the declarations of every setting of a problem's file.
const SettingTable& problem_settings();

}  // namespace armwright
