// Compares perturbed plants in the lanes of the engine `articulated` with a single arm of the same
// dynamics, and each lane with the same job alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "sim/articulated_runs.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/tracking/tracking_loop.hpp"

namespace armwright {
namespace {

using namespace articulated_test;

PlantVariation draw_variation(RandomStream& random) {
  PlantVariation variation;
  const double sizes[] = {60, 120, 40, 0.5};
  for (const double size : sizes) {
    variation.viscous_friction.push_back(random.uniform(0, size));
    variation.coulomb_friction.push_back(random.uniform(0, size));
    variation.torque_ripple.push_back(random.uniform(0, 0.1));
    variation.ripple_phase_rad.push_back(random.uniform(0, 6));
  }
  variation.friction_transition_rate = random.uniform(0.1, 0.2);
  variation.quantum = random.bernoulli(0.5) ? random.uniform(1e-5, 1e-3) : 0;
  variation.delay_substeps = static_cast<int>(random.below(3));
  variation.ripple_cycles_per_turn = 1 + static_cast<int>(random.below(20));
  return variation;
}

class PlantLanes : public testing::Test {
 protected:
  static TrackingTask make_task() {
    TrackingTask task;
    task.physics.substeps = 5;
    return task;
  }
  PlantLanes() {
    RandomStream random("test/sim/articulated/plants", 0);
    for (std::uint64_t number = 0; number < 40; ++number) {
      targets_.push_back(setup_.make_targets(make_case(number, 4)));
      variations_.push_back(draw_variation(random));
    }
    for (std::size_t i = 0; i < 40; ++i) {
      const ArmDesign& design = i % 7 == 5 ? kLimp : i % 7 == 6 ? kExploding : kTableA1;
      TrackingJob job = make_job(design, targets_[i], i % 7 == 5 ? 0.3 : kNever);
      job.variation = i % 5 == 4 ? nullptr : &variations_[i];
      job.recording.trajectory = i == 3;
      jobs_.push_back(job);
    }
  }
  TrackingSetup setup_{load_irb4600(), make_task()};
  std::vector<TargetTable> targets_;
  std::vector<PlantVariation> variations_;
  std::vector<TrackingJob> jobs_;
};

// The last bits of an angle half-way between two encoder steps decide which step it gets. With a
// quantum of up to a milliradian, results therefore agree far less closely than without.
TEST_F(PlantLanes, AgreeWithASingleArm) {
  for (const EngineOptions& options : make_double_options()) {
    SCOPED_TRACE(describe(options));
    const auto results = make_articulated(options)->simulate(setup_, jobs_);
    int compared = 0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (jobs_[i].design != &kTableA1) {
        continue;
      }
      ArticulatedArm arm(setup_.robot(), targets_[i].start_positions, setup_.task().physics);
      const TrackingResult expected = TrackingLoop(setup_, jobs_[i]).run(arm);
      const bool rounds = jobs_[i].variation != nullptr && variations_[i].quantum > 0;
      ASSERT_EQ(results[i].point_error_m.size(), expected.point_error_m.size()) << i;
      EXPECT_NEAR(results[i].mean_error_m, expected.mean_error_m,
                  (rounds ? 0.01 : 1e-6) * expected.mean_error_m)
          << i;
      compared += rounds ? 0 : 1;
    }
    EXPECT_GT(compared, 10);
  }
}

TEST_F(PlantLanes, HaveTheSameResultsAloneAndInAnyCompany) {
  for (const EngineOptions& options : make_all_options()) {
    SCOPED_TRACE(describe(options));
    const auto engine = make_articulated(options);
    const auto together = engine->simulate(setup_, jobs_);
    std::vector<TrackingJob> backwards(jobs_.rbegin(), jobs_.rend());
    const auto reversed = engine->simulate(setup_, backwards);
    EXPECT_TRUE(std::ranges::any_of(
        together, [](const auto& r) { return r.status == SimulationStatus::cut_off; }));
    EXPECT_TRUE(std::ranges::any_of(
        together, [](const auto& r) { return r.status == SimulationStatus::diverged; }));
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      SCOPED_TRACE(i);
      expect_identical(simulate_alone(*engine, setup_, jobs_[i]), together[i]);
      expect_identical(reversed[jobs_.size() - 1 - i], together[i]);
    }
  }
}

// A variation whose sizes are all zero is the nominal plant, up to rounding in other code.
TEST_F(PlantLanes, WithoutAnySizeAreNominal) {
  PlantVariation none = variations_[0];
  for (auto* sizes : {&none.viscous_friction, &none.coulomb_friction, &none.torque_ripple}) {
    std::ranges::fill(*sizes, 0.0);
  }
  none.quantum = 0;
  none.delay_substeps = 0;
  for (const EngineOptions& options : make_double_options()) {
    const auto engine = make_articulated(options);
    TrackingJob job = make_job(kTableA1, targets_[0]);
    const double nominal_m = simulate_alone(*engine, setup_, job).mean_error_m;
    job.variation = &none;
    EXPECT_NEAR(simulate_alone(*engine, setup_, job).mean_error_m, nominal_m, 1e-9 * nominal_m);
  }
}

}  // namespace
}  // namespace armwright
