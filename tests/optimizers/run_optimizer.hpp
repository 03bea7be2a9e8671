// Runs of an optimizer of the table in memory.
#pragma once

#include <string>
#include <vector>

#include "optimizers/table/optimizer_table.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {

inline void minimize_with(const std::string& name, MemoryEvaluator& evaluator, std::uint64_t seed,
                          const std::vector<std::string>& options = {}) {
  const OptimizerRow& row = find_optimizer(name);
  row.make(Options::parse(name, row.options, options))->minimize(evaluator, seed);
}

inline MemoryEvaluator run_optimizer(const std::string& name, const Problem& problem,
                                     const MemoryEvaluatorSettings& settings,
                                     std::uint64_t seed = 1,
                                     const std::vector<std::string>& options = {}) {
  MemoryEvaluator evaluator(problem, settings);
  minimize_with(name, evaluator, seed, options);
  return evaluator;
}

}  // namespace armwright
