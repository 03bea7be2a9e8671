// Instances of our own functions: shifted, rotated, and otherwise the same functions.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::Each;
using testing::Ge;
using testing::Le;

const CaseBlock kInstanceCase{CaseRole::training, "train/1", {0}};

std::unique_ptr<Problem> make_instance(const std::string& name, int dimension, int instance) {
  return make_analytic({.name = name, .dimension = dimension, .instance = instance});
}

double calc_instance_value(const Problem& problem, const std::vector<double>& x) {
  return problem.evaluate(x, kInstanceCase).objectives.at(0);
}

// Returns the point at the distance `step` from the minimiser, along axis `axis`.
std::vector<double> step_from_minimiser(const Problem& problem, std::size_t axis, double step) {
  std::vector<double> x = problem.description().known_optimum;
  x[axis] += step;
  return x;
}

class FunctionInstances : public testing::TestWithParam<std::string> {};

TEST_P(FunctionInstances, EveryInstanceHasItsOwnMinimiserWithinTheBox) {
  std::vector<std::vector<double>> minimisers;
  for (int instance = 0; instance <= 20; ++instance) {
    const auto problem = make_instance(GetParam(), 6, instance);
    const ProblemDescription& description = problem->description();
    EXPECT_EQ(calc_instance_value(*problem, description.known_optimum), 0);
    EXPECT_EQ(description.optimum, 0);
    EXPECT_EQ(description.resolution, 1e-8);
    EXPECT_THAT(description.known_optimum, Each(AllOf(Ge(-4), Le(4))));
    EXPECT_THAT(minimisers, testing::Not(testing::Contains(description.known_optimum)));
    minimisers.push_back(description.known_optimum);
  }
}

TEST_P(FunctionInstances, AnInstanceDependsOnNameDimensionAndNumberOnly) {
  const std::vector<double> x(6, 0.5);
  const double value = calc_instance_value(*make_instance(GetParam(), 6, 3), x);
  double in_another_thread = 0;
  std::thread thread([&] {
    calc_instance_value(*make_instance(GetParam(), 6, 4), x);
    in_another_thread = calc_instance_value(*make_instance(GetParam(), 6, 3), x);
  });
  thread.join();
  EXPECT_EQ(in_another_thread, value);
  EXPECT_NE(calc_instance_value(*make_instance(GetParam(), 6, 4), x), value);
}

TEST_P(FunctionInstances, TheObjectiveIsTheSumOfTheSquaredResiduals) {
  const auto problem = make_instance(GetParam(), 10, 5);
  ASSERT_TRUE(problem->description().has_residuals);
  RandomStream random("test/instances/" + GetParam());
  for (int sample = 0; sample < 100; ++sample) {
    std::vector<double> x(10);
    for (double& xi : x) {
      xi = random.uniform(-5, 5);
    }
    const Evaluation evaluation = problem->evaluate(x, kInstanceCase);
    double sum = 0;
    for (const double residual : evaluation.residuals) {
      sum += residual * residual;
    }
    // As for the plain form: residuals and value have the same z, so its rounding does not count.
    EXPECT_NEAR(sum, evaluation.objectives.at(0), 1e-14 * sum + 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FunctionInstances,
                         testing::Values("sphere", "ellipsoid", "rosenbrock", "rastrigin",
                                         "sphere-int", "ellipsoid-int"),
                         [](const auto& parameters) {
                           std::string name = parameters.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// The sum of a quadratic form's values at unit steps along all axes is its trace, which no rotation
// changes. The relative error of an orthogonal matrix made of 10 reflections is below 1e-14, and
// x - s has an absolute error of 1e-15.
TEST(FunctionInstance, RotationKeepsTheTraceAndLeavesTheAxes) {
  const auto problem = make_instance("ellipsoid", 10, 1);
  double trace = 0;
  double expected = 0;
  double largest = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    const double value = calc_instance_value(*problem, step_from_minimiser(*problem, i, 1));
    trace += value;
    largest = std::max(largest, value);
    expected += std::pow(1e6, static_cast<double>(i) / 9);
  }
  EXPECT_NEAR(trace, expected, 1e-12 * expected);
  EXPECT_LT(largest, 0.9e6);  // 1e6 if the longest axis were still an axis of the box
}

// A coordinate search solves the plain rastrigin exactly: its value is a sum over the coordinates,
// so f(a, b) - f(a, b') does not depend on a.
TEST(FunctionInstance, RastriginIsNotSeparableAfterRotation) {
  const auto calc_interaction = [](const Problem& problem) {
    const std::vector<double> s = problem.description().known_optimum;
    const auto at = [&](double a, double b) {
      return calc_instance_value(problem, {s[0] + a, s[1] + b});
    };
    return std::abs((at(0.3, 0.4) - at(0.3, 0)) - (at(0, 0.4) - at(0, 0)));
  };
  EXPECT_LT(calc_interaction(*make_instance("rastrigin", 2, 0)), 1e-12);
  for (const int instance : {1, 2, 3}) {
    EXPECT_GT(calc_interaction(*make_instance("rastrigin", 2, instance)), 0.1);
  }
}

// Q is drawn from all orthogonal matrices: the square of the first coordinate of the direction that
// the weight 1e6 has is on average 1/n. Its standard deviation for n = 4 is sqrt(3)/4 / sqrt(3) =
// 0.25 at most, so the mean of 400 has an error of 0.0125; the test allows four times as much.
TEST(FunctionInstance, RotationsHaveNoPreferredAxis) {
  constexpr int kCount = 400;
  for (std::size_t axis = 0; axis < 4; ++axis) {
    double sum = 0;
    for (int instance = 1; instance <= kCount; ++instance) {
      const auto problem = make_instance("ellipsoid", 4, instance);
      sum += calc_instance_value(*problem, step_from_minimiser(*problem, axis, 1)) / 1.010101e6;
    }
    EXPECT_NEAR(sum / kCount, 0.25, 0.05);
  }
}

TEST(FunctionInstance, OfOneDimensionIsPossible) {
  const auto problem = make_instance("ellipsoid", 1, 1);
  // One rounding of x - s, times the derivative 4.
  EXPECT_NEAR(calc_instance_value(*problem, step_from_minimiser(*problem, 0, 2)), 4, 1e-14);
}

// The bits of an instance are a promise: recorded runs name instances by number.
TEST(FunctionInstance, TheFirstInstanceKeepsItsBits) {
  const auto problem = make_instance("rosenbrock", 3, 1);
  EXPECT_THAT(problem->description().known_optimum,
              testing::ElementsAre(-1.1967769317222769, 3.5938836962742879, -1.8180164623415607));
  EXPECT_EQ(calc_instance_value(*problem, {0, 0, 0}), 4794.5657286107589);
}

TEST(FunctionInstance, ConstrainedHasThePlainFormOnly) {
  EXPECT_EQ(usage_error_of([] { make_instance("constrained", 4, 1); }),
            "analytic function 'constrained': instance is 1; it must be 0");
  const auto problem = make_analytic("constrained");
  EXPECT_EQ(problem->description().optimum, -44);
  EXPECT_EQ(problem->description().resolution, 1e-8);
}

}  // namespace
}  // namespace armwright
