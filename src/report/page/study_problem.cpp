// A problem on a study's page: cells, distributions, curves, tests.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/study_parts.hpp"
#include "study/analysis/verdict.hpp"
#include "study/run/run_times.hpp"
#include "study/statistics/ranking.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json rounded(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) {
    list.push_back(finite_or_null(round_shown(value)));
  }
  return list;
}

// Returns the cell's name for `armwright rerun`: its labels, or its folder if the labels would be
// ambiguous.
std::string name_cell(const StudyPlan& plan, const Cell& cell) {
  const std::string& problem = plan.problems[cell.problem].label;
  const std::string& optimizer = plan.optimizers[cell.optimizer].label;
  if ((problem + optimizer).find_first_of("/%") == std::string::npos) {
    return fmt::format("{}/{}/r{:02}", problem, optimizer, cell.replicate);
  }
  return make_cell_path(plan, cell).lexically_relative("cells").string();
}

json make_cell(const StudyPlan& plan, const Cell& cell, const CellOutcome& outcome, double value,
               const std::filesystem::path& folder) {
  const std::vector<std::string> words = {"armwright", "rerun", folder.string(),
                                          name_cell(plan, cell)};
  const auto times = find_times(folder / make_cell_path(plan, cell));
  return {{"replicate", outcome.replicate},
          {"value", finite_or_null(value)},
          {"cases", outcome.cases},
          {"evaluations", outcome.evaluations},
          {"wall_s", times ? json(times->wall_s) : json(nullptr)},
          {"cpu_s", times && times->cpu_s ? json(*times->cpu_s) : json(nullptr)},
          {"failure", sanitize(outcome.failure)},
          {"failures", outcome.errors.failures},
          {"x", rounded(outcome.x)},
          {"folder", (folder / make_cell_path(plan, cell)).string()},
          {"command", quote_command(words)}};
}

json make_interval(const Interval& interval) {
  return {finite_or_null(interval.lower), finite_or_null(interval.upper)};
}

json make_running_times(std::span<const RunningTime> times) {
  json list = json::array();
  for (const RunningTime& time : times) {
    list.push_back({{"target", finite_or_null(time.target)},
                    {"reached", time.reached},
                    {"expected", finite_or_null(time.expected)},
                    {"interval", make_interval(time.interval)}});
  }
  return list;
}

// Returns an optimizer's times to the targets of make_fixed_targets().
json make_target_times(std::span<const TargetTime> times) {
  json list = json::array();
  for (const TargetTime& time : times) {
    const bool compared = time.ratio && time.ratio->ratio;
    list.push_back({{"reached", time.reached},
                    {"kept", time.kept},
                    {"expected", finite_or_null(time.expected)},
                    {"interval", make_interval(time.interval)},
                    {"ratio", compared ? finite_or_null(*time.ratio->ratio) : json(nullptr)},
                    {"ratio_interval",
                     compared ? make_interval(time.ratio->interval) : json{nullptr, nullptr}}});
  }
  return list;
}

json make_fixed_targets(const StudyPlan& plan, const StudyProblem& problem,
                        const ProblemResult& result) {
  json list = json::array();
  for (const std::size_t t : result.fixed_targets) {
    list.push_back(sanitize(describe_target(problem, plan.targets[t])));
  }
  return list;
}

json make_curve(std::span<const Spread> curve) {
  json q1 = json::array(), median = json::array(), q3 = json::array();
  for (const Spread& spread : curve) {
    q1.push_back(finite_or_null(spread.lower_quartile));
    median.push_back(finite_or_null(spread.median));
    q3.push_back(finite_or_null(spread.upper_quartile));
  }
  return {{"q1", std::move(q1)}, {"median", std::move(median)}, {"q3", std::move(q3)}};
}

json make_final_check(const std::optional<FinalCheck>& check) {
  if (!check) {
    return nullptr;
  }
  return {{"engine", check->engine},
          {"value", finite_or_null(check->value)},
          {"failures", check->errors.failures},
          {"cases", check->errors.cases},
          {"replicate", check->replicate}};
}

json make_result(const StudyPlan& plan, const Cell& first, std::span<const CellOutcome* const> runs,
                 const OptimizerResult& one, bool compared, const std::filesystem::path& folder) {
  json cells = json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Cell cell{first.problem, first.optimizer, runs[i]->replicate};
    cells.push_back(make_cell(plan, cell, *runs[i], one.values[i], folder));
  }
  const bool any = !runs.empty();
  const auto of_any = [&](double value) { return any ? finite_or_null(value) : json(nullptr); };
  const auto extreme = [&](double p) { return of_any(any ? calc_quantile(one.values, p) : 0); };
  return {
      {"cells", std::move(cells)},
      {"successes", one.successes},
      {"infinite", one.infinite},
      {"infeasible", one.infeasible},
      {"failed", one.failed},
      {"min", extreme(0)},
      {"q1", of_any(one.spread.lower_quartile)},
      {"median", of_any(one.spread.median)},
      {"q3", of_any(one.spread.upper_quartile)},
      {"max", extreme(1)},
      {"median_interval", {of_any(one.median_interval.lower), of_any(one.median_interval.upper)}},
      {"mean_rank", compared ? finite_or_null(one.mean_rank) : json(nullptr)},
      {"anytime_area", of_any(one.anytime_area)},
      {"cases", of_any(one.cases)},
      {"running_times", make_running_times(one.running_times)},
      {"target_times", make_target_times(one.target_times)},
      {"curve", make_curve(one.curve)},
      {"ecdf", one.ecdf},
      {"final_check", make_final_check(one.final_check)}};
}

// Returns the rank of each optimizer's median, as in the mean ranks over problems: 1 is best, and
// medians that count as equal share their ranks.
std::vector<double> calc_median_ranks(const ProblemResult& result) {
  std::vector<double> medians;
  for (const OptimizerResult& one : result.optimizers) {
    medians.push_back(result.margin.round(one.spread.median));
  }
  return calc_ranks(medians);
}

json make_variables(const ProblemDescription& problem) {
  json list = json::array();
  for (const DecisionVariable& variable : problem.variables) {
    list.push_back({{"name", variable.name},
                    {"unit", variable.unit},
                    {"type", to_string(variable.type)},
                    {"choices", variable.choices},
                    {"lower", variable.lower},
                    {"upper", variable.upper},
                    {"start", variable.start},
                    {"logarithmic", variable.scale == Scale::logarithmic}});
  }
  return list;
}

}  // namespace

double round_shown(double value) {
  return std::isfinite(value) ? *parse_finite(fmt::format("{:.9g}", value)) : value;
}

std::vector<const CellOutcome*> list_cells_of(std::span<const CellOutcome> cells,
                                              const std::string& optimizer) {
  std::vector<const CellOutcome*> list;
  for (const CellOutcome& cell : cells) {
    if (cell.optimizer == optimizer) {
      list.push_back(&cell);
    }
  }
  return list;
}

json make_study_pairs(std::span<const PairResult> pairs) {
  json list = json::array();
  for (const PairResult& pair : pairs) {
    list.push_back({{"a", pair.a},
                    {"b", pair.b},
                    {"p", pair.test.p_value},
                    {"p_holm", pair.p_holm},
                    {"a12", pair.a12},
                    {"significant", pair.is_significant()},
                    {"wins", pair.wins.wins},
                    {"ties", pair.wins.ties},
                    {"losses", pair.wins.losses}});
  }
  return list;
}

json make_friedman(const std::optional<FriedmanTest>& test) {
  if (!test) {
    return nullptr;
  }
  return {{"statistic", finite_or_null(test->f)}, {"p", test->get_p()}};
}

json make_study_problem(const StudyPlan& plan, std::size_t number,
                        std::span<const CellOutcome> cells, const ProblemResult& result,
                        const std::filesystem::path& folder) {
  const StudyProblem& problem = plan.problems[number];
  const ProblemDescription& description = problem.loaded.problem->description();
  const std::size_t total = plan.optimizers.size() * static_cast<std::size_t>(plan.replicates);
  const bool compared = cells.size() == total;
  const std::vector<double> median_ranks = calc_median_ranks(result);
  json results = json::array();
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    results.push_back(make_result(plan, {number, o, 1},
                                  list_cells_of(cells, plan.optimizers[o].label),
                                  result.optimizers[o], compared, folder));
    results.back()["median_rank"] = compared ? json(median_ranks[o]) : json(nullptr);
  }
  return {{"label", problem.label},
          {"title", problem.loaded.title},
          {"quantity", make_quantity(result.quantity, !problem.loaded.tracking())},
          {"has_front", result.has_front},
          {"resolution", result.margin.resolution},
          {"optimum", result.margin.optimum ? json(*result.margin.optimum) : json(nullptr)},
          {"best_known", finite_or_null(result.best_known)},
          {"start", finite_or_null(result.start)},
          {"checkpoints", result.checkpoints},
          {"targets", result.targets},
          {"fixed_targets", make_fixed_targets(plan, problem, result)},
          {"variables", make_variables(description)},
          {"results", std::move(results)},
          {"friedman", make_friedman(result.friedman)},
          {"pairs", make_study_pairs(result.pairs)},
          {"order", result.order},
          {"missing", total - cells.size()},
          {"front", make_study_front(plan, problem, cells, result)}};
}

}  // namespace armwright
