// Reads problems of the kind identification.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/plant_file.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/identification/effort_check.hpp"
#include "problems/identification/identification_problem.hpp"
#include "problems/logs/log_samples.hpp"
#include "problems/logs/motion_log.hpp"

namespace armwright {
namespace {

const Setting<std::vector<std::string>> kLogFiles{
    "logs", kNoDefault, "for the kind identification: logs that are fitted, beside this file"};
const Setting<std::vector<std::string>> kLogsHeldBack{"validate", std::vector<std::string>{},
                                                      "logs that are held back and judge the fit"};
}  // namespace

const Setting<std::vector<std::string>> kFitGroups{
    "fit", std::vector<std::string>{"friction", "armature"},
    "what is fitted: friction, stribeck, armature, payload, counterbalance, "
    "counterbalance_slope, stiffness, delay, inertial"};
const Setting<double> kPayloadMass{"payload_kg",
                                   {.lower = 0, .upper = 1e5},
                                   0,
                                   "payload that the robot carried as far as is known; replaces "
                                   "that of the plant's file; 0: none"};
const Setting<std::vector<double>> kPayloadCom{"payload_com_m",
                                               {.lower = -100, .upper = 100},
                                               std::vector<double>{0, 0, 0},
                                               "centre of mass of that payload in the tip's frame"};

namespace {

const Setting<std::vector<std::string>> kLogColumns{
    "columns", std::vector<std::string>{},
    "columns of the logs, each OURS=THEIRS: position_1=q1, time=t"};
const Setting<std::vector<std::string>> kLogUnits{
    "units", std::vector<std::string>{}, "units of the logs, each QUANTITY=UNIT: position=deg"};
const Setting<std::vector<std::string>> kLogRatios{
    "gear_ratios", std::vector<std::string>{},
    "motor angle per joint position, each JOINT=RATIO; for logs with motor torques (default: "
    "gear_ratio of the plant's file)"};
const Setting<std::vector<std::string>> kLogSigns{
    "signs", std::vector<std::string>{}, "joints whose efforts have the other sign, each JOINT=-1"};
const Setting<std::vector<std::string>> kLogJoints{
    "joints", std::vector<std::string>{},
    "names that the logs have for the robot's joints, in the robot's order (default: the robot's)"};
const Setting<std::string> kLogTopic{"topic", "",
                                     "topic of a bag (default: the only one that fits)"};
const Setting<double> kLogCutoff{
    "cutoff_hz",
    {.lower = 0.1, .upper = 1000},
    Conditioning{}.cutoff_hz,
    "positions and efforts are filtered below this frequency, without phase"};
const Setting<double> kLogCut{"cut_s",
                              {.lower = 0, .upper = 1000},
                              Conditioning{}.cut_s,
                              "time that is cut at both ends of a log"};

const Setting<double> kPriorScale{"prior_scale",
                                  {.lower = 0, .upper = 1e6},
                                  1,
                                  "factor on how far the robot's files may be off (armature 30 %, "
                                  "counterbalance 0.2, inertia); 0: "
                                  "they count for nothing"};

LogOptions read_log_options(const ConfigTable& table, const RobotModel& robot) {
  LogOptions options;
  const std::pair<const Setting<std::vector<std::string>>*, const char*> lists[] = {
      {&kLogColumns, "column"},
      {&kLogUnits, "unit"},
      {&kLogRatios, "gear-ratio"},
      {&kLogSigns, "sign"}};
  for (const auto& [setting, word] : lists) {
    for (const std::string& text : table.get(*setting)) {
      const std::size_t at = text.find('=');
      if (at == std::string::npos) {
        table.refuse(*setting, fmt::format("'{}' must be KEY=VALUE", sanitize(text)));
      }
      try {
        set_log_option(options, word, text.substr(0, at), text.substr(at + 1));
      } catch (const Error& error) {
        table.refuse(*setting, error.what());
      }
    }
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    if (joint.plant.gear_ratio > 0 && !options.gear_ratios.contains(fmt::format("{}", i + 1))) {
      options.gear_ratios.try_emplace(joint.name, joint.plant.gear_ratio);
    }
  }
  options.joints = table.get(kLogJoints);
  options.topic = table.get(kLogTopic);
  return options;
}

// Reads the logs of a list and settles their absolute paths.
std::vector<IdentificationConfig::Log> read_logs(const ConfigTable& table,
                                                 const Setting<std::vector<std::string>>& setting,
                                                 const RobotModel& robot, const LogOptions& options,
                                                 const Conditioning& conditioning,
                                                 LoadedProblem& loaded,
                                                 std::vector<std::string>& notes) {
  std::vector<IdentificationConfig::Log> logs;
  std::vector<std::string> settled;
  for (const std::string& name : table.get(setting)) {
    const std::filesystem::path file =
        std::filesystem::absolute(table.file().parent_path() / name).lexically_normal();
    const MotionLog log = read_log(file, robot, options);
    loaded.input_hashes[std::filesystem::path(log.name).filename().string()] = log.sha256;
    logs.push_back({log.name, condition(log, conditioning)});
    for (const auto& its : {log.notes, logs.back().samples.notes}) {
      for (const std::string& note : its) {
        notes.push_back(fmt::format("{}: {}", log.name, note));
      }
    }
    settled.push_back(file.string());
  }
  table.settle(setting, settled);
  return logs;
}

}  // namespace

const SettingTable kIdentificationSettings{
    .key = "identification",
    .settings = {&kLogFiles, &kLogsHeldBack, &kFitGroups, &kLogColumns, &kLogUnits, &kLogRatios,
                 &kLogSigns, &kLogJoints, &kLogTopic, &kLogCutoff, &kLogCut, &kPayloadMass,
                 &kPayloadCom, &kPriorScale}};

std::vector<FitGroup> read_groups(const ConfigTable& table) {
  std::vector<FitGroup> groups;
  for (const std::string& name : table.get(kFitGroups)) {
    const auto at = std::ranges::find(fit_group_names(), name);
    if (at == fit_group_names().end()) {
      table.refuse(kFitGroups, fmt::format("'{}' cannot be fitted; each must be one of {}",
                                           sanitize(name), join(fit_group_names(), ", ")));
    }
    groups.push_back(static_cast<FitGroup>(at - fit_group_names().begin()));
  }
  const auto has = [&](FitGroup group) { return std::ranges::find(groups, group) != groups.end(); };
  if (groups.empty()) {
    table.refuse(kFitGroups, "it must name at least one group");
  }
  if (has(FitGroup::inertial) && has(FitGroup::payload)) {
    table.refuse(kFitGroups,
                 "inertial includes the payload, which is a part of the last link; give one of the "
                 "two");
  }
  if (has(FitGroup::stribeck) && !has(FitGroup::friction)) {
    table.refuse(kFitGroups, "stribeck needs friction");
  }
  return groups;
}

void read_payload(const ConfigTable& table, RobotModel& robot) {
  if (table.has(kPayloadMass)) {
    set_payload(robot, {table.get(kPayloadMass), read_vector(table, kPayloadCom, "x, y and z in m"),
                        Eigen::Matrix3d::Zero()});
  }
}

void load_identification(const ConfigTable& table, LoadedProblem& loaded) {
  IdentificationConfig config;
  config.name = loaded.name;
  config.summary = loaded.title;
  ReadRobot read = read_robot(table.get_table(kRobotSettings), loaded);
  config.robot = std::move(read.robot);
  config.plain = std::move(read.plain);
  const ConfigTable its = table.get_table(kIdentificationSettings);
  read_payload(its, config.robot);
  config.gravity_m_per_s2 =
      read_physics(table.get_table_or_empty(kPhysicsSettings)).gravity_m_per_s2;
  config.groups = read_groups(its);
  config.prior_scale = its.get(kPriorScale);
  const LogOptions options = read_log_options(its, config.robot);
  Conditioning conditioning;
  conditioning.cutoff_hz = its.get(kLogCutoff);
  conditioning.cut_s = its.get(kLogCut);
  config.cutoff_hz = conditioning.cutoff_hz;
  config.fitted =
      read_logs(its, kLogFiles, config.robot, options, conditioning, loaded, config.notes);
  config.held_back =
      read_logs(its, kLogsHeldBack, config.robot, options, conditioning, loaded, config.notes);
  if (config.fitted.empty()) {
    its.refuse(kLogFiles, "it must name at least one log");
  }
  const auto fitted = static_cast<int>(config.fitted.size());
  loaded.sets.validation_cases = fitted;
  loaded.sets.test_cases =
      config.held_back.empty() ? fitted : static_cast<int>(config.held_back.size());
  loaded.sets.training_cases = fitted;
  const auto problem = std::make_shared<IdentificationProblem>(config);
  const std::vector<std::string> faults = find_effort_faults(*problem);
  if (!faults.empty()) {
    throw Error(ErrorKind::bad_data, join(faults, "\n"));
  }
  loaded.problem = problem;
}

}  // namespace armwright
