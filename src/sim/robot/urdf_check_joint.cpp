// Checks the joints of a URDF and reads them.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

// The direction of an axis shorter than this is not reliable.
constexpr double kShortestAxis = 1e-6;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

struct Range {
  double lower = 0, upper = 0;
};

// Returns the lower and upper limit; a limit that is not given is 0.
Range read_range(const XMLElement& limit, bool prismatic, const UrdfXml& xml) {
  const Range range{xml.read_number(limit, "lower", 0.0), xml.read_number(limit, "upper", 0.0)};
  if (range.lower > range.upper) {
    xml.fail(limit, fmt::format("<limit>: lower is {} and upper is {} {}; lower must be <= upper",
                                range.lower, range.upper, prismatic ? "m" : "rad"));
  }
  return range;
}

}  // namespace

UrdfPlacement JointChecker::read(const XMLElement& element, const UrdfJoint& joint) {
  xml_.set_context(fmt::format("joint '{}'", joint.name));
  UrdfPlacement placement;
  placement.motion.name = joint.name;  // also if the rest cannot be read
  const bool has_known_parts = faults_.attempt([&] {
    xml_.check_names(element,
                     {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic",
                      "calibration", "safety_controller"},
                     {"name", "type"});
  });
  if (!has_known_parts) {
    return placement;  // a misspelt part would be missed, too
  }
  faults_.attempt([&] { placement.origin = read_origin(element, xml_); });
  if (chain_.joints.contains(joint.name)) {
    placement.motion = read_motion(element, joint);
  } else if (joint.type != "fixed") {
    faults_.attempt([&] { hold(element, joint, placement); });
  }
  return placement;
}

// Refuses what no joint of the chain can be.
void JointChecker::refuse_kind(const XMLElement& element, const UrdfJoint& joint) const {
  if (joint.type == "floating" || joint.type == "planar") {
    xml_.fail(element,
              fmt::format("the type is '{}'; between base '{}' and tip '{}' only revolute, "
                          "continuous, prismatic and fixed joints are simulated: name a base below "
                          "it (robot.base or --base)",
                          joint.type, chain_.base, chain_.tip));
  }
  if (const XMLElement* mimic = xml_.find_only(element, "mimic")) {
    xml_.fail(*mimic, fmt::format("follows another joint (<mimic>), which is not simulated between "
                                  "base '{}' and tip '{}'; name a tip above it (robot.tip or "
                                  "--tip), remove the element, or make the joint fixed",
                                  chain_.base, chain_.tip));
  }
}

Joint JointChecker::read_motion(const XMLElement& element, const UrdfJoint& joint) {
  Joint motion;
  motion.name = joint.name;
  motion.kind = joint.type == "prismatic" ? JointKind::prismatic : JointKind::revolute;
  if (!faults_.attempt([&] { refuse_kind(element, joint); })) {
    return motion;
  }
  faults_.attempt([&] { motion.axis = read_axis(element).normalized(); });
  faults_.attempt([&] { read_limit(element, joint, motion); });
  faults_.attempt([&] { read_dynamics(element, joint, motion); });
  faults_.attempt([&] {
    if (xml_.find_only(element, "safety_controller") != nullptr) {
      softly_limited_.push_back(fmt::format("'{}'", joint.name));
    }
  });
  return motion;
}

// Holds a joint at position 0, or at the end of its range that is nearest to 0. Floating and planar
// joints stay at their origin.
void JointChecker::hold(const XMLElement& element, const UrdfJoint& joint,
                        UrdfPlacement& placement) const {
  if (joint.type == "floating" || joint.type == "planar") {
    placement.held_at = "its origin";
    return;
  }
  const bool prismatic = joint.type == "prismatic";
  double position = 0;
  const XMLElement* limit = xml_.find_only(element, "limit");
  if (limit != nullptr && joint.type != "continuous") {
    const Range range = read_range(*limit, prismatic, xml_);
    position = std::clamp(0.0, range.lower, range.upper);
  }
  placement.held_at = fmt::format("{} {}", position, prismatic ? "m" : "rad");
  const Eigen::Vector3d axis = read_axis(element).normalized();
  if (position != 0 && prismatic) {
    placement.held_pose.translation() = position * axis;
  } else if (position != 0) {
    placement.held_pose.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
  }
}

Eigen::Vector3d JointChecker::read_axis(const XMLElement& element) const {
  std::vector<double> axis{1, 0, 0};  // the default in URDF
  if (const XMLElement* given = xml_.find_only(element, "axis")) {
    xml_.check_names(*given, {}, {"xyz"});
    axis = xml_.read_numbers(*given, "xyz", 3);
    if (std::hypot(axis[0], axis[1], axis[2]) < kShortestAxis) {
      xml_.fail(*given,
                fmt::format("<axis>: xyz is '{}', which has no direction; give one such as 0 0 1",
                            shorten(given->Attribute("xyz"))));
    }
  }
  return {axis[0], axis[1], axis[2]};
}

void JointChecker::read_limit(const XMLElement& element, const UrdfJoint& joint, Joint& motion) {
  const bool prismatic = joint.type == "prismatic";
  const bool bounded = joint.type != "continuous";
  motion.lower = -kNoLimit;
  motion.upper = kNoLimit;
  motion.speed_limit = kNoLimit;
  motion.effort_limit = kNoLimit;
  const XMLElement* limit = xml_.find_only(element, "limit");
  if (limit == nullptr) {
    if (prismatic) {
      xml_.fail(element,
                "has no <limit>; a prismatic joint needs one (lower and upper in m, velocity in "
                "m/s, effort in N)");
    }
    if (bounded) {
      xml_.fail(element,
                "has no <limit>; a revolute joint needs one (lower and upper in rad, velocity in "
                "rad/s, effort in N m), "
                "or the type must be continuous");
    }
    return;
  }
  xml_.check_names(*limit, {}, {"lower", "upper", "velocity", "effort"});
  if (bounded) {
    faults_.attempt([&] {
      const Range range = read_range(*limit, prismatic, xml_);
      motion.lower = range.lower;
      motion.upper = range.upper;
    });
  }
  for (const char* attribute : {"velocity", "effort"}) {
    faults_.attempt([&] {
      const double value = xml_.read_number(*limit, attribute);
      if (value < 0) {
        xml_.fail(*limit, fmt::format("<limit>: {} is {}; it must be >= 0", attribute, value));
      }
      if (value == 0) {  // a placeholder for no limit
        without_limit_[attribute].push_back(fmt::format("'{}'", joint.name));
      } else {
        (std::string_view(attribute) == "velocity" ? motion.speed_limit : motion.effort_limit) =
            value;
      }
    });
  }
}

void JointChecker::read_dynamics(const XMLElement& element, const UrdfJoint& joint, Joint& motion) {
  const XMLElement* dynamics = xml_.find_only(element, "dynamics");
  if (dynamics == nullptr) {
    return;
  }
  xml_.check_names(*dynamics, {}, {"damping", "friction"});
  std::vector<std::string> parts;
  for (const char* attribute : {"damping", "friction"}) {
    const double value = xml_.read_number(*dynamics, attribute, 0.0);
    if (value < 0) {
      xml_.fail(*dynamics, fmt::format("<dynamics>: {} is {}; it must be >= 0", attribute, value));
    }
    if (value != 0) {
      parts.push_back(fmt::format("{} {}", attribute, value));
    }
    if (dynamics_) {
      (std::string_view(attribute) == "damping" ? motion.plant.viscous : motion.plant.coulomb) =
          value;
    }
  }
  if (!dynamics_ && !parts.empty()) {
    rubbing_.push_back(fmt::format("'{}' ({})", joint.name, join(parts, ", ")));
  }
}

std::vector<std::string> JointChecker::make_notes() const {
  std::vector<std::string> notes;
  if (!rubbing_.empty()) {
    notes.push_back(fmt::format(
        "joints are simulated without the <dynamics> of {}; robot.dynamics = true gives them this "
        "friction",
        join(rubbing_, ", ")));
  }
  for (const auto& [attribute, joints] : without_limit_) {
    notes.push_back(
        fmt::format("<limit {}=\"0\"> is taken for no limit: {}", attribute, join(joints, ", ")));
  }
  if (!softly_limited_.empty()) {
    notes.push_back(fmt::format("the soft limits of <safety_controller> are left out: {}",
                                join(softly_limited_, ", ")));
  }
  return notes;
}

}  // namespace armwright
