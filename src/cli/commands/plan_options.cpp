#include "cli/commands/plan_options.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>

#include "base/error.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "process/command_words.hpp"

namespace armwright {

void PlanOptions::add_to(CLI::App& command) {
  command
      .add_option("--optimizer,-o", optimizer,
                  "The optimizer (armwright list optimizers; default: the problem's)")
      ->type_name("NAME");
  command
      .add_option("--opt", opt,
                  "An option of the optimizer, as in population=50; repeatable\n"
                  "(armwright list optimizers NAME)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--seed", seed, "Seed of the optimizer (default: 1)")
      ->type_name("N")
      ->envname("ARMWRIGHT_SEED");
  command
      .add_option("--budget", budget,
                  "Number of training cases to simulate, as 5000, 1e5 or 20k (default: the\n"
                  "problem's)")
      ->type_name("CASES");
}

std::string PlanOptions::get_problem() const {
  const std::string chosen = overrides.choose_problem(problem);
  if (chosen.empty()) {
    throw Error(ErrorKind::usage,
                "PROBLEM is required: name one (armwright list problems), or an arm of your own "
                "with --robot FILE; 'armwright optimize --help' has examples");
  }
  return chosen;
}

std::vector<std::string> PlanOptions::get_overrides() const {
  std::vector<std::string> all = overrides.get();
  if (!validation_cases.empty()) {
    all.push_back(fmt::format("sets.validation_cases={}",
                              parse_count("--validation-cases", validation_cases, 1, kMostCases)));
  }
  return all;
}

RunPlan PlanOptions::make_plan() const {
  RunPlan plan;
  const char* const variable = std::getenv("ARMWRIGHT_SEED");
  const bool is_from_variable = variable != nullptr && seed == variable;
  plan.seed = static_cast<std::uint64_t>(
      parse_count(is_from_variable ? "the environment variable ARMWRIGHT_SEED" : "--seed", seed, 0,
                  std::numeric_limits<std::int64_t>::max()));
  if (is_interpreter(optimizer) && !suggest_exec(problem).empty()) {
    // The shell has split --optimizer python3 mine.py, so that the script became the problem.
    throw Error(ErrorKind::usage,
                describe_missing_exec("optimizer", optimizer + " " + problem, "--optimizer "));
  }
  plan.problem = load_problem(get_problem(), get_overrides());
  plan.optimizer = load_optimizer(optimizer.empty() ? plan.problem.optimizer : optimizer);
  plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options, opt);
  plan.budget =
      budget.empty() ? plan.problem.budget : parse_count("--budget", budget, 1, 1'000'000'000'000);
  plan.schedule =
      schedule.empty() ? choose_schedule(plan.problem, plan.optimizer) : parse_schedule(schedule);
  plan.racing = racing.empty() ? plan.problem.racing : parse_racing(racing);
  check_plan(plan);
  return plan;
}

}  // namespace armwright
