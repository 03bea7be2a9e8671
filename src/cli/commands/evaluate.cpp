// armwright evaluate: evaluates a design on test cases, without optimization.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "cli/views/requirement_view.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/path_survey.hpp"
#include "problems/config/problem_readers.hpp"
#include "study/run/derived_files.hpp"
#include "study/run/json_values.hpp"
#include "study/run/winner_record.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kEvaluateExamples = R"(Examples:
  armwright evaluate table-a10                     # a published design on the problem it was made for
  armwright evaluate results/irb4600-auto-seed1/winner.toml --problem irb4600 --cases 100
  armwright evaluate table-a10 --set task.load_kg=20 --json
  armwright evaluate start --robot my.urdf         # the start design for an arm of your own, before tuning
  armwright evaluate table-a5 --trajectory arm.csv --trajectory-case 7
  armwright evaluate start --robot my.urdf --motion trajectory.yaml   # do the controllers follow a planned motion?

Terms: a test case is a sequence of points that the target visits, in the frame of the robot's base. The error of a
point is the largest distance between tip and target while the target rests there. The error of a case, the error at
rest, is the mean over its points. The error while moving is the root mean square (RMS) of the distance between tip and
moving target over all moves that count, and its peak. The error after start-up is the largest distance before the
target's first rest has ended. A failure is a case with an error above 100 mm or without a number (the simulation
diverged, or a target is out of reach). The total torque is the sum of the effort limits of the joints that turn, the
total force that of the joints that slide. If the problem has requirements
(docs/requirements.md), each is judged by its worst case. The exit code is 3 if a case has no number, or if a
requirement with use = "constraint" is missed.)";

struct EvaluateOptions {
  std::string design;
  std::string problem;
  OverrideOptions overrides;
  CaseOptions cases;
  std::string jobs;
  bool json = false;
  bool quiet = false;
  std::string csv;
  std::string trajectory;
  std::string trajectory_case;
  std::string motion;
};

// How an arm follows a given motion.
struct Following {
  TrackingResult result;
  std::optional<double> error_without_limits_m;
};

struct EvaluatedDesign {
  DesignFile design;
  LoadedProblem problem;
  ChosenCases cases;
  DesignEvaluation evaluation;
  std::vector<ShownRequirement> requirements;
  std::optional<Following> following;
};

// Returns the largest |q - target| of a joint (rad or m).
double find_joint_error(const TrackingResult& result, std::size_t joint) {
  double largest = 0;
  for (const TrajectorySample& sample : result.trajectory) {
    largest = std::max(largest, std::abs(sample.q[joint] - sample.target_q[joint]));
  }
  return largest;
}

json make_following(const EvaluatedDesign& evaluated) {
  const Following& following = *evaluated.following;
  const RobotModel& robot = evaluated.problem.tracking()->config().robot;
  json joints = json::array();
  for (std::size_t i = 0; i < following.result.peak_effort.size(); ++i) {
    joints.push_back({{"joint", sanitize(robot.joints[i].name)},
                      {"largest_error", find_joint_error(following.result, i)},
                      {"peak_effort", following.result.peak_effort[i]},
                      {"saturated_share", following.result.saturated_share[i]}});
  }
  return {{"joints", std::move(joints)},
          {"mean_error_without_limits_m", to_json_value(following.error_without_limits_m)}};
}

std::string format_following(const EvaluatedDesign& evaluated, const Style& style) {
  const Following& following = *evaluated.following;
  const RobotModel& robot = evaluated.problem.tracking()->config().robot;
  Table table({{"joint", false}, {"largest error"}, {"peak effort"}, {"at its limit"}});
  for (std::size_t i = 0; i < following.result.peak_effort.size(); ++i) {
    const Joint& joint = robot.joints[i];
    const bool turns = joint.kind == JointKind::revolute;
    table.add_row({sanitize(joint.name),
                   format_quantity(find_joint_error(following.result, i), turns ? "rad" : "m"),
                   format_quantity(following.result.peak_effort[i], get_effort_unit(joint.kind)),
                   fmt::format("{:.3g} %", 100 * following.result.saturated_share[i])});
  }
  std::string text = style.bold("How the joints follow the motion") + "\n" + table.format(style, 2);
  const auto error_m = get_error(following.result);
  if (error_m && following.error_without_limits_m) {
    text += fmt::format(
        "\n  Without effort limits the error would be {} mm, so the limits cost {} mm.\n",
        format_mm(*following.error_without_limits_m),
        format_mm(*error_m - *following.error_without_limits_m));
  }
  return text;
}

std::string format_json(const EvaluatedDesign& evaluated) {
  json cases = json::array();
  for (std::size_t i = 0; i < evaluated.evaluation.results.size(); ++i) {
    const TrackingResult& result = evaluated.evaluation.results[i];
    json one = {{"case", i},
                {"status", to_string(result.status)},
                {"mean_error_m", to_json_value(get_error(result))},
                {"point_error_m", json::array()},
                {"energy_j",
                 to_json_value(get_error(result) ? std::optional(result.energy_j) : std::nullopt)}};
    for (const double error : result.point_error_m) {
      one["point_error_m"].push_back(to_json_value(error));
    }
    if (!result.reason.empty()) {
      one["reason"] = sanitize(result.reason);
    }
    cases.push_back(std::move(one));
  }
  const DesignEvaluation& evaluation = evaluated.evaluation;
  json summary = {
      {"design", sanitize(evaluated.design.name)},
      {"problem", sanitize(evaluated.problem.name)},
      {"test_set", sanitize(evaluated.cases.set.name())},
      {"cases", evaluation.summary.cases},
      {"mean_error_m", to_json_value(evaluation.summary.mean)},
      {"median_error_m", to_json_value(evaluation.summary.median)},
      {"percentile_95_error_m", to_json_value(evaluation.summary.percentile_95)},
      {"worst_error_m", to_json_value(evaluation.summary.worst)},
      {"failures", evaluation.summary.failures},
      {"without_number", evaluation.summary.without_number},
      {"total_torque_n_m", to_json_value(evaluation.efforts.torque_n_m)},
      {"mean_energy_j", to_json_value(evaluation.mean_energy_j)},
  };
  add_motion(evaluation.motion, evaluation.efforts, summary);
  json all = {{"cases", cases}, {"summary", summary}};
  if (evaluated.following) {
    all["motion"] = make_following(evaluated);
  }
  if (!evaluated.requirements.empty()) {
    all["requirements"] = requirements_to_json(evaluated.requirements);
  }
  return all.dump(1) + "\n";
}

std::string format_csv(const DesignEvaluation& evaluation) {
  std::size_t points = 0;
  for (const TrackingResult& result : evaluation.results) {
    points = std::max(points, result.point_error_m.size());
  }
  std::string text = "case,status,mean_error_m,energy_j";
  for (std::size_t k = 1; k <= points; ++k) {
    text += fmt::format(",point_{}_error_m", k);
  }
  text += '\n';
  for (std::size_t i = 0; i < evaluation.results.size(); ++i) {
    const TrackingResult& result = evaluation.results[i];
    const auto error = get_error(result);
    text +=
        fmt::format("{},{},{},{}", i, to_string(result.status), error ? format_exact(*error) : "",
                    error ? format_exact(result.energy_j) : "");
    for (std::size_t k = 0; k < points; ++k) {
      const bool known = k < result.point_error_m.size() && std::isfinite(result.point_error_m[k]);
      text += fmt::format(",{}", known ? format_exact(result.point_error_m[k]) : "");
    }
    text += '\n';
  }
  return text;
}

// Returns a table of the error against the length of the move. Short moves are slow and end with
// smaller errors.
std::string format_profile(const EvaluatedDesign& evaluated, const Style& style) {
  struct Class {
    double upper_m;
    double sum_m = 0;
    double worst_m = 0;
    int points = 0;
  };
  std::array<Class, 6> classes{{{0.1}, {0.2}, {0.4}, {0.8}, {1.2}, {HUGE_VAL}}};
  const bool skip_first = !evaluated.problem.tracking()->config().task.count_first_point;
  for (std::size_t i = 0; i < evaluated.evaluation.results.size(); ++i) {
    const auto& errors_m = evaluated.evaluation.results[i].point_error_m;
    const auto points_m = evaluated.cases.set.make_case(i).points_m;
    for (std::size_t k = skip_first ? 2 : 1; k <= errors_m.size(); ++k) {
      const double error_m = errors_m[k - 1];
      if (!std::isfinite(error_m)) {
        continue;
      }
      const double move_m = (points_m[k] - points_m[k - 1]).norm();
      Class& its = *std::find_if(classes.begin(), classes.end(),
                                 [&](const Class& c) { return move_m < c.upper_m; });
      its.sum_m += error_m;
      its.worst_m = std::max(its.worst_m, error_m);
      ++its.points;
    }
  }
  Table table({{"move", false}, {"points"}, {"mean error"}, {"worst"}});
  double lower_m = 0;
  for (const Class& c : classes) {
    const double from_m = std::exchange(lower_m, c.upper_m);
    if (c.points == 0) {
      continue;
    }
    table.add_row({std::isinf(c.upper_m) ? fmt::format("{:.1f} m and more", from_m)
                                         : fmt::format("{:.1f} to {:.1f} m", from_m, c.upper_m),
                   fmt::format("{}", c.points), format_mm(c.sum_m / c.points) + " mm",
                   format_mm(c.worst_m) + " mm"});
  }
  return table.format(style, 2);
}

std::string format_text(const EvaluatedDesign& evaluated, const Style& style) {
  const DesignEvaluation& evaluation = evaluated.evaluation;
  const ErrorSummary& summary = evaluation.summary;
  std::string text =
      style.bold(fmt::format("{} on {}: the first {} of {}", sanitize(evaluated.design.name),
                             sanitize(evaluated.problem.name), format_count(summary.cases, "case"),
                             sanitize(evaluated.cases.set.name())));
  text += "\n\n";
  Table table = make_summary_table(summary, evaluation.motion);
  add_efforts(evaluation.efforts, table);
  table.add_row({"mean energy",
                 evaluation.mean_energy_j ? format_quantity(*evaluation.mean_energy_j, "J") : "-"});
  text += table.format(style, 2) + "\n";
  if (!evaluated.requirements.empty()) {
    text += format_requirements(evaluated.requirements, style) + "\n";
  }
  if (evaluated.following) {
    return text + format_following(evaluated, style);
  }
  return text + style.bold("Error against the length of the move") + "\n" +
         format_profile(evaluated, style);
}

bool is_arm_design(const std::string& design) {
  try {
    load_design(design);
    return true;
  } catch (const Error&) {
    return false;
  }
}

// Returns the problem if its designs are values of variables: one of the user's own, or a planned
// motion.
std::optional<LoadedProblem> load_own_problem(const EvaluateOptions& options) {
  if (options.problem.empty() || !options.overrides.robot.empty()) {
    return std::nullopt;
  }
  try {
    LoadedProblem problem = load_problem(options.problem, options.overrides.get());
    if (has_values(*problem.problem)) {
      return problem;
    }
  } catch (const Error&) {
    // The design may supply what an arm's problem lacks; load_design_and_problem() says more.
    if (!is_arm_design(options.design)) {
      throw;
    }
  }
  return std::nullopt;
}

// Simulates the design on the motion, and likewise with motors that are not limited.
Following follow(const TrackingProblem& problem, const ArmDesign& design, const TestSet& motion) {
  Following following{.result = problem.track(design, motion, 0, {.trajectory = true}),
                      .error_without_limits_m = std::nullopt};
  ArmDesign strong = design;
  constexpr double kStronger = 1e6;
  for (JointDrive& drive : strong.joints) {
    drive.limits.min *= kStronger;
    drive.limits.max *= kStronger;
  }
  following.error_without_limits_m = get_error(problem.track(strong, motion, 0));
  return following;
}

int run_evaluate(const EvaluateOptions& options, Session& session) {
  if (options.trajectory.empty() != options.trajectory_case.empty()) {
    throw Error(
        ErrorKind::usage,
        "--trajectory FILE and --trajectory-case N must be given together: the file holds the "
        "trajectory of one case");
  }
  if (options.json + (options.csv == "-") + (options.trajectory == "-") > 1) {
    throw Error(ErrorKind::usage,
                "only one of --json, --csv - and --trajectory - can write to standard output");
  }
  const unsigned jobs = parse_jobs(options.jobs);
  if (const auto own = load_own_problem(options)) {
    if (!options.csv.empty() || !options.trajectory.empty() || !options.motion.empty() ||
        !options.cases.test_cases.empty()) {
      throw Error(
          ErrorKind::usage,
          "--csv, --trajectory, --motion and --test-cases are for arms; use --json for a problem "
          "without an arm");
    }
    return evaluate_own(*own,
                        {.design = options.design,
                         .cases = options.cases.cases,
                         .test_set = options.cases.test_set,
                         .jobs = jobs,
                         .json = options.json,
                         .quiet = options.quiet},
                        session);
  }
  auto [design, problem] =
      load_design_and_problem(options.design, options.overrides.choose_problem(options.problem),
                              options.overrides.get(), options.quiet);
  const TrackingProblem& tracking = require_tracking(problem);
  tracking.check_design(design.design);
  if (!options.motion.empty() && !(options.cases.test_cases.empty() &&
                                   options.cases.test_set.empty() && options.cases.cases.empty())) {
    throw Error(
        ErrorKind::usage,
        "--motion FILE is the one test case; leave out --test-cases, --test-set and --cases");
  }
  ChosenCases cases =
      options.motion.empty()
          ? choose_cases(problem, options.cases)
          : ChosenCases{TestSet::make_repeated(
                            "the motion " + sanitize(options.motion),
                            read_motion_case(options.motion, tracking.make_robot(design.design),
                                             tracking.make_task(design.design))),
                        1};
  cases.motion = options.motion.empty();
  std::uint64_t traced = 0;
  if (!options.trajectory.empty()) {
    const auto most = static_cast<std::int64_t>(cases.set.size().value_or(1'000'000'000)) - 1;
    traced = static_cast<std::uint64_t>(
        parse_count("--trajectory-case", options.trajectory_case, 0, most));
  }

  const std::vector<std::string> notes = check_paths(problem);
  if (!options.quiet) {
    std::ranges::for_each(notes, write_message);
  }
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  auto evaluation = evaluate_with_progress(tracking, design.design, cases, jobs, session.stop, bar,
                                           {.total = cases.count});
  bar.clear();
  if (!evaluation) {
    write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  report_failures(list_failures(evaluation->results), "");
  auto requirements = judge_evaluation(tracking, *evaluation);
  EvaluatedDesign evaluated{std::move(design),      std::move(problem),      std::move(cases),
                            std::move(*evaluation), std::move(requirements), std::nullopt};
  if (!options.motion.empty()) {
    evaluated.following = follow(tracking, evaluated.design.design, evaluated.cases.set);
  }
  if (!options.csv.empty()) {
    write_output(options.csv, format_csv(evaluated.evaluation));
  }
  if (!options.trajectory.empty()) {
    const TrackingResult result =
        tracking.track(evaluated.design.design, evaluated.cases.set, traced, {.trajectory = true});
    write_output(options.trajectory, make_trajectory_csv(tracking, result));
  }
  if (options.json) {
    write_stdout(format_json(evaluated));
  } else if (options.csv != "-" && options.trajectory != "-") {
    write_stdout(format_text(evaluated, make_style(Stream::out, session.color)));
  }
  const bool failed = evaluated.evaluation.summary.without_number > 0 ||
                      is_constraint_missed(evaluated.requirements);
  return failed ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace

void add_evaluate(CLI::App& app, Session& session) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command =
      add_command(app, session, "evaluate", "Evaluate a design on test cases, without optimization",
                  kEvaluateExamples);
  add_design_argument(*command, options->design);
  command
      ->add_option("--problem,-p", options->problem,
                   "The problem, with its robot, task and physics (default: the one that the\n"
                   "design was published for, or 'robot' with --robot; otherwise required)")
      ->type_name("PROBLEM");
  options->overrides.add_to(*command);
  options->cases.add_to(*command);
  add_jobs_flag(*command, options->jobs);
  command
      ->add_option("--motion", options->motion,
                   "Follow this motion in place of test cases: motion.csv or trajectory.yaml of a\n"
                   "run that planned one, or a JointTrajectory of ROS 2 (YAML)")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print everything as JSON")->group("Output");
  command->add_option("--csv", options->csv, "Write one line per case; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--trajectory", options->trajectory,
                   "Write joint positions, efforts and tip positions of one case over time, as\n"
                   "CSV")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--trajectory-case,--case", options->trajectory_case,
                   "The number of the case for --trajectory, from 0")
      ->type_name("N")
      ->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_evaluate(*options, session); };
  });
}

}  // namespace armwright
