// Checks rotor inertia, friction, elasticity and counterbalance of a joint against closed forms, and
// that the engines agree.
#include "sim/robot/joint_plant.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "swinging_arms.hpp"

namespace armwright::physics_test {
namespace {

// A link on a vertical hinge, which gravity does not turn.
RobotModel make_turnstile(const JointPlant& plant) {
  RobotModel robot = make_pendulum({0, 0, 1});
  robot.joints[0].plant = plant;
  return robot;
}

double calc_turnstile_inertia() {
  const Inertial body = make_turnstile({}).links[0].inertial;
  return body.inertia_kg_m2(2, 2) +
         body.mass_kg * (body.com_m.x() * body.com_m.x() + body.com_m.y() * body.com_m.y());
}

// The friction in equilibrium at a rate.
double calc_friction(const JointPlant& its, double rate) {
  return its.offset + its.viscous * rate +
         (its.coulomb + its.stribeck) * std::tanh(rate / its.transition_rate) -
         its.stribeck * std::tanh(rate / its.stribeck_rate);
}

const VectorXd kBegin = VectorXd::Constant(1, 0.3);

template <class Arm>
class DrivenJoint : public testing::Test {
 protected:
  // Links that move along tangents lose some of their rate when they are pulled back.
  static double calc_tolerance(double turn_per_step_rad) {
    return ArmTraits<Arm>::kMovesAlongTangents ? std::abs(turn_per_step_rad) : 1e-6;
  }
};
TYPED_TEST_SUITE(DrivenJoint, ArmTypes, ArmNames);

TYPED_TEST(DrivenJoint, ArmatureAddsToTheInertia) {
  JointPlant plant;
  plant.armature = 1.7;
  DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, 0.001);
  for (int k = 0; k < 10; ++k) {
    driven.step(0.8);
  }
  // ODE solves with the reciprocal of the inertia, which costs some digits.
  const double expected = 0.01 * 0.8 / (calc_turnstile_inertia() + 1.7);
  EXPECT_NEAR(driven.rate(), expected, 1e-10 * expected);
}

// Under viscous friction d, a rate decays as exp(-d t / J), and in implicit steps as
// (1 + h d / J)^-k.
TYPED_TEST(DrivenJoint, ViscousFrictionLetsTheRateDecay) {
  JointPlant plant;
  plant.viscous = 0.6;
  DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, 0.001);
  driven.step(500);
  const double fastest = driven.rate();
  const int steps = 1000;
  for (int k = 0; k < steps; ++k) {
    driven.step(0);
  }
  const double share = 0.6 * 0.001 / calc_turnstile_inertia();
  EXPECT_NEAR(driven.rate() / fastest, std::pow(1 + share, -steps),
              TestFixture::calc_tolerance(fastest * 0.001));
  // The relative error of the implicit steps is (d t / J) (h d / J) / 2.
  const double exact = std::exp(-share * steps);
  EXPECT_NEAR(driven.rate() / fastest, exact, exact * steps * share * share / 2 * 1.1);
}

// A constant effort finally turns the joint at the rate at which friction takes all of it.
TYPED_TEST(DrivenJoint, FrictionSetsTheFinalRate) {
  JointPlant plant;
  plant.viscous = 0.4;
  plant.coulomb = 1.2;
  plant.stribeck = 0.5;
  plant.offset = -0.3;
  for (const double rate : {3.0, -2.0, 0.8}) {
    DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, 0.002);
    // The effort that starts the joint must exceed the friction at breakaway.
    for (int k = 0; k < 1000; ++k) {
      driven.step(std::copysign(4.0, rate));
    }
    for (int k = 0; k < 20000; ++k) {
      driven.step(calc_friction(plant, rate));
    }
    EXPECT_NEAR(driven.rate(), rate, TestFixture::calc_tolerance(rate * 0.002));
  }
}

// Below breakaway the joint creeps at v_w artanh(tau / c), however coarse the step: h c / (J v_w) is
// 1000 here, where explicit friction would oscillate.
TYPED_TEST(DrivenJoint, FrictionHoldsTheJointBelowBreakaway) {
  JointPlant plant;
  plant.coulomb = 2;
  plant.transition_rate = 1e-4;
  const double step_s = 1000 * calc_turnstile_inertia() * plant.transition_rate / plant.coulomb;
  for (const double effort : {1.5, -1.9, 0.1}) {
    DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, std::min(step_s, 0.01));
    const double creep = plant.transition_rate * std::atanh(effort / plant.coulomb);
    for (int k = 0; k < 4000; ++k) {
      driven.step(effort);
      ASSERT_LE(std::abs(driven.rate()), std::abs(creep) * (1 + 1e-6));
    }
    EXPECT_NEAR(driven.rate(), creep, 1e-6 * std::abs(creep));
  }
}

// The largest friction at any rate decides whether the joint breaks away.
TYPED_TEST(DrivenJoint, BreaksAwayAtTheLargestFriction) {
  JointPlant plant;
  plant.coulomb = 1;
  plant.stribeck = 0.6;
  plant.transition_rate = 0.005;
  plant.stribeck_rate = 0.2;
  double largest = 0;
  double at_rate = 0;
  for (double rate = 0; rate < 0.2; rate += 1e-5) {
    if (calc_friction(plant, rate) > largest) {
      largest = calc_friction(plant, rate);
      at_rate = rate;
    }
  }
  EXPECT_GT(largest, 1.5);  // near c + s_t
  for (const double share : {0.999, 1.001}) {
    DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, 0.002);
    for (int k = 0; k < 20000; ++k) {
      driven.step(share * largest);
    }
    if (share < 1) {
      EXPECT_LT(driven.rate(), at_rate);
    } else {
      EXPECT_GT(driven.rate(), 5);
    }
  }
}

// Without any effort a joint with friction comes to rest and stays.
TYPED_TEST(DrivenJoint, ComesToRestAndStays) {
  JointPlant plant;
  plant.coulomb = 2;
  DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, 0.002);
  driven.step(500);
  for (int k = 0; k < 5000; ++k) {
    driven.step(0);
  }
  const double place = driven.q()[0];
  EXPECT_NEAR(driven.rate(), 0, 1e-9);
  for (int k = 0; k < 5000; ++k) {
    driven.step(0);
  }
  EXPECT_NEAR(driven.q()[0], place, 1e-9);
}

TYPED_TEST(DrivenJoint, CounterbalanceIsStraightBetweenItsEfforts) {
  JointPlant plant;
  plant.counterbalance = {-1, 1, {4, -2, 6}};
  const auto push = [&](double q) {
    DrivenArm<TypeParam> driven(make_turnstile(plant), VectorXd::Constant(1, q), 0.001);
    driven.step(0);
    return driven.rate() * calc_turnstile_inertia() / 0.001;
  };
  EXPECT_NEAR(push(-1), 4, 1e-9);
  EXPECT_NEAR(push(-0.25), -0.5, 1e-9);
  EXPECT_NEAR(push(0.75), 4, 1e-9);
  EXPECT_NEAR(push(1.5), 6, 1e-9);  // beyond its ends it keeps its value
  EXPECT_NEAR(push(-3), 4, 1e-9);
  EXPECT_NEAR(push(0.75 + 2 * kPi), 4, 1e-9);
}

// Two inertias on a spring swing at w^2 = k (1 / A + 1 / M). In steps of h, semi-implicit Euler
// swings at 2 arcsin(w h / 2) / h: 0.1 % faster at w h = 0.155, such as 25 Hz at ten substeps of
// 1 ms. docs/plant.md has these numbers.
TYPED_TEST(DrivenJoint, ElasticJointSwingsAtItsFrequency) {
  constexpr double kStep_s = 0.001;
  for (const double turn_rad : {0.1, 0.155, 0.3, 0.5}) {
    const double rate = turn_rad / kStep_s;
    JointPlant plant;
    plant.armature = 0.9;
    plant.stiffness = rate * rate / (1 / plant.armature + 1 / calc_turnstile_inertia());
    DrivenArm<TypeParam> driven(make_turnstile(plant), kBegin, kStep_s);
    driven.step(40);
    double before = 0;
    double first_s = 0;
    double last_s = 0;
    int crossings = -1;
    for (int k = 0; k < 20000; ++k) {
      driven.step(0);
      const double stretch = std::remainder(driven.pushed(0) - driven.q()[0], 2 * kPi);
      if (before < 0 && stretch >= 0) {
        last_s = kStep_s * (k + 1 - stretch / (stretch - before));
        first_s = ++crossings == 0 ? last_s : first_s;
      }
      before = stretch;
    }
    ASSERT_GT(crossings, 250);
    const double measured = crossings * 2 * kPi / (last_s - first_s);
    EXPECT_NEAR(measured, 2 * std::asin(turn_rad / 2) / kStep_s, 1e-5 * rate);
    if (turn_rad < 0.155) {
      EXPECT_NEAR(measured, rate, 1e-3 * rate);
    }
  }
}

// In the end the spring holds the link, and the motor has turned by effort / k more.
TYPED_TEST(DrivenJoint, SpringCarriesTheEffort) {
  JointPlant plant;
  plant.armature = 0.9;
  plant.stiffness = 4000;
  plant.damping = 8;
  plant.viscous = 20;
  plant.measured = MeasuredSide::motor;
  RobotModel robot = make_turnstile(plant);
  DrivenArm<TypeParam> at_motor(robot, kBegin, 0.001);
  robot.joints[0].plant.measured = MeasuredSide::link;
  DrivenArm<TypeParam> at_link(robot, kBegin, 0.001);
  for (int k = 0; k < 3000; ++k) {  // both inertias turn at effort / d
    at_motor.step(30);
    at_link.step(30);
  }
  EXPECT_NEAR(at_motor.rate(), 1.5, 1e-5);
  // The spring turns the link against no friction, so that it is not stretched.
  EXPECT_NEAR(std::remainder(at_motor.pushed(0) - at_motor.q()[0], 2 * kPi), 0, 1e-5);
  DrivenArm<TypeParam> pulled(make_turnstile(plant), kBegin, 0.001);
  pulled.step(1e4);
  EXPECT_GT(std::abs(pulled.pushed(0) - pulled.q()[0]), 1e-3);
  EXPECT_EQ(pulled.measured(), pulled.pushed(0));
  EXPECT_EQ(at_link.measured(), at_link.q()[0]);
}

// The counterbalance of a real robot: its gas spring's closed form (facts: Weigand et al. 2021),
// given as even efforts.
TEST(Counterbalance, FollowsASmoothCurve) {
  Joint joint;
  joint.plant.counterbalance = {-2, 1, {}};
  const auto curve = [](double q) { return 3000 * std::sin(q + 0.4) / (1.3 - 0.5 * std::cos(q)); };
  const int last = 1024;
  for (int k = 0; k <= last; ++k) {
    joint.plant.counterbalance.efforts.push_back(curve(-2 + 3.0 * k / last));
  }
  for (double q = -2; q <= 1; q += 0.0137) {
    // (3 / 1024)^2 / 8 times a second derivative of up to 2e4 N m / rad^2.
    EXPECT_NEAR(articulated::calc_counterbalance(joint, q), curve(q), 0.03);
  }
}

// The work of the motors is the change of energy plus what friction and damping take, to the order
// of the integrator: the error halves with the step.
TEST(JointPlantEnergy, IsConservedToTheIntegratorsOrder) {
  RobotModel robot = make_skew_arm();
  robot.joints[0].plant.armature = 0.8;
  robot.joints[0].plant.viscous = 0.7;
  robot.joints[0].plant.coulomb = 1.1;
  robot.joints[0].plant.stribeck = 0.4;
  robot.joints[1].plant.counterbalance = {-3, 3, {-6, 2, 9, 1}};
  robot.joints[1].plant.armature = 0.3;
  robot.joints[2].plant.armature = 0.5;
  robot.joints[2].plant.stiffness = 300;
  robot.joints[2].plant.damping = 0.6;
  robot.joints[2].plant.coulomb = 0.3;
  const auto calc_gap = [&](int steps) {
    const double h = 1.0 / steps;
    DrivenArm<ArticulatedArm> driven(robot, make_vector({0.4, -0.3, 0.5}), h);
    const auto calc_energy = [&](double motor_rate) {
      const VectorXd rates = read_rates(driven.arm(), 3);
      const double stretch = std::remainder(driven.pushed(2) - driven.q()[2], 2 * kPi);
      return driven.arm().calc_kinetic_energy_j() + driven.arm().calc_potential_energy_j() +
             0.5 * (0.8 * rates[0] * rates[0] + 0.3 * rates[1] * rates[1] +
                    0.5 * motor_rate * motor_rate + 300 * stretch * stretch);
    };
    const double start = calc_energy(0);
    double work = 0;
    double motor_rate = 0;
    for (int k = 0; k < steps; ++k) {
      const double t = k * h;
      const VectorXd effort =
          make_vector({9 * std::cos(3 * t), 12 * std::sin(2 * t), 5 * std::cos(7 * t)});
      const VectorXd q = driven.q();
      const double motor = driven.pushed(2);
      driven.step(effort);
      const VectorXd way = calc_motion(robot, q, driven.q());
      motor_rate = (driven.pushed(2) - motor) / h;
      work += effort[0] * way[0] + effort[1] * way[1] + effort[2] * motor_rate * h;
      work += articulated::calc_counterbalance(robot.joints[1], q[1] + way[1] / 2) * way[1];
      work -= calc_friction(robot.joints[0].plant, way[0] / h) * way[0];
      work -= calc_friction(robot.joints[2].plant, motor_rate) * motor_rate * h;
      const double sliding = motor_rate - way[2] / h;
      work -= 0.6 * sliding * sliding * h;
    }
    return std::abs(calc_energy(motor_rate) - start - work);
  };
  const double coarse = calc_gap(4000);
  const double fine = calc_gap(8000);
  EXPECT_LT(coarse, 0.05);
  EXPECT_NEAR(coarse / fine, 2, 0.3);
}

// The thesis's arm with a full rigid plant of the size of an industrial robot's.
RobotModel make_full_arm() {
  RobotModel robot = load_irb4600();
  const double sizes[] = {1, 1.4, 0.5, 0.005};
  for (std::size_t i = 0; i < 4; ++i) {
    JointPlant& plant = robot.joints[i].plant;
    plant.armature = 100 * sizes[i];
    plant.viscous = 60 * sizes[i];
    plant.coulomb = 110 * sizes[i];
    plant.stribeck = 40 * sizes[i];
    plant.offset = 7 * sizes[i];
    plant.transition_rate = 0.02;
  }
  robot.joints[1].plant.counterbalance = {-2, 2, {-1500, -700, 0, 900, 1300}};
  return robot;
}

TrackingTask make_fine_task() {
  TrackingTask task = make_e6_task();
  task.physics.substeps = 10;
  return task;
}

// Whole cases: articulated and MuJoCo agree to 1e-9 m with armature and viscous friction and to
// 1e-6 m with everything; ODE's error is the same within a percent, as of the ideal arm.
TEST(JointPlantInEngines, Agree) {
  RobotModel light = make_full_arm();
  for (Joint& joint : light.joints) {
    JointPlant plant;
    plant.armature = joint.plant.armature;
    plant.viscous = joint.plant.viscous;
    joint.plant = plant;
  }
  RobotModel elastic = make_full_arm();
  elastic.joints[0].plant.stiffness = 2e6;
  elastic.joints[0].plant.damping = 500;
  elastic.joints[1].plant.stiffness = 3e6;
  elastic.joints[1].plant.measured = MeasuredSide::link;
  for (const auto& [robot, tolerance_m] :
       {std::pair(light, 1e-9), std::pair(make_full_arm(), 1e-6), std::pair(elastic, 1e-6)}) {
    const TrackingSetup setup(robot, make_fine_task());
    const TargetTable targets = setup.make_targets(make_case(2, 6));
    const TrackingJob job = make_job(kTableA1, targets, kNever, {.motion = true});
    const auto simulate = [&](const std::string& engine) {
      return std::move(make_engine(engine)->simulate(setup, {&job, 1}).at(0));
    };
    const TrackingResult expected = simulate("articulated");
    ASSERT_EQ(expected.status, SimulationStatus::ok) << expected.reason;
    const TrackingSetup ideal(load_irb4600(), make_fine_task());
    EXPECT_GT(
        calc_largest_gap_m(make_engine("articulated")->simulate(ideal, {&job, 1}).at(0), expected),
        1e-4);  // the plant has an effect
    for (const std::string& name : engine_names()) {
      SCOPED_TRACE(name);
      const TrackingResult result = simulate(name);
      ASSERT_EQ(result.status, SimulationStatus::ok) << result.reason;
      EXPECT_NEAR(result.mean_error_m, expected.mean_error_m, 0.01 * expected.mean_error_m);
      EXPECT_NEAR(result.energy_j, expected.energy_j, 0.01 * expected.energy_j);
      if (name != "ode") {
        EXPECT_LT(calc_largest_gap_m(result, expected), tolerance_m);
      }
    }
  }
}

// Arms of 3, 6 and 7 joints, with tilted axes and a slider, run other kernels than the thesis's arm.
TEST(JointPlantInEngines, AgreeOnArmsOfAnyShape) {
  const auto load = [](const std::string& name) {
    return load_urdf(ARMWRIGHT_CONFIGS "/robots/" + name + ".urdf");
  };
  TrackingTask task;
  task.physics.substeps = 10;
  task.count_first_point = true;
  for (const RobotModel& ideal :
       {load("arm7"), load("irb4600_six"), make_skew_arm(), make_mixed_arm("rpr")}) {
    SCOPED_TRACE(ideal.joint_count());
    const TargetTable targets = make_swing(ideal, 150);
    const auto [robot, design] = make_plant_of_size(ideal, targets);
    const TrackingSetup setup(robot, task);
    PlantVariation variation;
    variation.viscous_friction.assign(robot.joint_count(), 1e-3);
    variation.coulomb_friction.assign(robot.joint_count(), 1e-3);
    variation.torque_ripple.assign(robot.joint_count(), 0.02);
    variation.ripple_phase_rad.assign(robot.joint_count(), 0.3);
    variation.delay_substeps = 4;
    for (const PlantVariation* perturbed : {static_cast<const PlantVariation*>(nullptr),
                                            static_cast<const PlantVariation*>(&variation)}) {
      TrackingJob job = make_job(design, targets, kNever, {.motion = true});
      job.variation = perturbed;
      const auto simulate = [&](const std::string& engine, const EngineOptions& options) {
        auto result = std::move(make_engine(engine, options)->simulate(setup, {&job, 1}).at(0));
        EXPECT_EQ(result.status, SimulationStatus::ok) << engine << ": " << result.reason;
        return result;
      };
      const TrackingResult expected = simulate("articulated", {.simd = SimdLevel::scalar});
      for (const SimdLevel level :
           {SimdLevel::sse2, SimdLevel::avx2, SimdLevel::avx512, SimdLevel::scalar}) {
        if (!is_supported(level)) {
          continue;
        }
        SCOPED_TRACE(to_string(level));
        EXPECT_LT(calc_largest_gap_m(simulate("articulated", {.simd = level}), expected), 1e-9);
        EXPECT_LT(
            calc_largest_gap_m(
                simulate("articulated", {.precision = Precision::single, .simd = level}), expected),
            1e-3);
      }
#ifdef ARMWRIGHT_WITH_MUJOCO
      EXPECT_LT(calc_largest_gap_m(simulate("mujoco", {}), expected), 1e-6);
#endif
      // Links that move along tangents: an error in proportion to the step of 1 ms and the way of
      // 1 m (measured: up to 6.5 mm).
      EXPECT_LT(calc_largest_gap_m(simulate("ode", {}), expected), 1e-2);
    }
  }
}

// A lane's result does not depend on its neighbours, even if these have other plants.
TEST(JointPlantInLanes, NeighboursDoNotMatter) {
  RobotModel stiff = make_full_arm();
  stiff.joints[1].plant.stiffness = 3e6;
  const TrackingSetup ideal(load_irb4600(), make_fine_task());
  const TrackingSetup full(make_full_arm(), make_fine_task());
  const TrackingSetup elastic(stiff, make_fine_task());
  std::vector<TargetTable> targets;
  for (std::uint64_t number = 0; number < 3; ++number) {
    targets.push_back(ideal.make_targets(make_case(number, 5)));
  }
  const ArmDesign designs[] = {kTableA1, kLimp, kTableA5};
  const TrackingSetup* const setups[] = {&full, &ideal, &elastic, nullptr};
  PlantVariation variation;
  variation.viscous_friction.assign(4, 5);
  variation.coulomb_friction.assign(4, 2);
  variation.torque_ripple.assign(4, 0.01);
  variation.ripple_phase_rad.assign(4, 0);
  variation.delay_substeps = 3;
  std::vector<TrackingJob> jobs;
  for (std::size_t i = 0; i < 48; ++i) {
    jobs.push_back(make_job(designs[i % 3], targets[i / 3 % 3], i % 2 == 0 ? 0.3 : kNever));
    jobs.back().setup = setups[i % 4];
    jobs.back().variation = i % 5 == 0 ? &variation : nullptr;
  }
  const auto engine = make_engine("articulated");
  const auto together = engine->simulate(ideal, jobs);
  for (std::size_t i = 0; i < jobs.size(); i += 5) {
    expect_identical(together[i], engine->simulate(ideal, {&jobs[i], 1}).front());
    expect_identical(together[i + 1], engine->simulate(ideal, {&jobs[i + 1], 1}).front());
  }
}

// One rotor's inertia is not that of its link: with computed torque and no feedback the arm follows
// its targets, so the feed-forward knows the plant.
TEST(JointPlantFeedForward, TakesTheArmToItsTargets) {
  RobotModel robot = make_full_arm();
  for (Joint& joint : robot.joints) {
    joint.plant.coulomb = joint.plant.stribeck = joint.plant.viscous = 0;
  }
  TrackingTask task = make_e6_task();
  task.feed_forward = FeedForward::inverse_dynamics;
  const TrackingSetup setup(robot, task);
  const TargetTable targets = setup.make_targets(make_case(3, 4));
  const VectorXd start = Eigen::Map<const VectorXd>(targets.start_positions.data(), 4);
  DrivenArm<ArticulatedArm> driven(setup.robot(), start, task.control_period_s);
  for (int step = 0; step < targets.steps; ++step) {
    driven.step(Eigen::Map<const VectorXd>(targets.feed_forward(step).data(), 4));
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double target = targets.positions(step)[static_cast<std::size_t>(i)];
      ASSERT_NEAR(calc_displacement(JointKind::revolute, target, driven.q()[i]), 0, 1e-7)
          << "step " << step;
    }
  }
}

// The joint's range decides which turn a position belongs to, wherever the table lies.
TEST(Counterbalance, MayBeGivenBeyondTheRange) {
  Joint joint;
  joint.lower = -3;
  joint.upper = 3;
  joint.plant.counterbalance = {-3, 9, {-3, 0, 3, 6, 9}};  // s = q
  for (const double q : {-3.0, -1.2, 0.4, 3.0}) {
    EXPECT_NEAR(articulated::calc_counterbalance(joint, q), q, 1e-12);
    EXPECT_NEAR(articulated::calc_counterbalance(joint, q + 2 * kPi), q, 1e-12);
  }
}

TEST(JointPlantFeedForward, CoversFriction) {
  RobotModel robot = make_full_arm();
  TrackingTask task = make_e6_task();
  task.feed_forward = FeedForward::inverse_dynamics;
  const TargetTable with = TrackingSetup(robot, task).make_targets(make_case(3, 4));
  const TargetTable without = TrackingSetup(load_irb4600(), task).make_targets(make_case(3, 4));
  const std::size_t step = 40;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = [&](std::size_t k) { return with.positions(static_cast<int>(k))[i]; };
    const double rate = (at(step) - at(step - 1)) / 0.01;
    const double before = (at(step - 1) - at(step - 2)) / 0.01;
    const JointPlant& plant = robot.joints[i].plant;
    const double expected = plant.armature * (rate - before) / 0.01 + calc_friction(plant, rate) -
                            articulated::calc_counterbalance(robot.joints[i], at(step - 1));
    EXPECT_NEAR(with.feed_forward(step)[i] - without.feed_forward(step)[i], expected,
                1e-6 * std::abs(expected) + 1e-9);
  }
}

// Sticking makes the error's slope rough, so the derivatives are compared along a few gains.
TEST(JointPlantDerivatives, AreTheLimitsOfDifferences) {
  RobotModel robot = make_full_arm();
  robot.joints[0].plant.stiffness = 2e6;
  const TrackingSetup setup(robot, make_fine_task());
  const TargetTable targets = setup.make_targets(make_case(7, 5));
  ArmDesign design = kTableA1;
  for (double& gain : design.joints[0].gains) {
    gain *= 0.15;  // so that the loop around the spring is stable
  }
  const auto engine = make_engine("articulated", {.simd = SimdLevel::scalar});
  const auto calc_errors = [&](const ArmDesign& one) {
    const TrackingJob job = make_job(one, targets);
    return engine->simulate(setup, {&job, 1}).front().point_error_m;
  };
  for (std::size_t joint = 0; joint < 3; ++joint) {
    ArmDesign direction = design;
    for (JointDrive& drive : direction.joints) {
      std::ranges::fill(drive.gains, 0.0);
      drive.limits = {0, 0};
    }
    direction.joints[joint].gains[2] = design.joints[joint].gains[2];
    const TrackingJob job = make_job(design, targets);
    const auto exact = engine->calc_derivatives(setup, job, {&direction, 1});
    const auto calc_difference = [&](double step) {
      ArmDesign above = design;
      ArmDesign below = design;
      above.joints[joint].gains[2] *= 1 + step;
      below.joints[joint].gains[2] *= 1 - step;
      std::vector<double> slopes = calc_errors(above);
      const std::vector<double> low = calc_errors(below);
      for (std::size_t k = 0; k < slopes.size(); ++k) {
        slopes[k] = (slopes[k] - low[k]) / (2 * step);
      }
      return slopes;
    };
    const auto wide = calc_difference(2e-4);
    const auto narrow = calc_difference(1e-4);
    int smooth = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
      // As in derivatives_test.cpp: where two steps disagree, a kink lies between them.
      if (std::abs(wide[k] - narrow[k]) < 1e-4 * std::abs(wide[k])) {
        ++smooth;
        EXPECT_NEAR(exact[k], (4 * narrow[k] - wide[k]) / 3, 3e-4 * std::abs(wide[k]));
      }
    }
    EXPECT_GE(smooth, 2) << "joint " << joint;
  }
}

}  // namespace
}  // namespace armwright::physics_test
