// The part of armwright evaluate for problems of the user, which have no arm.

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "problems/config/values_file.hpp"
#include "problems/motion/motion_problem.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {
namespace {

using nlohmann::json;

struct FailedCase {
  std::uint64_t number = 0;
  std::string status;
  std::string reason;
};

struct Evaluated {
  std::vector<double> x;
  Evaluation evaluation;
  std::vector<FailedCase> failures;
  std::optional<double> least_time_s;  // of a planned motion, along its path
};

// Returns the value of a constraint's quantity, or g if it has no limit.
double get_constrained(const ProblemDescription& problem, const Evaluation& evaluation,
                       std::size_t i) {
  const double g = evaluation.constraint_values[i];
  return problem.limits.empty() ? g : (g + 1) * problem.limits[i].value;
}

std::string format_own_json(const LoadedProblem& problem, const CaseBlock& block,
                            const Evaluated& evaluated) {
  const ProblemDescription& description = problem.problem->description();
  const Evaluation& evaluation = evaluated.evaluation;
  json all = {{"problem", sanitize(problem.name)},
              {"test_set", block.set},
              {"cases", block.numbers.size()},
              {"failures", json::array()}};
  for (std::size_t i = 0; i < evaluated.x.size(); ++i) {
    const DecisionVariable& variable = description.variables[i];
    all["variables"][variable.name] = to_json_value(variable, evaluated.x[i]);
  }
  for (const char* key : {"objectives", "constraints", "metrics"}) {
    all[key] = json::object();
  }
  for (std::size_t i = 0; i < evaluation.objectives.size(); ++i) {
    all["objectives"][description.objectives[i].name] = evaluation.objectives[i];
  }
  for (std::size_t i = 0; i < evaluation.constraint_values.size(); ++i) {
    all["constraints"][description.constraints[i].name] = {
        {"value", get_constrained(description, evaluation, i)},
        {"met", evaluation.constraint_values[i] <= 0}};
  }
  for (std::size_t i = 0; i < evaluation.metrics.size(); ++i) {
    all["metrics"][description.metrics[i].name] = evaluation.metrics[i];
  }
  if (evaluated.least_time_s) {
    all["least_time_s"] = *evaluated.least_time_s;
  }
  for (const FailedCase& failure : evaluated.failures) {
    all["failures"].push_back({{"case", failure.number},
                               {"status", failure.status},
                               {"reason", sanitize(failure.reason)}});
  }
  return all.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

// Says how much faster the arm could move along the path of a planned motion.
std::string describe_bound(const LoadedProblem& problem, const Evaluated& evaluated) {
  if (!evaluated.least_time_s) {
    return "";
  }
  const auto& metrics = problem.problem->description().metrics;
  const auto duration = std::ranges::find(metrics, std::string("duration"), &Quantity::name);
  const double duration_s =
      evaluated.evaluation.metrics[static_cast<std::size_t>(duration - metrics.begin())];
  return fmt::format(
      "\n  Within the limits on speed, acceleration and effort, the arm could move along the same "
      "path in {} s. This motion takes {:.3g} times as long.\n",
      format_significant(*evaluated.least_time_s, 4), duration_s / *evaluated.least_time_s);
}

std::string format_own_text(const LoadedProblem& problem, const CaseBlock& block,
                            const Evaluated& evaluated, const Style& style) {
  const ProblemDescription& description = problem.problem->description();
  const Evaluation& evaluation = evaluated.evaluation;
  Table table({{"", false}, {""}, {"", false}, {"", false}});
  const auto add = [&](const char* kind, const Quantity& quantity, double value,
                       const std::string& note) {
    table.add_row({fmt::format("{} {}", kind, sanitize(quantity.name)),
                   format_significant(value, 6), sanitize(quantity.unit), note});
  };
  for (std::size_t i = 0; i < evaluation.objectives.size(); ++i) {
    add("objective", description.objectives[i], evaluation.objectives[i], "");
  }
  for (std::size_t i = 0; i < evaluation.constraint_values.size(); ++i) {
    add("constraint", description.constraints[i], get_constrained(description, evaluation, i),
        evaluation.constraint_values[i] <= 0 ? "met" : "exceeded");
  }
  for (std::size_t i = 0; i < evaluation.metrics.size(); ++i) {
    add("metric", description.metrics[i], evaluation.metrics[i], "");
  }
  table.add_row({"failed cases", fmt::format("{}", evaluated.failures.size()), "", ""});
  return style.bold(fmt::format("{}: {} of {}", sanitize(problem.name),
                                format_count(block.numbers.size(), "case"), sanitize(block.set))) +
         "\n\n" + table.format(style, 2) + describe_bound(problem, evaluated);
}

}  // namespace

int evaluate_own(const LoadedProblem& loaded, const OwnEvaluation& options, Session& session) {
  const Problem& problem = *loaded.problem;
  const auto& variables = problem.description().variables;
  Evaluated evaluated;
  if (options.design == kStartDesign) {
    evaluated.x = list_starts(variables);
  } else {
    evaluated.x = read_values(load_values(options.design), options.design, variables);
  }
  CaseBlock block{CaseRole::test, loaded.sets.test, {}};
  if (!options.test_set.empty()) {
    const bool is_whole = options.test_set.find('/') != std::string::npos;
    block.set = is_whole ? options.test_set : "test/" + options.test_set;
  }
  block.numbers.resize(options.cases.empty()
                           ? static_cast<std::size_t>(loaded.sets.test_cases)
                           : static_cast<std::size_t>(
                                 parse_count("--cases", options.cases, 1, loaded.sets.test_cases)));
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  catch_signals(session.stop);
  ThreadExecutor executor(options.jobs);
  const std::vector<std::span<const double>> candidates = {evaluated.x};
  bool is_done = false;
  executor.simulate(
      problem, candidates, block, {}, session.stop,
      [&](std::size_t, std::span<CaseOutcome> outcomes) {
        evaluated.evaluation = problem.aggregate(evaluated.x, outcomes);
        for (std::size_t i = 0; i < outcomes.size(); ++i) {
          if (!outcomes[i].has_error) {
            evaluated.failures.push_back(
                {block.numbers[i], to_string(outcomes[i].status), outcomes[i].reason});
          }
        }
        is_done = true;
      });
  if (!is_done) {
    write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  if (const MotionProblem* motion = find_motion(problem);
      motion != nullptr && evaluated.failures.empty()) {
    std::string reason;
    const auto plan = motion->assess(evaluated.x, motion->config().samples, reason);
    evaluated.least_time_s = motion->calc_bound(*plan);
  }
  if (!options.quiet) {
    constexpr std::size_t kMostNamed = 5;
    for (std::size_t i = 0; i < std::min(evaluated.failures.size(), kMostNamed); ++i) {
      write_message(fmt::format("case {}: {}", evaluated.failures[i].number,
                                sanitize(evaluated.failures[i].reason)));
    }
  }
  write_stdout(options.json ? format_own_json(loaded, block, evaluated)
                            : format_own_text(loaded, block, evaluated,
                                              make_style(Stream::out, session.color)));
  const bool is_met =
      std::ranges::all_of(evaluated.evaluation.constraint_values, [](double g) { return g <= 0; });
  return evaluated.failures.empty() && is_met ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace armwright
