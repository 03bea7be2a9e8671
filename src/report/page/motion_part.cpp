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
  const RobotModel& robot = *plan->robot;
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
  TrackingTask task;
  task.clearance = problem->config().clearance;
  task.control_period_s = kReplayPeriod_s;
  const std::size_t index =
      add_robot(robot, task, run.find_urdf().parent_path(), page["robots"], notes);
  const GivenMotion motion = make_planned_motion(*plan);
  page["replays"].push_back(make_given_replay_set(
      {kPlannedDesign, "The planned motion"}, "as planned", index, task, efforts, {&motion, 1}));
}

}  // namespace armwright
