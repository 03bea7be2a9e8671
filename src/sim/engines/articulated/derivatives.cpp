// The exact derivatives of a simulation's point errors with respect to gains and effort limits.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/engines/articulated/articulated_engine.hpp"
#include "sim/engines/articulated/number_simulation.hpp"

namespace armwright::articulated {
namespace {

struct DerivativeLevel;
using Slopes = lanes::Pair<lanes::Pack<double, 2, DerivativeLevel>>;
using Number = lanes::Dual<Slopes>;
constexpr std::size_t kAtOnce = Slopes::kLanes;

// Returns the drives of a design with their derivatives along at most kAtOnce directions.
std::vector<NumberDrive<Number>> make_drives(const ArmDesign& design,
                                             std::span<const ArmDesign> directions) {
  std::vector<NumberDrive<Number>> drives;
  for (std::size_t joint = 0; joint < design.joints.size(); ++joint) {
    const auto make = [&](auto get) {
      alignas(Slopes) double slopes[kAtOnce] = {};
      for (std::size_t k = 0; k < directions.size(); ++k) {
        slopes[k] = get(directions[k].joints[joint]);
      }
      return Number(get(design.joints[joint]), *reinterpret_cast<const Slopes*>(slopes));
    };
    std::vector<Number> gains;
    for (std::size_t gain = 0; gain < design.joints[joint].gains.size(); ++gain) {
      gains.push_back(make([gain](const JointDrive& drive) { return drive.gains[gain]; }));
    }
    drives.push_back({std::move(gains),
                      make([](const JointDrive& drive) { return drive.limits.min; }),
                      make([](const JointDrive& drive) { return drive.limits.max; })});
  }
  return drives;
}

}  // namespace

std::vector<double> calc_point_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                           std::span<const ArmDesign> directions) {
  std::vector<double> derivatives(job.targets->segments.size() * directions.size(), 0.0);
  for (std::size_t first = 0; first < directions.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, directions.size() - first);
    const std::vector<Number> squares =
        calc_squared_errors(setup, job, make_drives(*job.design, directions.subspan(first, count)));
    for (std::size_t point = 0; point < squares.size(); ++point) {
      alignas(Slopes) double slopes[kAtOnce];
      *reinterpret_cast<Slopes*>(slopes) = squares[point].slopes;
      const double error_m = std::sqrt(squares[point].value);
      for (std::size_t k = 0; k < count; ++k) {
        const double slope = slopes[k] / (2 * error_m);  // of the root of the square
        derivatives[point * directions.size() + first + k] = std::isfinite(slope) ? slope : 0;
      }
    }
  }
  return derivatives;
}

}  // namespace armwright::articulated
