// Makes the part of a run's page that shows an identification: the robot's parameters, the recorded
// efforts beside those of the models, and the arm as it was recorded. All numbers are those of
// identification.json. The logs are not read again.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <span>
#include <stdexcept>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/robot_scene.hpp"
#include "report/page/run_parts.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kRecordedDesign = "recorded";

// A motion of identification.json: numbers in rows, one column per joint.
struct RecordedMotion {
  std::string id, log;
  bool is_held_back = false;
  std::size_t rows = 0;
  std::size_t joints = 0;
  double period_s = 0;
  std::vector<float> positions = {}, recorded = {}, before = {}, after = {};
};

// A log is a file, whose folder says nothing to a reader.
std::string name_log(const json& log) {
  return std::filesystem::path(log.get<std::string>()).filename().string();
}

json name_logs(json set) {
  for (json& log : set.at("logs")) {
    log = name_log(log);
  }
  return set;
}

float read_value(const json& value) {
  return value.is_null() ? std::numeric_limits<float>::quiet_NaN() : value.get<float>();
}

// Returns lists of one joint each as rows. Throws std::length_error if their lengths differ.
std::vector<float> read_rows(const json& lists, std::size_t rows) {
  const std::size_t joints = lists.size();
  std::vector<float> values(rows * joints);
  for (std::size_t i = 0; i < joints; ++i) {
    if (lists[i].size() != rows) {
      throw std::length_error(fmt::format("a joint has {} of {} samples", lists[i].size(), rows));
    }
    for (std::size_t k = 0; k < rows; ++k) {
      values[k * joints + i] = read_value(lists[i][k]);
    }
  }
  return values;
}

RecordedMotion read_motion(const json& motion, std::size_t index, std::size_t fitted,
                           std::size_t joints) {
  const json& times = motion.at("times_s");
  RecordedMotion read{.id = fmt::format("log-{}", index + 1),
                      .log = name_log(motion.at("log")),
                      .is_held_back = index >= fitted,
                      .rows = times.size(),
                      .joints = joints};
  if (read.rows > 1) {
    read.period_s = times.back().get<double>() / static_cast<double>(read.rows - 1);
  }
  const std::pair<const char*, std::vector<float>*> columns[] = {{"positions", &read.positions},
                                                                 {"recorded", &read.recorded},
                                                                 {"model_before", &read.before},
                                                                 {"model_after", &read.after}};
  for (const auto& [key, values] : columns) {
    *values = read_rows(motion.at(key), read.rows);
    if (values->size() != read.rows * joints || read.rows < 2 || !(read.period_s > 0)) {
      throw std::length_error(fmt::format("the motion '{}' has no {}", sanitize(read.log), key));
    }
  }
  return read;
}

json write_motion(const RecordedMotion& motion) {
  return {{"id", motion.id},
          {"log", motion.log},
          {"held_back", motion.is_held_back},
          {"period_s", motion.period_s},
          {"recorded", pack_f32(motion.recorded)},
          {"before", pack_f32(motion.before)},
          {"after", pack_f32(motion.after)}};
}

// Returns the rows at multiples of `period_s`, straight between those of the motion.
std::vector<float> resample(const RecordedMotion& motion, const std::vector<float>& values,
                            double period_s, std::size_t rows) {
  std::vector<float> all;
  for (std::size_t k = 0; k < rows; ++k) {
    const double place = std::min(static_cast<double>(k) * period_s / motion.period_s,
                                  static_cast<double>(motion.rows - 1));
    const auto whole = std::min(static_cast<std::size_t>(place), motion.rows - 2);
    const auto share = static_cast<float>(place - static_cast<double>(whole));
    for (std::size_t i = 0; i < motion.joints; ++i) {
      const float a = values[whole * motion.joints + i];
      const float b = values[(whole + 1) * motion.joints + i];
      all.push_back(a + share * (b - a));
    }
  }
  return all;
}

GivenMotion make_recorded_motion(const RecordedMotion& motion, double period_s) {
  const double duration_s = motion.period_s * static_cast<double>(motion.rows - 1);
  const std::size_t rows = static_cast<std::size_t>(duration_s / period_s + 1e-6) + 1;
  return {.id = motion.id,
          .label = fmt::format("{}, {}", motion.log, motion.is_held_back ? "held back" : "fitted"),
          .set = "logs",
          .q = resample(motion, motion.positions, period_s, rows),
          .effort = resample(motion, motion.recorded, period_s, rows)};
}

// Adds the arm and its recorded motions, or a note if its file is gone. All cases of a replay have
// one period: the shortest.
void add_recorded_replay(const RecordedRun& run, const std::vector<RecordedMotion>& motions,
                         json& page, std::vector<std::string>& notes) {
  RobotModel robot;
  try {
    robot = run.load_robot();
  } catch (const std::exception& error) {  // the configuration may be of any kind
    notes.push_back(fmt::format("The arm is not shown, because its file cannot be read ({}).",
                                sanitize(error.what())));
    return;
  }
  if (motions.empty() || robot.joint_count() != motions.front().joints) {
    notes.push_back("The arm is not shown, because its file has other joints than the logs.");
    return;
  }
  TrackingTask task;
  task.control_period_s =
      std::ranges::min_element(motions, {}, &RecordedMotion::period_s)->period_s;
  json limits = json::array();
  for (const Joint& joint : robot.joints) {
    limits.push_back({finite_or_null(-joint.effort_limit), finite_or_null(joint.effort_limit)});
  }
  const std::size_t index =
      add_robot(robot, task, run.find_urdf().parent_path(), page["robots"], notes);
  std::vector<GivenMotion> shown;
  for (const bool held_back : {true, false}) {  // readers want to see first what was not fitted
    for (const RecordedMotion& motion : motions) {
      if (motion.is_held_back == held_back) {
        shown.push_back(make_recorded_motion(motion, task.control_period_s));
      }
    }
  }
  page["replays"].push_back(make_given_replay_set({kRecordedDesign, "Recorded motions"},
                                                  "as recorded", index, task, limits, shown));
}

std::string join_logs(const json& set) {
  return sanitize(join(set.at("logs").get<std::vector<std::string>>(), ", "));
}

void add_parts(const RecordedRun& run, const json& found, json& page,
               std::vector<std::string>& notes) {
  const json fitted = name_logs(found.at("fitted"));
  const json held_back = found.contains("held_back") ? name_logs(found["held_back"]) : json();
  std::vector<RecordedMotion> motions;
  json written = json::array();
  for (const json& motion : found.at("motions")) {
    motions.push_back(
        read_motion(motion, motions.size(), fitted.at("logs").size(), fitted.at("joints").size()));
    written.push_back(write_motion(motions.back()));
  }
  const auto robot = sanitize(found.at("robot").get<std::string>());
  page["title"] = "The plant of " + robot;
  page["subtitle"] = "identified from " + join_logs(fitted) +
                     (held_back.is_null() ? "" : "; held back: " + join_logs(held_back));
  page["identification"] = {{"robot", robot},
                            {"doubts", found.at("doubts")},
                            {"undetermined", found.at("undetermined")},
                            {"parameters", found.at("parameters")},
                            {"correlations", found.at("correlations")},
                            {"fitted", fitted},
                            {"held_back", held_back},
                            {"motions", std::move(written)}};
  add_recorded_replay(run, motions, page, notes);
}

}  // namespace

void add_identification(const RecordedRun& run, json& page, std::vector<std::string>& notes) {
  if (!run.is_identification()) {
    return;
  }
  const auto file = run.folder / kIdentificationFile;
  if (!path_exists(file)) {
    if (run.result && run.result->winner) {
      notes.push_back(fmt::format("{} is missing; the command that began the run makes it again.",
                                  kIdentificationFile));
    }
    return;
  }
  const std::string text = read_checked_json(file, kIdentificationLimit_bytes);
  try {
    add_parts(run, json::parse(text), page, notes);
  } catch (const std::exception& error) {  // of the JSON library, or std::length_error
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not an identification that armwright wrote ({})",
                            sanitize(file.string()), describe_json_error(error.what())));
  }
}

}  // namespace armwright
