// ceres::Jet runs through the simulation as well: the same values and derivatives as by the
// engine's own numbers.
#ifdef ARMWRIGHT_WITH_CERES

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sim/engines/articulated/number_simulation.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::lanes {

template <int N>
struct Carrier<ceres::Jet<double, N>> {
  using Jet = ceres::Jet<double, N>;
  static double get_value(const Jet& jet) { return jet.a; }
  static Jet calc(double value, double slope, const Jet& jet) { return Jet(value, slope * jet.v); }
};

}  // namespace armwright::lanes

namespace armwright {
namespace {

using Jet = ceres::Jet<double, 4>;

TEST(JetSimulation, HasTheValuesAndDerivativesOfTheEngine) {
  const RobotModel robot = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
  TrackingTask task;
  task.distance_limit_m = 1.6;
  const TrackingSetup setup(robot, task);
  WorkspaceSphere sphere;
  sphere.points = 6;
  const TargetTable targets = setup.make_targets(make_test_case("test/jets", 3, sphere));
  // Thesis, table A.1.
  ArmDesign design;
  design.joints = {{{45000, 150000, 7500}, {-20000, 20000}},
                   {{270000, 700000, 30000}, {-45000, 45000}},
                   {{30000, 100000, 5000}, {-20000, 20000}},
                   {{300, 2000, 5}, {-200, 200}}};
  std::vector<articulated::NumberDrive<Jet>> drives;
  ArmDesign zero = design;
  for (std::size_t i = 0; i < 4; ++i) {
    const JointDrive& joint = design.joints[i];
    drives.push_back(
        {{Jet(joint.gains[0], static_cast<int>(i)), Jet(joint.gains[1]), Jet(joint.gains[2])},
         Jet(joint.limits.min),
         Jet(joint.limits.max)});
    zero.joints[i] = {{0, 0, 0}, {0, 0}};
  }
  std::vector<ArmDesign> directions(4, zero);
  for (std::size_t i = 0; i < 4; ++i) {
    directions[i].joints[i].gains[0] = 1;
  }
  TrackingJob job;
  job.design = &design;
  job.targets = &targets;
  const std::vector<Jet> squares = articulated::calc_squared_errors(setup, job, drives);

  const auto engine = make_engine("articulated", {.simd = SimdLevel::scalar});
  const TrackingResult result = engine->simulate(setup, {&job, 1}).front();
  const auto derivatives = engine->calc_derivatives(setup, job, directions);
  ASSERT_EQ(squares.size(), result.point_error_m.size());
  double largest = 0;
  for (const double derivative : derivatives) {
    largest = std::max(largest, std::abs(derivative));
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const double error_m = std::sqrt(squares[k].a);
    EXPECT_NEAR(error_m, result.point_error_m[k], 1e-12);  // metres: roundings, some amplified
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(squares[k].v[static_cast<int>(i)] / (2 * error_m), derivatives[k * 4 + i],
                  1e-9 * largest);
    }
  }
  EXPECT_GT(largest, 0);
}

}  // namespace
}  // namespace armwright

#endif
