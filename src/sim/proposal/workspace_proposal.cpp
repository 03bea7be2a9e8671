#include "sim/proposal/workspace_proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/random.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/kinematics/floor_clearance.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/proposal/drive_proposal.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

constexpr int kDrawnPostures = 2000;
constexpr std::size_t kHomes = 24;  // postures around which a workspace is tried
constexpr std::size_t kQuickCases = 3;
constexpr int kCases = 8;
constexpr int kMostPoints = 25;
constexpr double kLook_s = 0.01;
constexpr int kStepsBetweenWeights = 5;
constexpr double kRest_s = 0.1;
// Fractions of the arm's length.
constexpr double kLargestRadius = 0.35;
constexpr double kSmallestRadius = 0.01;
constexpr double kWorthwhile = 0.04;  // a radius above which no other kind of workspace is tried
constexpr double kRadiusStep = 0.8;
constexpr double kKeepOff = 1.15;  // radii from the sphere's centre to the first joint
// Distance of the sphere from the axis of a first joint that turns about the vertical: the base.
constexpr double kBaseRadius = 0.08;
constexpr double kFront = 0.7;  // cosine of the largest angle, about the vertical, from the front
constexpr double kNoFront = 0.05;  // a mean place of the tip nearer to the first joint is no front
constexpr double kStepOfRadius = 0.1;  // distance of the checked points on a move
constexpr double kSafeDexterity = 3 * kSingularDexterity;
constexpr double kKeepOffEnds = 0.02;  // fraction of half a joint's range
// As in the thesis's cases, moves are at most a diameter and at least a sixteenth of the radius
// long.
constexpr double kShortestOfRadius = 1.0 / 16;
// Shares of the effort limits that hold the arm at home, and anywhere on the cases.
constexpr double kMostHeldAtHome = 0.85;
constexpr double kMostHeld = 0.9;

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

// Turns each posture so that the tool's axis points down, if it can; otherwise removes it.
void level(const NumericKinematics& kinematics, const ToolTask& tool,
           std::vector<std::vector<double>>& postures) {
  std::vector<NumericKinematics::Approach> searches;
  for (const std::vector<double>& q : postures) {
    ToolPose pose = kinematics.calc_pose(q);
    const Eigen::Vector3d axis = pose.turn * tool.axis;
    pose.turn =
        Eigen::Quaterniond::FromTwoVectors(axis, -Eigen::Vector3d::UnitZ()).toRotationMatrix() *
        pose.turn;
    searches.push_back(kinematics.make_search(pose, q));
  }
  constexpr std::size_t kAtOnce = 64;  // between two looks at the limit of reading
  for (std::size_t i = 0; i < searches.size(); i += kAtOnce) {
    check_reading();
    std::vector<NumericKinematics::Approach*> some;
    for (std::size_t k = i; k < std::min(i + kAtOnce, searches.size()); ++k) {
      some.push_back(&searches[k]);
    }
    kinematics.approach(some);
  }
  postures.clear();
  for (const NumericKinematics::Approach& search : searches) {
    if (search.reached) {
      postures.emplace_back(search.q.begin(), search.q.end());
    }
  }
}

// Returns the horizontal direction in which the arm works: that of the mean place of the tip.
Eigen::Vector2d find_front(const NumericKinematics& kinematics, const RobotModel& robot,
                           const std::vector<std::vector<double>>& postures) {
  const Eigen::Vector3d first_m = robot.joints.front().origin.translation();
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const std::vector<double>& q : postures) {
    sum_m += kinematics.calc_pose(q).position_m - first_m;
  }
  const Eigen::Vector2d mean_m = sum_m.head<2>() / static_cast<double>(postures.size());
  return mean_m.norm() > kNoFront * calc_arm_length_m(robot) ? mean_m.normalized()
                                                             : Eigen::Vector2d::UnitX();
}

// The floor and the obstacles of a task, from which the arm stays clear. Keeps references.
class Cell {
 public:
  Cell(const RobotModel& robot, const NumericKinematics& kinematics, const TrackingTask& task)
      : robot_(robot), task_(task) {
    if (task.floor_m) {
      floor_.emplace(robot, kinematics, *task.floor_m);
    }
  }

  bool is_clear(std::span<const double> q) const {
    return (!floor_ || floor_->find_lowest(q).excess_m <= 0) &&
           (!task_.clearance ||
            task_.clearance->find_nearest(calc_link_poses(robot_, q)).distance_m >=
                task_.clearance_m);
  }

 private:
  const RobotModel& robot_;
  const TrackingTask& task_;
  std::optional<FloorClearance> floor_;
};

// The search for the largest workspace of a task whose tool.orientation is set.
class Search {
 public:
  Search(const RobotModel& robot, const TrackingTask& task, const WorkspaceSphere& sphere)
      : robot_(robot),
        task_(task),
        sphere_(sphere),
        kinematics_(robot, task.tool, {}, true, task.solver),
        resting_(task.load_kg > 0 ? add_load(robot, task.load_kg, task.load_body) : robot,
                 task.physics),
        cell_(robot, kinematics_, task),
        length_m_(calc_arm_length_m(robot)),
        first_m_(robot.joints.front().origin.translation()) {}

  // Returns the largest workspace that is found, the tool pointing down or in any direction.
  std::optional<WorkspaceProposal> find(bool points_down);
  // Throws if the arm cannot even be held in the easiest of its postures.
  void check_holding();

 private:
  using Postures = std::vector<std::vector<double>>;

  Postures draw_postures() const;
  double calc_most_radius_m(const Eigen::Vector3d& centre_m) const;
  std::optional<WorkspaceProposal> try_homes(const Postures& homes, double least_m);

  const RobotModel& robot_;
  const TrackingTask& task_;
  WorkspaceSphere sphere_;
  NumericKinematics kinematics_;
  RestingArm resting_;
  Cell cell_;
  double length_m_;
  Eigen::Vector3d first_m_;
};

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

// Returns whether driving a joint moves the others so much that no proposed control period is short
// enough, as where two joints of a redundant arm have nearly the same axis.
bool is_too_coupled(RestingArm& resting, std::span<const double> q) {
  return resting.calc_coupling(q) > calc_most_coupling(kShortestPeriod_s);
}

// Returns whether the arm can follow straight moves through the points of the cases; checks
// coarsely spaced points.
bool can_follow(const NumericKinematics& kinematics, const RobotModel& robot, const Cell& cell,
                RestingArm& resting, const WorkspaceSphere& sphere, const Eigen::Matrix3d& turn,
                std::vector<double> q) {
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
            !cell.is_clear(q) || is_too_coupled(resting, q) ||
            kinematics.calc_dexterity(q) < kSafeDexterity) {
          return false;
        }
      }
    }
  }
  return true;
}

// Returns the same, checked with the target tables that simulations use.
bool has_good_tables(const RobotModel& robot, TrackingTask task, const WorkspaceProposal& place,
                     RestingArm& resting) {
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
      const std::span<const double> q = table.positions(step);
      if (touches_an_end(*kinematics, robot, q) ||
          (step % kStepsBetweenWeights == 0 &&
           (resting.find_hardest(q).share > kMostHeld || is_too_coupled(resting, q)))) {
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

Search::Postures Search::draw_postures() const {
  Postures postures = {kinematics_.home()};
  RandomStream random("proposal/home", 0);
  for (int i = 0; i < kDrawnPostures; ++i) {
    postures.push_back(kinematics_.draw_posture(random));
  }
  return postures;
}

double Search::calc_most_radius_m(const Eigen::Vector3d& centre_m) const {
  const Eigen::Vector3d way_m = centre_m - first_m_;
  double most_m = std::min(kLargestRadius * length_m_, way_m.norm() / kKeepOff);
  const Joint& first = robot_.joints.front();
  const double upright = std::abs((first.origin.linear() * first.axis).z());
  if (first.kind == JointKind::revolute && upright > 0.99) {
    most_m = std::min(most_m, way_m.head<2>().norm() - kBaseRadius * length_m_);
  }
  return task_.floor_m ? std::min(most_m, centre_m.z() - *task_.floor_m) : most_m;
}

std::optional<WorkspaceProposal> Search::try_homes(const Postures& homes, double least_m) {
  std::optional<WorkspaceProposal> best;
  for (const std::vector<double>& home : homes) {
    const ToolPose centre = kinematics_.calc_pose(home);
    WorkspaceSphere sphere = sphere_;
    sphere.centre_m = centre.position_m;
    const NumericKinematics from_home(robot_, task_.tool, home, true, task_.solver);
    for (double radius_m = calc_most_radius_m(sphere.centre_m); radius_m >= least_m;
         radius_m *= kRadiusStep) {
      check_reading();
      set_radius(sphere, radius_m);
      if (can_follow(from_home, robot_, cell_, resting_, sphere, centre.turn, home)) {
        best = WorkspaceProposal{.home = home,
                                 .centre = centre,
                                 .sphere = sphere,
                                 .orientation = task_.tool.orientation,
                                 .floor_m = task_.floor_m};
        least_m = radius_m / kRadiusStep;
        break;
      }
    }
  }
  return best;
}

std::optional<WorkspaceProposal> Search::find(bool points_down) {
  sphere_.normal = find_plane(kinematics_, robot_, task_.tool, length_m_);
  Postures postures = draw_postures();
  const Eigen::Vector2d front = find_front(kinematics_, robot_, postures);
  if (points_down) {
    level(kinematics_, task_.tool, postures);
  }
  // The postures in front of the arm and the others, each with its ease.
  std::vector<std::pair<double, std::vector<double>>> groups[2];
  const double most_coupling = calc_most_coupling(task_.control_period_s);
  for (std::vector<double>& q : postures) {
    // Less the more the other joints move when one is driven, if that limits its damping.
    const double ease = calc_ease(kinematics_, robot_, q) *
                        std::min(1.0, most_coupling / resting_.calc_coupling(q));
    if (ease <= 0 || !cell_.is_clear(q) || resting_.find_hardest(q).share > kMostHeldAtHome) {
      continue;
    }
    const Eigen::Vector2d way_m = (kinematics_.calc_pose(q).position_m - first_m_).head<2>();
    const bool in_front = way_m.dot(front) > kFront * way_m.norm();
    groups[in_front ? 0 : 1].emplace_back(ease, std::move(q));
  }
  const double smallest_m = kSmallestRadius * length_m_;
  std::optional<WorkspaceProposal> best;
  for (auto& group : groups) {
    if (best && best->sphere.radius_m > kWorthwhile * length_m_) {
      break;
    }
    std::ranges::stable_sort(group, std::greater<>{}, [](const auto& one) { return one.first; });
    Postures homes;
    for (std::size_t i = 0; i < std::min(kHomes, group.size()); ++i) {
      homes.push_back(std::move(group[i].second));
    }
    if (const auto found = try_homes(homes, best ? best->sphere.radius_m : smallest_m)) {
      best = found;
    }
  }
  while (best && best->sphere.radius_m >= smallest_m) {
    const bool is_good = has_good_tables(robot_, task_, *best, resting_);
    // A good sphere is made smaller once more, as a margin for cases that were not checked.
    set_radius(best->sphere, kRadiusStep * best->sphere.radius_m);
    if (is_good) {
      best->points_down = points_down;
      return best;
    }
  }
  return std::nullopt;
}

void Search::check_holding() {
  RestingArm::Hardest easiest;
  easiest.share = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& q : draw_postures()) {
    if (cell_.is_clear(q)) {
      const RestingArm::Hardest hardest = resting_.find_hardest(q);
      easiest = hardest.share < easiest.share ? hardest : easiest;
    }
  }
  if (std::isfinite(easiest.share) && easiest.share > kMostHeldAtHome) {
    refuse_to_hold(robot_, easiest,
                   fmt::format("in the easiest of {} postures above the floor{}", kDrawnPostures,
                               task_.clearance ? " and clear of obstacles" : ""));
  }
}

}  // namespace

void refuse_proposal(const RobotModel& robot, const std::string& what) {
  throw Error(ErrorKind::bad_data, fmt::format("robot '{}': {}", sanitize(robot.name), what));
}

void refuse_to_hold(const RobotModel& robot, const RestingArm::Hardest& hardest,
                    const std::string& where) {
  const Joint& joint = robot.joints[hardest.joint];
  refuse_proposal(
      robot,
      fmt::format("joint {} ('{}') needs {:.4g} {} to hold the arm {}, its effort limit is {:.4g}; "
                  "a motor needs some of its effort to move the arm, too: correct the limit or the "
                  "masses in the robot's file, state springs and "
                  "counterweights (robot.plant), carry less, or set another workspace",
                  hardest.joint + 1, sanitize(joint.name), hardest.effort,
                  get_effort_unit(joint.kind), where, joint.effort_limit));
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

Eigen::Vector3d propose_tool_axis(const RobotModel& robot) {
  // From the last joint that is not at the tip; in the tip's frame.
  const Eigen::Isometry3d& tip = robot.tip_pose;
  Eigen::Isometry3d pose = tip;
  Eigen::Vector3d out = tip.linear().transpose() * tip.translation();
  for (std::size_t i = robot.joint_count(); i-- > 0 && out.norm() < 1e-6;) {
    const Joint& joint = robot.joints[i];
    pose = joint.origin * pose;
    out = pose.linear().transpose() * pose.translation();
  }
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  if (out.norm() < 1e-6 || out.normalized().z() > kFront) {
    return axis;
  }
  Eigen::Index largest = 0;
  out.cwiseAbs().maxCoeff(&largest);
  axis.setZero();
  axis[largest] = out[largest] > 0 ? 1 : -1;
  return axis;
}

namespace {

// Returns a workspace that keeps to the task's floor, if it has one.
std::optional<WorkspaceProposal> find_workspace(const RobotModel& robot, TrackingTask task,
                                                const WorkspaceSphere& sphere,
                                                std::optional<ToolOrientation> orientation) {
  if (!orientation && task.kinematics != KinematicsChoice::numeric &&
      ElbowUpKinematics::make_if_suited(robot, task.ik_bug)) {
    orientation = ToolOrientation::free;  // the closed form itself keeps the last link upright
  }
  bool is_first = true;
  for (const bool points_down : {true, false}) {
    // Any direction that is not vertical stands for those that the tool may have.
    const Eigen::Vector3d direction =
        points_down ? Eigen::Vector3d(-Eigen::Vector3d::UnitZ()) : Eigen::Vector3d::UnitX();
    task.tool.turn =
        Eigen::Quaterniond::FromTwoVectors(task.tool.axis, direction).toRotationMatrix();
    for (const ToolOrientation one :
         {ToolOrientation::pose, ToolOrientation::pointing, ToolOrientation::free}) {
      if ((orientation && one != *orientation) || (points_down && one == ToolOrientation::free)) {
        continue;
      }
      task.tool.orientation = one;
      const NumericKinematics kinematics(robot, task.tool, {}, true, task.solver);
      if (!kinematics.suits_task()) {
        if (orientation && is_first && !points_down) {
          kinematics.check_task(robot);
        }
        continue;
      }
      Search search(robot, task, sphere);
      if (std::exchange(is_first, false)) {
        search.check_holding();
      }
      if (auto found = search.find(points_down)) {
        return found;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<WorkspaceProposal> propose_workspace(const RobotModel& robot, TrackingTask task,
                                                   const WorkspaceSphere& sphere,
                                                   std::optional<ToolOrientation> orientation) {
  const ReadStep step(fmt::format("proposing a workspace for robot '{}'", sanitize(robot.name)));
  if (!task.floor_m && robot.joints.front().origin.translation().z() >= 0) {
    task.floor_m = 0;
    if (auto found = find_workspace(robot, task, sphere, orientation)) {
      return found;
    }
    task.floor_m.reset();
  }
  return find_workspace(robot, task, sphere, orientation);
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
