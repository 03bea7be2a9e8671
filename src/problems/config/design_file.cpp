#include "problems/config/design_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/values_file.hpp"

namespace armwright {
namespace {

constexpr Range kScaleRange{.lower = 0.01, .upper = 100};  // more than any arm needs
constexpr Range kPublishedRange{.lower = 0, .lower_open = true};

const Setting<std::string> kDesignName{"name", kNoDefault,
                                       "name of the design (default: the file's name)"};
const Setting<std::string> kDesignTitle{"title", "", "one line"};
const Setting<std::string> kDesignSource{"source", "", "source of the design"};
const Setting<std::string> kDesignController{
    "controller", controller_names, "pid",
    "control law of all joints (armwright list controllers)"};
const Setting<double> kDesignSpeed{"speed_m_per_s",
                                   {.lower = 0.01, .upper = 100},
                                   kNoDefault,
                                   "nominal speed (default: the task's)"};

const Setting<std::string> kDriveName{"name", "", "name of the joint; joints count from the base"};
const Setting<double> kDriveEffortMin{
    "effort_min_n_m",
    {.upper = 0},
    kNoDefault,
    "largest effort in the negative direction; for joints that slide in N"};
const Setting<double> kDriveEffortMax{
    "effort_max_n_m",
    {.lower = 0},
    kNoDefault,
    "largest effort in the positive direction; for joints that slide in N"};
const Setting<double> kDriveLengthScale{"length_scale", kScaleRange, 1,
                                        "factor on the length of the link that the joint moves"};
const Setting<double> kDriveSectionScale{"section_scale", kScaleRange, 1,
                                         "factor on the cross-section of that link"};
constexpr Range kTubeSize{.lower = 0, .upper = 100, .lower_open = true};
const Setting<double> kDriveTubeDiameter{
    "tube_diameter_m", kTubeSize, kNoDefault,
    "outer diameter of that link, for problems with [tubes] (default: that of the problem)"};
const Setting<double> kDriveTubeWall{"tube_wall_m", kTubeSize, kNoDefault,
                                     "wall of that tube, at most half of its diameter"};

const Setting<std::string> kPublishedLabel{"label", kNoDefault,
                                           "name of this published result in tables"};
const Setting<std::string> kPublishedProblem{"problem", kNoDefault,
                                             "shipped problem of the published result"};
const Setting<std::vector<std::string>> kPublishedSet{
    "set", kNoDefault, "changes to that problem, a list of KEY=VALUE"};
const Setting<double> kPublishedError{"error_m", kPublishedRange, kNoDefault,
                                      "the published error"};
const Setting<double> kPublishedTorque{"total_torque_n_m", kPublishedRange, kNoDefault,
                                       "the published total torque"};
const Setting<std::string> kPublishedWhere{"where", "", "place in the source that reports it"};
const SettingTable kPublishedSettings{
    .key = "published",
    .is_array = true,
    .settings = {&kPublishedLabel, &kPublishedProblem, &kPublishedSet, &kPublishedError,
                 &kPublishedTorque, &kPublishedWhere}};

// Returns the gains of all controllers, each key once.
const std::vector<Setting<double>>& get_gain_settings() {
  static const std::vector<Setting<double>> settings = [] {
    std::vector<Setting<double>> all;
    for (const ControllerRow& controller : controller_table()) {
      for (const controllers::Gain& gain : controller.gains) {
        const auto found = std::ranges::find(all, gain.key, &Setting<double>::key);
        if (found != all.end()) {
          found->meaning += ", " + controller.name;
          continue;
        }
        all.emplace_back(gain.key, gain.any_sign ? Range{} : Range{.lower = 0}, kNoDefault,
                         "gain of the controllers " + controller.name);
        all.back().unit = gain.unit;
      }
    }
    return all;
  }();
  return settings;
}

const Setting<double>& find_gain_setting(const controllers::Gain& gain) {
  return *std::ranges::find(get_gain_settings(), gain.key, &Setting<double>::key);
}

const SettingTable& get_drive_settings() {
  static const SettingTable settings = [] {
    SettingTable table{
        .key = "joint",
        .is_array = true,
        .settings = {&kDriveName, &kDriveEffortMin, &kDriveEffortMax, &kDriveLengthScale,
                     &kDriveSectionScale, &kDriveTubeDiameter, &kDriveTubeWall}};
    for (const Setting<double>& gain : get_gain_settings()) {
      table.settings.push_back(&gain);
    }
    return table;
  }();
  return settings;
}

std::string quote_design_text(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    const auto code = static_cast<unsigned char>(c);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (code < 0x20 || code == 0x7F) {
      quoted += fmt::format("\\u{:04X}", code);
    } else if (code == 0xC2 && next >= 0x80 && next < 0xA0) {  // the other control characters
      quoted += fmt::format("\\u{:04X}", next);
      ++i;
    } else {
      quoted += c;
    }
  }
  return sanitize(quoted) + '"';
}

PublishedResult read_published(const ConfigTable& table) {
  PublishedResult published;
  published.label = table.get(kPublishedLabel);
  published.problem = table.get(kPublishedProblem);
  published.overrides = table.get_or(kPublishedSet, {});
  published.error_m = table.find(kPublishedError);
  published.total_torque_n_m = table.find(kPublishedTorque);
  published.where = table.get(kPublishedWhere);
  return published;
}

JointDrive read_drive(const ConfigTable& joint, const ControllerRow& controller) {
  // Every key counts as known before the first value is read. So a message about a missing key
  // never takes a right key for its mistyped name.
  for (const controllers::Gain& gain : controller.gains) {
    joint.has(find_gain_setting(gain));
  }
  for (const auto* setting :
       {&kDriveEffortMin, &kDriveEffortMax, &kDriveLengthScale, &kDriveSectionScale}) {
    joint.has(*setting);
  }
  JointDrive drive;
  for (const controllers::Gain& gain : controller.gains) {
    drive.gains.push_back(joint.get(find_gain_setting(gain)));
  }
  drive.limits.min = joint.get(kDriveEffortMin);
  drive.limits.max = joint.get(kDriveEffortMax);
  drive.length_scale = joint.get(kDriveLengthScale);
  drive.section_scale = joint.get(kDriveSectionScale);
  const auto diameter_m = joint.find(kDriveTubeDiameter), wall_m = joint.find(kDriveTubeWall);
  if (diameter_m.has_value() != wall_m.has_value()) {
    joint.refuse(diameter_m ? kDriveTubeWall : kDriveTubeDiameter,
                 "a tube has tube_diameter_m and tube_wall_m; give both or neither");
  }
  if (diameter_m) {
    drive.tube = {*diameter_m, *wall_m};
    if (2 * *wall_m > *diameter_m) {
      joint.refuse(kDriveTubeWall,
                   fmt::format("it must be at most {:g}, the radius of the tube", *diameter_m / 2));
    }
  }
  return drive;
}

}  // namespace

const SettingTable& design_settings() {
  static const SettingTable settings{
      .key = "",
      .settings = {&kDesignName, &kDesignTitle, &kDesignSource, &kDesignController, &kDesignSpeed},
      .tables = {&get_drive_settings(), &kPublishedSettings},
      .listed_as = "design:"};
  return settings;
}

namespace {

DesignFile read_design(const std::filesystem::path& path) {
  const ConfigTable table = ConfigTable::load(design_settings(), path);
  DesignFile file;
  file.name = table.get_or(kDesignName, path.stem().string());
  file.title = table.get(kDesignTitle);
  file.source = table.get(kDesignSource);
  file.design.controller = table.get(kDesignController);
  file.design.speed_m_per_s = table.find(kDesignSpeed);
  const ControllerRow& controller = find_controller(file.design.controller);
  for (const ConfigTable& joint : table.get_tables(get_drive_settings())) {
    file.joint_names.push_back(joint.get(kDriveName));
    file.design.joints.push_back(read_drive(joint, controller));
  }
  if (file.design.joints.empty()) {
    table.refuse(get_drive_settings().key, "a design must have at least one joint, [[joint]]");
  }
  for (const ConfigTable& published : table.get_tables_or_empty(kPublishedSettings)) {
    file.published.push_back(read_published(published));
  }
  table.refuse_unknown();
  return file;
}

// Returns whether the file is the winner of a problem without an arm.
bool is_values_file(const std::filesystem::path& path) {
  try {
    load_values(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

DesignFile load_design(std::string_view name_or_path) {
  const ReadStep step(fmt::format("the design '{}'", sanitize(name_or_path)));
  const auto path = resolve_config("designs", name_or_path);
  try {
    return read_design(path);
  } catch (const Error& error) {
    if (is_values_file(path)) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{} has the variables of a problem without an arm, so it is no "
                              "design of an arm; 'armwright evaluate FILE --problem PROBLEM' "
                              "evaluates it on that problem",
                              sanitize(path.string())));
    }
    // A design is an input like a robot, not a part of the configuration.
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::bad_data : error.kind(),
                error.what());
  }
}

DesignFile make_design_file(const RobotModel& robot, ArmDesign design) {
  DesignFile file;
  for (const Joint& joint : robot.joints) {
    file.joint_names.push_back(joint.name);
  }
  file.design = std::move(design);
  return file;
}

std::string to_toml(const DesignFile& file) {
  const ControllerRow& controller = find_controller(file.design.controller);
  std::string text =
      fmt::format("name = {}\ntitle = {}\nsource = {}\ncontroller = {}\n",
                  quote_design_text(file.name), quote_design_text(file.title),
                  quote_design_text(file.source), quote_design_text(file.design.controller));
  if (file.design.speed_m_per_s) {
    text += fmt::format("speed_m_per_s = {}\n", format_exact(*file.design.speed_m_per_s));
  }
  for (std::size_t i = 0; i < file.design.joints.size(); ++i) {
    const JointDrive& joint = file.design.joints[i];
    text += fmt::format("\n[[joint]]\nname = {}\n", quote_design_text(file.joint_names.at(i)));
    for (std::size_t g = 0; g < controller.gains.size(); ++g) {
      text += fmt::format("{} = {}\n", controller.gains[g].key, format_exact(joint.gains.at(g)));
    }
    text += fmt::format("effort_min_n_m = {}\neffort_max_n_m = {}\n",
                        format_exact(joint.limits.min), format_exact(joint.limits.max));
    if (joint.length_scale != 1) {
      text += fmt::format("length_scale = {}\n", format_exact(joint.length_scale));
    }
    if (joint.section_scale != 1) {
      text += fmt::format("section_scale = {}\n", format_exact(joint.section_scale));
    }
    if (joint.tube.diameter_m > 0) {
      text += fmt::format("tube_diameter_m = {}\ntube_wall_m = {}\n",
                          format_exact(joint.tube.diameter_m), format_exact(joint.tube.wall_m));
    }
  }
  return text;
}

}  // namespace armwright
