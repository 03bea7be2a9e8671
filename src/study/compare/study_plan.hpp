// The plan of a comparison: problems x optimizers x replicates, under equal conditions.
//
// A cell is one run: optimizer `o` on problem `p` in replicate `r`. In one replicate every
// optimizer gets the same training cases (set train/STUDY-SEED-P-R) and the same start point. The
// start is a uniform draw from a box around the problem's own start, on the variables' scales. All
// noise comes with the training cases, so it is the same too. The optimizer's own random numbers
// come from a stream named after the problem, the replicate and what the optimizer is
// (optimizer_streams.hpp). No random number depends on the plan as a whole, so a plan can be
// extended.
//
// All optimizers have the same budget, in simulated training cases; a plan cannot give one of them
// more. The problem defines how the budget is spent (schedule, racing, perturbed plants in
// training) and which controller the designs have. An optimizer's entry may override these settings
// and then defines a method: "ga on one fresh case per generation" beside "ga on five fixed ones".
// The requirements on a design are the same for all methods.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/setting.hpp"
#include "study/compare/study_schedules.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

struct StudyProblem {
  std::string label;  // unique in the plan; used in tables, folder names and random streams
  std::string name;   // as the user wrote it: a shipped name or a path
  std::vector<std::string> settings;  // KEY=VALUE, every change to the problem's settings
  LoadedProblem loaded;
  // The schedule of all optimizers without one of their own. Its K also defines the checkpoints.
  Schedule schedule;
  // True if every optimizer gets its StudyOptimizer::own_schedule instead. Never true for a
  // function, which has no training cases.
  bool own_schedules = false;
};

struct StudyOptimizer {
  std::string label;                 // unique in the plan
  bool has_given_label = false;      // by the plan; otherwise optimizer_labels.hpp chooses it
  std::string name;                  // as the user wrote it
  std::vector<std::string> options;  // KEY=VALUE
  bool baseline = false;             // added by armwright, unless the plan turns baselines off
  OptimizerRow row;
  Options parsed;
  // Only for methods: a schedule that replaces the problem's, and KEY=VALUE settings that override
  // the problem's. They do not change the requirements on a design (study_methods.hpp).
  std::optional<Schedule> schedule;
  std::vector<std::string> settings;
  std::map<std::string, LoadedProblem> loaded;  // with these settings; key: problem label
  Schedule own_schedule;  // on problems with own schedules, unless `schedule` replaces it
  std::string stream;     // names its random streams; unique in the plan (optimizer_streams.hpp)
};

// A fixed target: the quality that a design must have on the test set. At least one of `value` and
// `failures` is set.
struct StudyTarget {
  std::string label;                     // unique in the plan
  std::vector<std::string> problems;     // labels
  std::optional<double> value;           // largest allowed objective
  std::optional<std::int64_t> failures;  // largest allowed number of failing test cases
};

// Defines the value of a run: the winner's objective on the test set, or the share of test cases in
// which the winner fails.
enum class StudyValue : std::uint8_t { objective, failures };

struct StudyPlan {
  std::string name;  // the name of the study's folder
  std::string title;
  std::uint64_t seed = 1;
  int replicates = 15;
  std::int64_t budget = 0;  // simulated training cases per cell
  // Width of the box from which starts are drawn, as a fraction (0 to 2) of the bounds' width.
  // A part of the box outside the bounds is cut off.
  double start_spread = 0.1;
  Selection selection{.last = 9, .best = 5, .most = 9};
  // If true, every checkpoint has judged candidates, and the winner is the best of them all on the
  // validation set. If false, only the candidates at the end of the run are judged. Long training on
  // few cases can end with designs that fail on all other cases.
  bool judge_along = false;
  // A winner has a value only if each of its constraints g on the test set is at most this number.
  // A number above 0 allows for the fact that no design was trained on the test set.
  double constraint_tolerance = 0;
  // The largest number of checkpoints: budgets, logarithmically spaced, at which the incumbents are
  // tested.
  int checkpoints = 20;
  // The smallest checkpoint, in cases. If the budget is smaller, the budget is the only checkpoint.
  std::int64_t first_checkpoint = 1;
  // Engine that simulates the best design of every optimizer and problem again; empty for none.
  std::string final_engine;
  bool baselines = true;  // adds the start, a random search and a local search to the optimizers
  StudyValue value = StudyValue::objective;
  std::vector<StudyTarget> targets;
  // Label of the reference optimizer. Tables show the expected running time of every optimizer also
  // divided by that of the reference. Empty for no reference.
  std::string reference;
  std::vector<StudyProblem> problems;
  std::vector<StudyOptimizer> optimizers;
  ProgramSource programs;  // where the programs of users' problems come from
};

// The baselines, which are part of every comparison: a useful method must beat all of them.
inline constexpr std::string_view kStartBaseline = "start";
inline constexpr std::string_view kRandomBaseline = "random";
inline constexpr std::string_view kLocalBaseline = "nlopt:neldermead";

// What make_study_plan() does with plugins.
enum class PluginUse : std::uint8_t {
  // Starts or opens them, so that the plan can run. Those of a recorded plan need consent, and so do
  // the programs of its problems (plugin_consent.hpp).
  run,
  // Takes those of a recorded plan from the record. Starts or opens the others.
  preview,
  // Starts and opens none. The plan can be read, but cells of plugins cannot run.
  read
};

// Asks the user a question. Returns true for yes. An empty one stands for no.
using AskUser = std::function<bool(const std::string& question)>;

// The input of make_study_plan(): a file, flags, or both. Flags override the file.
struct StudyRequest {
  std::string file;  // a path, or the name of a shipped study; empty: only flags
  std::vector<std::string> problems;
  std::vector<std::string> optimizers;
  std::vector<std::string> settings;  // for every problem
  std::optional<int> replicates;
  std::optional<std::int64_t> budget;
  std::optional<StudySchedule> schedule;
  std::optional<std::uint64_t> seed;
  bool baselines = true;
  // Optimizers that the calling program implements itself, by name
  // (optimizers/plugins/recorded_optimizer.hpp).
  std::vector<OptimizerRow> rows = {};
  std::vector<UserProgram> hosts = {};  // problems that it computes itself, likewise
  PluginUse plugins = PluginUse::run;
  // A rank of mpirun beside rank 0: with PluginUse::read, the programs of problems may describe
  // themselves, because this rank simulates.
  bool is_rank = false;
  AskUser ask = {};  // whether plugins and programs of a recorded plan may run
};

// Reads, completes and checks the whole plan. Throws Error{usage} or Error{bad_data}; Error{usage}
// too if plugins of a recorded plan need consent and the user does not give it.
StudyPlan make_study_plan(const StudyRequest& request);

// Returns the SHA-256 of a problem's resolved configuration and of the hashes of the files that it
// refers to. Reads no file and throws no Error.
std::string calc_configuration_hash(const LoadedProblem& problem);

// Throws Error{bad_data} if the file is a resolved plan (to_toml()) that was changed later, and
// Error{io} if it cannot be read. Does nothing for a file without a recorded hash.
void check_plan_hash(const std::filesystem::path& path);

// Adds to `plan` every baseline of the recorded plan that `plan` lacks. Example: the recorded plan
// has the baseline nlopt:neldermead; if the user adds another local search to the study,
// make_study_plan() adds no local baseline, but the recorded cells need it. Ignores a baseline that
// is a plugin: armwright adds only its own optimizers. Throws Error{usage} or Error{bad_data} if the
// file or a baseline cannot be loaded, Error{io} if a file cannot be read.
void keep_baselines(const std::filesystem::path& recorded, StudyPlan& plan);

// Gives arms of `plan` the SIMD level of the recorded plan, where "auto" means another one on this
// machine. Throws as keep_baselines().
void keep_simd_levels(const std::filesystem::path& recorded, StudyPlan& plan);

// Content of a study's file that needs no loading of problems and optimizers.
struct StudyOutline {
  std::string name;
  std::string title;
  std::vector<std::string> problems = {};  // labels, or names where the file gives no label
  // Likewise. Lacks the baselines that the file does not name.
  std::vector<std::string> optimizers = {};
  int replicates = 0;
  std::int64_t budget = 0;  // 0: the file has none
  // True if make_study_plan() has to start a program that describes a problem.
  bool needs_programs = false;
};

// Both read a study's file without loading the problems and optimizers that it names. The outline
// also takes a look at the problems' files. `file` is a path or the name of a shipped study. Throw
// Error{usage} if there is no such file or it is not valid, Error{io} if it cannot be read, and
// Error{bad_data} if reading takes too long (base/read_limit.hpp).
std::string read_study_title(const std::string& file);
StudyOutline read_study_outline(const std::string& file);

// Returns the declarations of every setting of a study's file.
const SettingTable& study_settings();

// One run of the plan, as indices into its lists.
struct Cell {
  std::size_t problem = 0;
  std::size_t optimizer = 0;
  int replicate = 1;  // from 1
};
// Returns all cells, replicate by replicate, so that an interrupted study has cells of every
// problem and optimizer.
std::vector<Cell> list_cells(const StudyPlan& plan);

// Returns every problem that cells train on: the plan's problems, then the methods' versions of
// them, in the plan's order. The pointers point into `plan`. They are valid until `plan` is
// destroyed or its lists of problems or optimizers change.
std::vector<const LoadedProblem*> list_problems(const StudyPlan& plan);
// Returns the problem with the settings that the cell's optimizer trains on.
const LoadedProblem& get_problem(const StudyPlan& plan, const Cell& cell);
Schedule get_schedule(const StudyPlan& plan, const Cell& cell);
// Returns the settings of the problem that the user chose: all but the recorded description of a
// program.
std::vector<std::string> list_chosen_settings(const StudyProblem& problem);
// Returns the schedule of a problem as the key `schedule` has it: "fixed:5" or "own".
std::string describe_schedule(const StudyProblem& problem);

// Returns the name of the replicate's training set, which is the same for every optimizer.
std::string make_training_set_name(const StudyPlan& plan, const Cell& cell);
// Returns how many candidates of a run are judged on the validation set, the same for every
// optimizer. For one objective without constraints this is the plan's selection. Otherwise `last` is
// at least the number that `armwright optimize` uses, and `most` grows with it. A few candidates
// would be too few for a front, and too few to find a design that meets the constraints on unseen
// cases.
Selection choose_selection(const StudyPlan& plan, const StudyProblem& problem);
// Returns the plan of the cell's run. Throws Error{usage} if the start cannot be converted to the
// controller of the cell's method.
RunPlan make_run_plan(const StudyPlan& plan, const Cell& cell);
// Returns "cells/q1-complex/ga/r01", relative to the study's folder.
std::filesystem::path make_cell_path(const StudyPlan& plan, const Cell& cell);

// Returns the budgets, in cases, at which incumbents are tested: ascending, each once, at most
// `count`. They are logarithmically spaced from `first` to `budget` and rounded to whole evaluations
// of `cases` cases each. The smallest is at least one evaluation. Returns none if the budget does
// not pay for one evaluation.
std::vector<std::int64_t> calc_checkpoints(std::int64_t first, std::int64_t budget, int cases,
                                           int count);

// Returns the checkpoints of a problem, calc_checkpoints() with the number of cases per evaluation
// of the problem's own schedule. A method with another schedule has the same checkpoints.
std::vector<std::int64_t> list_checkpoints(const StudyPlan& plan, std::size_t problem);

// The largest numbers of cases that the whole plan can simulate, per split.
struct StudyCost {
  std::int64_t cells = 0;
  std::int64_t training = 0;
  std::int64_t validation = 0;
  std::int64_t test = 0;
};
StudyCost calc_cost(const StudyPlan& plan);

// Turns a name that a user chose into a file name. Letters, digits, '_', '-' and (except at the
// beginning) '.' stay; any other byte becomes %XX. Two different names never become the same one,
// and no file name is hidden or leads out of its folder.
std::string escape_name(std::string_view name);
// Returns the name of the file, relative to the study's folder, that has a problem's configuration.
std::string make_problem_name(const std::string& label);
// The largest recorded plan or problem that is read.
inline constexpr std::size_t kPlanLimit_bytes = std::size_t{16} << 20;

}  // namespace armwright
