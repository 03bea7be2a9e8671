#include "study/contract/contract.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {

MemoryEvaluator ContractTrial::run(const MemoryEvaluatorSettings& settings,
                                   std::uint64_t seed) const {
  MemoryEvaluator evaluator = make_evaluator(settings);
  row.make(options)->minimize(evaluator, seed);
  return evaluator;
}

ContractFinding make_broken(std::string detail) {
  return {ContractOutcome::broken, std::move(detail)};
}

ContractFinding make_exempt(std::string why) {
  return {ContractOutcome::exempt, std::move(why)};
}

ContractFinding check_on_all(const OptimizerRow& row, const Options& options,
                             const std::function<std::string(const ContractTrial&)>& find_fault) {
  const auto problems = make_contract_problems(row);
  if (problems.empty()) {
    return make_broken("none of the problems it could be tried on suits it");
  }
  for (const auto& problem : problems) {
    const std::string fault = find_fault({row, options, *problem});
    if (!fault.empty()) {
      return make_broken(fmt::format("on {}: {}", problem->description().name, fault));
    }
  }
  return {};
}

std::string describe_difference(const std::vector<MemoryEvaluator::Entry>& a,
                                const std::vector<MemoryEvaluator::Entry>& b) {
  const std::size_t common = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (!(a[i] == b[i])) {
      return fmt::format("evaluation {} differs", i);
    }
  }
  return a.size() == b.size()
             ? ""
             : fmt::format("one run made {} evaluations, the other {}", a.size(), b.size());
}

const std::vector<ContractCheck>& contract_checks() {
  static const std::vector<ContractCheck> checks = {
      {"Budget", "asks for no more than the budget allows", check_budget},
      {"ZeroBudget", "is content with a budget of nothing", check_zero_budget},
      {"Points", "asks for finite points, inside the bounds if it says so", check_points},
      {"Types", "asks for whole numbers if it says so", check_types},
      {"Repeatable", "same seed, same evaluations", check_repeatable},
      {"Seed", "uses its seed if it says so, and only then", check_seed},
      {"Memory", "keeps nothing from one run for the next", check_memory_between_runs},
      {"Beginning", "a smaller budget is the beginning of a larger one", check_beginning},
      {"Batches", "batches and generations are as declared", check_batches},
      {"Failures", "survives evaluations that fail", check_failures},
      {"Exceptions", "lets an exception of the evaluator through", check_exceptions},
      {"Stop", "stops within a second when told to", check_stop},
      {"Resume", "stopped and resumed, gives the same result", check_resume},
      {"Leaks", "leaves no memory, descriptor or process behind", check_leaks},
      {"Learning", "beats random search", check_learning},
      {"Constraints", "finds designs that meet constraints if it knows or weighs them",
       check_constraints},
  };
  return checks;
}

ContractFinding run_contract_check(const ContractCheck& check, const OptimizerRow& row,
                                   const Options& options) {
  try {
    return check.run(row, options);
  } catch (const OptimizerFailure& failure) {
    const auto& printed = failure.printed();
    return make_broken(
        failure.what() +
        (printed.empty() ? "" : "; the last that it printed: " + join(printed, " | ")));
  } catch (const std::exception& error) {
    return make_broken(error.what());
  }
}

}  // namespace armwright
