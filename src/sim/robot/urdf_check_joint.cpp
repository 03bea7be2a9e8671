#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

// An axis shorter than this has no direction worth the name.
constexpr double kShortestAxis = 1e-6;

struct Range {
  double lower = 0, upper = 0;
};

// <limit>'s ends, each 0 where it is not given.
Range read_range(const XMLElement& limit, bool prismatic, const UrdfXml& xml) {
  const Range range{xml.read_number(limit, "lower", 0.0), xml.read_number(limit, "upper", 0.0)};
  if (range.lower > range.upper) {
    xml.fail(limit, fmt::format("<limit>: lower is {} and upper is {} {}; lower must be <= upper",
                                range.lower, range.upper, prismatic ? "m" : "rad"));
  }
  return range;
}

}  // namespace

void JointChecker::check(const XMLElement& element, const UrdfJoint& joint) {
  xml_.set_context(fmt::format("joint '{}'", joint.name));
  xml_.check_names(element,
                   {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic",
                    "calibration", "safety_controller"},
                   {"name", "type"});
  const bool moves = chain_.joints.contains(joint.name);
  out_.open("joint");
  out_.write("name", joint.name);
  out_.write("type", moves ? joint.type : "fixed");
  for (const auto& [end, link] : {std::pair("parent", joint.parent), {"child", joint.child}}) {
    out_.open(end);
    out_.write("link", link);
    out_.close();
  }
  copy_origin(element, xml_, out_);
  if (moves) {
    write_moving(element, joint);
  } else if (joint.type != "fixed") {
    held_.emplace(joint.name, hold(element, joint));
  }
  out_.close();
}

void JointChecker::write_moving(const XMLElement& element, const UrdfJoint& joint) {
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
  out_.open("axis");
  out_.write("xyz", read_axis(element));
  out_.close();
  write_limit(element, joint);
  note_extras(element, joint);
}

// At 0, or at the end of its range nearest to that. Floating and planar joints have no position and
// stay at their origin.
HeldJoint JointChecker::hold(const XMLElement& element, const UrdfJoint& joint) const {
  if (joint.type == "floating" || joint.type == "planar") {
    return {joint.line, Eigen::Isometry3d::Identity(), "its origin"};
  }
  const bool prismatic = joint.type == "prismatic";
  double position = 0;
  const XMLElement* limit = xml_.find_only(element, "limit");
  if (limit != nullptr && joint.type != "continuous") {
    const Range range = read_range(*limit, prismatic, xml_);
    position = std::clamp(0.0, range.lower, range.upper);
  }
  HeldJoint held;
  held.line = joint.line;
  held.place = fmt::format("{} {}", position, prismatic ? "m" : "rad");
  const std::vector<double> xyz = read_axis(element);
  const Eigen::Vector3d axis = Eigen::Vector3d(xyz[0], xyz[1], xyz[2]).normalized();
  if (position != 0 && prismatic) {
    held.motion.translation() = position * axis;
  } else if (position != 0) {
    held.motion.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
  }
  return held;
}

std::vector<double> JointChecker::read_axis(const XMLElement& element) const {
  std::vector<double> axis{1, 0, 0};  // URDF's default
  if (const XMLElement* given = xml_.find_only(element, "axis")) {
    xml_.check_names(*given, {}, {"xyz"});
    axis = xml_.read_numbers(*given, "xyz", 3);
    if (std::hypot(axis[0], axis[1], axis[2]) < kShortestAxis) {
      xml_.fail(*given,
                fmt::format("<axis>: xyz is '{}', which has no direction; give one such as 0 0 1",
                            shorten(given->Attribute("xyz"))));
    }
  }
  return axis;
}

void JointChecker::write_limit(const XMLElement& element, const UrdfJoint& joint) {
  const bool prismatic = joint.type == "prismatic";
  const bool bounded = joint.type != "continuous";
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
  out_.open("limit");
  if (bounded) {
    const Range range = read_range(*limit, prismatic, xml_);
    out_.write("lower", {range.lower});
    out_.write("upper", {range.upper});
  }
  for (const char* attribute : {"velocity", "effort"}) {
    const double value = xml_.read_number(*limit, attribute);
    if (value < 0) {
      xml_.fail(*limit, fmt::format("<limit>: {} is {}; it must be >= 0", attribute, value));
    }
    if (value == 0) {  // build_model() makes infinity of it
      without_limit_[attribute].push_back(fmt::format("'{}'", joint.name));
    }
    out_.write(attribute, {value});
  }
  out_.close();
}

// What would change how the joint moves, and is not simulated.
void JointChecker::note_extras(const XMLElement& element, const UrdfJoint& joint) {
  if (xml_.find_only(element, "safety_controller") != nullptr) {
    softly_limited_.push_back(fmt::format("'{}'", joint.name));
  }
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
  }
  if (!parts.empty()) {
    rubbing_.push_back(fmt::format("'{}' ({})", joint.name, join(parts, ", ")));
  }
}

std::vector<std::string> JointChecker::make_notes() const {
  std::vector<std::string> notes;
  if (!rubbing_.empty()) {
    notes.push_back(fmt::format(
        "joints are simulated without the <dynamics> of {}; [perturbation] can add friction: "
        "viscous_friction_n_m_s_per_rad, coulomb_friction_n_m (docs/robust.md)",
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
