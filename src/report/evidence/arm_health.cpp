// Makes the health card of a winner from its results on the test set and its motion on one case.

#include <algorithm>
#include <cmath>

#include "report/evidence/arm_evidence.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/evidence/health.hpp"
#include "report/evidence/page_json.hpp"
#include "sim/tracking/response.hpp"
#include "study/statistics/summary.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright {
namespace {

using nlohmann::json;

json grade_or_null(const std::optional<double>& share, const HealthLimits& limits) {
  return share ? json(to_string(grade(*share, limits))) : json(nullptr);
}

// Returns the efforts of one joint as far as all of them are finite. The last row of a diverged
// simulation may have no numbers.
std::vector<double> list_efforts(const TrackingResult& motion, std::size_t joint) {
  std::vector<double> efforts;
  for (const TrajectorySample& sample : motion.trajectory) {
    if (!std::isfinite(sample.effort[joint])) {
      break;
    }
    efforts.push_back(sample.effort[joint]);
  }
  return efforts;
}

json make_joints(const RobotModel& robot, const ArmDesign& design, const ShownDesign& winner,
                 const TrackingResult& motion, double period_s) {
  const std::vector<double> saturation = calc_saturation(winner.results);
  json joints = json::array();
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    const JointDrive& drive = design.joints[i];
    const std::vector<double> efforts = list_efforts(motion, i);
    const auto ripple = calc_ripple(efforts, period_s);
    const double limit = calc_largest_effort(drive);
    std::optional<double> saturated;
    std::optional<double> ripple_share;
    if (!saturation.empty()) {
      saturated = saturation[i];
    }
    if (ripple && limit > 0) {
      ripple_share = ripple->rms / limit;
    }
    joints.push_back(
        {{"name", robot.joints[i].name},
         {"unit", robot.joints[i].kind == JointKind::prismatic ? "N" : "N m"},
         {"saturated_share", finite_or_null(saturated)},
         {"saturation", grade_or_null(saturated, kSaturationLimits)},
         {"ripple_rms", ripple ? finite_or_null(ripple->rms) : json(nullptr)},
         {"ripple_share", finite_or_null(ripple_share)},
         {"ripple_hz", ripple && ripple->rms > 0 ? json(ripple->frequency_hz) : json(nullptr)},
         {"ripple", grade_or_null(ripple_share, kRippleLimits)},
         {"used_share",
          finite_or_null(calc_used_effort(efforts, drive.limits.min, drive.limits.max))}});
  }
  return joints;
}

// Returns the response of the tip to the moves that count in the case's error; null if there are
// none.
json make_moves(const TrackingTask& task, const TargetTable& targets,
                const TrackingResult& motion) {
  std::vector<double> overshoots;
  std::vector<double> settling_s;
  int unsettled = 0;
  for (std::size_t k = task.count_first_point ? 0 : 1; k < targets.segments.size(); ++k) {
    if (const auto move = find_tip_move(targets, k, motion.tips_m, task.control_period_s)) {
      overshoots.push_back(calc_overshoot(*move));
      const double band_m = kSettlingBandShare * move->length_m;
      settling_s.push_back(calc_settling_time_s(*move, band_m));
      unsettled += move->away_m.back() <= band_m ? 0 : 1;
    }
  }
  if (overshoots.empty()) {
    return nullptr;
  }
  return {{"count", overshoots.size()},
          {"overshoot_median", finite_or_null(calc_spread(overshoots).median)},
          {"overshoot_largest", finite_or_null(std::ranges::max(overshoots))},
          {"settling_median_s", finite_or_null(calc_spread(settling_s).median)},
          {"settling_largest_s", finite_or_null(std::ranges::max(settling_s))},
          {"settling_band", kSettlingBandShare},
          {"unsettled", unsettled}};
}

// Returns the variables near a bound, the nearest one first; if there are none, the nearest one.
json make_bounds(const ProblemDescription& description, const std::vector<double>& x) {
  const std::vector<VariablePlace> places = list_bound_places(description.variables, x);
  const auto near = static_cast<std::size_t>(std::ranges::count_if(
      places, [](const VariablePlace& place) { return place.to.distance <= kNearBound; }));
  json list = json::array();
  for (std::size_t i = 0; i < std::min(places.size(), std::max<std::size_t>(near, 1)); ++i) {
    list.push_back({{"name", description.variables[places[i].variable].name},
                    {"bound", places[i].to.is_upper ? "upper" : "lower"},
                    {"distance", places[i].to.distance}});
  }
  return {{"grade", to_string(near > 0 ? HealthGrade::watch : HealthGrade::good)},
          {"near", near},
          {"nearest", std::move(list)}};
}

// Returns which constraints the winner violates on the test set; null if the problem has none. The
// grade is null if a case without a number leaves it open.
json make_constraints(const RunResult& result) {
  if (result.constraints.empty()) {
    return nullptr;
  }
  const std::vector<std::string> violated = list_violated(result);
  const bool is_known = !violated.empty() || is_proven_feasible(result.test);
  const HealthGrade grade = violated.empty() ? HealthGrade::good : HealthGrade::bad;
  return {{"grade", is_known ? json(to_string(grade)) : json()}, {"violated", violated}};
}

// Returns the grade of a verdict; null if the setting was not simulated.
json grade_verdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return to_string(HealthGrade::good);
    case Verdict::worse:
      return to_string(HealthGrade::watch);
    case Verdict::fails:
      return to_string(HealthGrade::bad);
    case Verdict::missing:
      break;
  }
  return nullptr;
}

// Returns the recorded check of the winner; null if there is none.
json make_check_json(const std::filesystem::path& folder) {
  const auto check = load_check(folder);
  if (!check) {
    return nullptr;
  }
  json settings = json::array();
  for (const CheckedSetting& checked : check->settings) {
    settings.push_back({{"name", checked.name},
                        {"grade", grade_verdict(checked.verdict)},
                        {"outcome", describe_outcome(checked, check->limit_m)},
                        {"mean_m", finite_or_null(checked.summary.mean)},
                        {"reason", checked.fault}});
  }
  return {{"cases", check->own.cases},
          {"own_m", finite_or_null(check->own.mean)},
          {"limit_m", check->limit_m},
          {"settings", std::move(settings)}};
}

}  // namespace

json make_health(const RecordedRun& run, const ShownDesign& winner, PageSimulator& simulator) {
  const TrackingProblem& problem = *run.tracking();
  const ArmDesign& design = winner.named.design;
  const TestSet set = problem.get_set(run.problem->sets.test);
  const std::vector<double> errors = get_case_errors(winner.results);
  const std::size_t number = rank_by_error(errors)[(errors.size() - 1) / 2];
  TrackingResult motion;
  simulator.run(1, [&](std::size_t) {
    motion = problem.track(design, set, number, {.trajectory = true, .motion = true});
  });
  const auto setup = problem.get_setup(design);
  const TargetTable targets = setup->make_targets(set.make_case(number));
  const TrackingTask task = problem.make_task(design);
  const std::uint64_t failures = summarize_cases(winner.results).failures;
  return {
      {"set", set.name()},
      {"cases", errors.size()},
      {"case", make_case_id(set.name(), number)},
      {"failures", failures},
      {"failing", to_string(failures > 0 ? HealthGrade::bad : HealthGrade::good)},
      {"constraints", make_constraints(*run.result)},
      {"ripple_floor_hz", kRippleFloor_hz},
      {"limits",
       {{"saturation", {kSaturationLimits.watch, kSaturationLimits.bad}},
        {"ripple", {kRippleLimits.watch, kRippleLimits.bad}},
        {"bound", kNearBound}}},
      {"joints",
       make_joints(problem.config().robot, design, winner, motion, task.control_period_s)},
      {"moves", make_moves(task, targets, motion)},
      {"bounds", make_bounds(run.describe(), run.find_best())},
      {"check", make_check_json(run.folder)},
  };
}

}  // namespace armwright
