// Reads problems of the kind excitation.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/identification/excitation_problem.hpp"

namespace armwright {
namespace {

const Setting<std::string> kCriterion{
    "criterion", excitation_criterion_names,
    excitation_criterion_names()[static_cast<std::size_t>(ExcitationConfig{}.criterion)],
    "for the kind excitation: condition (the condition number) or d-optimal (the determinant of "
    "the "
    "information) of what the motion tells"};
const Setting<double> kDuration{
    "duration_s", {.lower = 2, .upper = 600}, ExcitationConfig{}.duration_s, "of the whole motion"};
const Setting<double> kBasePeriod{
    "period_s", {.lower = 0.1, .upper = 600}, ExcitationConfig{}.period_s, "of the first harmonic"};
const Setting<double> kBlend{"blend_s",
                             {.lower = 0.05, .upper = 300},
                             ExcitationConfig{}.blend_s,
                             "time in which the series is blended in at the beginning and out at "
                             "the end, at most half of duration_s"};
const Setting<int> kHarmonics{
    "harmonics", {.lower = 1, .upper = 20}, ExcitationConfig{}.harmonics, "of the Fourier series"};
constexpr Range kShareRange{.lower = 0.01, .upper = 1};
const Setting<double> kPositionShare{
    "position_share", kShareRange, ExcitationConfig{}.position_share,
    "the part of each joint's range that is used; continuous joints have -pi to pi"};
const Setting<double> kSpeedShare{"speed_share", kShareRange, ExcitationConfig{}.speed_share,
                                  "the part of each joint's speed limit that is used"};
const Setting<double> kEffortShare{
    "effort_share", kShareRange, ExcitationConfig{}.effort_share,
    "the part of each joint's effort limit that the inverse dynamics may need"};
const Setting<std::vector<double>> kAccelerations{
    "acceleration_limits",
    {.lower = 0, .upper = 1e6, .lower_open = true},
    std::vector<double>{},
    "largest acceleration in rad/s^2 or m/s^2, one number for all joints or one per joint "
    "(default: "
    "efforts alone limit it)"};
const Setting<double> kExcitationFloor{
    "floor_m",
    {.lower = -1000, .upper = 1000},
    kNoDefault,
    "height in the world below which no link may be (default: there is no floor)"};

// Refuses robots whose limits do not say what motions are allowed.
void check_limits_of(const RobotModel& robot) {
  std::vector<std::string> faults;
  for (const Joint& joint : robot.joints) {
    const auto add = [&](const std::string& what) {
      faults.push_back(fmt::format("joint '{}' {}", sanitize(joint.name), what));
    };
    if (joint.upper - joint.lower <= 0) {
      add(
          fmt::format("has a range of width 0 (lower and upper are {:g}); give it a range, or make "
                      "it a fixed joint",
                      joint.lower));
    }
    if (!std::isfinite(joint.speed_limit)) {
      add("has no speed limit; write its largest speed as velocity=\"...\" into its <limit>");
    }
    if (!std::isfinite(joint.effort_limit)) {
      add("has no effort limit; write what its motor can do as effort=\"...\" into its <limit>");
    }
  }
  if (!faults.empty()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("no motion can be proposed, as its limits are not known: {}",
                            join(faults, "; ")));
  }
}

}  // namespace

const SettingTable kExcitationSettings{
    .key = "excitation",
    .settings = {&kFitGroups, &kCriterion, &kDuration, &kBasePeriod, &kBlend, &kHarmonics,
                 &kPositionShare, &kSpeedShare, &kEffortShare, &kAccelerations, &kExcitationFloor,
                 &kPayloadMass, &kPayloadCom}};

void load_excitation(const ConfigTable& table, LoadedProblem& loaded) {
  ExcitationConfig config;
  config.name = loaded.name;
  config.summary = loaded.title;
  const ConfigTable robot = table.get_table(kRobotSettings);
  config.robot = read_robot(robot, loaded).robot;
  const ConfigTable its = table.get_table_or_empty(kExcitationSettings);
  read_payload(its, config.robot);
  config.gravity_m_per_s2 =
      read_physics(table.get_table_or_empty(kPhysicsSettings)).gravity_m_per_s2;
  config.groups = read_groups(its);
  const double payload_kg = config.robot.payload ? config.robot.payload->mass_kg : 0;
  if (std::ranges::find(config.groups, FitGroup::payload) != config.groups.end() &&
      payload_kg <= 0) {
    its.refuse(
        kFitGroups,
        "the payload is to be fitted, but how heavy it is, is not known even roughly, so that "
        "the motion could overload the arm; state the mass that the robot will carry: "
        "--payload KG, or payload_kg");
  }
  config.criterion = static_cast<ExcitationCriterion>(its.get_choice(kCriterion));
  config.duration_s = its.get(kDuration);
  config.period_s = its.get(kBasePeriod);
  config.blend_s = its.get(kBlend);
  if (config.blend_s > config.duration_s / 2) {
    const std::string most =
        fmt::format("it must be at most half of the duration, {:g} s", config.duration_s / 2);
    if (its.has(kBlend)) {
      its.refuse(kBlend, most);
    }
    config.blend_s = config.duration_s / 2;
  }
  its.settle(kBlend, config.blend_s);
  config.harmonics = its.get(kHarmonics);
  config.position_share = its.get(kPositionShare);
  config.speed_share = its.get(kSpeedShare);
  config.effort_share = its.get(kEffortShare);
  config.acceleration_limits = read_per_joint(its, kAccelerations, config.robot.joint_count());
  config.floor_m = its.find(kExcitationFloor);
  if (config.floor_m) {
    check_floor(its, kExcitationFloor, *config.floor_m, config.robot);
  }
  const std::filesystem::path urdf = resolve_named(robot, kRobotUrdf, "robots");
  config.clearance = read_clearance(table, urdf, false, config.robot, loaded);
  name_robot_file(urdf, [&] {
    check_limits_of(config.robot);
    loaded.problem = std::make_shared<ExcitationProblem>(std::move(config));
  });
}

}  // namespace armwright
