#include "sim/proposal/drive_proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/decompositions.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/proposal/resting_arm.hpp"
#include "sim/proposal/workspace_proposal.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {
namespace {

// The share of a joint's speed limit, and of the effort that gravity and friction leave, that the
// longest move may take.
constexpr double kSpeedShare = 0.6;
constexpr double kEffortShare = 0.6;
// A joint that holds its arm with more than this share of its effort limit cannot be controlled.
constexpr double kMostHoldingShare = 0.95;
constexpr int kMostRounds = 12;
constexpr double kRoundTolerance = 1.01;
// Slower than the first speed by this factor, tables have longer control periods instead of more:
// 400 for the longest move, since it takes 1 s at first, and a period 10 ms.
constexpr double kSlowdownOfSteps = 4;

constexpr double kDampingRatio = 0.7;
// The largest h D (M^-1)_ii; sampled damping diverges at 2.
constexpr double kMostSampledDamping = 0.7;
constexpr double kEffortReserve = 2;
constexpr double kUsualEffortShare = 0.1;
constexpr double kMostReserve = 10;
constexpr double kLeastAcceleration = 5;  // rad/s^2 or m/s^2
constexpr int kStepsBetween = 20;         // steps between two evaluations of the mass matrix

// What the path asks of the joints, one number per joint.
struct Demand {
  std::vector<double> efforts;   // the largest of inverse dynamics
  std::vector<double> inertia;   // the largest M_ii
  std::vector<double> mobility;  // the largest (M^-1)_ii
};

Demand calc_demand(const TrackingSetup& setup, const std::vector<TargetTable>& tables) {
  const std::size_t n = setup.robot().joint_count();
  const std::vector<double> nothing(n, 0);
  Demand demand{nothing, nothing, nothing};
  RestingArm resting(setup.robot(), setup.task().physics);
  for (const TargetTable& table : tables) {
    for (int step = 0; step < table.steps; ++step) {
      const auto efforts = table.feed_forward(step);
      for (std::size_t i = 0; i < n; ++i) {
        demand.efforts[i] = std::max(demand.efforts[i], std::abs(efforts[i]));
      }
      if (step % kStepsBetween == 0) {
        check_reading();
        const Eigen::MatrixXd mass = resting.calc_mass_matrix(table.positions(step));
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

// Returns the task without refusals of paths that are too fast: proposals find what limits allow.
TrackingTask make_lenient(TrackingTask task) {
  if (task.limits == LimitPolicy::enforce) {
    task.limits = LimitPolicy::warn;
  }
  return task;
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

// Returns the largest share of a joint's speed limit that the tables use.
double find_speed_share(const TrackingSetup& setup, const std::vector<TargetTable>& tables) {
  double most = 0;
  for (const TargetTable& table : tables) {
    std::span<const double> before = table.start_positions;
    for (int step = 0; step < table.steps; ++step) {
      for (std::size_t i = 0; i < table.joints; ++i) {
        const Joint& joint = setup.robot().joints[i];
        const double way = calc_displacement(joint.kind, before[i], table.positions(step)[i]);
        most = std::max(most, std::abs(way) / setup.task().control_period_s / joint.speed_limit);
      }
      before = table.positions(step);
    }
  }
  return most;
}

// Returns the largest share of the effort that is left for motion: what inverse dynamics asks for
// beside gravity and dry friction, divided by what these two leave of the limit. Throws
// Error{bad_data} if they leave too little.
double find_motion_share(const RobotModel& robot, const TrackingSetup& setup,
                         const std::vector<TargetTable>& tables) {
  RestingArm resting(setup.robot(), setup.task().physics);
  double most = 0;
  RestingArm::Hardest hardest;
  for (const TargetTable& table : tables) {
    std::span<const double> before = table.start_positions;
    for (int step = 0; step < table.steps; ++step) {
      if (step % kStepsBetween == 0) {
        check_reading();
      }
      if (step > 0 && std::ranges::equal(before, table.positions(step))) {
        continue;  // the target rests
      }
      const std::vector<double> held = resting.calc_holding_efforts(before);
      for (std::size_t i = 0; i < table.joints; ++i) {
        const Joint& joint = setup.robot().joints[i];
        const double dry = joint.plant.coulomb + std::max(0.0, joint.plant.stribeck);
        const double standing = std::abs(held[i]) + dry;
        if (standing > hardest.share * joint.effort_limit) {
          hardest = {i, standing / joint.effort_limit, standing};
        }
        const double moving = std::abs(table.feed_forward(step)[i] - held[i]) - dry;
        most = std::max(most, moving / std::max(joint.effort_limit - standing, 1e-12));
      }
      before = table.positions(step);
    }
  }
  if (hardest.share > kMostHoldingShare) {
    refuse_to_hold(robot, hardest, "in its workspace");
  }
  return most;
}

}  // namespace

double propose_speed(const RobotModel& robot, TrackingTask task,
                     const std::vector<TestCase>& cases) {
  const ReadStep step(fmt::format("proposing a speed for robot '{}'", sanitize(robot.name)));
  task = make_lenient(task);
  coarsen(task);
  task.feed_forward = FeedForward::inverse_dynamics;
  const double first_speed = task.distance_limit_m / kProposedMove_s;
  const double first_period_s = task.control_period_s;
  task.speed_m_per_s = first_speed;
  for (int round = 0;; ++round) {
    task.control_period_s =
        first_period_s * std::max(1.0, first_speed / task.speed_m_per_s / kSlowdownOfSteps);
    const TrackingSetup setup(robot, task);
    const std::vector<TargetTable> tables = make_tables(robot, setup, cases);
    // Joint speeds are proportional to the speed. Inertial and Coriolis efforts are to its square,
    // viscous friction is to its first power, for which another round accounts.
    const double slowdown =
        std::max(find_speed_share(setup, tables) / kSpeedShare,
                 std::sqrt(find_motion_share(robot, setup, tables) / kEffortShare));
    if (slowdown <= kRoundTolerance || round == kMostRounds) {
      return task.speed_m_per_s;
    }
    task.speed_m_per_s /= slowdown;
  }
}

double calc_most_coupling(double control_period_s) {
  return kMostSampledDamping / (control_period_s * 2 * kDampingRatio * kStartBandwidth_rad_per_s);
}

double propose_period_s(const RobotModel& robot, TrackingTask task,
                        const std::vector<TestCase>& cases) {
  const ReadStep step(
      fmt::format("proposing a control period for robot '{}'", sanitize(robot.name)));
  task = make_lenient(task);
  coarsen(task);
  task.speed_m_per_s = task.distance_limit_m / kProposedMove_s;
  const TrackingSetup setup(robot, task);
  RestingArm resting(setup.robot(), task.physics);
  double coupling = 1;
  for (const TargetTable& table : make_tables(robot, setup, cases)) {
    check_reading();
    for (int at = 0; at < table.steps; at += kStepsBetween) {
      coupling = std::max(coupling, resting.calc_coupling(table.positions(at)));
    }
  }
  for (const double period_s : {0.01, 0.005, 0.002}) {
    if (coupling <= calc_most_coupling(period_s)) {
      return period_s;
    }
  }
  return kShortestPeriod_s;
}

std::vector<ArmDesign> propose_designs(const RobotModel& robot, TrackingTask task,
                                       const std::vector<TestCase>& cases, bool own_limits,
                                       std::span<const double> bandwidths_rad_per_s) {
  const ReadStep step(fmt::format("proposing controllers for robot '{}'", sanitize(robot.name)));
  task = make_lenient(task);
  const double own_period_s = task.control_period_s;
  if (!cases.front().continuous) {
    coarsen(task);
  }
  task.feed_forward = FeedForward::inverse_dynamics;
  const TrackingSetup setup(robot, task);
  const Demand demand = calc_demand(setup, make_tables(robot, setup, cases));
  std::vector<ArmDesign> designs;
  for (const double bandwidth_rad_per_s : bandwidths_rad_per_s) {
    const bool is_first = bandwidth_rad_per_s == kStartOfVersion1;
    const double w = is_first ? kStartBandwidth_rad_per_s : bandwidth_rad_per_s;
    const double period_s = is_first ? task.control_period_s : own_period_s;
    ArmDesign& design = designs.emplace_back();
    for (std::size_t i = 0; i < robot.joint_count(); ++i) {
      if (robot.joints[i].plant.unactuated) {
        design.joints.push_back({.gains = {0, 0, 0}, .limits = {}});
        continue;
      }
      const double m = demand.inertia[i];
      const double d = std::min(2 * kDampingRatio * w * m,
                                kMostSampledDamping / (period_s * demand.mobility[i]));
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
  }
  return designs;
}

}  // namespace armwright
