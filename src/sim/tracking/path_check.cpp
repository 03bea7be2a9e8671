#include "sim/tracking/path_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.hpp"
#include "sim/kinematics/floor_clearance.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

// Tolerance for the rounding of positions at the end of a range and of speeds at the limit.
constexpr double kRounding = 1e-6;
// Singular values cost far more than positions, so they are computed only every so many steps.
constexpr int kStepsBetweenDecompositions = 5;

// The worst fault of one kind so far.
struct Worst {
  std::optional<PathFault> fault;
  double excess = 0;

  void consider(const PathFault& found, double by) {
    if (by > excess) {
      excess = by;
      fault = found;
    }
  }
};

// Returns by how much a joint is beyond its range (negative inside). If `wrapped`, an angle is
// replaced by the turn nearest to the middle of the range.
double calc_excess(const Joint& joint, bool wrapped, double& position) {
  if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper)) {
    return 0;
  }
  if (wrapped && joint.kind == JointKind::revolute) {
    const double middle = 0.5 * (joint.lower + joint.upper);
    position = middle + wrap_angle(position - middle);
  }
  return std::max(joint.lower - position, position - joint.upper);
}

// Returns the fault of a posture: its links' least distance, if that is below the task's.
std::optional<PathFault> find_contact(const TrackingSetup& setup, std::span<const double> q) {
  const ArmClearance& clearance = *setup.task().clearance;
  const RobotModel& robot = setup.robot();
  const ArmClearance::Nearest nearest = clearance.find_nearest(calc_link_poses(robot, q));
  if (nearest.distance_m > setup.task().clearance_m - kRounding) {
    return std::nullopt;
  }
  PathFault fault;
  fault.kind = PathFault::Kind::obstacle;
  fault.joint = (nearest.is_obstacle ? nearest.body : nearest.other) - 1;
  fault.value = nearest.distance_m;
  fault.limit = setup.task().clearance_m;
  const std::string& body =
      nearest.body == 0 ? robot.base.name : robot.links[nearest.body - 1].name;
  fault.other =
      nearest.is_obstacle
          ? fmt::format("the obstacle '{}'", sanitize(clearance.obstacles()[nearest.other].name))
          : fmt::format("the link '{}'", sanitize(body));
  return fault;
}

}  // namespace

std::vector<PathFault> find_path_faults(const TrackingSetup& setup, const TargetTable& table) {
  const RobotModel& robot = setup.robot();
  const double period_s = setup.task().control_period_s;
  const auto kinematics = setup.get_kinematics();
  std::vector<Worst> positions(table.joints), speeds(table.joints);
  Worst singular, low, near;
  const auto look_around = [&](std::span<const double> q, std::size_t point, double time_s) {
    if (auto contact = find_contact(setup, q)) {
      contact->point = point;
      contact->time_s = time_s;
      near.consider(*contact, contact->limit - contact->value);
    }
  };
  if (setup.task().clearance) {
    look_around(table.start_positions, 1, 0);
  }
  std::optional<FloorClearance> clearance;
  if (setup.task().floor_m) {
    clearance.emplace(robot, *kinematics, *setup.task().floor_m);
  }
  std::span<const double> before = table.start_positions;
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    for (int step = segment.first_step; step < segment.first_step + segment.steps; ++step) {
      const std::span<const double> q = table.positions(step);
      PathFault fault;
      fault.point = k + 1;
      fault.time_s = (step + 1) * period_s;
      for (std::size_t i = 0; i < table.joints; ++i) {
        const Joint& joint = robot.joints[i];
        fault.joint = i;
        fault.kind = PathFault::Kind::position;
        fault.value = q[i];
        const double beyond = calc_excess(joint, setup.has_closed_form(), fault.value);
        fault.limit = fault.value > joint.upper ? joint.upper : joint.lower;
        if (beyond > kRounding) {
          positions[i].consider(fault, beyond);
        }
        fault.kind = PathFault::Kind::speed;
        fault.value = std::abs(calc_displacement(joint.kind, before[i], q[i])) / period_s;
        fault.limit = joint.speed_limit;
        if (fault.value > (1 + kRounding) * joint.speed_limit) {
          speeds[i].consider(fault, fault.value - joint.speed_limit);
        }
      }
      if (clearance && !std::ranges::equal(before, q)) {
        const FloorClearance::Lowest lowest = clearance->find_lowest(q);
        fault.kind = PathFault::Kind::floor;
        fault.joint = lowest.link;
        fault.value = lowest.height_m;
        fault.limit = lowest.allowed_m;
        if (lowest.excess_m > kRounding) {
          low.consider(fault, lowest.excess_m);
        }
      }
      if (setup.task().clearance && !std::ranges::equal(before, q)) {
        look_around(q, k + 1, (step + 1) * period_s);
      }
      if (step % kStepsBetweenDecompositions == 0 && !std::ranges::equal(before, q)) {
        fault.kind = PathFault::Kind::singular;
        fault.value = kinematics->calc_dexterity(q);
        fault.limit = kSingularDexterity;
        if (fault.value < kSingularDexterity &&
            kSingularDexterity - fault.value > singular.excess) {
          fault.joint = kinematics->find_idle_joint(q);
          singular.consider(fault, kSingularDexterity - fault.value);
        }
      }
      before = q;
    }
  }
  std::vector<PathFault> faults;
  for (std::size_t i = 0; i < table.joints; ++i) {
    for (const Worst& worst : {positions[i], speeds[i]}) {
      if (worst.fault) {
        faults.push_back(*worst.fault);
      }
    }
  }
  for (const Worst& worst : {singular, low, near}) {
    if (worst.fault) {
      faults.push_back(*worst.fault);
    }
  }
  return faults;
}

std::string describe(const PathFault& fault, const RobotModel& robot) {
  const Joint& joint = robot.joints[fault.joint];
  const std::string unit = joint.kind == JointKind::revolute ? "rad" : "m";
  const std::string name = fmt::format("joint {} ('{}')", fault.joint + 1, sanitize(joint.name));
  const std::string where = fmt::format("on the way to point {}: ", fault.point);
  switch (fault.kind) {
    case PathFault::Kind::position:
      return where + fmt::format(
                         "{} would have to go to {:.4g} {} (at {:.2f} s), its range is "
                         "{:.4g} to {:.4g} {}",
                         name, fault.value, unit, fault.time_s, joint.lower, joint.upper, unit);
    case PathFault::Kind::speed:
      return where + fmt::format(
                         "{} would have to move at {:.4g} {}/s (at {:.2f} s), its limit "
                         "is {:.4g} {}/s",
                         name, fault.value, unit, fault.time_s, fault.limit, unit);
    case PathFault::Kind::floor:
      return where + fmt::format(
                         "the end of link {} ('{}') would be {:.4g} m high (at {:.2f} s), at "
                         "least {:.4g} m are needed above task.floor_m",
                         fault.joint + 1, sanitize(robot.links[fault.joint].name), fault.value,
                         fault.time_s, fault.limit);
    case PathFault::Kind::obstacle: {
      const std::string link =
          fmt::format("link {} ('{}')", fault.joint + 1, sanitize(robot.links[fault.joint].name));
      const std::string needed =
          fault.limit > 0
              ? fmt::format(", at least {:.4g} m between them are needed (task.clearance_m)",
                            fault.limit)
              : "";
      return where + fmt::format("{} would be {:.4g} m {} {} (at {:.2f} s){}", link,
                                 std::abs(fault.value), fault.value < 0 ? "inside" : "away from",
                                 fault.other, fault.time_s, needed);
    }
    case PathFault::Kind::singular:
      break;
  }
  return where + fmt::format(
                     "the arm comes close to a singularity (at {:.2f} s), in which {} "
                     "hardly moves the tool: its least singular value is {:.2g} of the "
                     "largest, allowed is {:.2g}",
                     fault.time_s, name, fault.value, fault.limit);
}

std::string describe_unreachable(const NumericKinematics& kinematics, const RobotModel& robot,
                                 const ToolTask& tool, const ToolPose& target,
                                 std::span<const double> from) {
  std::string text = fmt::format("target ({:.6g}, {:.6g}, {:.6g}) m", target.position_m.x(),
                                 target.position_m.y(), target.position_m.z());
  if (tool.orientation != ToolOrientation::free) {
    const Eigen::Vector3d rpy = calc_rpy(target.turn);
    text += fmt::format(" with the tool at roll, pitch, yaw ({:.4g}, {:.4g}, {:.4g}) rad", rpy.x(),
                        rpy.y(), rpy.z());
  }
  text += " is out of reach";
  const std::string question = ask_millimetres(target.position_m.norm(), kinematics.reach_m());
  std::vector<std::string> ends;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Joint& joint = robot.joints[i];
    constexpr double kAtTheEnd = 1e-3;
    if (from[i] < joint.lower + kAtTheEnd || from[i] > joint.upper - kAtTheEnd) {
      ends.push_back(fmt::format("joint {} ('{}')", i + 1, sanitize(joint.name)));
    }
  }
  if (!ends.empty()) {
    return fmt::format("{}: at the end of its range is {}{}", text, join(ends, ", "), question);
  }
  if (kinematics.calc_dexterity(from) < 5 * kSingularDexterity) {
    text += ", the arm being stretched out or otherwise singular there";
  }
  return text + question;
}

}  // namespace armwright
