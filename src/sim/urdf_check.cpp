#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>

#include "base/text.hpp"
#include "sim/urdf.hpp"
#include "sim/urdf_xml.hpp"

namespace armwright {
namespace {

using tinyxml2::XMLElement;

// How far the largest principal moment may exceed the sum of the others: the rounding of a plate's
// moments to three digits.
constexpr double kTriangleTolerance = 1e-3;
// An axis shorter than this has no direction worth the name.
constexpr double kShortestAxis = 1e-6;

std::string explain(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed by another name, or not at all";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is malformed or given twice; they are written name=\"value\"";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "it has no elements; a URDF has one <robot> element";
    default:
      return document.ErrorName();
  }
}

// One pass over the document that validates and writes side by side.
class Checker {
 public:
  explicit Checker(const std::string& name) : name_(name), xml_(name), out_(nullptr, true) {}

  std::string check(std::string_view xml) {
    tinyxml2::XMLDocument document;
    if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
      fail_urdf(name_, std::max(1, document.ErrorLineNum()),
                fmt::format("is not well-formed XML: {}", explain(document)));
    }
    const XMLElement* robot = document.RootElement();
    if (robot == nullptr) {
      fail_urdf(name_, 1, "has no element at all; a URDF has one <robot> element");
    }
    if (std::string_view(robot->Name()) != "robot") {
      xml_.fail(*robot, fmt::format("begins with <{}>; a URDF's root element is <robot>",
                                    shorten(robot->Name())));
    }
    if (const XMLElement* second = robot->NextSiblingElement()) {
      xml_.fail(*second, fmt::format("has <{}> after </robot>; a URDF has one root element",
                                     shorten(second->Name())));
    }
    check_robot(*robot);
    return out_.CStr();
  }

 private:
  void write(const char* attribute, std::initializer_list<double> numbers) {
    write(attribute, std::vector<double>(numbers));
  }
  void write(const char* attribute, const std::vector<double>& numbers) {
    std::vector<std::string> texts;
    for (const double number : numbers) {
      texts.push_back(format_exact(number));
    }
    out_.PushAttribute(attribute, join(texts, " ").c_str());
  }
  void write(const char* attribute, const std::string& text) {
    out_.PushAttribute(attribute, text.c_str());
  }

  void check_robot(const XMLElement& robot) {
    xml_.check_names(robot, {"link", "joint", "material", "transmission", "gazebo", "sensor"},
                     {"name", "version"});
    out_.OpenElement("robot");
    write("name", xml_.get_text(robot, "name"));
    if (robot.Attribute("version") != nullptr) {
      write("version", xml_.get_text(robot, "version"));
    }
    collect_colors(robot);
    std::vector<UrdfLink> links;
    for (const XMLElement* e = robot.FirstChildElement("link"); e != nullptr;
         e = e->NextSiblingElement("link")) {
      links.push_back(check_link(*e));
      if (links.size() > kUrdfLinkLimit) {
        xml_.fail(*e, fmt::format("is one too many; at most {} links are allowed", kUrdfLinkLimit));
      }
    }
    if (links.empty()) {
      xml_.fail(robot, "<robot> has no <link>; it needs a chain of links and joints");
    }
    std::vector<UrdfJoint> joints;
    for (const XMLElement* e = robot.FirstChildElement("joint"); e != nullptr;
         e = e->NextSiblingElement("joint")) {
      joints.push_back(check_joint(*e));
    }
    out_.CloseElement();
    check_urdf_chain(links, joints, name_);
  }

  // Materials are defined at the top or in the visual that uses them first.
  void collect_colors(const XMLElement& robot) {
    const auto add = [&](const XMLElement& holder) {
      for (const XMLElement* e = holder.FirstChildElement("material"); e != nullptr;
           e = e->NextSiblingElement("material")) {
        xml_.check_names(*e, {"color", "texture"}, {"name"});
        std::vector<double> rgba;
        if (const XMLElement* color = xml_.find_only(*e, "color")) {
          xml_.check_names(*color, {}, {"rgba"});
          rgba = xml_.read_numbers(*color, "rgba", 4);
          for (const double part : rgba) {
            if (part < 0 || part > 1) {
              xml_.fail(*color,
                        fmt::format("<color>: rgba has the part {}; each must be in [0, 1]", part));
            }
          }
        }
        const char* material = e->Attribute("name");
        if (!rgba.empty() || e->FirstChildElement("texture") != nullptr) {
          colors_.emplace(material == nullptr ? "" : material, rgba);
        }
        own_colors_[e] = rgba;
      }
    };
    add(robot);
    for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
      for (const XMLElement* visual = link->FirstChildElement("visual"); visual != nullptr;
           visual = visual->NextSiblingElement("visual")) {
        add(*visual);
      }
    }
  }

  UrdfLink check_link(const XMLElement& element) {
    xml_.set_context("a link");
    const std::string link_name = xml_.get_text(element, "name");
    xml_.set_context(fmt::format("link '{}'", link_name));
    if (!link_names_.insert(link_name).second) {
      xml_.fail(element, "the name is used by an earlier link; names must be unique");
    }
    xml_.check_names(element, {"inertial", "visual", "collision", "sensor"}, {"name", "type"});
    out_.OpenElement("link");
    write("name", link_name);
    const XMLElement* inertial = xml_.find_only(element, "inertial");
    if (inertial != nullptr) {
      check_inertial(*inertial);
    }
    for (const XMLElement* visual = element.FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual")) {
      check_visual(*visual);
    }
    out_.CloseElement();
    return {link_name, element.GetLineNum(), inertial != nullptr};
  }

  void check_origin(const XMLElement& parent) {
    const XMLElement* origin = xml_.find_only(parent, "origin");
    if (origin == nullptr) {
      return;
    }
    xml_.check_names(*origin, {}, {"xyz", "rpy"});
    if (origin->Attribute("quat_xyzw") != nullptr) {
      xml_.fail(*origin, "<origin>: quat_xyzw is not supported; give the rotation as rpy");
    }
    const std::vector<double> xyz = xml_.read_numbers(*origin, "xyz", 3, {0, 0, 0});
    const std::vector<double> rpy = xml_.read_numbers(*origin, "rpy", 3, {0, 0, 0});
    out_.OpenElement("origin");
    write("xyz", xyz);
    write("rpy", rpy);
    out_.CloseElement();
  }

  void check_inertial(const XMLElement& element) {
    xml_.check_names(element, {"origin", "mass", "inertia"}, {});
    out_.OpenElement("inertial");
    check_origin(element);

    const XMLElement& mass = xml_.get_only(
        element, "mass",
        "a body needs its mass in kg (leave <inertial> out for a frame without mass)");
    xml_.check_names(mass, {}, {"value"});
    out_.OpenElement("mass");
    write("value", {xml_.read_positive(mass, "value")});
    out_.CloseElement();

    const XMLElement& inertia = xml_.get_only(
        element, "inertia", "a body needs its inertia about the centre of mass in kg m2");
    xml_.check_names(inertia, {}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
    out_.OpenElement("inertia");
    Eigen::Matrix3d tensor;
    constexpr const char* kEntries[3][3] = {
        {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        tensor(row, column) = xml_.read_number(inertia, kEntries[row][column]);
        if (row <= column) {
          write(kEntries[row][column], {tensor(row, column)});
        }
      }
    }
    out_.CloseElement();
    check_tensor(inertia, tensor);
    out_.CloseElement();
  }

  void check_tensor(const XMLElement& element, const Eigen::Matrix3d& tensor) const {
    const Eigen::Vector3d moments =  // ascending
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly)
            .eigenvalues();
    const std::string found =
        fmt::format("<inertia> has the principal moments {:.6g}, {:.6g}, {:.6g} kg m2", moments[0],
                    moments[1], moments[2]);
    if (!(moments[0] > 0)) {
      xml_.fail(element,
                found + "; all must be > 0 (a positive definite tensor about the centre of mass)");
    }
    if (!(moments[0] + moments[1] >= (1 - kTriangleTolerance) * moments[2])) {
      xml_.fail(
          element,
          found + "; no body has these: the largest must not exceed the sum of the other two");
    }
  }

  void check_visual(const XMLElement& element) {
    xml_.check_names(element, {"origin", "geometry", "material"}, {"name"});
    out_.OpenElement("visual");
    check_origin(element);
    const XMLElement& geometry = xml_.get_only(element, "geometry", "a visual needs one");
    const std::vector<std::string> shapes{"box", "cylinder", "sphere", "mesh"};
    const XMLElement* shape = geometry.FirstChildElement();
    if (shape == nullptr || shape->NextSiblingElement() != nullptr) {
      xml_.fail(geometry,
                fmt::format("<geometry> must hold exactly one of {}", join(shapes, ", ")));
    }
    xml_.check_names(geometry, shapes, {});
    out_.OpenElement("geometry");
    check_shape(*shape, shapes);
    out_.CloseElement();
    if (const XMLElement* material = xml_.find_only(element, "material")) {
      write_color(*material);
    }
    out_.CloseElement();
  }

  void check_shape(const XMLElement& shape, const std::vector<std::string>& shapes) {
    const std::string kind = shape.Name();
    out_.OpenElement(kind.c_str());
    if (kind == "box") {
      xml_.check_names(shape, {}, {"size"});
      const std::vector<double> size = xml_.read_numbers(shape, "size", 3);
      if (*std::min_element(size.begin(), size.end()) <= 0) {
        xml_.fail(shape, fmt::format("<box>: size is '{}'; all three edges must be > 0",
                                     shorten(shape.Attribute("size"))));
      }
      write("size", size);
    } else if (kind == "cylinder") {
      xml_.check_names(shape, {}, {"radius", "length"});
      write("radius", {xml_.read_positive(shape, "radius")});
      write("length", {xml_.read_positive(shape, "length")});
    } else if (kind == "sphere") {
      xml_.check_names(shape, {}, {"radius"});
      write("radius", {xml_.read_positive(shape, "radius")});
    } else if (kind == "mesh") {
      xml_.check_names(shape, {}, {"filename", "scale"});
      write("filename", xml_.get_text(shape, "filename"));
      write("scale", xml_.read_numbers(shape, "scale", 3, {1, 1, 1}));
    } else {
      xml_.fail(shape, describe_unknown("shape", kind, shapes));
    }
    out_.CloseElement();
  }

  // Under a name of its own, as urdfdom takes the first colour it saw for every material of that
  // name ("", say).
  void write_color(const XMLElement& material) {
    std::vector<double> rgba = own_colors_.at(&material);
    if (rgba.empty() && material.FirstChildElement("texture") == nullptr) {
      const std::string wanted = xml_.get_text(material, "name");
      const auto found = colors_.find(wanted);
      if (found == colors_.end()) {
        std::vector<std::string> known;
        for (const auto& [known_name, color] : colors_) {
          known.push_back(known_name);
        }
        xml_.fail(material, describe_unknown("material", wanted, known));
      }
      rgba = found->second;
    }
    if (rgba.empty()) {
      return;  // a texture only
    }
    out_.OpenElement("material");
    write("name", fmt::format("material_{}", ++materials_));
    out_.OpenElement("color");
    write("rgba", rgba);
    out_.CloseElement();
    out_.CloseElement();
  }

  UrdfJoint check_joint(const XMLElement& element) {
    xml_.set_context("a joint");
    UrdfJoint joint;
    joint.line = element.GetLineNum();
    joint.name = xml_.get_text(element, "name");
    xml_.set_context(fmt::format("joint '{}'", joint.name));
    if (!joint_names_.insert(joint.name).second) {
      xml_.fail(element, "the name is used by an earlier joint; names must be unique");
    }
    xml_.check_names(element,
                     {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic",
                      "calibration", "safety_controller"},
                     {"name", "type"});
    const std::string type = xml_.get_text(element, "type");
    if (type != "revolute" && type != "continuous" && type != "prismatic" && type != "fixed") {
      xml_.fail(element, fmt::format("the type is '{}'; only revolute, continuous, prismatic and "
                                     "fixed are supported",
                                     type));
    }
    joint.moving = type != "fixed";
    out_.OpenElement("joint");
    write("name", joint.name);
    write("type", type);
    joint.parent = check_end(element, "parent");
    joint.child = check_end(element, "child");
    if (joint.parent == joint.child) {
      xml_.fail(element, fmt::format("joins link '{}' to itself; parent and child must differ",
                                     joint.parent));
    }
    check_origin(element);
    if (joint.moving) {
      check_axis(element);
      check_limit(element, type);
      check_extras(element);
    }
    out_.CloseElement();
    return joint;
  }

  // The link that <parent> or <child> names.
  std::string check_end(const XMLElement& joint, const char* end) {
    const XMLElement& element =
        xml_.get_only(joint, end, "a joint needs a parent and a child link");
    xml_.check_names(element, {}, {"link"});
    const std::string link = xml_.get_text(element, "link");
    if (!link_names_.contains(link)) {
      const std::vector<std::string> known(link_names_.begin(), link_names_.end());
      xml_.fail(element, fmt::format("<{}>: {}", end, describe_unknown("link", link, known)));
    }
    out_.OpenElement(end);
    write("link", link);
    out_.CloseElement();
    return link;
  }

  void check_axis(const XMLElement& joint) {
    std::vector<double> axis{1, 0, 0};  // URDF's default
    if (const XMLElement* element = xml_.find_only(joint, "axis")) {
      xml_.check_names(*element, {}, {"xyz"});
      axis = xml_.read_numbers(*element, "xyz", 3);
      if (std::hypot(axis[0], axis[1], axis[2]) < kShortestAxis) {
        xml_.fail(*element,
                  fmt::format("<axis>: xyz is '{}', which has no direction; give one such as 0 0 1",
                              shorten(element->Attribute("xyz"))));
      }
    }
    out_.OpenElement("axis");
    write("xyz", axis);
    out_.CloseElement();
  }

  void check_limit(const XMLElement& joint, const std::string& type) {
    const bool prismatic = type == "prismatic";
    const bool bounded = prismatic || type == "revolute";
    const XMLElement* limit = xml_.find_only(joint, "limit");
    if (limit == nullptr) {
      if (prismatic) {
        xml_.fail(joint,
                  "has no <limit>; a prismatic joint needs one (lower and upper in m, velocity in "
                  "m/s, effort in N)");
      }
      if (bounded) {
        xml_.fail(joint,
                  "has no <limit>; a revolute joint needs one (lower and upper in rad, velocity in "
                  "rad/s, effort in N m), "
                  "or the type must be continuous");
      }
      return;
    }
    xml_.check_names(*limit, {}, {"lower", "upper", "velocity", "effort"});
    out_.OpenElement("limit");
    if (bounded) {
      const double lower = xml_.read_number(*limit, "lower", 0.0);
      const double upper = xml_.read_number(*limit, "upper", 0.0);
      if (lower > upper) {
        xml_.fail(*limit,
                  fmt::format("<limit>: lower is {} and upper is {} {}; lower must be <= upper",
                              lower, upper, prismatic ? "m" : "rad"));
      }
      write("lower", {lower});
      write("upper", {upper});
    }
    for (const char* attribute : {"velocity", "effort"}) {
      const double value = xml_.read_number(*limit, attribute);
      if (value < 0) {
        xml_.fail(*limit, fmt::format("<limit>: {} is {}; it must be >= 0", attribute, value));
      }
      write(attribute, {value});
    }
    out_.CloseElement();
  }

  // What would change how the joint moves, and is not simulated: refused rather than silently left
  // out.
  void check_extras(const XMLElement& joint) const {
    if (const XMLElement* mimic = xml_.find_only(joint, "mimic")) {
      xml_.fail(*mimic,
                "<mimic> joints are not supported; remove the element, or make the joint fixed");
    }
    const XMLElement* dynamics = xml_.find_only(joint, "dynamics");
    if (dynamics == nullptr) {
      return;
    }
    xml_.check_names(*dynamics, {}, {"damping", "friction"});
    for (const char* attribute : {"damping", "friction"}) {
      const double value = xml_.read_number(*dynamics, attribute, 0.0);
      if (value != 0) {
        xml_.fail(*dynamics,
                  fmt::format("<dynamics>: {} is {}, but joints are simulated without any; "
                              "set it to 0 or remove it",
                              attribute, value));
      }
    }
  }

  const std::string& name_;
  UrdfXml xml_;
  tinyxml2::XMLPrinter out_;
  std::set<std::string> link_names_, joint_names_;
  std::map<std::string, std::vector<double>> colors_;  // of materials, empty: a texture only
  std::map<const XMLElement*, std::vector<double>> own_colors_;  // of each <material> element
  int materials_ = 0;
};

}  // namespace

std::string check_urdf(std::string_view xml, const std::string& name) {
  scan_urdf(xml, name);
  return Checker(name).check(xml);
}

}  // namespace armwright
