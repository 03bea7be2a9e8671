#include "sim/proposal/drive_proposal.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/proposal/workspace_proposal.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
namespace {

constexpr double kSpeedShare = 0.6;
constexpr double kEffortShare = 0.6;
constexpr double kSlower = 0.8;
constexpr int kSlowdowns = 20;
// Below 1 / kSlowdownOfSteps of the first speed, efforts are computed for longer control periods
// instead of more: 400 for the longest move, since it takes 1 s at first, and a period 10 ms. The
// efforts are nearly those at rest then. The proposed speed depends on the joints' speeds to the
// last bit, so they keep the task's periods down to 1 / kSlowdownOfSpeeds.
constexpr double kSlowdownOfSteps = 4;
constexpr double kSlowdownOfSpeeds = 30;

constexpr double kBandwidth_rad_per_s = 10;
constexpr double kDampingRatio = 0.7;
// The largest h D (M^-1)_ii; sampled damping diverges at 2.
constexpr double kMostSampledDamping = 0.7;
constexpr double kEffortReserve = 2;
constexpr double kUsualEffortShare = 0.1;
constexpr double kMostReserve = 10;
constexpr double kLeastAcceleration = 5;  // rad/s^2 or m/s^2
constexpr int kStepsBetween = 20;         // steps between two evaluations of the mass matrix

// The largest efforts of inverse dynamics on the path and the largest M_ii, one per joint.
struct Demand {
  std::vector<double> efforts;
  std::vector<double> inertia;
  std::vector<double> mobility;  // the largest (M^-1)_ii
};

Demand calc_demand(const TrackingSetup& setup, const std::vector<TargetTable>& tables) {
  const std::size_t n = setup.robot().joint_count();
  const std::vector<double> nothing(n, 0);
  Demand demand{nothing, nothing, nothing};
  RobotModel rigid = setup.robot();  // feed-forward efforts treat elastic joints as rigid, too
  for (Joint& joint : rigid.joints) {
    joint.plant.stiffness = 0;
  }
  ArticulatedArm arm(rigid, tables.front().start_positions, setup.task().physics);
  const std::vector<double> rest(n, 0);
  for (const TargetTable& table : tables) {
    for (int step = 0; step < table.steps; ++step) {
      if (step % kStepsBetween == 0) {
        check_reading();
      }
      const auto efforts = table.feed_forward(step);
      for (std::size_t i = 0; i < n; ++i) {
        demand.efforts[i] = std::max(demand.efforts[i], std::abs(efforts[i]));
      }
      if (step % kStepsBetween == 0) {
        arm.set_state(table.positions(step), rest);
        const Eigen::MatrixXd mass = arm.calc_mass_matrix();
        const Eigen::MatrixXd inverse = mass.inverse();
        for (std::size_t i = 0; i < n; ++i) {
          const auto at = static_cast<Eigen::Index>(i);
          demand.inertia[i] = std::max(demand.inertia[i], mass(at, at));
          demand.mobility[i] = std::max(demand.mobility[i], inverse(at, at));
        }
      }
    }
  }
  return demand;
}

std::vector<TargetTable> make_tables(const RobotModel& robot, const TrackingSetup& setup,
                                     const std::vector<TestCase>& cases) {
  std::vector<TargetTable> tables = setup.make_targets(cases);
  for (const TargetTable& table : tables) {
    if (!table.unreachable.empty()) {
      refuse_proposal(robot, fmt::format("it cannot follow the path: {}", table.unreachable));
    }
  }
  return tables;
}

// Returns the joint that uses the largest share of its limit, and that share.
template <class GetShare>
std::pair<std::size_t, double> find_busiest(std::size_t joints, const GetShare& get_share) {
  std::pair<std::size_t, double> busiest{0, 0};
  for (std::size_t i = 0; i < joints; ++i) {
    const double share = get_share(i);
    if (share > busiest.second) {
      busiest = {i, share};
    }
  }
  return busiest;
}

}  // namespace

double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases) {
  const ReadStep step(fmt::format("proposing a speed for robot '{}'", sanitize(robot.name)));
  if (task.limits == LimitPolicy::enforce) {
    task.limits = LimitPolicy::warn;  // this function itself finds the speed that the limits allow
  }
  coarsen(task);
  task.feed_forward = FeedForward::inverse_dynamics;
  const double first_speed = task.distance_limit_m / kProposedMove_s;
  const double first_period_s = task.control_period_s;
  task.speed_m_per_s = first_speed;
  bool has_speed = false;  // whether the joints' speed limits allow the speed
  const std::size_t n = robot.joint_count();
  for (int round = 0;; ++round) {
    const double slowdown = first_speed / task.speed_m_per_s;
    task.control_period_s =
        first_period_s *
        std::max(1.0, slowdown / (has_speed ? kSlowdownOfSteps : kSlowdownOfSpeeds));
    const TrackingSetup setup(robot, task);
    const std::vector<TargetTable> tables = make_tables(robot, setup, cases);
    std::vector<double> speeds(n, 0);
    for (const TargetTable& table : tables) {
      std::span<const double> before = table.start_positions;
      for (int at = 0; at < table.steps; ++at) {
        for (std::size_t i = 0; i < n; ++i) {
          const double way =
              calc_displacement(robot.joints[i].kind, before[i], table.positions(at)[i]);
          speeds[i] = std::max(speeds[i], std::abs(way) / task.control_period_s);
        }
        before = table.positions(at);
      }
    }
    const double fastest = find_busiest(n, [&](std::size_t i) {
                             return speeds[i] / robot.joints[i].speed_limit;
                           }).second;
    if (fastest > kSpeedShare) {
      task.speed_m_per_s *= std::max(kSpeedShare / fastest, 0.1) * 0.99;
      if (round < kSlowdowns) {
        continue;
      }
    }
    const Demand demand = calc_demand(setup, tables);
    const auto [joint, share] = find_busiest(
        n, [&](std::size_t i) { return demand.efforts[i] / setup.robot().joints[i].effort_limit; });
    if (share <= kEffortShare) {
      return task.speed_m_per_s;
    }
    if (round >= kSlowdowns) {
      if (share < 1) {
        return task.speed_m_per_s;  // the joint can hold the arm with a small reserve
      }
      refuse_proposal(
          robot,
          fmt::format("joint {} ('{}') needs {:.4g} {} to hold the arm in its workspace, its "
                      "effort limit is {:.4g}; correct the limit or the masses in the URDF, "
                      "carry less, or set another workspace",
                      joint + 1, sanitize(robot.joints[joint].name), demand.efforts[joint],
                      robot.joints[joint].kind == JointKind::revolute ? "N m" : "N",
                      robot.joints[joint].effort_limit));
    }
    task.speed_m_per_s *= kSlower;
    has_speed = true;
  }
}

ArmDesign propose_design(const RobotModel& robot, TrackingTask task,
                         const std::vector<TestCase>& cases, bool own_limits) {
  const ReadStep step(fmt::format("proposing controllers for robot '{}'", sanitize(robot.name)));
  if (task.limits == LimitPolicy::enforce) {
    task.limits = LimitPolicy::warn;
  }
  if (!cases.front().continuous) {
    coarsen(task);
  }
  task.feed_forward = FeedForward::inverse_dynamics;
  const TrackingSetup setup(robot, task);
  const Demand demand = calc_demand(setup, make_tables(robot, setup, cases));
  ArmDesign design;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const double w = kBandwidth_rad_per_s;
    const double m = demand.inertia[i];
    const double d = std::min(2 * kDampingRatio * w * m,
                              kMostSampledDamping / (task.control_period_s * demand.mobility[i]));
    const double p = std::min(w * w * m, d * d / m);
    JointDrive drive;
    drive.gains = {p, p * std::sqrt(p / m) / 4, d};
    const double own = robot.joints[i].effort_limit;
    const double needed =
        std::max(kEffortReserve * demand.efforts[i], kLeastAcceleration * demand.inertia[i]);
    // A tenth of the joint's limit, but at most kMostReserve times the needed effort.
    const double usual =
        std::isfinite(own) ? std::min(kUsualEffortShare * own, kMostReserve * needed) : 0;
    const double limit =
        own_limits && std::isfinite(own) ? own : std::min(std::max(needed, usual), own);
    drive.limits = {-limit, limit};
    design.joints.push_back(drive);
  }
  return design;
}

}  // namespace armwright
