#include "sim/proposal/workspace_proposal.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

constexpr int kPostures = 400;
constexpr std::size_t kHomes = 24;  // postures around which a workspace is tried
constexpr std::size_t kQuickCases = 3;
constexpr int kCases = 8;
constexpr int kMostPoints = 25;
constexpr double kLook_s = 0.01;
constexpr double kRest_s = 0.1;
// Fractions of the arm's length.
constexpr double kLargestRadius = 0.35;
constexpr double kSmallestRadius = 0.01;
constexpr double kRadiusStep = 0.8;
constexpr double kKeepOff = 1.15;      // radii from the sphere's centre to the first joint
constexpr double kStepOfRadius = 0.1;  // distance of the checked points on a move
constexpr double kSafeDexterity = 3 * kSingularDexterity;
constexpr double kKeepOffEnds = 0.02;  // fraction of half a joint's range
// As in the thesis's cases, moves are at most a diameter and at least a sixteenth of the radius
// long.
constexpr double kShortestOfRadius = 1.0 / 16;

double calc_length_m(const RobotModel& robot) {
  double length_m = robot.tip_pose.translation().norm();
  for (std::size_t i = 1; i < robot.joint_count(); ++i) {
    length_m += robot.joints[i].origin.translation().norm();
  }
  for (const Joint& joint : robot.joints) {
    if (joint.kind == JointKind::prismatic && std::isfinite(joint.upper - joint.lower)) {
      length_m += joint.upper - joint.lower;
    }
  }
  return length_m;
}

// Returns the largest relative distance of a joint from the middle of its range: 0 in the middle, 1
// at an end.
double calc_excursion(const NumericKinematics& kinematics, const RobotModel& robot,
                      std::span<const double> q) {
  double farthest = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (kinematics.has_middle(i)) {
      const double half = 0.5 * (robot.joints[i].upper - robot.joints[i].lower);
      farthest = std::max(farthest, std::abs(q[i] - kinematics.get_middle(i)) / half);
    }
  }
  return farthest;
}

// Returns how far a posture is from singularities and from the ends of the joints' ranges, in [0,
// 1].
double calc_ease(const NumericKinematics& kinematics, const RobotModel& robot,
                 std::span<const double> q) {
  // Only joints near an end of their range reduce the value.
  const double margin = std::max(0.0, 1 - calc_excursion(kinematics, robot, q));
  return kinematics.calc_dexterity(q) * std::min(1.0, 3 * margin);
}

std::vector<std::vector<double>> choose_homes(const NumericKinematics& kinematics,
                                              const RobotModel& robot) {
  std::vector<std::pair<double, std::vector<double>>> postures;
  postures.emplace_back(0, kinematics.home());
  RandomStream random("proposal/home", 0);
  for (int i = 0; i < kPostures; ++i) {
    postures.emplace_back(0, kinematics.draw_posture(random));
  }
  for (auto& [ease, q] : postures) {
    ease = calc_ease(kinematics, robot, q);
  }
  std::ranges::stable_sort(postures, std::greater<>{}, [](const auto& one) { return one.first; });
  std::vector<std::vector<double>> homes;
  for (std::size_t i = 0; i < std::min(kHomes, postures.size()); ++i) {
    if (postures[i].first > 0) {
      homes.push_back(postures[i].second);
    }
  }
  return homes;
}

// Returns the normal of the plane in which the tip moves, or nothing if it moves in space.
std::optional<Eigen::Vector3d> find_plane(const NumericKinematics& kinematics,
                                          const RobotModel& robot, const ToolTask& tool,
                                          double length_m) {
  if (tool.orientation != ToolOrientation::free || kinematics.rank() >= 3) {
    return std::nullopt;
  }
  if (kinematics.rank() < 2) {
    refuse_proposal(
        robot,
        "its tip moves along a single line; there must be at least two joints that move "
        "it in different directions");
  }
  RandomStream random("proposal/plane", 0);
  const std::vector<double> first = kinematics.draw_posture(random);
  const Eigen::Vector3d place_m = kinematics.calc_pose(first).position_m;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(
      Eigen::MatrixXd(kinematics.calc_jacobian(first).topRows<3>()), Eigen::ComputeFullU);
  Eigen::Vector3d normal = svd.matrixU().col(2);
  // Chooses the normal that points up; if it is horizontal, the one that points left or forwards.
  const double sign = std::abs(normal.z()) > 1e-9   ? normal.z()
                      : std::abs(normal.y()) > 1e-9 ? normal.y()
                                                    : normal.x();
  normal *= sign < 0 ? -1 : 1;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d other_m =
        kinematics.calc_pose(kinematics.draw_posture(random)).position_m;
    if (std::abs(normal.dot(other_m - place_m)) > 1e-6 * length_m) {
      refuse_proposal(robot,
                      "its tip moves on a curved surface, on which there are no straight moves; "
                      "there must be three joints that move it in three directions, or all must "
                      "move it in one plane (robot.tip can name another link)");
    }
  }
  // Components that are only rounding errors become exactly 0.
  for (double& part : normal) {
    part = std::abs(part) < 1e-9 ? 0 : part;
  }
  return normal.normalized();
}

bool touches_an_end(const NumericKinematics& kinematics, const RobotModel& robot,
                    std::span<const double> q) {
  return calc_excursion(kinematics, robot, q) > 1 - kKeepOffEnds;
}

// Returns whether the arm can follow straight moves through the points of the cases; checks
// coarsely spaced points.
bool can_follow(const NumericKinematics& kinematics, const RobotModel& robot,
                const WorkspaceSphere& sphere, const Eigen::Matrix3d& turn, std::vector<double> q) {
  const std::size_t n = q.size();
  if (!kinematics.find({sphere.centre_m, turn}, q)) {
    return false;
  }
  const std::vector<double> start = q;
  std::vector<double> wish(n);
  const std::vector<TestCase> all = make_proposal_cases(sphere);
  for (const TestCase& its : std::span(all).first(kQuickCases)) {
    q = start;
    for (std::size_t k = 1; k < its.points_m.size(); ++k) {
      const Eigen::Vector3d way_m = its.points_m[k] - its.points_m[k - 1];
      const int steps =
          static_cast<int>(std::ceil(way_m.norm() / (kStepOfRadius * sphere.radius_m)));
      for (int step = 1; step <= steps; ++step) {
        for (std::size_t i = 0; i < n; ++i) {
          wish[i] = kinematics.has_middle(i) ? 0.02 * (kinematics.get_middle(i) - q[i]) : 0;
        }
        const Eigen::Vector3d at_m =
            its.points_m[k - 1] + (static_cast<double>(step) / steps) * way_m;
        if (!kinematics.follow({at_m, turn}, wish, q) || touches_an_end(kinematics, robot, q) ||
            kinematics.calc_dexterity(q) < kSafeDexterity) {
          return false;
        }
      }
    }
  }
  return true;
}

// Returns the same, checked with the target tables that simulations use.
bool has_good_tables(const RobotModel& robot, TrackingTask task, const WorkspaceProposal& place) {
  coarsen(task);
  task.limits = LimitPolicy::warn;
  task.home = place.home;
  task.tool.turn = place.centre.turn;
  task.distance_limit_m = 2 * place.sphere.radius_m;
  task.speed_m_per_s = task.distance_limit_m / kProposedMove_s;
  const TrackingSetup setup(robot, task);
  const auto kinematics = setup.get_kinematics();
  for (const TargetTable& table : setup.make_targets(make_proposal_cases(place.sphere))) {
    check_reading();
    if (!table.unreachable.empty()) {
      return false;
    }
    for (int step = 0; step < table.steps; ++step) {
      if (touches_an_end(*kinematics, robot, table.positions(step))) {
        return false;
      }
    }
    if (std::ranges::any_of(find_path_faults(setup, table), [](const PathFault& fault) {
          return fault.kind != PathFault::Kind::speed;
        })) {
      return false;
    }
  }
  return true;
}

void set_radius(WorkspaceSphere& sphere, double radius_m) {
  sphere.radius_m = radius_m;
  sphere.shortest_move_m = kShortestOfRadius * radius_m;
}

}  // namespace

void refuse_proposal(const RobotModel& robot, const std::string& what) {
  throw Error(ErrorKind::bad_data, fmt::format("robot '{}': {}", sanitize(robot.name), what));
}

void coarsen(TrackingTask& task) {
  task.control_period_s = std::max(task.control_period_s, kLook_s);
  task.rest_s = std::min(task.rest_s, kRest_s);
}

ToolOrientation propose_orientation(const RobotModel& robot, const ToolTask& tool) {
  for (const ToolOrientation orientation : {ToolOrientation::pose, ToolOrientation::pointing}) {
    ToolTask tried = tool;
    tried.orientation = orientation;
    if (NumericKinematics(robot, tried, {}, true).suits_task()) {
      return orientation;
    }
  }
  return ToolOrientation::free;
}

WorkspaceProposal propose_workspace(const RobotModel& robot, const TrackingTask& task,
                                    WorkspaceSphere sphere) {
  const ReadStep step(fmt::format("proposing a workspace for robot '{}'", sanitize(robot.name)));
  const ToolTask& tool = task.tool;
  const NumericKinematics kinematics(robot, tool, {}, true, task.solver);
  kinematics.check_task(robot);
  const double length_m = calc_length_m(robot);
  sphere.normal = find_plane(kinematics, robot, tool, length_m);
  const Eigen::Vector3d first_m = robot.joints.front().origin.translation();
  std::optional<WorkspaceProposal> best;
  const double smallest_m = kSmallestRadius * length_m;
  double least_m = smallest_m;
  for (const std::vector<double>& home : choose_homes(kinematics, robot)) {
    const ToolPose centre = kinematics.calc_pose(home);
    sphere.centre_m = centre.position_m;
    const double most_m =
        std::min(kLargestRadius * length_m, (centre.position_m - first_m).norm() / kKeepOff);
    const NumericKinematics from_home(robot, tool, home, true, task.solver);
    for (double radius_m = most_m; radius_m >= least_m; radius_m *= kRadiusStep) {
      check_reading();
      set_radius(sphere, radius_m);
      if (can_follow(from_home, robot, sphere, centre.turn, home)) {
        best = WorkspaceProposal{home, centre, sphere};
        least_m = radius_m / kRadiusStep;
        break;
      }
    }
  }
  while (best && best->sphere.radius_m >= smallest_m) {
    const bool is_good = has_good_tables(robot, task, *best);
    // A good sphere is made smaller once more, as a margin for cases that were not checked.
    set_radius(best->sphere, kRadiusStep * best->sphere.radius_m);
    if (is_good) {
      return *best;
    }
  }
  refuse_proposal(
      robot, fmt::format("no place was found where its tool can move {:.2g} m along straight lines "
                         "with task.orientation = \"{}\", within all joint ranges and off "
                         "singularities; set another task.orientation, or workspace.centre_m, "
                         "workspace.radius_m and task.home yourself",
                         2 * smallest_m,
                         tool_orientation_names()[static_cast<std::size_t>(tool.orientation)]));
}

std::vector<TestCase> make_proposal_cases(const WorkspaceSphere& sphere) {
  WorkspaceSphere looked_at = sphere;
  looked_at.points = std::min(looked_at.points, kMostPoints);
  std::vector<TestCase> cases;
  for (std::uint64_t number = 0; number < kCases; ++number) {
    cases.push_back(make_test_case(kProposalSet, number, looked_at));
  }
  return cases;
}

}  // namespace armwright
