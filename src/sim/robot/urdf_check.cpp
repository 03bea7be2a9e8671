// Checks the robot element of a URDF and what links and joints have in common.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

// Returns the rotation Rz(yaw) Ry(pitch) Rx(roll), computed from its normalized quaternion. The
// order of the operations must not change: it decides the last bits of all results of robots with
// rotated frames, and it is the same as in version 1.0.
Eigen::Matrix3d make_rotation(double roll, double pitch, double yaw) {
  const double phi = roll / 2.0;
  const double the = pitch / 2.0;
  const double psi = yaw / 2.0;
  double x =
      std::sin(phi) * std::cos(the) * std::cos(psi) - std::cos(phi) * std::sin(the) * std::sin(psi);
  double y =
      std::cos(phi) * std::sin(the) * std::cos(psi) + std::sin(phi) * std::cos(the) * std::sin(psi);
  double z =
      std::cos(phi) * std::cos(the) * std::sin(psi) - std::sin(phi) * std::sin(the) * std::cos(psi);
  double w =
      std::cos(phi) * std::cos(the) * std::cos(psi) + std::sin(phi) * std::sin(the) * std::sin(psi);
  const double norm = std::sqrt(x * x + y * y + z * z + w * w);
  return Eigen::Quaterniond(w / norm, x / norm, y / norm, z / norm).toRotationMatrix();
}

}  // namespace

Eigen::Isometry3d read_origin(const XMLElement& parent, const UrdfXml& xml) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const XMLElement* origin = xml.find_only(parent, "origin");
  if (origin == nullptr) {
    return pose;
  }
  xml.check_names(*origin, {}, {"xyz", "rpy"});
  if (origin->Attribute("quat_xyzw") != nullptr) {
    xml.fail(*origin, "<origin>: quat_xyzw is not supported; give the rotation as rpy");
  }
  const std::vector<double> xyz = xml.read_numbers(*origin, "xyz", 3, {0, 0, 0});
  const std::vector<double> rpy = xml.read_numbers(*origin, "rpy", 3, {0, 0, 0});
  pose.translation() = Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
  pose.linear() = make_rotation(rpy[0], rpy[1], rpy[2]);
  return pose;
}

namespace {

std::string explain(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element has a closing tag of another name, or none";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is malformed or given twice; they are written name=\"value\"";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "it has no elements; a URDF has one <robot> element";
    default:
      return document.ErrorName();
  }
}

const XMLElement& find_robot(const tinyxml2::XMLDocument& document, const UrdfXml& xml,
                             const std::string& name) {
  const XMLElement* robot = document.RootElement();
  if (robot == nullptr) {
    fail_urdf(name, 1, "has no element at all; a URDF has one <robot> element");
  }
  if (std::string_view(robot->Name()) != "robot") {
    xml.fail(*robot, fmt::format("begins with <{}>; a URDF's root element is <robot>",
                                 shorten(robot->Name())));
  }
  if (const XMLElement* second = robot->NextSiblingElement()) {
    xml.fail(*second, fmt::format("has <{}> after </robot>; a URDF has one root element",
                                  shorten(second->Name())));
  }
  return *robot;
}

// The names of links and joints and the links that each joint connects. They are read before
// anything else of links and joints.
class Index {
 public:
  // Throws all faults of the links, or if there are none, those of the joints.
  Index(const XMLElement& robot, UrdfXml& xml, const std::string& name, const UrdfNumbers& numbers)
      : xml_(xml), numbers_(numbers) {
    UrdfFaults faults(name);
    for (const XMLElement* e = robot.FirstChildElement("link"); e != nullptr;
         e = e->NextSiblingElement("link")) {
      faults.attempt([&] { add_link(*e); });
    }
    faults.throw_if_any();
    xml_.set_context("the file");
    if (links.empty()) {
      xml_.fail(robot, "<robot> has no <link>; it needs a chain of links and joints");
    }
    for (const XMLElement* e = robot.FirstChildElement("joint"); e != nullptr;
         e = e->NextSiblingElement("joint")) {
      faults.attempt([&] { add_joint(*e); });
    }
    faults.throw_if_any();
  }

  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;

 private:
  void add_link(const XMLElement& element) {
    xml_.set_context("a link");
    const std::string name = xml_.get_text(element, "name");
    xml_.set_context(fmt::format("link '{}'", name));
    if (!link_names_.insert(name).second) {
      xml_.fail(element, "the name is used by an earlier link; names must be unique");
    }
    if (links.size() == kUrdfLinkLimit) {
      xml_.fail(element,
                fmt::format("is one too many; at most {} links are allowed", kUrdfLinkLimit));
    }
    links.push_back({name, element.GetLineNum(), numbers_.at(&element),
                     element.FirstChildElement("visual") != nullptr});
  }

  void add_joint(const XMLElement& element) {
    xml_.set_context("a joint");
    UrdfJoint joint;
    joint.line = element.GetLineNum();
    joint.name = xml_.get_text(element, "name");
    xml_.set_context(fmt::format("joint '{}'", joint.name));
    if (!joint_names_.insert(joint.name).second) {
      xml_.fail(element, "the name is used by an earlier joint; names must be unique");
    }
    joint.type = xml_.get_text(element, "type");
    const std::vector<std::string> types{"revolute", "continuous", "prismatic",
                                         "fixed",    "floating",   "planar"};
    if (std::find(types.begin(), types.end(), joint.type) == types.end()) {
      xml_.fail(element, describe_unknown("type", joint.type, types));
    }
    joint.parent = read_end(element, "parent");
    joint.child = read_end(element, "child");
    if (joint.parent == joint.child) {
      xml_.fail(element, fmt::format("joins link '{}' to itself; parent and child must differ",
                                     joint.parent));
    }
    joints.push_back(std::move(joint));
  }

  // Returns the name of the link that <parent> or <child> refers to.
  std::string read_end(const XMLElement& joint, const char* end) const {
    const XMLElement& element =
        xml_.get_only(joint, end, "a joint needs a parent and a child link");
    xml_.check_names(element, {}, {"link"});
    const std::string link = xml_.get_text(element, "link");
    if (!link_names_.contains(link)) {
      const std::vector<std::string> known(link_names_.begin(), link_names_.end());
      xml_.fail(element, fmt::format("<{}>: {}", end, describe_unknown("link", link, known)));
    }
    return link;
  }

  UrdfXml& xml_;
  const UrdfNumbers& numbers_;
  std::set<std::string> link_names_, joint_names_;
};

// Numbers an element and those inside it in the file's order.
void add_numbers(const XMLElement& element, UrdfNumbers& numbers) {
  numbers.emplace(&element, numbers.size());
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    add_numbers(*child, numbers);  // at most kUrdfDepthLimit deep
  }
}

// Throws unless the version is 1.0, the only version of URDF.
void check_version(const XMLElement& robot, const UrdfXml& xml) {
  const std::string version = xml.get_text(robot, "version");
  if (version != "1.0") {
    xml.fail(robot, fmt::format("<robot>: version is '{}'; it must be 1.0, or left out",
                                shorten(version)));
  }
}

// Parses the text into `document` and returns its <robot>, whose name and version are checked.
const XMLElement& parse_robot(std::string_view xml_text, const std::string& name, UrdfXml& xml,
                              tinyxml2::XMLDocument& document) {
  scan_urdf(xml_text, name);
  if (document.Parse(xml_text.data(), xml_text.size()) != tinyxml2::XML_SUCCESS) {
    fail_urdf(name, std::max(1, document.ErrorLineNum()),
              fmt::format("is not well-formed XML: {}", explain(document)));
  }
  const XMLElement& robot = find_robot(document, xml, name);
  xml.check_names(robot,
                  {"link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control"},
                  {"name", "version"});
  xml.get_text(robot, "name");
  if (robot.Attribute("version") != nullptr) {
    check_version(robot, xml);
  }
  return robot;
}

}  // namespace

std::vector<CollisionShape> parse_collisions(std::string_view xml_text, const std::string& name) {
  tinyxml2::XMLDocument document;
  UrdfXml xml(name);
  const XMLElement& robot = parse_robot(xml_text, name, xml, document);
  UrdfNumbers numbers;
  add_numbers(robot, numbers);
  const Index index(robot, xml, name, numbers);
  std::map<std::string, std::vector<std::size_t>> below;  // the joints of each parent link
  std::vector<Eigen::Isometry3d> origins;
  UrdfFaults faults(name);
  for (const XMLElement* e = robot.FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint")) {
    const UrdfJoint& joint = index.joints[origins.size()];
    xml.set_context(fmt::format("joint '{}'", joint.name));
    below[joint.parent].push_back(origins.size());
    Eigen::Isometry3d& origin = origins.emplace_back(Eigen::Isometry3d::Identity());
    faults.attempt([&] { origin = read_origin(*e, xml); });
  }
  std::map<std::string, Eigen::Isometry3d> poses;
  std::vector<std::string> open = {find_root(index.links, index.joints, name).name};
  poses[open.front()] = Eigen::Isometry3d::Identity();
  while (!open.empty()) {
    const std::string link = std::move(open.back());
    open.pop_back();
    for (const std::size_t joint : below[link]) {
      const std::string& child = index.joints[joint].child;
      poses[child] = poses.at(link) * origins[joint];
      open.push_back(child);
    }
  }
  std::vector<CollisionShape> collisions;
  std::size_t number = 0;
  for (const XMLElement* e = robot.FirstChildElement("link"); e != nullptr;
       e = e->NextSiblingElement("link")) {
    const std::string& link = index.links[number++].name;
    xml.set_context(fmt::format("link '{}'", link));
    for (const XMLElement* its = e->FirstChildElement("collision"); its != nullptr;
         its = its->NextSiblingElement("collision")) {
      faults.attempt([&] {
        xml.check_names(*its, {"origin", "geometry"}, {"name"});
        VisualShape shape = read_geometry(*its, xml);
        if (has_no_size(shape)) {
          xml.fail(*its, "the <collision> has a size of 0; give it a size or leave it out");
        }
        shape.pose = poses.at(link) * shape.pose;
        collisions.push_back({link, its->GetLineNum(), std::move(shape)});
      });
    }
  }
  faults.throw_if_any();
  return collisions;
}

CheckedUrdf check_urdf(std::string_view xml_text, const std::string& name,
                       const RobotOptions& options, UrdfFaults& faults) {
  tinyxml2::XMLDocument document;
  UrdfXml xml(name);
  const XMLElement& robot = parse_robot(xml_text, name, xml, document);
  CheckedUrdf checked;
  checked.name = robot.Attribute("name");
  UrdfNumbers numbers;
  add_numbers(robot, numbers);
  VisualChecker visuals(robot, xml, numbers, checked.repairs);
  Index index(robot, xml, name, numbers);
  checked.chain = choose_chain(index.links, index.joints, options, name);
  checked.links = std::move(index.links);
  checked.joints = std::move(index.joints);
  InertialChecker inertials(checked.chain, options.repair, xml, numbers, checked.repairs);
  for (const XMLElement* e = robot.FirstChildElement("link"); e != nullptr;
       e = e->NextSiblingElement("link")) {
    const std::string& link = checked.links[checked.bodies.size()].name;
    UrdfBody& body = checked.bodies.emplace_back();
    xml.set_context(fmt::format("link '{}'", link));
    const std::size_t before = faults.count();
    faults.attempt([&] {
      xml.check_names(*e, {"inertial", "visual", "collision", "sensor"}, {"name", "type"});
      inertials.read(*e, link, body, faults);
    });
    body.has_faults = faults.count() > before;
    visuals.read(*e, link, body);
  }
  JointChecker joints(checked.chain, options.dynamics, xml, faults);
  for (const XMLElement* e = robot.FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint")) {
    checked.placements.push_back(joints.read(*e, checked.joints[checked.placements.size()]));
  }
  checked.notes = inertials.make_notes();
  for (std::string& note : joints.make_notes()) {
    checked.notes.push_back(std::move(note));
  }
  return checked;
}

}  // namespace armwright
