// Compares exact derivatives of simulations with differences of the same simulations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "sim/tracking/design.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

// Returns one number of the design, in the order of the derivatives.
double& get_number(ArmDesign& design, std::size_t which) {
  const std::size_t gains = design.joints.front().gains.size();
  JointDrive& joint = design.joints[which / (gains + 2)];
  const std::size_t k = which % (gains + 2);
  return k < gains ? joint.gains[k] : k == gains ? joint.limits.min : joint.limits.max;
}
std::size_t count_numbers(const ArmDesign& design) {
  return design.joints.size() * (design.joints.front().gains.size() + 2);
}
constexpr std::size_t kNumbers = 20;  // of a PID design

// Makes directions along the numbers themselves. The derivatives are then with respect to the
// logarithms of the numbers, in m per factor of e.
std::vector<ArmDesign> make_directions(const ArmDesign& design) {
  ArmDesign zero = design;
  const std::size_t numbers = count_numbers(design);
  for (std::size_t i = 0; i < numbers; ++i) {
    get_number(zero, i) = 0;
  }
  std::vector<ArmDesign> directions(numbers, zero);
  for (std::size_t i = 0; i < numbers; ++i) {
    ArmDesign copy = design;
    get_number(directions[i], i) = get_number(copy, i);
  }
  return directions;
}

std::unique_ptr<PhysicsEngine> make_articulated() {
  return make_engine("articulated", {.simd = SimdLevel::scalar});
}

std::vector<double> calc_errors(const PhysicsEngine& engine, const TrackingSetup& setup,
                                const ArmDesign& design, const TargetTable& targets) {
  const TrackingJob job = make_job(design, targets);
  return engine.simulate(setup, {&job, 1}).front().point_error_m;
}

// Returns central differences, one row per point; `step` is relative to the number itself.
std::vector<double> calc_differences(const PhysicsEngine& engine, const TrackingSetup& setup,
                                     const ArmDesign& design, const TargetTable& targets,
                                     double step) {
  const std::size_t numbers = count_numbers(design);
  std::vector<double> differences(targets.segments.size() * numbers);
  for (std::size_t i = 0; i < numbers; ++i) {
    ArmDesign above = design;
    ArmDesign below = design;
    get_number(above, i) *= 1 + step;
    get_number(below, i) *= 1 - step;
    const auto high = calc_errors(engine, setup, above, targets);
    const auto low = calc_errors(engine, setup, below, targets);
    for (std::size_t k = 0; k < high.size(); ++k) {
      differences[k * numbers + i] = (high[k] - low[k]) / (2 * step);
    }
  }
  return differences;
}

// The distance of derivatives from differences. If differences of two step sizes disagree, there is
// a kink between them (another control period has the maximum, a limit is just reached) or strong
// curvature. If they agree to `kAgreement` of the scale, the error is smooth there, and
// extrapolation to step size 0 leaves an error far below that.
struct Comparison {
  int smooth = 0;
  int with_influence = 0;  // count of smooth ones
  int rough = 0;
  double worst = 0;  // largest distance at smooth ones, as a share of the scale
};
constexpr double kAgreement = 3e-6;

Comparison compare(const TrackingSetup& setup, const ArmDesign& design,
                   const TargetTable& targets) {
  constexpr double kStep = 4e-5;
  const auto engine = make_articulated();
  const auto wide = calc_differences(*engine, setup, design, targets, kStep);
  const auto narrow = calc_differences(*engine, setup, design, targets, kStep / 2);
  const TrackingJob job = make_job(design, targets);
  const auto exact = engine->calc_derivatives(setup, job, make_directions(design));
  const auto errors = calc_errors(*engine, setup, design, targets);
  const std::size_t numbers = count_numbers(design);
  EXPECT_EQ(exact.size(), wide.size());
  Comparison comparison;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    // Errors are rounded to some 1e-15 m, and differences divide that by the step: 1e-10 m. The
    // scale is never below the errors themselves, at least 1e-4 m.
    const double scale = std::max(std::abs(wide[i]), errors[i / numbers]);
    if (std::abs(wide[i] - narrow[i]) > kAgreement * scale) {
      ++comparison.rough;
      continue;
    }
    ++comparison.smooth;
    comparison.with_influence += std::abs(wide[i]) > 0.01 * errors[i / numbers] ? 1 : 0;
    const double limit = (4 * narrow[i] - wide[i]) / 3;
    comparison.worst = std::max(comparison.worst, std::abs(exact[i] - limit) / scale);
  }
  return comparison;
}

void expect_agreement(const Comparison& comparison) {
  // The test does not see a kink that changes the differences by less than the required agreement,
  // and the extrapolated differences by little more.
  EXPECT_LT(comparison.worst, 3 * kAgreement);
  // Most derivatives are smooth, and many of them are not zero.
  EXPECT_GT(comparison.smooth, 4 * comparison.rough);
  EXPECT_GT(comparison.with_influence, comparison.smooth / 10);
}

class Derivatives : public testing::Test {
 protected:
  TrackingSetup setup_{load_irb4600(), make_e6_task()};
  TargetTable targets_ = setup_.make_targets(make_case(7));
};

TEST_F(Derivatives, AreTheLimitsOfDifferences) {
  for (const ArmDesign& design : {kTableA1, kTableA5, kTableA10}) {
    expect_agreement(compare(setup_, design, targets_));
  }
}

// If the third axis is slightly off parallel, it begins a group of its own at a general angle. Then
// the code for chains of any shape runs.
TEST_F(Derivatives, HoldForAnyShapeOfChain) {
  RobotModel robot = load_irb4600();
  robot.joints[2].axis = (robot.joints[2].axis + 3e-7 * Eigen::Vector3d(0.6, 0, 0.8)).normalized();
  const TrackingSetup setup(robot, make_e6_task());
  const Comparison comparison = compare(setup, kTableA1, targets_);
  expect_agreement(comparison);
  // The arm is the same to 3e-7 rad, and so are its derivatives, except near kinks.
  const TrackingJob job = make_job(kTableA1, targets_);
  const auto directions = make_directions(kTableA1);
  const auto a = make_articulated()->calc_derivatives(setup_, job, directions);
  const auto b = make_articulated()->calc_derivatives(setup, job, directions);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_NE(a, b);  // because other code ran
  double largest = 0;
  double difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i]));
    difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  EXPECT_LT(difference, 1e-3 * largest);
}

TEST_F(Derivatives, DoNotDependOnHowManyAreAskedForAtOnce) {
  const auto engine = make_articulated();
  const TrackingJob job = make_job(kTableA5, targets_);
  const auto directions = make_directions(kTableA5);
  const auto all = engine->calc_derivatives(setup_, job, directions);
  for (const std::size_t i : {0UL, 6UL, 19UL}) {
    const auto one = engine->calc_derivatives(setup_, job, std::span(directions).subspan(i, 1));
    ASSERT_EQ(one.size(), targets_.segments.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
      EXPECT_EQ(one[k], all[k * kNumbers + i]);
    }
  }
  EXPECT_EQ(make_engine("articulated")->calc_derivatives(setup_, job, directions), all);
  EXPECT_TRUE(engine->calc_derivatives(setup_, job, {}).empty());
}

// Tests every controller, converted from the first design. Numbers that start at zero or at a kink
// are moved away from it.
TEST_F(Derivatives, AreTheLimitsOfDifferencesForEveryController) {
  for (const ControllerRow& row : controller_table()) {
    TrackingTask task = make_e6_task(row);
    task.control_start = ControlStart::gravity;
    const TrackingSetup setup(load_irb4600(), task);
    const TargetTable targets = setup.make_targets(make_case(7, 8));
    ArmDesign design =
        convert_design(kTableA1, row.name, task.control_period_s, task.drives.calc_lag_s());
    for (JointDrive& joint : design.joints) {
      joint.limits.min *= 0.97;  // two equal limits would be a kink of the larger one
      for (std::size_t k = 0; k < joint.gains.size(); ++k) {
        joint.gains[k] += row.gains[k].any_sign    ? 0.01 * std::cos(static_cast<double>(k))
                          : row.gains[k].range > 0 ? -0.1
                                                   : 0;
      }
    }
    SCOPED_TRACE(row.name);
    const Comparison comparison = compare(setup, design, targets);
    EXPECT_LT(comparison.worst, 3 * kAgreement);
    EXPECT_GT(comparison.smooth, 3 * comparison.rough);
    EXPECT_GT(comparison.with_influence, comparison.smooth / 20);
  }
}

// Points that were not reached have the cut-off error, which is constant.
TEST_F(Derivatives, AreZeroFromACutOffOnAndFiniteWhereAnArmDiverges) {
  const auto engine = make_articulated();
  const TrackingJob job = make_job(kLimp, targets_, 0.3);
  const TrackingResult result = engine->simulate(setup_, {&job, 1}).front();
  ASSERT_EQ(result.status, SimulationStatus::cut_off) << result.reason;
  const auto derivatives = engine->calc_derivatives(setup_, job, make_directions(kLimp));
  ASSERT_EQ(derivatives.size(), targets_.segments.size() * kNumbers);
  for (std::size_t k = 0; k < targets_.segments.size(); ++k) {
    const bool reached = result.point_error_m[k] < 0.3;
    for (std::size_t i = 0; i < kNumbers && !reached; ++i) {
      EXPECT_EQ(derivatives[k * kNumbers + i], 0);
    }
  }
  const TrackingJob exploding = make_job(kExploding, targets_);
  for (const double slope :
       engine->calc_derivatives(setup_, exploding, make_directions(kExploding))) {
    EXPECT_TRUE(std::isfinite(slope));
  }
}

TEST_F(Derivatives, NeitherExistForUnreachableTargetsNorFromOde) {
  TargetTable unreachable = targets_;
  unreachable.unreachable = "too far";
  const auto directions = make_directions(kTableA1);
  const TrackingJob job = make_job(kTableA1, unreachable);
  EXPECT_TRUE(make_articulated()->calc_derivatives(setup_, job, directions).empty());
  EXPECT_TRUE(make_articulated()->has_derivatives());
  const auto ode = make_engine("ode");
  EXPECT_FALSE(ode->has_derivatives());
  EXPECT_THROW(ode->calc_derivatives(setup_, job, directions), std::logic_error);
}

}  // namespace
}  // namespace armwright::physics_test
