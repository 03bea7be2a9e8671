// Evaluates candidates on cases, whoever simulates them (executor/case_executor.hpp). What is
// shared out are pairs of a candidate and a case, so that one candidate on many cases uses all
// threads and lanes as well as many candidates on one. Results depend neither on threads nor on
// chunks.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "study/executor/case_executor.hpp"

namespace armwright {

class CaseRunner {
 public:
  CaseRunner(const Problem& problem, CaseExecutor& executor, StopSignal& stop)
      : problem_(problem), executor_(executor), stop_(stop) {}

  // Called once for each finished candidate, from the thread that finished it, as soon as its last
  // case is done.
  using OnDone = std::function<void(std::size_t candidate, Evaluation evaluation)>;

  // As OnDone, with the outcomes of all cases, in the block's order, to take.
  using OnOutcomes = std::function<void(std::size_t candidate, std::span<CaseOutcome> outcomes)>;
  void run_cases(std::span<const std::span<const double>> candidates, const CaseBlock& block,
                 CaseExtras extras, const OnOutcomes& on_outcomes);

  // Every candidate on every case of the block. A stop counts between chunks; candidates that it
  // leaves unfinished `on_done` never hears of. Evaluations carry residuals only if asked for.
  // `jacobian`: with their derivatives, of problems that have them. Rethrows what `on_done` throws.
  void run(std::span<const std::span<const double>> candidates, const CaseBlock& block,
           bool residuals, const OnDone& on_done, bool jacobian = false);

 private:
  const Problem& problem_;
  CaseExecutor& executor_;
  StopSignal& stop_;
};

}  // namespace armwright
