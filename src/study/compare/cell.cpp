#include "study/compare/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "study/case_runner.hpp"
#include "study/compare/incumbents.hpp"
#include "study/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kCellLimit_bytes = std::size_t{64} << 20;
constexpr int kFormat = 1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Designs on the whole test set, each but once.
class TestBench {
 public:
  TestBench(const LoadedProblem& problem, unsigned jobs, StopSignal& stop)
      : problem_(problem), pool_(jobs), stop_(stop), runner_(*problem.problem, pool_, stop) {
    block_.role = CaseRole::test;
    block_.set = problem.sets.test;
    block_.numbers.resize(static_cast<std::size_t>(problem.sets.test_cases));
    std::iota(block_.numbers.begin(), block_.numbers.end(), std::uint64_t{0});
  }

  // False if stopped.
  bool add(const std::vector<std::vector<double>>& designs) {
    std::vector<std::span<const double>> candidates;
    for (const auto& x : designs) {
      if (find(x) == nullptr &&
          std::ranges::none_of(candidates, [&](const auto& y) { return same_bits(x, y); })) {
        candidates.emplace_back(x);
      }
    }
    const std::size_t first = designs_.size();
    for (const auto& x : candidates) {
      designs_.emplace_back(x.begin(), x.end());
    }
    evaluations_.resize(designs_.size());
    runner_.run(candidates, block_, false, [&](std::size_t candidate, Evaluation evaluation) {
      evaluations_[first + candidate] = std::move(evaluation);
    });
    return !stop_.requested();
  }

  const Evaluation& get(std::span<const double> x) const { return *find(x); }

 private:
  const Evaluation* find(std::span<const double> x) const {
    for (std::size_t i = 0; i < designs_.size(); ++i) {
      if (same_bits(designs_[i], x)) {
        return &evaluations_[i];
      }
    }
    return nullptr;
  }

  const LoadedProblem& problem_;
  ThreadPool pool_;
  StopSignal& stop_;
  CaseRunner runner_;
  CaseBlock block_;
  std::vector<std::vector<double>> designs_;
  std::vector<Evaluation> evaluations_;
};

std::vector<double> get_start(const ProblemDescription& problem) {
  std::vector<double> start;
  for (const DecisionVariable& variable : problem.variables) {
    start.push_back(variable.start);
  }
  return start;
}

void set_winner(const ProblemDescription& problem, const RunResult& result, double tolerance,
                CellOutcome& outcome) {
  outcome.value = kInfinity;
  outcome.validation_value = kInfinity;
  if (!result.winner) {
    return;
  }
  const JudgedCandidate& winner = result.judged[*result.winner];
  outcome.x = winner.candidate.x;
  outcome.validation_value = calc_test_value(problem, winner.validation, tolerance);
  outcome.value = calc_test_value(problem, result.test, tolerance);
  outcome.violation = calc_violation(result.test.constraint_values);
  outcome.errors = result.test_summary;
  outcome.objectives = result.test.objectives;
  outcome.metrics = result.test.metrics;
}

// What the designs along the way are worth on the test set. False if stopped.
bool test_progress(const StudyPlan& plan, const RunPlan& run, const RunResult& result,
                   const CellRequest& where, StopSignal& stop, CellOutcome& outcome) {
  const ProblemDescription& problem = run.problem.problem->description();
  const auto journal = read_journal(where.folder / "journal");
  const auto incumbents = find_incumbents(problem, journal.training, run.schedule.changes_cases());
  const auto checkpoints = calc_checkpoints(plan.budget, run.schedule.cases, plan.checkpoints);
  const auto find_incumbent = [&](std::int64_t budget) {
    const auto after = std::ranges::upper_bound(incumbents, budget, {}, &Incumbent::cases);
    return after == incumbents.begin() ? nullptr : &*std::prev(after);
  };
  std::vector<std::vector<double>> designs = {get_start(problem)};
  for (const std::int64_t budget : checkpoints) {
    if (const Incumbent* incumbent = find_incumbent(budget)) {
      designs.push_back(incumbent->x);
    }
  }
  const bool has_front = problem.objectives.size() > 1;
  for (std::size_t i = 0; has_front && i < result.judged.size(); ++i) {
    designs.push_back(result.judged[i].candidate.x);
  }
  TestBench bench(run.problem, where.jobs, stop);
  if (!bench.add(designs)) {
    return false;
  }
  outcome.start_value =
      calc_test_value(problem, bench.get(designs.front()), plan.constraint_tolerance);
  for (const std::int64_t budget : checkpoints) {
    const Incumbent* incumbent = find_incumbent(budget);
    outcome.curve.push_back({budget, incumbent == nullptr
                                         ? kInfinity
                                         : calc_test_value(problem, bench.get(incumbent->x),
                                                           plan.constraint_tolerance)});
  }
  for (std::size_t i = 0; has_front && i < result.judged.size(); ++i) {
    const Evaluation& evaluation = bench.get(result.judged[i].candidate.x);
    if (std::isfinite(calc_test_value(problem, evaluation, plan.constraint_tolerance))) {
      outcome.front.push_back(evaluation.objectives);
    }
  }
  return true;
}

}  // namespace

double calc_test_value(const ProblemDescription& problem, const Evaluation& evaluation,
                       double tolerance) {
  const bool violated =
      std::ranges::any_of(evaluation.constraint_values, [&](double g) { return g > tolerance; });
  return evaluation.objectives.empty() || evaluation.failed_cases > 0 || violated
             ? kInfinity
             : calc_scalar(problem, evaluation.objectives);
}

std::string to_json(const CellOutcome& outcome) {
  json curve = json::array();
  for (const CurvePoint& point : outcome.curve) {
    curve.push_back({point.budget, value_to_json(point.value)});
  }
  const json j = {
      {"format", kFormat},
      {"problem", outcome.problem},
      {"label", outcome.optimizer},
      {"optimizer", outcome.optimizer_name},
      {"replicate", outcome.replicate},
      {"configuration_sha256", outcome.configuration_sha256},
      {"end_reason", outcome.end_reason},
      {"failure", outcome.failure},
      {"evaluations", outcome.evaluations},
      {"cases", outcome.cases},
      {"clipped", outcome.clipped},
      {"failed_evaluations", outcome.failed_evaluations},
      {"x", outcome.x},
      {"validation_value", value_to_json(outcome.validation_value)},
      {"value", value_to_json(outcome.value)},
      {"violation", outcome.violation},
      {"test", summary_to_json(outcome.errors)},
      {"objectives", outcome.objectives},
      {"metrics", outcome.metrics},
      {"start_value", value_to_json(outcome.start_value)},
      {"curve", curve},
      {"front", outcome.front},
  };
  return j.dump(1) + "\n";
}

CellOutcome parse_cell(const std::string& text, const std::filesystem::path& file) {
  try {
    const json j = json::parse(text);
    if (j.at("format") != kFormat) {
      throw std::runtime_error("its format is not the one this version reads");
    }
    CellOutcome outcome;
    outcome.problem = j.at("problem");
    outcome.optimizer = j.at("label");
    outcome.optimizer_name = j.at("optimizer");
    outcome.replicate = j.at("replicate");
    outcome.configuration_sha256 = j.at("configuration_sha256");
    outcome.end_reason = j.at("end_reason");
    outcome.failure = j.at("failure");
    outcome.evaluations = j.at("evaluations");
    outcome.cases = j.at("cases");
    outcome.clipped = j.at("clipped");
    outcome.failed_evaluations = j.at("failed_evaluations");
    outcome.x = j.at("x").get<std::vector<double>>();
    outcome.validation_value = value_from_json(j.at("validation_value"));
    outcome.value = value_from_json(j.at("value"));
    outcome.violation = j.at("violation");
    outcome.errors = summary_from_json(j.at("test"));
    outcome.objectives = j.at("objectives").get<std::vector<double>>();
    outcome.metrics = j.at("metrics").get<std::vector<double>>();
    outcome.start_value = value_from_json(j.at("start_value"));
    for (const json& point : j.at("curve")) {
      outcome.curve.push_back({point.at(0), value_from_json(point.at(1))});
    }
    outcome.front = j.at("front").get<std::vector<std::vector<double>>>();
    return outcome;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a cell that armwright wrote ({}); remove it, and the same "
                            "command makes it again from the journal beside it",
                            file.string(), error.what()));
  }
}

std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const std::filesystem::path& study, StopSignal& stop,
                                    RunObserver& observer) {
  const CellRequest where{
      .folder = study / make_cell_path(plan, cell), .jobs = 1, .command_line = {}};
  return run_cell(plan, cell, where, stop, observer);
}

std::optional<CellOutcome> run_cell(const StudyPlan& plan, const Cell& cell,
                                    const CellRequest& where, StopSignal& stop,
                                    RunObserver& observer) {
  RunRequest request;
  request.plan = make_run_plan(plan, cell);
  request.folder = where.folder;
  request.jobs = where.jobs;
  request.command_line = where.command_line;
  request.derived = DerivedFiles::winner;
  const auto result = execute_run(request, stop, observer);
  if (!result) {
    return std::nullopt;
  }
  CellOutcome outcome;
  outcome.problem = plan.problems[cell.problem].label;
  outcome.optimizer = plan.optimizers[cell.optimizer].label;
  outcome.optimizer_name = plan.optimizers[cell.optimizer].row.name;
  outcome.replicate = cell.replicate;
  outcome.configuration_sha256 = calc_configuration_hash(plan.problems[cell.problem].loaded);
  outcome.end_reason = result->end_reason;
  outcome.failure = result->failure;
  outcome.evaluations = result->counts.evaluations;
  outcome.cases = result->counts.cases;
  outcome.clipped = result->counts.clipped;
  outcome.failed_evaluations = result->counts.failed;
  set_winner(request.plan.problem.problem->description(), *result, plan.constraint_tolerance,
             outcome);
  if (!test_progress(plan, request.plan, *result, where, stop, outcome)) {
    return std::nullopt;
  }
  write_file_atomically(request.folder / "cell.json", to_json(outcome));
  return outcome;
}

std::optional<CellOutcome> load_cell(const StudyPlan& plan, const Cell& cell,
                                     const std::filesystem::path& study) {
  const auto file = study / make_cell_path(plan, cell) / "cell.json";
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  CellOutcome outcome = parse_cell(read_file(file, kCellLimit_bytes), file);
  const StudyProblem& problem = plan.problems[cell.problem];
  if (outcome.problem != problem.label ||
      outcome.optimizer != plan.optimizers[cell.optimizer].label ||
      outcome.replicate != cell.replicate ||
      outcome.configuration_sha256 != calc_configuration_hash(problem.loaded)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is of another cell ({} on {}, replicate {}, or of another "
                            "configuration); remove it, and the same command makes the right one",
                            file.string(), sanitize(outcome.optimizer), sanitize(outcome.problem),
                            outcome.replicate));
  }
  return outcome;
}

}  // namespace armwright
