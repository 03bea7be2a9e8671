// Simulations that diverge: their messages, and that they do not affect other simulations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "sim/tracking/engine_support.hpp"
#include "test_arms.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

constexpr double kLargest = std::numeric_limits<double>::max();
const VectorXd kStart = make_vector({0.6, -0.9, 1.3});

std::string divergence_message(const std::function<void()>& action) {
  try {
    action();
  } catch (const DivergenceError& error) {
    return error.what();
  }
  return "(no error)";
}

// Steps until a DivergenceError, at most `steps` times, and returns its message.
template <class Arm>
std::string step_until_divergence(const RobotModel& model, Eigen::Index joint, double effort_n_m,
                                  int steps) {
  Arm arm = make_arm<Arm>(model, kStart);
  VectorXd tau = VectorXd::Constant(3, 1.5);
  tau[joint] = effort_n_m;
  return divergence_message([&] {
    for (int k = 0; k < steps; ++k) {
      step(arm, tau, 0.01);
    }
  });
}

// Returns everything that can be read from an arm after half a second of general motion.
template <class Arm>
VectorXd simulate_half_a_second() {
  const RobotModel model = make_skew_arm();
  Arm arm = make_arm<Arm>(model, kStart);
  for (int k = 0; k < 50; ++k) {
    step(arm, VectorXd::LinSpaced(3, std::sin(k), -2), 0.01);
  }
  VectorXd all(11);
  all << read_positions(arm, 3), read_rates(arm, 3), arm.tip_position_m(),
      arm.calc_kinetic_energy_j(), arm.calc_potential_energy_j();
  return all;
}

template <class Arm>
class Divergence : public testing::Test {};
TYPED_TEST_SUITE(Divergence, ArmTypes, ArmNames);

TYPED_TEST(Divergence, ANonFiniteEffortNamesItsJoint) {
  const RobotModel model = make_skew_arm();
  const std::vector<std::string> names{"joint 1 (waist)", "joint 2 (shoulder)", "joint 3 (elbow)"};
  for (const double effort_n_m :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      EXPECT_EQ(
          step_until_divergence<TypeParam>(model, static_cast<Eigen::Index>(i), effort_n_m, 1),
          names[i] + ": its controller asks for a non-finite effort");
    }
  }
}

// The square of 1e160 overflows. With the largest double, the first step overflows, and the engine
// stops in the middle of it.
TYPED_TEST(Divergence, AbsurdEffortsAreCaughtAndNameAJoint) {
  const RobotModel model = make_skew_arm();
  for (const double effort_n_m : {1e12, -1e30, 1e100, 1e160, -1e160, 1e300, kLargest, -kLargest}) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_THAT(step_until_divergence<TypeParam>(model, i, effort_n_m, 3),
                  MatchesRegex(ArmTraits<TypeParam>::kBlownUp))
          << effort_n_m << " N m in joint " << i + 1;
    }
  }
}

// A link on an axis along y gets a rate within one step (qd = h tau / J, exact from rest). An arm
// that is only out of control must not count as diverged.
template <class Arm>
std::string kick(double rate_rad_per_s, double h_s) {
  const RobotModel model = make_pendulum({0, 1, 0});
  const double inertia_kg_m2 =
      ChainOracle(model, 0).calc(VectorXd::Zero(1), VectorXd::Zero(1)).mass(0, 0);
  PhysicsSettings physics;
  physics.gravity_m_per_s2 = 0;
  Arm arm = make_arm<Arm>(model, VectorXd::Constant(1, 0.7), physics);
  return divergence_message(
      [&] { step(arm, VectorXd::Constant(1, rate_rad_per_s * inertia_kg_m2 / h_s), h_s); });
}

// In a microsecond the link moves by less than a metre, so only the rate decides.
TYPED_TEST(Divergence, BeginsAtAMillionRadiansPerSecond) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(kick<TypeParam>(sign * 0.99e6, 1e-6), "(no error)");
    const std::string message = kick<TypeParam>(sign * 1.01e6, 1e-6);
    EXPECT_THAT(message, MatchesRegex(ArmTraits<TypeParam>::kBlownUp));
    EXPECT_THAT(message, MatchesRegex("joint 1 \\(pivot\\): .* at -?1\\.01e\\+06 rad/s"));
  }
}

// The centre of mass is at most 0.34 m from the hinge, and the distance that counts is |x| + |y| +
// |z|. If it leaves its circle, it moves 0.34 to 0.48 km away in 0.1 s at 1e4 rad/s, and 3.4 to 4.8
// km at 1e5 rad/s.
TYPED_TEST(Divergence, BeginsAtAKilometre) {
  EXPECT_EQ(kick<TypeParam>(1e4, 0.1), "(no error)");
  if constexpr (ArmTraits<TypeParam>::kMovesAlongTangents) {
    EXPECT_THAT(kick<TypeParam>(1e5, 0.1),
                MatchesRegex("joint 1 \\(pivot\\): its link is .*e\\+03 m from the "
                             "base and turns at 1e\\+05 rad/s"));
  } else {
    EXPECT_EQ(kick<TypeParam>(1e5, 0.1), "(no error)");
  }
}

// A link on a level rail is pushed for one step of 10 s. It either reports its position or is too
// far away.
TYPED_TEST(Divergence, OfASliderBeginsFarAwayToo) {
  const RobotModel model = make_slider({0.6, -0.8, 0});
  const auto push = [&](double distance_m) {
    auto arm = make_arm<TypeParam>(model, make_vector({0.5}));
    return divergence_message(
        [&] { step(arm, make_vector({distance_m / 100 * kFirstBody.mass_kg}), 10); });
  };
  // |x| + |y| + |z| is 1.4 times the way along this rail, and 1.7 m at the start.
  const double farthest_m = ArmTraits<TypeParam>::kFarthestSlide_m;
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(push(sign * 0.98 * farthest_m), "(no error)");
    const std::string message = push(sign * 1.02 * farthest_m);
    EXPECT_THAT(message, MatchesRegex(ArmTraits<TypeParam>::kBlownUp));
    EXPECT_THAT(message, StartsWith("joint 1 (rail): "));
  }
  EXPECT_EQ(push(std::numeric_limits<double>::quiet_NaN()),
            "joint 1 (rail): its controller asks for a non-finite effort");
}

// Here the rate (m/s) is a tenth of the way (m).
TEST(ArticulatedArmDivergence, BeginsAtAMillionRadiansInAll) {
  EXPECT_EQ(kick<ArticulatedArm>(0.9e5, 10), "(no error)");
  EXPECT_EQ(kick<ArticulatedArm>(1e5, 10),
            "joint 1 (pivot): it is at 1e+06 rad and moves at 1e+05 rad/s");
}

TYPED_TEST(Divergence, LeavesNoTraceInTheNextSimulation) {
  const VectorXd fresh = simulate_half_a_second<TypeParam>();
  const RobotModel model = make_skew_arm();
  for (const double effort_n_m :
       {1e12, 1e160, 1e300, kLargest, std::numeric_limits<double>::quiet_NaN()}) {
    auto survivor = make_arm<TypeParam>(model, kStart);  // must not change when another diverges
    EXPECT_NE(step_until_divergence<TypeParam>(model, 1, effort_n_m, 3), "(no error)");
    EXPECT_EQ(simulate_half_a_second<TypeParam>(), fresh) << effort_n_m;
    step(survivor, VectorXd::Constant(3, 1.5), 0.01);
    EXPECT_TRUE(read_rates(survivor, 3).allFinite());
    VectorXd elsewhere;
    std::thread([&] { elsewhere = simulate_half_a_second<TypeParam>(); }).join();
    EXPECT_EQ(elsewhere, fresh) << effort_n_m;
  }
}

// A thread in which an arm has diverged gives the same results as another thread.
TYPED_TEST(Divergence, LeavesNoTraceInItsThread) {
  const VectorXd fresh = simulate_half_a_second<TypeParam>();
  VectorXd after;
  std::thread([&] {
    EXPECT_NE(step_until_divergence<TypeParam>(make_skew_arm(), 0, kLargest, 3), "(no error)");
    after = simulate_half_a_second<TypeParam>();
  }).join();
  EXPECT_EQ(after, fresh);
}

TEST(DivergedSimulation, IsAStatusWithTimeAndJoint) {
  const TrackingSetup setup(load_irb4600(), {});
  const TargetTable targets = setup.make_targets(make_case(1));
  const TrackingResult result = simulate_one(setup, make_job(kExploding, targets));
  EXPECT_EQ(result.status, SimulationStatus::diverged);
  EXPECT_THAT(
      result.reason,
      MatchesRegex("diverged at 0\\.[0-9]+ s, on the way to point 1: joint [1-4] "
                   "\\(joint_[1-4]\\): its link is .* m from the base and turns at .* rad/s"));
  EXPECT_THAT(result.reason, HasSubstr("joint 4 (joint_4)"));
  EXPECT_LT(result.steps, 100);
  EXPECT_TRUE(result.point_error_m.empty());  // it reached none, and there is no cut-off
  EXPECT_EQ(result.mean_error_m, 0);
}

// Limits that leave joint 1 only the largest double as effort.
TEST(DivergedSimulation, IsAStatusEvenIfTheEngineStopsInTheMiddleOfAStep) {
  ArmDesign design = kTableA5;
  design.joints[0] = {{1, 0, 0}, {kLargest, kLargest}};
  const TrackingSetup setup(load_irb4600(), {});
  const TargetTable targets = setup.make_targets(make_case(1, 4));
  const std::vector<TrackingJob> jobs{make_job(kTableA5, targets), make_job(design, targets),
                                      make_job(kTableA5, targets)};
  const auto results = make_engine("ode")->simulate(setup, jobs);
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(results[1].status, SimulationStatus::diverged);
  EXPECT_THAT(results[1].reason, StartsWith("diverged at "));
  EXPECT_EQ(results[0].status, SimulationStatus::ok);
  expect_identical(results[2], results[0]);
}

TEST(DivergedSimulation, CountsAsTheCutOffErrorWhereThereIsOne) {
  const TrackingSetup setup(load_irb4600(), {});
  const TargetTable targets = setup.make_targets(make_case(1));
  const double cutoff_m = 0.75;
  const TrackingResult result = simulate_one(setup, make_job(kExploding, targets, cutoff_m));
  EXPECT_EQ(result.status, SimulationStatus::diverged);
  EXPECT_THAT(result.reason, StartsWith("diverged at "));
  EXPECT_EQ(result.point_error_m.size(), 25u);
  EXPECT_THAT(result.point_error_m, Each(cutoff_m));
  EXPECT_EQ(result.mean_error_m, cutoff_m);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(std::isfinite(result.peak_effort[i])) << i;
    EXPECT_TRUE(std::isfinite(result.rms_effort[i])) << i;
  }
  EXPECT_TRUE(std::isfinite(result.energy_j));
}

// A diverging job in a batch with others, and before them.
TEST(DivergedSimulation, LeavesTheOthersOfItsBatchAlone) {
  const TrackingSetup setup(load_irb4600(), {});
  const TargetTable targets = setup.make_targets(make_case(1, 4));
  const TrackingResult alone = simulate_one(setup, make_job(kTableA5, targets));
  ASSERT_EQ(alone.status, SimulationStatus::ok) << alone.reason;
  const std::vector<TrackingJob> jobs{make_job(kTableA5, targets), make_job(kExploding, targets),
                                      make_job(kTableA5, targets)};
  const auto results = make_engine("ode")->simulate(setup, jobs);
  ASSERT_EQ(results.size(), 3u);
  expect_identical(results[0], alone);
  EXPECT_EQ(results[1].status, SimulationStatus::diverged);
  expect_identical(results[2], alone);
}

TEST(UnreachableTarget, IsAStatusThatNamesPointAndReach) {
  const TrackingSetup setup(load_irb4600(), {});
  TestCase far = make_case(1, 4);
  far.points_m[3] = {2.9, 0.4, 1.1};
  TestCase far_start = make_case(1, 4);
  far_start.points_m[0] = {-0.3, 3.1, 0.4};
  const TargetTable tables[] = {setup.make_targets(far), setup.make_targets(far_start),
                                setup.make_targets(make_case(1, 4))};
  const std::vector<TrackingJob> jobs{make_job(kTableA5, tables[0]), make_job(kTableA5, tables[1]),
                                      make_job(kTableA5, tables[2])};
  const auto results = make_engine("ode")->simulate(setup, jobs);
  ASSERT_EQ(results.size(), 3u);
  for (const int i : {0, 1}) {
    EXPECT_EQ(results[i].status, SimulationStatus::unreachable);
    EXPECT_EQ(results[i].steps, 0);
    EXPECT_TRUE(results[i].point_error_m.empty());
  }
  // Joints 2 to 3 and 3 to 4: 1.095 m and hypot(1.270, 0.175) = 1.282 m.
  EXPECT_THAT(
      results[0].reason,
      MatchesRegex("on the way to point 3: target \\(.*\\) m is out of reach: .*2\\.377.*"));
  EXPECT_THAT(
      results[1].reason,
      MatchesRegex("start: target \\(-0\\.3, 3\\.1, 0\\.4\\) m is out of reach: .*2\\.377.*"));
  EXPECT_EQ(results[2].status, SimulationStatus::ok);
}

}  // namespace
}  // namespace armwright::physics_test
