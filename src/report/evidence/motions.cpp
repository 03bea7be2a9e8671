#include "report/evidence/motions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "sim/tracking/designed_arm.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json make_point(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

void append(std::vector<float>& all, std::span<const double> values) {
  for (const double value : values) {
    all.push_back(static_cast<float>(value));
  }
}

// A diverged simulation stops at the first state that is out of bounds. The state of its last step
// may already have no number.
bool is_drawable(const TrajectorySample& sample) {
  const auto fits = [](double value) { return std::isfinite(static_cast<float>(value)); };
  return std::ranges::all_of(sample.q, fits) && std::ranges::all_of(sample.effort, fits) &&
         fits((sample.tip_m - sample.target_m).norm());
}

json make_motion(const std::string& design, const TrackingResult& result) {
  std::vector<float> q, effort, error;
  std::size_t steps = 0;
  for (const TrajectorySample& sample : result.trajectory) {
    if (!is_drawable(sample)) {
      break;
    }
    append(q, sample.q);
    append(effort, sample.effort);
    error.push_back(static_cast<float>(result.error_series_m[steps]));
    ++steps;
  }
  const bool has_error = result.status == SimulationStatus::ok;
  return {{"design", design},
          {"status", to_string(result.status)},
          {"reason", result.reason},
          {"steps", steps},
          {"mean_error_m", has_error ? finite_or_null(result.mean_error_m) : json(nullptr)},
          {"point_error_m", finite_or_null(result.point_error_m)},
          {"q", pack_f32(q)},
          {"effort", pack_f32(effort)},
          {"error_m", pack_f32(error)}};
}

json make_segment(const Segment& segment) {
  return {{"first_step", segment.first_step},
          {"steps", segment.steps},
          {"window_start", segment.window_start},
          {"distance_m", (segment.to_m - segment.from_m).norm()},
          {"duration_s", segment.duration_s}};
}

const TrackingProblem& get_problem(const TrackingProblem& problem, const NamedDesign& design) {
  return design.problem != nullptr ? *design.problem : problem;
}

bool is_same_arm(const ArmDesign& a, const ArmDesign& b) {
  return std::ranges::equal(a.joints, b.joints, [](const JointDrive& one, const JointDrive& other) {
    return one.length_scale == other.length_scale && one.section_scale == other.section_scale &&
           one.tube == other.tube;
  });
}

bool is_same_motion(const TrackingProblem& problem, const NamedDesign& a, const NamedDesign& b) {
  const TrackingTask task_of_a = get_problem(problem, a).make_task(a.design);
  const TrackingTask task_of_b = get_problem(problem, b).make_task(b.design);
  return is_same_arm(a.design, b.design) && task_of_a.speed_m_per_s == task_of_b.speed_m_per_s &&
         task_of_a.control_period_s == task_of_b.control_period_s;
}

json make_case(const TrackingSetup& setup, const ReplayRequest& request) {
  const TestCase test_case = request.set.make_case(request.number);
  const TargetTable targets = setup.make_targets(test_case);
  json points = json::array();
  for (const Eigen::Vector3d& point : test_case.points_m) {
    points.push_back(make_point(point));
  }
  json segments = json::array();
  std::vector<float> target, target_q;
  for (const Segment& segment : targets.segments) {
    segments.push_back(make_segment(segment));
    for (int step = 0; step < segment.steps; ++step) {
      const Eigen::Vector3d place = setup.calc_target_position(segment, step);
      append(target, {place.data(), 3});
    }
  }
  append(target_q, targets.joint_positions);  // empty if a target is out of reach
  return {{"id", make_case_id(request.set.name(), request.number)},
          {"label", request.label},
          {"set", request.set.name()},
          {"number", request.number},
          {"points_m", std::move(points)},
          {"segments", std::move(segments)},
          {"steps", targets.steps},
          {"target_m", pack_f32(target)},
          {"target_q", pack_f32(target_q)},
          {"start_q", finite_or_null(targets.start_positions)},
          {"motions", json::array()}};
}

}  // namespace

std::string make_case_id(const std::string& set, std::uint64_t number) {
  return fmt::format("{}:{}", set, number);
}

void ReplayList::add(const std::string& set, std::uint64_t number, const std::string& reason) {
  const auto is_it = [&](const ReplayRequest& request) {
    return request.number == number && request.set.name() == set;
  };
  if (std::ranges::none_of(requests_, is_it)) {
    requests_.push_back({problem_.get_set(set), number,
                         fmt::format("{}, case {}: {}", sanitize(set), number, reason)});
  }
}

void ReplayList::add(const std::string& case_id, const std::string& reason) {
  const auto colon = case_id.rfind(':');
  const std::string set = case_id.substr(0, std::min(colon, case_id.size()));
  constexpr long long kMost = 1'000'000'000;
  const long long number =
      colon == std::string::npos ? -1 : parse_integer(case_id.substr(colon + 1)).value_or(-1);
  if (set.find('/') == std::string::npos || set.front() == '/' || set.back() == '/' || number < 0 ||
      number > kMost) {
    throw Error(ErrorKind::usage,
                fmt::format("case '{}' is not valid: it must be SET:NUMBER with the name of a set "
                            "of test cases and a number from 0, such as test/2:17",
                            sanitize(case_id)));
  }
  add(set, static_cast<std::uint64_t>(number), reason);
}

std::size_t find_worst_case(std::span<const double> errors) {
  const auto worst = std::ranges::max_element(errors, {}, [](double error) {
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
  });
  return static_cast<std::size_t>(worst - errors.begin());
}

json make_design_info(const NamedDesign& design, const RobotModel& robot) {
  const EffortTotals efforts = calc_effort_totals(design.design, robot);
  json limits = json::array();
  for (const JointDrive& joint : design.design.joints) {
    limits.push_back({finite_or_null(joint.limits.min), finite_or_null(joint.limits.max)});
  }
  return {{"id", design.id},
          {"name", design.name},
          {"total_torque_n_m", finite_or_null(efforts.torque_n_m)},
          {"total_force_n", finite_or_null(efforts.force_n)},
          {"effort_limits", std::move(limits)}};
}

json make_task_info(const TrackingTask& task) {
  return {{"signal", signal_names()[static_cast<std::size_t>(task.signal)]},
          {"speed_m_per_s", task.speed_m_per_s},
          {"distance_limit_m", task.distance_limit_m},
          {"rest_s", task.rest_s},
          {"control_period_s", task.control_period_s},
          {"load_kg", task.load_kg},
          {"ik_bug", task.ik_bug}};
}

std::vector<std::vector<NamedDesign>> divide_by_motion(const TrackingProblem& problem,
                                                       std::span<const NamedDesign> designs) {
  std::vector<std::vector<NamedDesign>> groups;
  for (const NamedDesign& design : designs) {
    const auto group = std::ranges::find_if(groups, [&](const std::vector<NamedDesign>& known) {
      return is_same_motion(problem, known.front(), design);
    });
    if (group == groups.end()) {
      groups.push_back({design});
    } else {
      group->push_back(design);
    }
  }
  return groups;
}

ReplayText make_group_text(ReplayText text, std::span<const std::vector<NamedDesign>> groups,
                           std::size_t group) {
  if (groups.size() > 1) {
    std::vector<std::string> names;
    for (const NamedDesign& design : groups[group]) {
      names.push_back(design.name);
    }
    text.title += ": " + join(names, "; ");
  }
  if (group > 0) {
    text.id += fmt::format("-{}", group + 1);
  }
  return text;
}

RobotModel make_shown_arm(const TrackingProblem& problem, const NamedDesign& design) {
  return make_robot(problem.config().robot, design.design, 0);
}

json make_replay_set(PageSimulator& simulator, const TrackingProblem& problem,
                     const ReplayText& text, std::size_t robot,
                     std::span<const NamedDesign> designs, std::span<const ReplayRequest> cases) {
  const TrackingProblem& first_problem = get_problem(problem, designs.front());
  const auto setup = first_problem.get_setup(designs.front().design);
  std::vector<json> motions(designs.size() * cases.size());
  simulator.run(motions.size(), [&](std::size_t i) {
    const NamedDesign& design = designs[i % designs.size()];
    const ReplayRequest& one = cases[i / designs.size()];
    const TrackingResult result =
        get_problem(problem, design)
            .track(design.design, one.set, one.number, {.error_series = true, .trajectory = true});
    motions[i] = make_motion(design.id, result);
  });
  json list = json::array();
  for (const NamedDesign& design : designs) {
    list.push_back(make_design_info(design, first_problem.config().robot));
  }
  json replayed = json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    json& one = replayed.emplace_back(make_case(*setup, cases[i]));
    for (std::size_t k = 0; k < designs.size(); ++k) {
      one["motions"].push_back(std::move(motions[i * designs.size() + k]));
    }
  }
  return {{"id", text.id},
          {"title", text.title},
          {"robot", robot},
          {"task", make_task_info(first_problem.make_task(designs.front().design))},
          {"designs", std::move(list)},
          {"cases", std::move(replayed)}};
}

json make_given_replay_set(const ReplayText& text, const std::string& design, std::size_t robot,
                           const TrackingTask& task, const json& effort_limits,
                           std::span<const GivenMotion> motions) {
  const std::size_t joints = effort_limits.size();
  const json nothing = pack_f32({});
  json cases = json::array();
  for (const GivenMotion& motion : motions) {
    const std::size_t steps = motion.q.size() / joints - 1;
    const auto after_start = [&](const std::vector<float>& values) {
      return pack_f32(std::span(values).subspan(joints));
    };
    const json moved = {{"design", text.id},
                        {"status", "ok"},
                        {"reason", ""},
                        {"steps", steps},
                        {"mean_error_m", nullptr},
                        {"point_error_m", json::array()},
                        {"q", after_start(motion.q)},
                        {"effort", after_start(motion.effort)},
                        {"error_m", nothing}};
    cases.push_back(
        {{"id", motion.id},
         {"label", motion.label},
         {"set", motion.set},
         {"number", 0},
         {"points_m", json::array()},
         {"segments", json::array()},
         {"steps", steps},
         {"target_m", nothing},
         {"target_q", nothing},
         {"start_q", std::vector<float>(motion.q.begin(),
                                        motion.q.begin() + static_cast<std::ptrdiff_t>(joints))},
         {"motions", {moved}}});
  }
  return {{"id", text.id},
          {"title", text.title},
          {"robot", robot},
          {"task", make_task_info(task)},
          {"designs",
           {{{"id", text.id},
             {"name", design},
             {"total_torque_n_m", nullptr},
             {"total_force_n", nullptr},
             {"effort_limits", effort_limits}}}},
          {"cases", std::move(cases)}};
}

}  // namespace armwright
