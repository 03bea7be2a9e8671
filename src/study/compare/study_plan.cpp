#include "study/compare/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#include "optimizers/interface/search_space.hpp"
#include "problems/config/problem_loader.hpp"
#include "sim/tracking/design.hpp"
#include "study/compare/incumbents.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

std::string make_stream(const StudyPlan& plan, const Cell& cell) {
  return fmt::format("study/{}/{}/{}", plan.seed, plan.problems[cell.problem].label,
                     cell.replicate);
}

// Draws a point from a box around a problem's own start; the box is cut off at the bounds.
// `start_spread` is its width as a fraction of the bounds' width.
std::vector<double> draw_near_start(std::span<const DecisionVariable> variables,
                                    double start_spread, const std::string& stream) {
  const SearchSpace space({variables.begin(), variables.end()});
  std::vector<double> lower = space.lower();
  std::vector<double> upper = space.upper();
  for (std::size_t i = 0; i < space.dimension(); ++i) {
    const double reach = start_spread * (upper[i] - lower[i]) / 2;
    lower[i] = std::max(lower[i], space.start()[i] - reach);
    upper[i] = std::min(upper[i], space.start()[i] + reach);
  }
  RandomStream random(stream);
  std::vector<double> start = space.to_point(space.draw_between(lower, upper, random));
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (variables[i].type != VariableType::real) {
      start[i] = settle_value(variables[i], start[i]);
    }
  }
  return start;
}

// Converts a start of the problem for a method with another controller: the same PID, expressed as
// that controller. A draw in the method's own variables would be a different start. Network weights
// that are each moved by a fraction of their range would not control the arm at all.
std::vector<double> convert_start(const StudyPlan& plan, const Cell& cell,
                                  const std::vector<double>& start) {
  const TrackingProblem& own = *get_problem(plan, cell).tracking();
  const ArmDesign design = plan.problems[cell.problem].loaded.tracking()->make_design(start);
  std::vector<double> own_start;
  try {
    const TrackingConfig& config = own.config();
    own_start = own.make_vector(convert_design(design, config.start.controller,
                                               config.task.control_period_s,
                                               config.task.drives.calc_lag_s()));
  } catch (const Error& error) {
    throw Error(error.kind(),
                fmt::format("optimizer {} on {}: {}", plan.optimizers[cell.optimizer].label,
                            plan.problems[cell.problem].label, error.what()));
  }
  const auto& variables = own.description().variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    own_start[i] = std::clamp(own_start[i], variables[i].lower, variables[i].upper);
  }
  return own_start;
}

// Draws the start, which is the same for every method of a replicate.
std::vector<double> draw_start(const StudyPlan& plan, const Cell& cell) {
  const LoadedProblem& problem = plan.problems[cell.problem].loaded;
  const std::vector<double> start =
      draw_near_start(problem.problem->description().variables, plan.start_spread,
                      make_stream(plan, cell) + "/start");
  const LoadedProblem& own = get_problem(plan, cell);
  const bool has_own_controller =
      problem.tracking() && own.tracking() &&
      own.tracking()->config().start.controller != problem.tracking()->config().start.controller;
  return has_own_controller ? convert_start(plan, cell, start) : start;
}

// Returns 63 bits of the hash of the cell's name, so that a user can type it after --seed.
std::uint64_t make_seed(const std::string& stream) {
  const auto hash = calc_sha256(stream);
  std::uint64_t seed = 0;
  std::memcpy(&seed, hash.data(), sizeof seed);
  return seed >> 1;
}

}  // namespace

std::string calc_configuration_hash(const LoadedProblem& problem) {
  std::string text = problem.resolved_json;
  for (const auto& [file, hash] : problem.input_hashes) {
    text += fmt::format("\n{} {}", file, hash);
  }
  return calc_sha256_hex(text);
}

std::vector<Cell> list_cells(const StudyPlan& plan) {
  std::vector<Cell> cells;
  for (int replicate = 1; replicate <= plan.replicates; ++replicate) {
    for (std::size_t problem = 0; problem < plan.problems.size(); ++problem) {
      for (std::size_t optimizer = 0; optimizer < plan.optimizers.size(); ++optimizer) {
        cells.push_back({problem, optimizer, replicate});
      }
    }
  }
  return cells;
}

std::string make_training_set_name(const StudyPlan& plan, const Cell& cell) {
  return fmt::format("train/study-{}-{}-{}", plan.seed, plan.problems[cell.problem].label,
                     cell.replicate);
}

Selection choose_selection(const StudyPlan& plan, const StudyProblem& problem) {
  const ProblemDescription& description = problem.loaded.problem->description();
  Selection selection = plan.selection;
  if (description.objectives.size() > 1 || !description.constraints.empty()) {
    selection.last = std::max(selection.last, Selection{}.last);
    selection.most = selection.last + selection.best;
  }
  return selection;
}

std::vector<const LoadedProblem*> list_problems(const StudyPlan& plan) {
  std::vector<const LoadedProblem*> problems;
  for (const StudyProblem& problem : plan.problems) {
    problems.push_back(&problem.loaded);
  }
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    for (const auto& [label, problem] : optimizer.loaded) {
      problems.push_back(&problem);
    }
  }
  return problems;
}

const LoadedProblem& get_problem(const StudyPlan& plan, const Cell& cell) {
  const StudyProblem& problem = plan.problems[cell.problem];
  const auto& own = plan.optimizers[cell.optimizer].loaded;
  const auto found = own.find(problem.label);
  return found == own.end() ? problem.loaded : found->second;
}

Schedule get_schedule(const StudyPlan& plan, const Cell& cell) {
  const StudyProblem& problem = plan.problems[cell.problem];
  const StudyOptimizer& optimizer = plan.optimizers[cell.optimizer];
  return optimizer.schedule.value_or(problem.own_schedules ? optimizer.own_schedule
                                                           : problem.schedule);
}

std::vector<std::string> list_chosen_settings(const StudyProblem& problem) {
  std::vector<std::string> settings = problem.settings;
  std::erase_if(settings,
                [](const std::string& text) { return text.starts_with(kRecordedDescription); });
  return settings;
}

std::string describe_schedule(const StudyProblem& problem) {
  return problem.own_schedules ? std::string(kOwnSchedules) : to_text(problem.schedule);
}

RunPlan make_run_plan(const StudyPlan& plan, const Cell& cell) {
  const StudyOptimizer& optimizer = plan.optimizers[cell.optimizer];
  RunPlan run;
  run.problem = make_replicate(get_problem(plan, cell), cell.replicate,
                               make_training_set_name(plan, cell), draw_start(plan, cell));
  run.optimizer = optimizer.row;
  run.options = optimizer.parsed;
  run.seed = make_seed(make_stream(plan, cell) + "/" + optimizer.stream);
  run.budget = plan.budget;
  run.schedule = get_schedule(plan, cell);
  run.racing = run.problem.racing;
  run.selection = choose_selection(plan, plan.problems[cell.problem]);
  return run;
}

std::filesystem::path make_cell_path(const StudyPlan& plan, const Cell& cell) {
  return std::filesystem::path("cells") / escape_name(plan.problems[cell.problem].label) /
         escape_name(plan.optimizers[cell.optimizer].label) / fmt::format("r{:02}", cell.replicate);
}

std::vector<std::int64_t> calc_checkpoints(std::int64_t first, std::int64_t budget, int cases,
                                           int count) {
  const std::int64_t evaluations = budget / cases;
  const auto fewest = static_cast<double>(std::max<std::int64_t>(1, first / cases));
  std::set<std::int64_t> chosen;
  for (int i = 0; i < count && evaluations > 0; ++i) {
    const double share = count == 1 ? 1 : static_cast<double>(i) / (count - 1);
    const double exact = fewest * std::pow(static_cast<double>(evaluations) / fewest, share);
    chosen.insert(std::clamp(std::llround(exact), 1LL, static_cast<long long>(evaluations)) *
                  cases);
  }
  return {chosen.begin(), chosen.end()};
}

std::vector<std::int64_t> list_checkpoints(const StudyPlan& plan, std::size_t problem) {
  return calc_checkpoints(plan.first_checkpoint, plan.budget, plan.problems[problem].schedule.cases,
                          plan.checkpoints);
}

StudyCost calc_cost(const StudyPlan& plan) {
  StudyCost cost;
  const auto runs = static_cast<std::int64_t>(plan.optimizers.size()) * plan.replicates;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    const CaseSets& sets = problem.loaded.sets;
    const bool fronts = problem.loaded.problem->description().objectives.size() > 1;
    const std::int64_t judged = choose_selection(plan, problem).most;
    const auto tested = static_cast<std::int64_t>(list_checkpoints(plan, p).size());
    cost.cells += runs;
    cost.training += runs * plan.budget;
    // With targets, the winners at all checkpoints are chosen and tested as well.
    const bool has_targets = !plan.targets.empty() || plan.judge_along;
    cost.validation += runs * judged * (has_targets ? tested : 1) * sets.validation_cases;
    // Tested designs: the winner, the start, the incumbents at the checkpoints, those of an arm's
    // trace, and a front.
    const std::int64_t evaluations = plan.budget / problem.schedule.cases;
    const std::int64_t traced =
        problem.loaded.tracking() == nullptr ? 0 : std::min<std::int64_t>(evaluations, kMostTraced);
    cost.test += runs * (2 + tested * (has_targets ? 2 : 1) + traced + (fronts ? judged : 0)) *
                 sets.test_cases;
    if (!plan.final_engine.empty() && problem.loaded.tracking()) {
      cost.test += static_cast<std::int64_t>(plan.optimizers.size()) * sets.test_cases;
    }
  }
  return cost;
}

std::string make_problem_name(const std::string& label) {
  return "problems/" + escape_name(label) + ".json";
}

std::string escape_name(std::string_view name) {
  std::string escaped;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_digit = c >= '0' && c <= '9';
    if (is_letter || is_digit || c == '_' || c == '-' || (c == '.' && i > 0)) {
      escaped += c;
    } else {
      escaped += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return escaped;
}

}  // namespace armwright
