// Makes the part of a run's page that shows a planned motion: the arm that moves, and the limits of the
// joints beside their signals.

#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "problems/motion/motion_problem.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/robot_scene.hpp"
#include "report/page/run_parts.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kPlannedDesign = "planned";
constexpr double kReplayPeriod_s = 0.01;

GivenMotion make_planned_motion(const AssessedPlan& plan) {
  const std::size_t joints = plan.curve.joint_count();
  const auto steps = static_cast<std::size_t>(std::ceil(plan.curve.duration_s() / kReplayPeriod_s));
  GivenMotion motion{.id = kPlannedDesign,
                     .label = fmt::format("the planned motion, {:.3f} s", plan.curve.duration_s()),
                     .set = "motion",
                     .q = {},
                     .effort = {}};
  std::vector<double> values(joints);
  for (std::size_t step = 0; step <= steps; ++step) {
    const double t = static_cast<double>(step) * kReplayPeriod_s;
    plan.curve.calc(t, 0, values);
    motion.q.insert(motion.q.end(), values.begin(), values.end());
    const auto last = static_cast<double>(plan.times_s.size() - 1);
    const auto row =
        static_cast<Eigen::Index>(std::min(std::round(t / plan.curve.duration_s() * last), last));
    for (std::size_t joint = 0; joint < joints; ++joint) {
      motion.effort.push_back(
          static_cast<float>(plan.efforts(row, static_cast<Eigen::Index>(joint))));
    }
  }
  return motion;
}

// Obstacles belong to the base, which does not move.
void add_obstacles(const ArmClearance& clearance, RobotModel& robot) {
  const Eigen::Vector4d colour(0.84, 0.37, 0, 0.6);
  std::vector<VisualShape>& shapes = robot.base.visuals;
  for (const Obstacle& obstacle : clearance.obstacles()) {
    if (obstacle.kind == ObstacleKind::box) {
      shapes.push_back({.kind = ShapeKind::box,
                        .size_m = 2 * obstacle.half_m,
                        .mesh_file = "",
                        .pose = obstacle.pose,
                        .rgba = colour});
    } else if (obstacle.kind == ObstacleKind::cylinder) {
      const Eigen::Vector3d half = obstacle.half_m.z() * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d centre = obstacle.centre_m();
      shapes.push_back(make_cylinder(centre - half, centre + half, obstacle.half_m.x(), colour));
    } else {
      const Capsule& its = obstacle.capsule;
      shapes.push_back(make_ball(its.from_m, its.radius_m, colour));
      if (its.from_m != its.to_m) {
        shapes.push_back(make_cylinder(its.from_m, its.to_m, its.radius_m, colour));
        shapes.push_back(make_ball(its.to_m, its.radius_m, colour));
      }
    }
  }
}

}  // namespace

void add_planned_motion(const RecordedRun& run, json& page, std::vector<std::string>& notes) {
  const MotionProblem* problem = run.problem ? find_motion(*run.problem->problem) : nullptr;
  if (problem == nullptr || !run.result || !run.result->winner) {
    return;
  }
  std::string reason;
  const auto plan = problem->assess(run.result->judged[*run.result->winner].candidate.x,
                                    problem->config().samples, reason);
  if (!plan) {
    notes.push_back(fmt::format("The motion is not shown: {}.", sanitize(reason)));
    return;
  }
  const JointLimits& limits = problem->config().limits;
  json lines = json::object();
  json efforts = json::array();
  RobotModel robot = *plan->robot;
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    const std::string& name = robot.joints[i].name;
    for (const auto& [what, values] :
         {std::pair{"speed", &limits.speed}, std::pair{"acceleration", &limits.acceleration},
          std::pair{"jerk", &limits.jerk}, std::pair{"effort", &limits.effort}}) {
      if (std::isfinite((*values)[i])) {
        lines[fmt::format("{} {}", name, what)] = (*values)[i];
      }
    }
    efforts.push_back({finite_or_null(-limits.effort[i]), finite_or_null(limits.effort[i])});
  }
  page["record_limits"] = lines;
  if (problem->config().clearance) {
    add_obstacles(*problem->config().clearance, robot);
  }
  TrackingTask task;
  task.control_period_s = kReplayPeriod_s;
  const std::size_t index =
      add_robot(robot, task, run.find_urdf().parent_path(), page["robots"], notes);
  const GivenMotion motion = make_planned_motion(*plan);
  page["replays"].push_back(make_given_replay_set(
      {kPlannedDesign, "The planned motion"}, "as planned", index, task, efforts, {&motion, 1}));
}

}  // namespace armwright
