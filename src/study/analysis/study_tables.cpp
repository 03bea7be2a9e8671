#include "study/analysis/study_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/method_facts.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/case_sets.hpp"
#include "study/compare/study_folder.hpp"
#include "study/run/json_values.hpp"
#include "study/statistics/pareto.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Formats a value. An infinite one counts and is written as "inf"; a missing one is an empty field.
std::string number(double value) {
  return format_exact(value);
}
std::string number(const std::optional<double>& value) {
  return value ? format_exact(*value) : "";
}

std::string name(const StudyPlan& plan, std::size_t optimizer) {
  return quote_csv(plan.optimizers[optimizer].label);
}

std::string make_cells(const StudyResult& result) {
  std::string csv =
      "problem,optimizer,replicate,value,validation_value,start_value,violation,test_mean_error,"
      "test_median_error,test_p95_error,test_worst_error,test_failures,test_cases,evaluations,"
      "cases,clipped,failed_evaluations,end_reason,failure\n";
  for (const CellOutcome& cell : result.cells) {
    const ErrorSummary& errors = cell.errors;
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quote_csv(cell.problem),
        quote_csv(cell.optimizer), cell.replicate, number(cell.value),
        number(cell.validation_value), number(cell.start_value), number(cell.violation),
        number(errors.mean), number(errors.median), number(errors.percentile_95),
        number(errors.worst), errors.failures, errors.cases, cell.evaluations, cell.cases,
        cell.clipped, cell.failed_evaluations, quote_csv(cell.end_reason), quote_csv(cell.failure));
  }
  return csv;
}

// Has one row per run of a problem with several objectives: how good its front is.
std::string make_indicators(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = "problem,optimizer,replicate,missed_hypervolume,igd_plus\n";
  for (const ProblemResult& problem : result.problems) {
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      const OptimizerResult& one = problem.optimizers[o];
      std::size_t run = 0;  // `values` and `igd_plus` are in the order of the cells
      for (const CellOutcome& cell : result.cells) {
        if (cell.problem == problem.label && cell.optimizer == plan.optimizers[o].label &&
            run < one.igd_plus.size()) {
          csv += fmt::format("{},{},{},{},{}\n", quote_csv(problem.label), name(plan, o),
                             cell.replicate, number(one.values[run]), number(one.igd_plus[run]));
          ++run;
        }
      }
    }
  }
  return csv;
}

// Has one row per objective and metric of every winner, on the test set.
std::string make_metrics(const StudyPlan& plan, std::span<const CellOutcome> cells) {
  std::string csv = "problem,optimizer,replicate,kind,name,unit,value\n";
  for (const CellOutcome& cell : cells) {
    const auto problem = std::ranges::find(plan.problems, cell.problem, &StudyProblem::label);
    const ProblemDescription& description = problem->loaded.problem->description();
    const auto add = [&](const char* kind, std::span<const Quantity> names,
                         std::span<const double> values) {
      for (std::size_t i = 0; i < values.size(); ++i) {  // a run without a winner has no values
        csv += fmt::format("{},{},{},{},{},{},{}\n", quote_csv(cell.problem),
                           quote_csv(cell.optimizer), cell.replicate, kind,
                           quote_csv(names[i].name), quote_csv(names[i].unit), number(values[i]));
      }
    };
    add("objective", description.objectives, cell.objectives);
    add("metric", description.metrics, cell.metrics);
  }
  return csv;
}

// Has the same rows for every optimizer's best run on the validation set.
std::string make_best(const StudyPlan& plan, const StudyResult& result) {
  std::vector<CellOutcome> best;
  for (const StudyProblem& problem : plan.problems) {
    for (const StudyOptimizer& optimizer : plan.optimizers) {
      const CellOutcome* cell = find_best_cell(result.cells, problem.label, optimizer.label);
      if (cell != nullptr) {
        best.push_back(*cell);
      }
    }
  }
  return make_metrics(plan, best);
}

std::string make_summary(const StudyPlan& plan, const StudyResult& result) {
  std::string csv =
      "problem,optimizer,unit,runs,without_value,infeasible,failed,median,lower_quartile,upper_"
      "quartile,"
      "median_lower_95,median_upper_95,mean_rank,anytime_area,median_cases,final_engine,"
      "final_replicate,final_value,final_failures,final_cases,successes,resolution,optimum,";
  csv += kMethodColumns;
  csv += "\n";
  for (const ProblemResult& problem : result.problems) {
    const auto methods = calc_method_facts(plan, problem.label, result.cells);
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      const OptimizerResult& one = problem.optimizers[o];
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", quote_csv(problem.label),
                         name(plan, o), quote_csv(problem.quantity.unit), one.values.size(),
                         one.infinite, one.infeasible, one.failed, number(one.spread.median),
                         number(one.spread.lower_quartile), number(one.spread.upper_quartile),
                         number(one.median_interval.lower), number(one.median_interval.upper),
                         number(one.mean_rank), number(one.anytime_area), number(one.cases));
      if (const auto& check = one.final_check) {
        csv += fmt::format(",{},{},{},{},{}", check->engine, check->replicate, number(check->value),
                           check->errors.failures, check->errors.cases);
      } else {
        csv += ",,,,,";
      }
      csv += fmt::format(",{},{},{},{}\n", one.successes, number(problem.margin.resolution),
                         number(problem.margin.optimum), make_method_fields(methods[o]));
    }
  }
  return csv;
}

std::string make_pair_rows(const StudyPlan& plan, const std::string& problem,
                           std::span<const PairResult> pairs) {
  std::string csv;
  for (const PairResult& pair : pairs) {
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quote_csv(problem),
                       name(plan, pair.a), name(plan, pair.b), pair.test.pairs, pair.test.zeros,
                       number(pair.test.positive_rank_sum), number(pair.test.negative_rank_sum),
                       pair.test.exact ? 1 : 0, number(pair.test.p_value), number(pair.p_holm),
                       number(pair.a12), pair.wins.wins, pair.wins.ties, pair.wins.losses,
                       pair.is_significant() ? 1 : 0);
  }
  return csv;
}

constexpr const char* kOverall = "(over problems)";

constexpr const char* kPairsHead =
    "problem,a,b,pairs_that_differ,ties,rank_sum_a_worse,rank_sum_b_worse,exact,p,p_holm,"
    "a12_a_better,wins_a,ties_a,losses_a,significant\n";

// Compares every two optimizers by the shares of failing test cases.
std::string make_failure_pairs(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = kPairsHead;
  for (const ProblemResult& problem : result.problems) {
    csv += make_pair_rows(plan, problem.label, problem.failure_pairs);
  }
  return csv;
}

std::string make_pairs(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = kPairsHead;
  for (const ProblemResult& problem : result.problems) {
    csv += make_pair_rows(plan, problem.label, problem.pairs);
  }
  return csv + make_pair_rows(plan, kOverall, result.overall.pairs);
}

std::string make_friedman(const StudyResult& result) {
  std::string csv = "problem,chi_squared,degrees,p,iman_davenport_f,f_degrees_1,f_degrees_2,f_p\n";
  const auto add = [&](const std::string& where, const std::optional<FriedmanTest>& test) {
    if (test) {
      csv += fmt::format("{},{},{},{},{},{},{},{}\n", quote_csv(where), number(test->chi_squared),
                         number(test->degrees), number(test->p_value), number(test->f),
                         number(test->f_degrees_1), number(test->f_degrees_2),
                         number(test->f_p_value));
    }
  };
  for (const ProblemResult& problem : result.problems) {
    add(problem.label, problem.friedman);
  }
  add(kOverall, result.overall.friedman);
  return csv;
}

std::string make_running_times(const StudyPlan& plan, const StudyResult& result) {
  std::string csv =
      "problem,optimizer,target_share,target,reached,runs,expected_cases,lower_95,upper_95\n";
  for (const ProblemResult& problem : result.problems) {
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      const OptimizerResult& one = problem.optimizers[o];
      for (std::size_t t = 0; t < one.running_times.size(); ++t) {
        const RunningTime& time = one.running_times[t];
        csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", quote_csv(problem.label), name(plan, o),
                           number(kRunningTimeTargets[t]), number(time.target), time.reached,
                           one.values.size(), number(time.expected), number(time.interval.lower),
                           number(time.interval.upper));
      }
    }
  }
  return csv;
}

std::string make_curves(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = "problem,optimizer,cases,median,lower_quartile,upper_quartile\n";
  for (const ProblemResult& problem : result.problems) {
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      for (std::size_t i = 0; i < problem.checkpoints.size(); ++i) {
        const Spread& spread = problem.optimizers[o].curve[i];
        csv += fmt::format("{},{},{},{},{},{}\n", quote_csv(problem.label), name(plan, o),
                           problem.checkpoints[i], number(spread.median),
                           number(spread.lower_quartile), number(spread.upper_quartile));
      }
    }
  }
  return csv;
}

std::string make_ecdf(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = "problem,optimizer,cases,share_of_run_target_pairs\n";
  for (const ProblemResult& problem : result.problems) {
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      for (std::size_t i = 0; i < problem.checkpoints.size(); ++i) {
        csv += fmt::format("{},{},{},{}\n", quote_csv(problem.label), name(plan, o),
                           problem.checkpoints[i], number(problem.optimizers[o].ecdf[i]));
      }
    }
  }
  return csv;
}

std::string make_profiles(const StudyPlan& plan, std::string_view abscissa,
                          std::span<const double> grid, std::span<const Profile> profiles) {
  std::string csv = fmt::format("tolerance,optimizer,{},share_of_problem_replicates\n", abscissa);
  for (const Profile& profile : profiles) {
    for (std::size_t o = 0; o < profile.shares.size(); ++o) {
      for (std::size_t i = 0; i < grid.size(); ++i) {
        csv += fmt::format("{},{},{},{}\n", number(profile.tolerance), name(plan, o),
                           number(grid[i]), number(profile.shares[o][i]));
      }
    }
  }
  return csv;
}

std::string make_ranking(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = "left_out,optimizer,mean_rank,kendall_tau,leader_changes\n";
  const RankingStability& stability = result.overall.ranking;
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    csv += fmt::format(",{},{},,\n", name(plan, o), number(stability.full.mean_ranks[o]));
  }
  for (const RankingWithout& without : stability.without) {
    for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
      csv += fmt::format("{},{},{},{},{}\n", quote_csv(plan.problems[without.problem].label),
                         name(plan, o), number(without.ranking.mean_ranks[o]), number(without.tau),
                         without.leader_changes ? 1 : 0);
    }
  }
  return csv;
}

bool has_fronts(const StudyResult& result) {
  return std::ranges::any_of(result.problems, &ProblemResult::has_front);
}

std::string make_fronts(const StudyResult& result) {
  std::size_t most = 0;
  for (const CellOutcome& cell : result.cells) {
    most = std::max(most, cell.front.empty() ? 0 : cell.front.front().size());
  }
  std::string csv = "problem,optimizer,replicate";
  for (std::size_t k = 1; k <= most; ++k) {
    csv += fmt::format(",objective_{}", k);
  }
  csv += "\n";
  for (const CellOutcome& cell : result.cells) {
    for (const auto& point : cell.front) {
      csv += fmt::format("{},{},{}", quote_csv(cell.problem), quote_csv(cell.optimizer),
                         cell.replicate);
      for (std::size_t k = 0; k < most; ++k) {
        csv += "," + (k < point.size() ? number(point[k]) : "");
      }
      csv += "\n";
    }
  }
  return csv;
}

std::string make_attainment(const StudyPlan& plan, const StudyResult& result) {
  std::string csv = "problem,optimizer,share_of_runs,first_objective,second_objective\n";
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    if (plan.problems[p].loaded.problem->description().objectives.size() != 2) {
      continue;
    }
    for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
      std::vector<std::vector<std::vector<double>>> fronts;
      for (const CellOutcome& cell : result.cells) {
        if (cell.problem == plan.problems[p].label && cell.optimizer == plan.optimizers[o].label) {
          fronts.push_back(cell.front);
        }
      }
      for (const double level : {0.25, 0.5, 0.75}) {
        for (const auto& corner : calc_attainment_surface(fronts, level)) {
          csv += fmt::format("{},{},{},{},{}\n", quote_csv(plan.problems[p].label), name(plan, o),
                             number(level), number(corner[0]), number(corner[1]));
        }
      }
    }
  }
  return csv;
}

std::string make_sets(const StudyPlan& plan) {
  std::string csv = "problem,role,set,cases,sha256\n";
  for (const UsedSet& set : list_used_sets(plan)) {
    csv += fmt::format("{},{},{},{},{}\n", quote_csv(set.problem), set.role, quote_csv(set.name),
                       set.cases, set.sha256);
  }
  return csv;
}

json spread_to_json(const Spread& spread) {
  return {value_to_json(spread.lower_quartile), value_to_json(spread.median),
          value_to_json(spread.upper_quartile)};
}

json pair_to_json(const StudyPlan& plan, const PairResult& pair) {
  return {{"a", plan.optimizers[pair.a].label},
          {"b", plan.optimizers[pair.b].label},
          {"p", pair.test.p_value},
          {"p_holm", pair.p_holm},
          {"a12", pair.a12},
          {"wins", {pair.wins.wins, pair.wins.ties, pair.wins.losses}},
          {"significant", pair.is_significant()}};
}

json optimizer_to_json(const StudyPlan& plan, const ProblemResult& problem,
                       const OptimizerResult& one) {
  json times = json::array();
  for (const RunningTime& time : one.running_times) {
    times.push_back(
        {{"target", value_to_json(time.target)},
         {"reached", time.reached},
         {"expected_cases", value_to_json(time.expected)},
         {"interval", {value_to_json(time.interval.lower), value_to_json(time.interval.upper)}}});
  }
  json values = json::array();
  for (const double value : one.values) {
    values.push_back(value_to_json(value));
  }
  json j = {{"values", values},
            {"successes", one.successes},
            {"without_value", one.infinite},
            {"infeasible", one.infeasible},
            {"failed", one.failed},
            {"quartiles", spread_to_json(one.spread)},
            {"median_interval",
             {value_to_json(one.median_interval.lower), value_to_json(one.median_interval.upper)}},
            {"mean_rank", one.mean_rank},
            {"anytime_area", one.anytime_area},
            {"running_times", times},
            {"targets", target_times_to_json(plan, problem, one)},
            {"failed_cases", failures_to_json(one)},
            {"final", nullptr}};
  if (!one.igd_plus.empty()) {
    j["igd_plus"] = json::array();
    for (const double value : one.igd_plus) {
      j["igd_plus"].push_back(value_to_json(value));
    }
  }
  if (const auto& check = one.final_check) {
    j["final"] = {{"engine", check->engine},
                  {"replicate", check->replicate},
                  {"value", value_to_json(check->value)},
                  {"test", summary_to_json(check->errors)}};
  }
  return j;
}

}  // namespace

std::string to_json(const StudyPlan& plan, const StudyResult& result) {
  json problems = json::array();
  for (const ProblemResult& problem : result.problems) {
    json optimizers = json::object();
    const auto methods = calc_method_facts(plan, problem.label, result.cells);
    for (std::size_t o = 0; o < problem.optimizers.size(); ++o) {
      json& one = optimizers[plan.optimizers[o].label];
      one = optimizer_to_json(plan, problem, problem.optimizers[o]);
      one["method"] = method_to_json(methods[o]);
    }
    json pairs = json::array();
    for (const PairResult& pair : problem.pairs) {
      pairs.push_back(pair_to_json(plan, pair));
    }
    json failure_pairs = json::array();
    for (const PairResult& pair : problem.failure_pairs) {
      failure_pairs.push_back(pair_to_json(plan, pair));
    }
    json order = json::array();
    for (const std::size_t o : problem.order) {
      order.push_back(plan.optimizers[o].label);
    }
    json friedman = nullptr;
    if (problem.friedman) {
      friedman = {{"chi_squared", problem.friedman->chi_squared},
                  {"p", problem.friedman->p_value},
                  {"f", value_to_json(problem.friedman->f)},
                  {"f_p", problem.friedman->f_p_value}};
    }
    problems.push_back(
        {{"problem", problem.label},
         {"quantity", problem.quantity.name},
         {"unit", problem.quantity.unit},
         {"resolution", problem.margin.resolution},
         {"optimum", problem.margin.optimum ? json(*problem.margin.optimum) : json()},
         {"best_known", value_to_json(problem.best_known)},
         {"start", value_to_json(problem.start)},
         {"order", order},
         {"optimizers", optimizers},
         {"friedman", friedman},
         {"pairs", pairs},
         {"failure_pairs", failure_pairs}});
  }
  json pairs = json::array();
  for (const PairResult& pair : result.overall.pairs) {
    pairs.push_back(pair_to_json(plan, pair));
  }
  json ranks = json::object();
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    ranks[plan.optimizers[o].label] = result.overall.ranking.full.mean_ranks[o];
  }
  const json j = {{"study", plan.name},
                  {"plan_sha256", calc_plan_hash(plan)},
                  {"replicates", plan.replicates},
                  {"budget", plan.budget},
                  {"baselines", plan.baselines},
                  {"missing_cells", result.missing.size()},
                  {"problems", problems},
                  {"over_problems", {{"mean_ranks", ranks}, {"pairs", pairs}}},
                  {"verdict", describe_verdict(plan, result)}};
  return j.dump(1) + "\n";
}

void write_study_tables(const StudyPlan& plan, const StudyResult& result,
                        const std::filesystem::path& study) {
  std::vector<std::pair<std::string, std::string>> files;
  const auto write = [&](const std::string& file, std::string text) {
    files.emplace_back("tables/" + file, std::move(text));
  };
  write("cells.csv", make_cells(result));
  write("metrics.csv", make_metrics(plan, result.cells));
  write("best.csv", make_best(plan, result));
  write("summary.csv", make_summary(plan, result));
  write("pairs.csv", make_pairs(plan, result));
  write("friedman.csv", make_friedman(result));
  write("running_times.csv", make_running_times(plan, result));
  write("curves.csv", make_curves(plan, result));
  write("ecdf.csv", make_ecdf(plan, result));
  write("data_profiles.csv", make_profiles(plan, "simplex_gradients", result.overall.kappas,
                                           result.overall.data_profiles));
  write("performance_profiles.csv", make_profiles(plan, "times_the_quickest", result.overall.alphas,
                                                  result.overall.performance_profiles));
  write("ranking.csv", make_ranking(plan, result));
  write("sets.csv", make_sets(plan));
  if (std::ranges::any_of(result.problems, [](const ProblemResult& problem) {
        return !problem.failure_pairs.empty();
      })) {
    write("failures.csv", make_failures_table(plan, result));
    write("failure_pairs.csv", make_failure_pairs(plan, result));
  }
  if (!plan.targets.empty()) {
    write("targets.csv", make_targets_table(plan, result));
    write("choices.csv", make_choices_table(result));
  }
  if (has_fronts(result)) {
    write("fronts.csv", make_fronts(result));
    write("indicators.csv", make_indicators(plan, result));
    write("attainment.csv", make_attainment(plan, result));
  }
  const auto verdict = describe_verdict(plan, result);
  files.emplace_back("verdict.txt", join(verdict, "\n") + "\n");
  files.emplace_back("result.json", to_json(plan, result));
  FolderChecksums checksums(study);
  checksums.write(files);
  checksums.save();
  cover_study(plan, study);
}

}  // namespace armwright
