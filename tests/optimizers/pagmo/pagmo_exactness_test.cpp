// The rows ask for the very points, bit for bit, that pagmo asks for by itself when it is given the
// same first population, options and seed.
#ifdef ARMWRIGHT_WITH_PAGMO

#include <gmock/gmock.h>

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/pso.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/memory_evaluator.hpp"

namespace armwright {
namespace {

using Points = std::vector<std::vector<double>>;

constexpr unsigned kSeed = 7;
constexpr std::int64_t kBudget = 1200;

// A problem as a user of pagmo would write it, with a record of what is asked for.
struct RecordedProblem {
  const Problem* problem = nullptr;
  Points* asked = nullptr;

  std::vector<double> fitness(const std::vector<double>& x) const {
    asked->push_back(x);
    return problem->evaluate(x, {CaseRole::training, "train/test", {0}}).objectives;
  }
  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    std::pair<std::vector<double>, std::vector<double>> bounds;
    for (const DecisionVariable& variable : problem->description().variables) {
      bounds.first.push_back(variable.lower);
      bounds.second.push_back(variable.upper);
    }
    return bounds;
  }
};

Points run_row(const std::string& name, const Problem& problem) {
  const OptimizerRow& row = find_optimizer(name);
  MemoryEvaluator evaluator(problem, {.budget = kBudget});
  row.make(Options::parse(name, row.options, {}))->minimize(evaluator, kSeed);
  Points points;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    points.push_back(entry.asked);
  }
  return points;
}

// pagmo alone, from the same first population.
Points run_alone(const pagmo::algorithm& algorithm, const Problem& problem, const Points& first) {
  Points asked;
  pagmo::population population(pagmo::problem{RecordedProblem{&problem, &asked}}, 0, kSeed);
  for (const std::vector<double>& individual : first) {
    population.push_back(individual);
  }
  algorithm.evolve(population);
  return asked;
}

void expect_exact(const std::string& name, const pagmo::algorithm& algorithm,
                  std::ptrdiff_t population) {
  const auto problem = make_analytic("rosenbrock", 10);
  const Points from_row = run_row(name, *problem);
  ASSERT_EQ(std::ssize(from_row), kBudget);
  const Points alone =
      run_alone(algorithm, *problem, {from_row.begin(), from_row.begin() + population});
  ASSERT_EQ(alone.size(), from_row.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    ASSERT_EQ(alone[i], from_row[i]) << "evaluation " << i;
  }
}

// As many generations as the budget holds beside the first population.
unsigned count_generations(std::int64_t population) {
  return static_cast<unsigned>(kBudget / population - 1);
}

TEST(PagmoExactness, DifferentialEvolution) {
  expect_exact("pagmo:de",
               pagmo::algorithm{pagmo::de{count_generations(24), 0.8, 0.9, 2, 0, 0, kSeed}}, 24);
}

TEST(PagmoExactness, CmaEs) {
  expect_exact("pagmo:cmaes",
               pagmo::algorithm{pagmo::cmaes{count_generations(12), -1, -1, -1, -1, 0.07, 0, 1e-10,
                                             false, true, kSeed}},
               12);
}

TEST(PagmoExactness, ParticleSwarm) {
  expect_exact("pagmo:pso",
               pagmo::algorithm{pagmo::pso{count_generations(24), 0.7298, 2.05, 2.05, 0.1, 5, 2, 4,
                                           false, kSeed}},
               24);
}

}  // namespace
}  // namespace armwright

#endif
