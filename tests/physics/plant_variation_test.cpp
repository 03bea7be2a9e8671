// Checks the perturbations of a joint against closed forms and numbers computed by hand, and that
// the engines agree.
#include "sim/tracking/plant_variation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "sim/tracking/tracking_loop.hpp"
#include "test_arms.hpp"
#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

PlantVariation make_variation(std::size_t joints) {
  PlantVariation variation;
  variation.viscous_friction.resize(joints);
  variation.coulomb_friction.resize(joints);
  variation.torque_ripple.resize(joints);
  variation.ripple_phase_rad.resize(joints);
  return variation;
}

// A link on a vertical hinge, which gravity does not turn, and its moment of inertia.
const RobotModel kTurnstile = make_pendulum({0, 0, 1});
double calc_inertia_kg_m2() {
  const Inertial& body = kTurnstile.links[0].inertial;
  return body.inertia_kg_m2(2, 2) +
         body.mass_kg * (body.com_m.x() * body.com_m.x() + body.com_m.y() * body.com_m.y());
}

template <class Arm>
class Turnstile : public testing::Test {
 protected:
  static constexpr double kStep_s = 0.001;

  void step(double effort_n_m) {
    q_ = read_positions(arm_, 1);
    rate_ = read_rates(arm_, 1);
    plant_.act({&effort_n_m, 1}, {q_.data(), 1}, {rate_.data(), 1});
    arm_.step(plant_.effort(), kStep_s);
  }
  double rate() const { return read_rates(arm_, 1)[0]; }

  PlantVariation variation_ = make_variation(1);
  VectorXd q_ = VectorXd::Constant(1, 0.3), rate_;
  Arm arm_ = make_arm<Arm>(kTurnstile, q_);
  ArmPlant plant_{kTurnstile, &variation_, {q_.data(), 1}, kStep_s};
};
TYPED_TEST_SUITE(Turnstile, ArmTypes, ArmNames);

// Under viscous friction b, a rate decays as exp(-b t / J), and in steps as (1 - h b / J)^k.
TYPED_TEST(Turnstile, ViscousFrictionLetsTheRateDecay) {
  const double effort_n_m = 0.5;
  for (int k = 0; k < 200; ++k) {
    this->step(effort_n_m);
  }
  const double fastest = this->rate();
  EXPECT_NEAR(fastest, 0.2 * effort_n_m / calc_inertia_kg_m2(), 1e-6);
  const double b = 0.6;
  this->variation_.viscous_friction = {b};
  const int steps = 1000;
  for (int k = 0; k < steps; ++k) {
    this->step(0);
  }
  const double share = b * this->kStep_s / calc_inertia_kg_m2();
  EXPECT_NEAR(this->rate() / fastest, std::pow(1 - share, steps), 1e-5);
  // The relative error of the explicit steps is (b t / J) (h b / J) / 2.
  const double exact = std::exp(-share * steps);
  EXPECT_NEAR(this->rate() / fastest, exact, exact * steps * share * share / 2 * 1.1);
}

// Under an effort below c, the joint creeps no faster than v_s tau / c; above c, it accelerates.
TYPED_TEST(Turnstile, CoulombFrictionHoldsItBelowItsTorque) {
  this->variation_.coulomb_friction = {2};
  this->variation_.friction_transition_rate = 0.05;
  const double tau_n_m = 1.5;
  for (int k = 0; k < 2000; ++k) {
    this->step(tau_n_m);
    ASSERT_LE(this->rate(), 0.05 * tau_n_m / 2 * (1 + 1e-6));
  }
  EXPECT_NEAR(this->rate(), 0.05 * tau_n_m / 2, 1e-6);
  for (int k = 0; k < 500; ++k) {
    this->step(2.5);
  }
  EXPECT_GT(this->rate(), 0.05 * 3);
}

TYPED_TEST(Turnstile, TorqueRipplesWithTheAngle) {
  this->variation_.torque_ripple = {0.3};
  this->variation_.ripple_cycles_per_turn = 7;
  this->variation_.ripple_phase_rad = {0.4};
  const double tau_n_m = 0.8;
  const double share = 1 + 0.3 * std::sin(7 * 0.3 + 0.4);
  this->step(tau_n_m);
  EXPECT_NEAR(this->rate(), this->kStep_s * tau_n_m * share / calc_inertia_kg_m2(), 1e-12);
}

// An arm that turns its joints by 1 mrad per step under any effort.
struct RecordingArm {
  int steps = 0;
  std::vector<std::vector<double>> torques_n_m;

  double angle(std::size_t joint, int step) const {
    return 0.1 * (static_cast<double>(joint) + 1) + 0.001 * step;
  }
  void step(std::span<const double> torque_n_m, double /*dt_s*/,
            std::span<const double> /*inertia*/ = {}) {
    torques_n_m.emplace_back(torque_n_m.begin(), torque_n_m.end());
    ++steps;
  }
  void read_positions(std::span<double> q) const {
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = angle(i, steps);
    }
  }
  void read_rates(std::span<double> qd) const { std::ranges::fill(qd, 0.5); }
  Eigen::Vector3d tip_position_m() const { return {1, 2, 3}; }
  Eigen::Vector3d tool_point_m(std::size_t /*point*/) const { return tip_position_m(); }
};

class ScriptedPlant : public testing::Test {
 protected:
  TrackingTask make_task() const {
    TrackingTask task;
    task.physics.substeps = 4;
    return task;
  }
  TrackingSetup setup_{load_irb4600(), make_task()};
  TargetTable targets_ = setup_.make_targets(make_case(1, 3));
  ArmDesign design_ = make_design(
      {{10, 0, 0, -1e3, 1e3}, {20, 0, 0, -1e3, 1e3}, {30, 0, 0, -1e3, 1e3}, {40, 0, 0, -1e3, 1e3}});
  PlantVariation variation_ = make_variation(4);
};

// Measured three substeps late, with a quantum of 7 mrad. Before the start, the start is measured.
TEST_F(ScriptedPlant, ControllersSeeLateAndRoundedAngles) {
  variation_.delay_substeps = 3;
  variation_.quantum = 0.007;
  TrackingJob job = make_job(design_, targets_);
  job.variation = &variation_;
  RecordingArm arm;
  TrackingLoop(setup_, job).run(arm);
  for (const int period : {0, 1, 2, 9}) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double late = arm.angle(i, std::max(0, 4 * period - 3));
      const double seen = 0.007 * std::round(late / 0.007);
      const double gain = 10 * (static_cast<double>(i) + 1);
      for (const int substep : {0, 3}) {
        EXPECT_NEAR(arm.torques_n_m[static_cast<std::size_t>(4 * period + substep)][i],
                    gain * (targets_.positions(period)[i] - seen), 1e-12)
            << "period " << period << ", joint " << i;
      }
    }
  }
}

TEST_F(ScriptedPlant, EffortsAreMeasuredAsTheyWereAskedFor) {
  variation_.torque_ripple.assign(4, 0.5);
  variation_.viscous_friction.assign(4, 3);
  variation_.coulomb_friction = {1, 2, 3, 4};
  TrackingJob job = make_job(design_, targets_);
  RecordingArm nominal;
  const TrackingResult expected = TrackingLoop(setup_, job).run(nominal);
  job.variation = &variation_;
  RecordingArm arm;
  const TrackingResult result = TrackingLoop(setup_, job).run(arm);
  EXPECT_EQ(result.peak_effort, expected.peak_effort);
  EXPECT_EQ(result.energy_j, expected.energy_j);
  // The joint is faster than v_s, so Coulomb friction has its full size.
  for (std::size_t i = 0; i < 4; ++i) {
    const double ripple = 1 + 0.5 * std::sin(12 * arm.angle(i, 5));
    EXPECT_NEAR(arm.torques_n_m[5][i],
                nominal.torques_n_m[5][i] * ripple - 3 * 0.5 - (static_cast<double>(i) + 1), 1e-12);
  }
}

// The vertical joint of the whole arm, in every engine. Under a constant torque it finally turns at
// tau / b, and it creeps at v_s tau / c if tau < c. There is no gravity, and all other joints are
// free except for friction.
TEST(PlantVariationInEngines, FrictionSetsTheRate) {
  TrackingTask task;
  task.physics.gravity_m_per_s2 = 0;
  task.physics.substeps = 10;
  const TrackingSetup setup(load_irb4600(), task);
  const TargetTable targets = setup.make_targets(make_case(1, 3));
  const double tau_n_m = 20;
  const ArmDesign pushed =
      make_design({{0, 0, 0, tau_n_m, tau_n_m}, {0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}});
  PlantVariation viscous = make_variation(4);
  viscous.viscous_friction = {4000, 40, 40, 4};
  PlantVariation sticking = make_variation(4);
  sticking.coulomb_friction = {50, 1, 1, 0.1};
  sticking.friction_transition_rate = 0.02;
  for (const std::string& name : engine_names()) {
    SCOPED_TRACE(name);
    const auto engine = make_engine(name);
    for (const PlantVariation* variation : {&viscous, &sticking}) {
      TrackingJob job = make_job(pushed, targets, kNever, {.trajectory = true});
      job.variation = variation;
      const auto motion = std::move(engine->simulate(setup, {&job, 1}).at(0).trajectory);
      ASSERT_GT(motion.size(), 300U);
      const double rate = (motion.back().q[0] - motion[motion.size() - 101].q[0]) / 1.0;
      const double expected = variation == &viscous ? tau_n_m / 4000 : 0.02 * tau_n_m / 50;
      EXPECT_NEAR(rate, expected, 1e-3 * expected);
    }
  }
}

// A design under all perturbations at once has the same error in every engine, to about a percent.
TEST(PlantVariationInEngines, AgreeUnderEverythingAtOnce) {
  TrackingTask task;
  task.physics.substeps = 10;
  const TrackingSetup setup(load_irb4600(), task);
  PlantVariation variation = make_variation(4);
  variation.viscous_friction = {60, 120, 40, 0.5};
  variation.coulomb_friction = {100, 200, 60, 0.2};
  variation.friction_transition_rate = 0.1;
  variation.quantum = 1e-4;
  variation.delay_substeps = 2;
  variation.torque_ripple = {0.02, 0.01, 0.02, 0.015};
  variation.ripple_phase_rad = {1, 2, 3, 4};
  for (const std::uint64_t number : {0U, 1U}) {
    const TargetTable targets = setup.make_targets(make_case(number, 8));
    TrackingJob job = make_job(kTableA1, targets);
    const double nominal_m = simulate_one(setup, job).mean_error_m;
    job.variation = &variation;
    const double expected_m = simulate_one(setup, job).mean_error_m;
    EXPECT_GT(std::abs(expected_m / nominal_m - 1), 0.005);  // the perturbations have an effect
    for (const std::string& name : engine_names()) {
      const TrackingResult result = make_engine(name)->simulate(setup, {&job, 1}).at(0);
      EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
      EXPECT_NEAR(result.mean_error_m, expected_m, 0.01 * expected_m) << name;
    }
  }
}

}  // namespace
}  // namespace armwright::physics_test
