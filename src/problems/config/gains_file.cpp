#include "problems/config/gains_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/logs/yaml_scalars.hpp"

namespace armwright {
namespace {

constexpr std::uintmax_t kGainsLimit_bytes = std::uintmax_t{1} << 20;
constexpr std::size_t kMostValues = 20'000;

// Returns the text for a message.
std::string show(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  return text.size() <= kLongest ? sanitize(text) : sanitize(text.substr(0, kLongest)) + "...";
}
std::string show(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 16;
  std::vector<std::string> shown;
  for (const std::string& name : names) {
    if (shown.size() == kMost) {
      shown.push_back(fmt::format("and {} more", names.size() - kMost));
      break;
    }
    shown.push_back(show(name));
  }
  return join(shown, ", ");
}

// The parameters of one controller.
struct ControllerParameters {
  std::string name;
  YamlScalars scalars;

  const YamlScalar* find(const std::string& key) const {
    const auto found = scalars.find(key);
    return found == scalars.end() ? nullptr : &found->second;
  }
  // Returns the joints that have a p, with the p.
  std::map<std::string, YamlScalar> list_joints() const {
    constexpr std::string_view kBefore = "gains.", kAfter = ".p";
    std::map<std::string, YamlScalar> joints;
    for (const auto& [key, scalar] : scalars) {
      if (key.starts_with(kBefore) && key.ends_with(kAfter) &&
          key.size() > kBefore.size() + kAfter.size()) {
        joints[key.substr(kBefore.size(), key.size() - kBefore.size() - kAfter.size())] = scalar;
      }
    }
    return joints;
  }
};

class GainsReader {
 public:
  GainsReader(const std::string& file, const RobotModel& robot, const ArmDrives& drives)
      : file_(file), robot_(robot), drives_(drives) {}

  ArmDesign read(const YamlScalars& scalars) const {
    const ControllerParameters controller = choose(split_controllers(scalars));
    check_interface(controller);
    ArmDesign design;
    design.controller = get_plain_controller(drives_.interface).name;
    for (const Joint& joint : robot_.joints) {
      design.joints.push_back(read_joint(controller, joint));
    }
    return design;
  }

 private:
  [[noreturn]] void refuse(const YamlScalar* at, const std::string& what) const {
    throw Error(ErrorKind::bad_data, at == nullptr
                                         ? fmt::format("{}: {}", file_, what)
                                         : fmt::format("{}:{}: {}", file_, at->line, what));
  }

  static std::vector<ControllerParameters> split_controllers(const YamlScalars& scalars) {
    constexpr std::string_view kMark = "ros__parameters.";
    std::map<std::string, ControllerParameters> found;
    for (const auto& [key, scalar] : scalars) {
      const std::size_t at = key.find(kMark);
      if (at == std::string::npos) {
        continue;
      }
      const std::string name = key.substr(0, at == 0 ? 0 : at - 1);
      found[name].name = name;
      found[name].scalars[key.substr(at + kMark.size())] = scalar;
    }
    std::vector<ControllerParameters> controllers;
    for (auto& [name, controller] : found) {
      if (!controller.list_joints().empty()) {
        controllers.push_back(std::move(controller));
      }
    }
    return controllers;
  }

  // Returns the one controller whose gains are those of the robot's joints.
  ControllerParameters choose(const std::vector<ControllerParameters>& controllers) const {
    if (controllers.empty()) {
      refuse(nullptr,
             "it has no gains of a controller (NAME: ros__parameters: gains: JOINT: p: ...); name "
             "a file with the parameters of a joint_trajectory_controller or pid_controller");
    }
    std::vector<std::string> own, names;
    for (const Joint& joint : robot_.joints) {
      own.push_back(joint.name);
    }
    std::ranges::sort(own);
    const ControllerParameters* chosen = nullptr;
    for (const ControllerParameters& controller : controllers) {
      std::vector<std::string> joints;
      for (const auto& [joint, p] : controller.list_joints()) {
        joints.push_back(joint);
      }
      if (joints == own) {
        chosen = &controller;
        names.push_back(controller.name);
      }
    }
    if (names.size() > 1) {
      refuse(nullptr, fmt::format("the controllers {} all have gains of the robot's joints; leave "
                                  "one of them",
                                  show(names)));
    }
    if (chosen == nullptr) {
      refuse_joints(controllers.front(), own);
    }
    return *chosen;
  }

  [[noreturn]] void refuse_joints(const ControllerParameters& controller,
                                  const std::vector<std::string>& own) const {
    const auto joints = controller.list_joints();
    std::vector<std::string> names;
    const YamlScalar* line = nullptr;
    for (const auto& [joint, p] : joints) {
      names.push_back(joint);
      if (line == nullptr && std::ranges::find(own, joint) == own.end()) {
        line = &p;
      }
    }
    refuse(line == nullptr ? &joints.begin()->second : line,
           fmt::format("the gains of controller '{}' are those of the joints {}, but the robot's "
                       "are {}; name a file for this robot, or another robot.base or robot.tip",
                       show(controller.name), show(names), show(own)));
  }

  static bool is_trajectory_controller(const ControllerParameters& controller) {
    return controller.find("command_interface") == nullptr;
  }

  void check_interface(const ControllerParameters& controller) const {
    const bool trajectory = is_trajectory_controller(controller);
    const YamlScalar* const named =
        controller.find(trajectory ? "command_interfaces.0" : "command_interface");
    const std::string& taken =
        control_interface_names()[static_cast<std::size_t>(drives_.interface)];
    if (const YamlScalar* const second = controller.find("command_interfaces.1")) {
      refuse(second, fmt::format("controller '{}' has several command interfaces; armwright tunes "
                                 "controllers with one",
                                 show(controller.name)));
    }
    if (named != nullptr && named->text != taken) {
      refuse(named, fmt::format("controller '{}' commands '{}', but control.interface is '{}'; "
                                "set control.interface, or name another file",
                                show(controller.name), show(named->text), taken));
    }
    if (trajectory && drives_.interface == ControlInterface::position) {
      refuse(named, fmt::format("controller '{}' passes positions on and uses no gains; name the "
                                "file of a pid_controller",
                                show(controller.name)));
    }
  }

  // Returns a parameter of a joint that is a number, or nothing if the file lacks it.
  std::optional<double> find_number(const ControllerParameters& controller, const Joint& joint,
                                    const std::string& name) const {
    const YamlScalar* const scalar = controller.find("gains." + joint.name + "." + name);
    if (scalar == nullptr) {
      return {};
    }
    const std::optional<double> number = parse_finite(scalar->text);
    if (!number) {
      refuse(scalar, fmt::format("{} of joint '{}' is '{}'; it must be a finite number", name,
                                 show(joint.name), show(scalar->text)));
    }
    return number;
  }

  double read_gain(const ControllerParameters& controller, const Joint& joint,
                   const std::string& name) const {
    const double gain = find_number(controller, joint, name).value_or(0);  // as in ROS 2
    if (gain < 0) {
      refuse(controller.find("gains." + joint.name + "." + name),
             fmt::format("{} of joint '{}' is {}; it must not be below 0", name, show(joint.name),
                         gain));
    }
    return gain;
  }

  // Returns the share of the setpoint, or of its rate, that is added to the PID.
  double read_feed_forward(const ControllerParameters& controller, const Joint& joint) const {
    const std::string name =
        is_trajectory_controller(controller) ? "ff_velocity_scale" : "feedforward_gain";
    const double share = read_gain(controller, joint, name);
    const YamlScalar* const at = controller.find("gains." + joint.name + "." + name);
    if (drives_.interface == ControlInterface::effort && share != 0) {
      refuse(at, fmt::format("{} of joint '{}' is {}; armwright's controllers of efforts have no "
                             "such part, so it must be 0",
                             name, show(joint.name), share));
    }
    if (drives_.interface == ControlInterface::position && share != 1) {
      refuse(at, fmt::format("{} of joint '{}' is {}; armwright's controller adds the whole "
                             "position, so it must be 1",
                             name, show(joint.name), share));
    }
    return share;
  }

  JointDrive read_joint(const ControllerParameters& controller, const Joint& joint) const {
    JointDrive drive;
    for (const char* name : {"p", "i", "d"}) {
      drive.gains.push_back(read_gain(controller, joint, name));
    }
    const double feed_forward = read_feed_forward(controller, joint);
    if (drives_.interface == ControlInterface::velocity) {
      drive.gains.push_back(feed_forward);
    }
    drive.limits = {-joint.effort_limit, joint.effort_limit};
    if (drives_.interface == ControlInterface::effort) {
      const auto low = find_number(controller, joint, "u_clamp_min");
      const auto high = find_number(controller, joint, "u_clamp_max");
      if (low && high) {
        drive.limits = {*low, *high};
      }
    }
    if (!std::isfinite(drive.limits.max) || !(drive.limits.min <= 0 && drive.limits.max >= 0)) {
      refuse(controller.find("gains." + joint.name + ".p"),
             fmt::format("the effort limits of joint '{}' are {} to {}; give the joint an effort "
                         "limit in its URDF, or u_clamp_min <= 0 and u_clamp_max >= 0 here if the "
                         "controller commands efforts",
                         show(joint.name), drive.limits.min, drive.limits.max));
    }
    return drive;
  }

  const std::string& file_;
  const RobotModel& robot_;
  const ArmDrives& drives_;
};

}  // namespace

bool is_gains_file(std::string_view name) {
  return name.ends_with(".yaml") || name.ends_with(".yml");
}

ArmDesign parse_gains(std::string_view text, const std::string& name, const RobotModel& robot,
                      const ArmDrives& drives) {
  const std::string file = sanitize(name);
  return GainsReader(file, robot, drives)
      .read(read_yaml_scalars(text, file, kMostValues, "leave the gains of one controller"));
}

ArmDesign load_gains(const std::filesystem::path& file, const RobotModel& robot,
                     const ArmDrives& drives) {
  const ReadStep step(fmt::format("the gains '{}'", sanitize(file.string())));
  return parse_gains(read_file(file, kGainsLimit_bytes), file.string(), robot, drives);
}

}  // namespace armwright
