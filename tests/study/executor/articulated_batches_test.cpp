// Tests the engine in SIMD lanes through an executor: the evaluations of a population do not depend
// on batches, threads, or the other candidates in a batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <numeric>

#include "base/bits.hpp"
#include "base/random.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {
namespace {

// Returns designs near the start and far from it, as in a search, so that some are cut off.
std::vector<std::vector<double>> make_population(const ProblemDescription& problem, int size) {
  RandomStream random("test/articulated-batches", 1);
  std::vector<std::vector<double>> population;
  for (int i = 0; i < size; ++i) {
    std::vector<double>& x = population.emplace_back();
    for (const DecisionVariable& variable : problem.variables) {
      x.push_back(std::clamp(variable.start * std::exp(random.uniform(-1.5, 1.5)), variable.lower,
                             variable.upper));
    }
  }
  return population;
}

std::vector<Evaluation> evaluate(const Problem& problem,
                                 const std::vector<std::vector<double>>& population,
                                 std::size_t at_once, std::size_t threads, std::size_t cases) {
  StopSignal stop;
  ThreadExecutor executor(threads);
  CaseBlock block{CaseRole::training, "train/1", std::vector<std::uint64_t>(cases)};
  std::iota(block.numbers.begin(), block.numbers.end(), 0);
  std::vector<Evaluation> evaluations(population.size());
  for (std::size_t first = 0; first < population.size(); first += at_once) {
    const std::size_t count = std::min(at_once, population.size() - first);
    std::vector<std::span<const double>> candidates;
    for (std::size_t i = 0; i < count; ++i) {
      candidates.emplace_back(population[first + i]);
    }
    executor.evaluate(problem, candidates, block, {.residuals = true}, stop,
                      [&](std::size_t candidate, Evaluation evaluation) {
                        evaluations[first + candidate] = std::move(evaluation);
                      });
  }
  return evaluations;
}

TEST(ArticulatedBatches, PopulationsSplitInAnyWayEvaluateToTheSameBits) {
  for (const char* precision : {"double", "float"}) {
    const std::vector<std::string> overrides = {"physics.engine=articulated",
                                                std::string("physics.precision=") + precision};
    const LoadedProblem loaded = load_problem("q1-complex", overrides);
    const Problem& problem = *loaded.problem;
    const auto population = make_population(problem.description(), 64);
    for (const std::size_t cases : {1u, 3u}) {
      const auto reference = evaluate(problem, population, 1, 1, cases);
      const auto cut_off = std::ranges::count_if(
          reference, [](const Evaluation& evaluation) { return evaluation.objectives[0] > 0.1; });
      EXPECT_GT(cut_off, 0);
      EXPECT_LT(cut_off, 64);
      for (const std::size_t at_once : {1u, 7u, 35u, 64u}) {
        for (const std::size_t threads : {1u, 2u, 3u}) {
          const auto other = evaluate(problem, population, at_once, threads, cases);
          for (std::size_t i = 0; i < population.size(); ++i) {
            ASSERT_EQ(other[i].status, reference[i].status) << i;
            ASSERT_EQ(other[i].reason, reference[i].reason) << i;
            ASSERT_TRUE(same_bits(other[i].case_errors, reference[i].case_errors)) << i;
            ASSERT_TRUE(same_bits(other[i].objectives, reference[i].objectives)) << i;
            ASSERT_TRUE(same_bits(other[i].metrics, reference[i].metrics)) << i;
            ASSERT_TRUE(same_bits(other[i].residuals, reference[i].residuals)) << i;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace armwright
