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

// Returns ReplayCase of the motion. There is no target.
json make_planned_case(const AssessedPlan& plan) {
  const std::size_t joints = plan.curve.joint_count();
  const auto steps = static_cast<std::size_t>(std::ceil(plan.curve.duration_s() / kReplayPeriod_s));
  std::vector<float> q, effort;
  std::vector<double> values(joints);
  for (std::size_t step = 0; step <= steps; ++step) {
    const double t = static_cast<double>(step) * kReplayPeriod_s;
    plan.curve.calc(t, 0, values);
    q.insert(q.end(), values.begin(), values.end());
    const auto last = static_cast<double>(plan.times_s.size() - 1);
    const auto row =
        static_cast<Eigen::Index>(std::min(std::round(t / plan.curve.duration_s() * last), last));
    for (std::size_t joint = 0; joint < joints; ++joint) {
      effort.push_back(static_cast<float>(plan.efforts(row, static_cast<Eigen::Index>(joint))));
    }
  }
  const auto after_start = [&](const std::vector<float>& all) {
    return pack_f32(std::span(all).subspan(joints));
  };
  const json nothing = pack_f32({});
  const json moved = {{"design", kPlannedDesign},
                      {"status", "ok"},
                      {"reason", ""},
                      {"steps", steps},
                      {"mean_error_m", nullptr},
                      {"point_error_m", json::array()},
                      {"q", after_start(q)},
                      {"effort", after_start(effort)},
                      {"error_m", nothing}};
  return {{"id", kPlannedDesign},
          {"label", fmt::format("the planned motion, {:.3f} s", plan.curve.duration_s())},
          {"set", "motion"},
          {"number", 0},
          {"points_m", json::array()},
          {"segments", json::array()},
          {"steps", steps},
          {"target_m", nothing},
          {"target_q", nothing},
          {"start_q", std::vector<float>(q.begin(), q.begin() + static_cast<long>(joints))},
          {"motions", {moved}}};
}

// Obstacles belong to the base, which does not move.
void add_obstacles(const ArmClearance& clearance, RobotModel& robot) {
  const Eigen::Vector4d colour(0.84, 0.37, 0, 0.6);
  const auto add = [&](ShapeKind kind, const Eigen::Vector3d& size_m,
                       const Eigen::Isometry3d& pose) {
    VisualShape shape;
    shape.kind = kind;
    shape.size_m = size_m;
    shape.pose = pose;
    shape.rgba = colour;
    robot.base.visuals.push_back(shape);
  };
  for (const Obstacle& obstacle : clearance.obstacles()) {
    if (obstacle.kind == ObstacleKind::box) {
      add(ShapeKind::box, 2 * obstacle.half_m, obstacle.pose);
    } else if (obstacle.kind == ObstacleKind::cylinder) {
      add(ShapeKind::cylinder, {obstacle.half_m.x(), 2 * obstacle.half_m.z(), 0}, obstacle.pose);
    } else {
      const Capsule& its = obstacle.capsule;
      const Eigen::Vector3d way = its.to_m - its.from_m;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      for (const Eigen::Vector3d& end : {its.from_m, its.to_m}) {
        pose.translation() = end;
        add(ShapeKind::sphere, {its.radius_m, 0, 0}, pose);
      }
      if (way.norm() > 0) {
        pose.translation() = (its.from_m + its.to_m) / 2;
        pose.linear() =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), way).toRotationMatrix();
        add(ShapeKind::cylinder, {its.radius_m, way.norm(), 0}, pose);
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
  RobotModel robot = plan->robot;
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
  page["replays"].push_back({{"id", kPlannedDesign},
                             {"title", "The planned motion"},
                             {"robot", index},
                             {"task", make_task_info(task)},
                             {"designs",
                              {{{"id", kPlannedDesign},
                                {"name", "as planned"},
                                {"total_torque_n_m", nullptr},
                                {"total_force_n", nullptr},
                                {"effort_limits", efforts}}}},
                             {"cases", {make_planned_case(*plan)}}});
}

}  // namespace armwright
