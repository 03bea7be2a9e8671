// Writes the data sheet of a tuned arm as one HTML page.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/build_info.hpp"
#include "base/text.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "report/deliverables/datasheet_parts.hpp"
#include "report/formats/export_text.hpp"
#include "sim/tracking/designed_arm.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

using SheetFacts = std::vector<std::pair<std::string, std::string>>;  // label and text

constexpr const char* kUnknown = "\u2013";

std::string format_mm(const std::optional<double>& metres) {
  return metres ? fmt::format("{:.4g}", kMillimetresPerMetre * *metres) : kUnknown;
}

// ---- Robot, task, optimization -----------------------------------------------------------------

std::string describe_load(const TrackingTask& task) {
  const std::string mass = fmt::format("{:.5g} kg", task.load_kg);
  if (task.load_kg == 0 || !task.load_body) {
    return mass;
  }
  const Eigen::Vector3d& com_m = task.load_body->com_m;
  return fmt::format("{}, centre of mass at {:.4g}, {:.4g}, {:.4g} m in the tip's frame", mass,
                     com_m.x(), com_m.y(), com_m.z());
}

std::string make_robot_facts(const FinishedArm& arm) {
  const TrackingConfig& config = arm.config();
  const RobotModel robot = arm.run.tracking()->make_robot(arm.design);
  const auto sliding = std::ranges::count(robot.joints, JointKind::prismatic, &Joint::kind);
  const auto turning = static_cast<std::ptrdiff_t>(robot.joint_count()) - sliding;
  const SheetFacts facts = {
      {"Name", sanitize(robot.name)},
      {"Chain",
       fmt::format("{} \u2192 {}", sanitize(robot.base.name), sanitize(robot.links.back().name))},
      {"Joints", fmt::format("{}: {} turn, {} slide", robot.joint_count(), turning, sliding)},
      {"Moving mass", fmt::format("{:.5g} kg", calc_moving_mass_kg(robot))},
      {"Load", describe_load(config.task)},
      {"Links", is_stretched(arm.design) ? "other than the URDF's (see winner.toml)" : ""},
      {"URDF", sanitize(arm.run.find_urdf().filename().string())}};
  return make_fact_list(facts);
}

std::string describe_points(const TrackingConfig& config) {
  if (!config.path) {
    return fmt::format("{} a test case", config.workspace.points);
  }
  return fmt::format("{} of a path, {}", config.path->points_m.size() - 1,
                     config.path->continuous ? "without a stop" : "with a stop at each");
}

std::string describe_workspace(const TrackingConfig& config) {
  const WorkspaceSphere& sphere = config.workspace;
  return config.path ? ""
                     : fmt::format("{} of radius {:.4g} m about ({:.4g}, {:.4g}, {:.4g}) m",
                                   sphere.normal ? "disc" : "sphere", sphere.radius_m,
                                   sphere.centre_m.x(), sphere.centre_m.y(), sphere.centre_m.z());
}

// A path that is sampled has its speeds in its samples.
std::string describe_target(const TrackingConfig& config, const TrackingTask& task) {
  const std::string signal = signal_names()[static_cast<std::size_t>(task.signal)];
  return config.never_rests() ? "moves along its samples"
                              : fmt::format("{} moves at {:.4g} m/s, below {:.4g} m slower", signal,
                                            task.speed_m_per_s, task.distance_limit_m);
}

std::string make_task_facts(const FinishedArm& arm) {
  const TrackingConfig& config = arm.config();
  const TrackingTask task = arm.run.tracking()->make_task(arm.design);
  const std::string plants = describe_plants(config.perturbation, CaseRole::test);
  const SheetFacts facts = {
      {"Problem", sanitize(arm.result().problem)},
      {"Target", describe_target(config, task)},
      {"Rest", fmt::format("{:.4g} s after each move", task.rest_s)},
      {"Points", describe_points(config)},
      {"Workspace", describe_workspace(config)},
      {"Tool", tool_orientation_names()[static_cast<std::size_t>(task.tool.orientation)]},
      {"Plants", plants.empty() ? "" : "other ones in each case: " + plants},
      {"Controller",
       fmt::format("{}, every {:.4g} s", arm.design.controller, task.control_period_s)},
      {"Physics", config.engines.training_name == config.engines.judging_name
                      ? config.engines.judging_name
                      : fmt::format("{}, judged by {}", config.engines.training_name,
                                    config.engines.judging_name)}};
  return make_fact_list(facts);
}

std::string make_run_facts_of(const FinishedArm& arm) {
  const RunResult& result = arm.result();
  const SheetFacts facts = {
      {"Run of", sanitize(arm.run.started)},
      {"Optimizer", sanitize(shorten_optimizer(result.optimizer))},
      {"Seed", fmt::format("{}", result.seed)},
      {"Budget", fmt::format("{} of {} cases", result.counts.cases, arm.run.budget)},
      {"Designs tried", fmt::format("{}", result.counts.evaluations)},
      {"Cases", to_text(arm.run.schedule)},
      {"Ended by", sanitize(result.end_reason)}};
  return make_fact_list(facts);
}

// Returns "N m/rad", or "N m/rad; slides: N/m" for an arm with joints of both kinds.
std::string list_units(const RobotModel& robot, std::string_view unit) {
  std::vector<std::string> units;
  for (const JointKind kind : {JointKind::revolute, JointKind::prismatic}) {
    const std::string own = get_joint_unit(unit, kind);
    if (std::ranges::count(robot.joints, kind, &Joint::kind) > 0 &&
        (units.empty() || units.front() != own)) {
      units.push_back(units.empty() ? own : "slides: " + own);
    }
  }
  return join(units, "; ");
}

// ---- Results -----------------------------------------------------------------------------------

std::optional<double> find_metric(const RunResult& result, const Evaluation& evaluation,
                                  std::string_view name) {
  const auto found = std::ranges::find(result.metric_names, name);
  const auto at = static_cast<std::size_t>(found - result.metric_names.begin());
  return at < evaluation.metrics.size() ? std::optional(evaluation.metrics[at]) : std::nullopt;
}

std::string format_metric(const RunResult& result, const Evaluation& evaluation,
                          std::string_view name) {
  const auto value = find_metric(result, evaluation, name);
  return value ? fmt::format("{:.6g}", *value) : kUnknown;
}

// Returns why the arm sags when its controllers are enabled and what to do about it, or what holds it.
std::string explain_start(const FinishedArm& arm) {
  if (arm.config().task.drives.has_loops()) {
    return "The drives hold the arm from the first period on.";
  }
  const FeedForward ahead = find_controller(arm.design.controller).feed_forward;
  if (ahead != FeedForward::none) {
    return "The controllers add the efforts that hold the arm from the first period on.";
  }
  if (arm.starts_held()) {
    return "The controllers start with integrals that hold the arm against gravity "
           "(control.start); one that starts empty sags further when it is enabled.";
  }
  return "It is the sag when the controllers are enabled: their integrals start empty, so gravity "
         "pulls the arm until they have filled. control.start = \"gravity\" holds it, if the "
         "controller has an integral; the controller pid_gravity always does.";
}

std::string list_totals(const EffortTotals& efforts) {
  std::vector<std::string> totals;
  if (efforts.torque_n_m) {
    totals.push_back(fmt::format("total torque {:.6g} N m", *efforts.torque_n_m));
  }
  if (efforts.force_n) {
    totals.push_back(fmt::format("total force {:.6g} N", *efforts.force_n));
  }
  return join(totals, ", ");
}

// Returns an empty text if the run did not measure its winner's motion.
std::string describe_motion(const FinishedArm& arm) {
  const auto& motion = arm.result().test_motion;
  if (!motion) {
    return "";
  }
  std::string html = fmt::format(
      "<p><strong>Error while moving</strong>: RMS {} mm, peak {} mm, the distance from the moving "
      "target on "
      "the moves of all test cases.</p>\n",
      format_mm(motion->moving_rms_m), format_mm(motion->moving_peak_m));
  if (motion->start_up_m) {
    html += fmt::format(
        "<p><strong>Error after start-up</strong>: up to {} mm before the target's first rest has "
        "ended. "
        "{}</p>\n",
        format_mm(motion->start_up_m), escape_html(explain_start(arm)));
  }
  return html;
}

std::string make_results(const FinishedArm& arm) {
  const RunResult& result = arm.result();
  const bool continuous = arm.config().never_rests();
  const std::vector<std::string> heads = {continuous ? "Errors in mm" : "Errors at rest, mm",
                                          "cases",
                                          "mean",
                                          "median",
                                          "95 %",
                                          "worst",
                                          "failures",
                                          "no number",
                                          "energy J",
                                          "clamped %"};
  std::vector<std::vector<HtmlCell>> rows;
  const auto add = [&](const std::string& name, const Evaluation& evaluation) {
    const ErrorSummary summary = summarize(evaluation.case_errors, get_failure_error(result));
    const auto clamped = find_metric(result, evaluation, "saturated_share");
    rows.push_back({{name},
                    {fmt::format("{}", summary.cases)},
                    {format_mm(summary.mean)},
                    {format_mm(summary.median)},
                    {format_mm(summary.percentile_95)},
                    {format_mm(summary.worst)},
                    {fmt::format("{}", summary.failures)},
                    {fmt::format("{}", summary.without_number)},
                    {format_metric(result, evaluation, "energy")},
                    {clamped ? fmt::format("{:.3g}", 100 * *clamped) : kUnknown}});
  };
  add("test: " + sanitize(result.test_set), result.test);
  add("validation: " + sanitize(arm.run.problem->sets.validation), arm.winner().validation);
  std::string html = make_table(heads, rows);
  html += fmt::format(
      "<p>{} 95 %: of the cases are below it. A failure has an error above {:.4g} mm or no number. "
      "Means over the cases: energy, the positive work of all joints; clamped, the share of "
      "control "
      "periods that ask for more than the limits allow. Each joint's larger limit summed: "
      "{}.</p>\n",
      continuous ? "Mean over the samples of a path."
                 : "Largest distance while the target rests at a point, mean over a case's points.",
      kMillimetresPerMetre * get_failure_error(result),
      list_totals(calc_effort_totals(arm.design, arm.config().robot)));
  return html + describe_motion(arm);
}

// ---- Requirements ------------------------------------------------------------------------------

// Returns an empty text if the problem has no requirements.
std::string make_requirements(const FinishedArm& arm) {
  const auto judged =
      judge_requirements(arm.run.tracking()->description().requirements, arm.result().test);
  if (judged.empty()) {
    return "";
  }
  std::vector<std::vector<HtmlCell>> rows;
  for (const JudgedRequirement& one : judged) {
    const auto number = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.4g}", *value) : kUnknown;
    };
    rows.push_back({{fmt::format("{} [{}]", one.requirement.limit.quantity.name,
                                 one.requirement.limit.quantity.unit)},
                    {number(one.value)},
                    {fmt::format("{:.4g}", one.requirement.limit.value)},
                    {number(one.ratio)},
                    {to_string(one.grade), get_light(one.grade)},
                    {one.binds ? "binds" : ""}});
  }
  return make_table(std::vector<std::string>{"Worst of the test cases", "value", "limit",
                                             "value / limit", "", ""},
                    rows);
}

// ---- Joints ------------------------------------------------------------------------------------

// Returns "p [N m/rad]".
std::string label_with_unit(const RobotModel& robot, std::string_view name, std::string_view unit) {
  return fmt::format("{} [{}]", name, list_units(robot, unit));
}

std::string format_range(const Joint& joint) {
  if (std::isinf(joint.lower)) {
    return "no end";
  }
  if (joint.kind == JointKind::prismatic) {
    return fmt::format("{:.4g} to {:.4g} m", joint.lower, joint.upper);
  }
  constexpr double kDegrees = 180 / std::numbers::pi;
  return fmt::format("{:.4g}\u00b0 to {:.4g}\u00b0", kDegrees * joint.lower,
                     kDegrees * joint.upper);
}

std::string make_joints(const FinishedArm& arm) {
  const RobotModel& robot = arm.config().robot;
  const ControllerRow& controller = find_controller(arm.design.controller);
  const RunResult& result = arm.result();
  std::vector<std::string> heads = {"Joint"};
  for (const Joint& joint : robot.joints) {
    heads.push_back(sanitize(joint.name));
  }
  std::vector<std::vector<HtmlCell>> rows;
  const auto add = [&](const std::string& label, auto&& make_text) {
    std::vector<HtmlCell> row = {{label}};
    for (std::size_t i = 0; i < robot.joint_count(); ++i) {
      row.push_back({make_text(i)});
    }
    rows.push_back(std::move(row));
  };
  const auto drive = [&](std::size_t i) -> const JointDrive& { return arm.design.joints[i]; };
  add("range", [&](std::size_t i) { return format_range(robot.joints[i]); });
  for (std::size_t k = 0; k < controller.gains.size(); ++k) {
    add(label_with_unit(robot, controller.gains[k].name, controller.gains[k].unit),
        [&](std::size_t i) { return fmt::format("{:.6g}", drive(i).gains[k]); });
  }
  add(label_with_unit(robot, "lowest effort", "N m"),
      [&](std::size_t i) { return fmt::format("{:.6g}", drive(i).limits.min); });
  add(label_with_unit(robot, "highest effort", "N m"),
      [&](std::size_t i) { return fmt::format("{:.6g}", drive(i).limits.max); });
  for (const auto& [label, metric] :
       {std::pair{"peak used", "peak_effort"}, std::pair{"RMS used", "rms_effort"}}) {
    add(label_with_unit(robot, label, "N m"), [&, name = metric](std::size_t i) {
      return format_metric(result, result.test, robot.joints[i].name + "." + name);
    });
  }
  return make_table(heads, rows) +
         "<p>Used on the test set: the largest effort, and the mean of the cases' root mean "
         "squares.</p>\n";
}

// ---- Origin ------------------------------------------------------------------------------------

std::string make_origin(const FinishedArm& arm) {
  std::string html = "<div class=\"small\">\n";
  std::vector<std::string> build;
  for (const char* key : {"version", "git", "compiler", "build_type", "cpu", "ode", "eigen"}) {
    if (const auto fact = arm.run.build.find(key); fact != arm.run.build.end()) {
      build.push_back(fact->first + " " + sanitize(fact->second));
    }
  }
  html += fmt::format("<p class=\"clamped\">Made with armwright: {}. Sheet by version {}.</p>\n",
                      escape_html(join(build, ", ")), escape_html(get_version()));
  for (const auto& [file, hash] : arm.run.configuration.at("inputs").items()) {
    html += fmt::format("<p class=\"clamped\">{}: SHA-256 {}</p>\n", escape_html(sanitize(file)),
                        escape_html(sanitize(hash.get<std::string>())));
  }
  if (!arm.run.command_line.empty()) {
    html += fmt::format("<p class=\"command\">To make it: {}</p>\n",
                        escape_html(sanitize(arm.run.make_begin_command())));
  }
  const std::string command = arm.run.make_evaluate_command("winner.toml", {});
  if (!command.empty()) {
    html += fmt::format("<p class=\"command\">To simulate it again: {}</p>\n",
                        escape_html(sanitize(command)));
  }
  return html + "</div>\n";
}

}  // namespace

std::string make_datasheet(const FinishedArm& arm) {
  const std::string title = fmt::format("{}: tuned controllers", sanitize(arm.config().robot.name));
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>{0}</title>\n<style>{1}</style>\n</"
      "head>\n<body>\n<main>\n<h1>{0}</h1>\n"
      "<p class=\"lead\">{2}. All numbers are simulated, none is measured.</p>\n",
      escape_html(title), kDatasheetStyle, escape_html(sanitize(arm.run.problem->title)));
  for (const std::string& warning : arm.warnings) {
    html += fmt::format("<p class=\"fault\">{}</p>\n", escape_html(warning));
  }
  html += "<div class=\"columns\">\n" + make_section("Robot", make_robot_facts(arm)) +
          make_section("Task", make_task_facts(arm)) +
          make_section("Optimization", make_run_facts_of(arm)) + "</div>\n";
  html += make_section("Results", make_results(arm));
  if (const std::string requirements = make_requirements(arm); !requirements.empty()) {
    html += make_section("Requirements", requirements);
  }
  html += make_section(fmt::format("Controller {} and effort limits", arm.design.controller),
                       make_joints(arm));
  if (const std::string figures = make_datasheet_figures(arm); !figures.empty()) {
    html += make_section("Errors", figures);
  }
  html += make_section("Origin", make_origin(arm));
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace armwright
