// The rows ask for the very points, bit for bit, that NLopt asks for by itself when it is given the
// same bounds, start, step and seed.
#ifdef ARMWRIGHT_WITH_NLOPT

#include <gmock/gmock.h>
#include <nlopt.h>

#include "optimizers/nlopt_points.hpp"
#include "optimizers/run_optimizer.hpp"
#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

// What the bare library asks for, up to `count` points.
struct Recorder {
  const Problem& problem;
  Points points = {};
};

double record(unsigned n, const double* x, double* /*gradient*/, void* data) {
  auto& recorder = *static_cast<Recorder*>(data);
  recorder.points.emplace_back(x, x + n);
  return calc_value(recorder.problem, recorder.points.back());
}

struct Exact {
  std::string name;
  nlopt_algorithm algorithm;
  double step = 0;  // share of the box; 0: none is set
  double xtol_rel = 0;
};

Points ask_library(const Exact& exact, const Problem& problem, unsigned long seed, int count) {
  const std::vector<DecisionVariable>& variables = problem.description().variables;
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<double> x;
  std::vector<double> step;
  for (const DecisionVariable& variable : variables) {
    lower.push_back(variable.lower);
    upper.push_back(variable.upper);
    x.push_back(variable.start);
    step.push_back(exact.step * (variable.upper - variable.lower));
  }
  Recorder recorder{problem};
  nlopt_opt solver = nlopt_create(exact.algorithm, static_cast<unsigned>(x.size()));
  nlopt_set_lower_bounds(solver, lower.data());
  nlopt_set_upper_bounds(solver, upper.data());
  nlopt_set_min_objective(solver, record, &recorder);
  nlopt_set_maxeval(solver, count);
  nlopt_set_xtol_rel(solver, exact.xtol_rel);
  if (exact.step > 0) {
    nlopt_set_initial_step(solver, step.data());
  }
  nlopt_srand(seed);
  double value = 0;
  nlopt_optimize(solver, x.data(), &value);
  nlopt_destroy(solver);
  recorder.points.resize(std::min(recorder.points.size(), static_cast<std::size_t>(count)));
  return recorder.points;
}

class NloptExactness : public testing::TestWithParam<Exact> {};

TEST_P(NloptExactness, TheRowAsksForTheVeryPointsOfTheBareLibrary) {
  const auto problem = make_analytic("rosenbrock", 10);
  constexpr int kCount = 500;
  std::vector<std::string> options;
  if (GetParam().step > 0) {
    options = {"restarts=0"};
  }
  const MemoryEvaluator ours =
      run_optimizer(GetParam().name, *problem, {.budget = kCount}, 7, options);
  const Points bare = ask_library(GetParam(), *problem, 7, kCount);
  ASSERT_GE(bare.size(), 400u);
  EXPECT_EQ(asked_points(ours), bare);  // no -0.0 among them: == is bit for bit
}

INSTANTIATE_TEST_SUITE_P(Rows, NloptExactness,
                         testing::Values(Exact{"nlopt:neldermead", NLOPT_LN_NELDERMEAD, 0.05, 1e-8},
                                         Exact{"nlopt:sbplx", NLOPT_LN_SBPLX, 0.05, 1e-8},
                                         Exact{"nlopt:bobyqa", NLOPT_LN_BOBYQA, 0.05, 1e-8},
                                         Exact{"nlopt:cobyla", NLOPT_LN_COBYLA, 0.05, 1e-8},
                                         Exact{"nlopt:crs2_lm", NLOPT_GN_CRS2_LM},
                                         Exact{"nlopt:esch", NLOPT_GN_ESCH},
                                         Exact{"nlopt:isres", NLOPT_GN_ISRES},
                                         Exact{"nlopt:direct_l", NLOPT_GN_DIRECT_L},
                                         Exact{"nlopt:orig_direct", NLOPT_GN_ORIG_DIRECT}),
                         [](const auto& parameters) { return parameters.param.name.substr(6); });

}  // namespace
}  // namespace armwright

#endif
