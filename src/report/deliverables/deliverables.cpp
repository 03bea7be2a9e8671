#include "report/deliverables/deliverables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "report/deliverables/ros2_control.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/run_traces.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/urdf_writer.hpp"
#include "sim/tracking/designed_arm.hpp"
#include "study/run/run.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_run(const fs::path& folder, const std::string& what) {
  throw Error(ErrorKind::usage, fmt::format("{}: {}", sanitize(folder.string()), what));
}

void refuse_study(const fs::path& folder, std::string_view format) {
  if (path_exists(folder / "manifest.json") || !path_exists(folder / "cells")) {
    return;
  }
  const FoundRuns found = find_runs(folder);
  const auto run = std::ranges::find_if(
      found.runs, [](const RunEntry& one) { return load_result(one.folder).tracking; });
  refuse_run(
      folder,
      run == found.runs.end()
          ? fmt::format("this is a study of functions; {} needs a run of an arm", format)
          : fmt::format("this is a study; {} needs one run: name the folder of a run, such as {}",
                        format, sanitize(run->folder.string())));
}

// Returns lines that say where the design comes from and how the simulated arm differs from the one
// in the robot's file.
std::vector<std::string> describe_origin(const FinishedArm& arm) {
  const TrackingConfig& config = arm.config();
  const ErrorSummary& test = arm.result().test_summary;
  const bool rests = !config.never_rests();
  std::vector<std::string> lines = {
      fmt::format("Written by armwright {} for the robot {}: {}, a run of {}.", get_version(),
                  sanitize(config.robot.name), arm.describe(), sanitize(arm.run.started)),
      fmt::format("Simulated on {} ({} cases): {}, {} failed.", sanitize(arm.result().test_set),
                  test.cases,
                  test.mean ? fmt::format("mean error {}{:.4g} mm", rests ? "at rest " : "",
                                          kMillimetresPerMetre * *test.mean)
                            : "no mean",
                  test.failures)};
  std::ranges::copy(arm.warnings, std::back_inserter(lines));
  if (arm.starts_held()) {
    lines.emplace_back(
        "The simulated controllers started with integrals that hold the arm against gravity. One "
        "that starts empty sags when it is enabled.");
  }
  if (config.task.load_kg > 0) {
    lines.push_back(fmt::format(
        "The arm carried a load of {:.6g} kg, which its URDF does not have.", config.task.load_kg));
  }
  if (config.mass_scale != 1) {
    lines.push_back(
        fmt::format("Its masses were {:.6g} times those of its URDF.", config.mass_scale));
  }
  if (config.torque_per_mass_n_m_per_kg > 0) {
    lines.push_back(fmt::format("Its motors' masses, {:.6g} N m/kg, came on top of those.",
                                config.torque_per_mass_n_m_per_kg));
  }
  if (is_stretched(arm.design) || has_tubes(arm.design)) {
    lines.push_back(fmt::format(
        "The winner's links are other ones than those of the URDF: these numbers belong to them "
        "({} in winner.toml).",
        has_tubes(arm.design) ? "length_scale, tube_diameter_m and tube_wall_m"
                              : "length_scale and section_scale"));
  }
  return lines;
}

std::string read_urdf_of(const FinishedArm& arm, const fs::path& file) {
  constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;  // as load_urdf()
  std::string xml = read_file(file, kUrdfLimit_bytes);
  const auto& inputs = arm.run.configuration.at("inputs");
  const std::string name = file.filename().string();
  if (!inputs.contains(name) || inputs[name] != calc_sha256_hex(xml)) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format(
            "{}: is not the file that the run used; restore it as it was, or optimize again",
            sanitize(file.string())));
  }
  if (is_mjcf(xml)) {
    refuse_run(arm.run.folder,
               fmt::format("the robot's file is MJCF ({}), and the format urdf changes the limits "
                           "of a URDF; ros2-control and datasheet can be exported",
                           sanitize(file.string())));
  }
  return xml;
}

void check_links(const FinishedArm& arm) {
  if (has_tubes(arm.design)) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: the winner's links are tubes, and the export leaves the links of "
                            "the robot's URDF as they are: change them in CAD, with winner.toml's "
                            "sizes, and optimize the controllers of the new robot; ros2-control "
                            "and datasheet can be exported",
                            sanitize(arm.run.folder.string())));
  }
  for (std::size_t i = 0; i < arm.design.joints.size(); ++i) {
    const JointDrive& joint = arm.design.joints[i];
    if (joint.length_scale != 1 || joint.section_scale != 1) {
      throw Error(
          ErrorKind::usage,
          fmt::format(
              "{}: the winner has other links than the robot's URDF (the one that {} moves: "
              "length x {:.6g}, section x {:.6g}), and the export leaves links and meshes "
              "as they are: change them in CAD, with winner.toml's scales, and optimize "
              "the controllers of the new robot; ros2-control and datasheet can be "
              "exported",
              sanitize(arm.run.folder.string()), sanitize(arm.config().robot.joints[i].name),
              joint.length_scale, joint.section_scale));
    }
  }
}

}  // namespace

std::string FinishedArm::describe() const {
  return fmt::format("the winner of {} (seed {}) on {}",
                     sanitize(shorten_optimizer(result().optimizer)), result().seed,
                     sanitize(result().problem));
}

bool FinishedArm::starts_held() const {
  const ControllerRow& controller = find_controller(design.controller);
  std::vector<double> states(static_cast<std::size_t>(controller.states));
  const auto holds = [&](const JointDrive& joint) {
    constexpr double kSomeEffort = 1;
    controller.hold(kSomeEffort, {-kSomeEffort, kSomeEffort}, joint.gains, states.data());
    return std::ranges::any_of(states, [](double state) { return state != 0; });
  };
  bool all = config().task.control_start == ControlStart::gravity;
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    all = all && (config().robot.joints[i].plant.unactuated || holds(design.joints[i]));
  }
  return all;
}

FinishedArm load_finished_arm(const fs::path& folder, std::string_view format, bool force) {
  refuse_study(folder, format);
  const RunResult result = load_result(folder);
  if (!result.tracking) {
    refuse_run(folder, fmt::format("is a run on {}, which has no arm; {} needs a run of an arm. "
                                   "The formats csv, ioh, coco and json work for every run",
                                   sanitize(result.problem), format));
  }
  if (!result.winner) {
    refuse_run(folder, fmt::format("this run found no design that could be simulated to its end, "
                                   "so there is nothing to make {} of; optimize again with a "
                                   "larger budget or another start",
                                   format));
  }
  const std::vector<std::string> faults = list_faults(result);
  if (!faults.empty() && !force) {
    refuse_run(folder, fmt::format("{}. A robot should not get this design: optimize again with a "
                                   "larger budget or another optimizer. --force writes {} anyway",
                                   join(faults, "; "), format));
  }
  FinishedArm arm;
  arm.run = read_recorded_run(folder);
  if (arm.run.tracking() == nullptr) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the arm of this run cannot be rebuilt. {} Restore the files as "
                            "they were, or optimize again",
                            sanitize(folder.string()), arm.run.problem_fault));
  }
  arm.design = arm.run.tracking()->make_design(arm.run.find_best());
  for (const std::string& fault : faults) {
    arm.warnings.push_back("Do not use this design: " + fault + ".");
  }
  const auto check = load_check(folder);
  const std::string weak = check ? list_weaknesses(*check) : "";
  if (!check) {
    arm.warnings.emplace_back(
        "This design was not checked under other conditions; armwright verify checks it.");
  } else if (!weak.empty()) {
    arm.warnings.push_back("Under other conditions this design is not shown to work: " + weak +
                           ".");
  }
  return arm;
}

void write_ros2_control(const FinishedArm& arm, const fs::path& folder) {
  const TrackingConfig& config = arm.config();
  const std::vector<std::string> origin = describe_origin(arm);
  for (const Ros2Distribution& distribution : ros2_distributions()) {
    if (!has_interface(distribution, arm.design)) {
      continue;  // the documentation says which
    }
    write_output_file(folder / fmt::format("controllers-{}.yaml", distribution.name),
                      make_ros2_control(distribution, config.robot, arm.design,
                                        config.task.control_period_s, origin));
  }
}

void write_urdf(const FinishedArm& arm, const fs::path& folder) {
  check_links(arm);
  const fs::path file = arm.run.find_urdf();
  const std::string xml = read_urdf_of(arm, file);
  std::string comment = join(describe_origin(arm), "\n");
  comment +=
      "\nChanged: the effort of these joints' <limit>, to the larger of the design's two limits.\n";
  std::map<std::string, double> efforts;
  for (std::size_t i = 0; i < arm.design.joints.size(); ++i) {
    const Joint& joint = arm.config().robot.joints[i];
    const JointDrive& drive = arm.design.joints[i];
    if (joint.plant.unactuated) {
      continue;
    }
    efforts[joint.name] = calc_largest_effort(drive);
    comment += fmt::format("  {}: {} to {} {}\n", joint.name, format_exact(drive.limits.min),
                           format_exact(drive.limits.max), get_joint_unit("N m", joint.kind));
  }
  comment += "Everything else is as it was; meshes with relative names are looked for beside it.";
  write_output_file(folder / file.filename(),
                    set_effort_limits(xml, sanitize(file.string()), efforts, comment));
}

void write_datasheet(const FinishedArm& arm, const fs::path& folder) {
  write_output_file(folder / "datasheet.html", make_datasheet(arm));
}

}  // namespace armwright
