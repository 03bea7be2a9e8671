// The plan of a comparison: problems x optimizers x replicates, all on the same footing.
//
// A cell is one run: optimizer `o` on problem `p` in replicate `r`. What a replicate gives is the
// same for every optimizer: the training cases (set train/STUDY-SEED-P-R), the place to start from
// (a uniform draw from a box about the problem's own start, on the variables' scales) and, through
// the training cases, all noise. The optimizer's own random numbers come from a stream named after
// the cell. Nothing derives from the plan as a whole, so that it can be extended.
//
// There is one budget, in simulated training cases, for all optimizers: a plan in which one of them
// would get more cannot be written. How the budget is spent (schedule, racing, perturbed plants in
// training), and what kind of controller designs have, is the problem's, unless an optimizer's
// entry says otherwise and so makes a method of it: "ga on one fresh case a generation" beside "ga
// on five fixed ones". What is asked of a design is the same for all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/setting.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

struct StudyProblem {
  std::string label;                  // unique in the plan: what tables, folders and streams say
  std::string name;                   // as asked for: a shipped name or a path
  std::vector<std::string> settings;  // KEY=VALUE, all that is changed about it
  LoadedProblem loaded;
  Schedule schedule;
};

struct StudyOptimizer {
  std::string label;                 // unique in the plan
  std::string name;                  // as asked for
  std::vector<std::string> options;  // KEY=VALUE
  bool baseline = false;             // not asked for: every comparison has it unless told otherwise
  OptimizerRow row;
  Options parsed;
  // A method's own: a schedule instead of the problem's, and KEY=VALUE over the problem's settings,
  // which change nothing of what is asked of a design (study_methods.hpp).
  std::optional<Schedule> schedule;
  std::vector<std::string> settings;
  std::map<std::string, LoadedProblem> loaded;  // with these settings, by the problem's label
};

// A fixed target: what a design must be worth on the test set, at least one of the two.
struct StudyTarget {
  std::string label;                     // unique in the plan
  std::vector<std::string> problems;     // labels
  std::optional<double> value;           // the objective at most
  std::optional<std::int64_t> failures;  // this many failing test cases at most
};

// What the value of a run is: the winner's objective on the test set, or the share of test cases
// in which it fails.
enum class StudyValue : std::uint8_t { objective, failures };

struct StudyPlan {
  std::string name;  // of its folder
  std::string title;
  std::uint64_t seed = 1;
  int replicates = 15;
  std::int64_t budget = 0;  // simulated training cases a cell
  // Width of the box that starts are drawn from, as a share of the bounds' box.
  double start_spread = 0.1;
  Selection selection{.last = 5, .best = 5};
  // The winner is the best, on the validation set, of the candidates at all checkpoints, not only
  // of those at the end: whoever trains on few cases for long ends with designs that hold on no
  // others.
  bool judge_along = false;
  // By how much a constraint may be violated on validation and test sets, which nobody trained on,
  // for a design to count as feasible there.
  double constraint_tolerance = 0;
  int checkpoints = 20;  // budgets, logarithmically spaced, at which incumbents are tested
  std::int64_t first_checkpoint = 1;  // the smallest of them, in cases; of a smaller budget itself
  std::string final_engine;  // the best design of every optimizer and problem once more; or empty
  bool baselines = true;     // random search and a local search are in the pool by themselves
  StudyValue value = StudyValue::objective;
  std::vector<StudyTarget> targets;
  std::string reference;  // optimizer (label) that expected running times are divided by; or none
  std::vector<StudyProblem> problems;
  std::vector<StudyOptimizer> optimizers;
};

// What stands in every comparison: a method that does not beat these is of no use.
inline constexpr std::string_view kRandomBaseline = "random";
inline constexpr std::string_view kLocalBaseline = "nlopt:neldermead";

// What a plan can be made of: a file, flags, or both; flags come last.
struct StudyRequest {
  std::string file;  // a path, or the name of a shipped study; empty: flags alone
  std::vector<std::string> problems;
  std::vector<std::string> optimizers;
  std::vector<std::string> settings;  // of every problem
  std::optional<int> replicates;
  std::optional<std::int64_t> budget;
  std::optional<Schedule> schedule;
  std::optional<std::uint64_t> seed;
  bool baselines = true;
  // Optimizers that live in the program that asks, by their names (foreign_optimizer.hpp).
  std::vector<OptimizerRow> rows = {};
};

// Reads, completes and checks everything. Error{usage} or Error{bad_data}.
StudyPlan make_study_plan(const StudyRequest& request);

// SHA-256 of a problem's resolved configuration and of the files that it refers to.
std::string calc_configuration_hash(const LoadedProblem& problem);

// Error{bad_data} if the file is a resolved plan (to_toml()) that was changed since.
void check_plan_hash(const std::filesystem::path& path);

// Baselines that a recorded plan has and this one would do without, having grown others of its
// kind, stay in it.
void keep_baselines(const std::filesystem::path& recorded, StudyPlan& plan);

// Returns the title in a study's file, without loading what the file names.
std::string read_study_title(const std::string& file);

// Returns the declarations of every setting of a study's file.
const SettingTable& study_settings();

struct Cell {
  std::size_t problem = 0;
  std::size_t optimizer = 0;
  int replicate = 1;  // from 1
};
// Replicate by replicate, so that an interrupted study has something of everything.
std::vector<Cell> list_cells(const StudyPlan& plan);

// All that cells train on: the problems, then those of methods, in the plan's order.
std::vector<const LoadedProblem*> list_problems(const StudyPlan& plan);
// The problem as the cell's optimizer trains on it.
const LoadedProblem& get_problem(const StudyPlan& plan, const Cell& cell);
Schedule get_schedule(const StudyPlan& plan, const Cell& cell);

// The replicate's training cases, the same for every optimizer.
std::string make_training_set_name(const StudyPlan& plan, const Cell& cell);
// Of one objective without constraints the plan's; otherwise at least as many as `optimize` judges,
// since a front, and designs that keep a limit on unseen cases, are not found among the last few.
Selection choose_selection(const StudyPlan& plan, const StudyProblem& problem);
// The run that the cell is.
RunPlan make_run_plan(const StudyPlan& plan, const Cell& cell);
// "cells/q1-complex/ga/r01", relative to the study's folder.
std::filesystem::path make_cell_path(const StudyPlan& plan, const Cell& cell);

// Budgets at which incumbents are tested: from `first` cases, but at least one evaluation, to the
// whole, logarithmically spaced, whole evaluations, without repetitions.
std::vector<std::int64_t> calc_checkpoints(std::int64_t first, std::int64_t budget, int cases,
                                           int count);

// Those of a problem: the same for all optimizers, in evaluations by the problem's own schedule.
std::vector<std::int64_t> list_checkpoints(const StudyPlan& plan, std::size_t problem);

// How many test cases the whole plan simulates at most.
struct StudyCost {
  std::int64_t cells = 0;
  std::int64_t training = 0;
  std::int64_t validation = 0;
  std::int64_t test = 0;
};
StudyCost calc_cost(const StudyPlan& plan);

}  // namespace armwright
