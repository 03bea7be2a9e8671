// Checks the links of a URDF and reads them.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

// The largest principal moment may exceed the sum of the others by this fraction, because a thin
// plate's moments can be rounded to three digits.
constexpr double kTriangleTolerance = 1e-3;

constexpr const char* kEntries[3][3] = {
    {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};

Eigen::Matrix3d read_tensor(const XMLElement& inertia, const UrdfXml& xml) {
  xml.check_names(inertia, {}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
  Eigen::Matrix3d tensor;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      tensor(row, column) = xml.read_number(inertia, kEntries[row][column]);
    }
  }
  return tensor;
}

void check_tensor(const XMLElement& element, const Eigen::Matrix3d& tensor, const UrdfXml& xml) {
  const Eigen::Vector3d moments =  // ascending
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string found =
      fmt::format("<inertia> has the principal moments {:.6g}, {:.6g}, {:.6g} kg m2", moments[0],
                  moments[1], moments[2]);
  if (!(moments[0] > 0)) {
    xml.fail(element,
             found + "; all must be > 0 (a positive definite tensor about the centre of mass)");
  }
  if (!(moments[0] + moments[1] >= (1 - kTriangleTolerance) * moments[2])) {
    xml.fail(
        element,
        found + "; no body has such moments: the largest must not exceed the sum of the other two");
  }
}

}  // namespace

LinkChecker::LinkChecker(const XMLElement& robot, UrdfXml& xml) : xml_(xml) {
  collect_colors(robot);
  for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    for (const XMLElement* visual = link->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual")) {
      collect_colors(*visual);
    }
  }
}

// Materials are defined at the top level or in the visual that uses them first.
void LinkChecker::collect_colors(const XMLElement& holder) {
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
}

UrdfBody LinkChecker::read(const XMLElement& link, const std::string& link_name) {
  xml_.set_context(fmt::format("link '{}'", link_name));
  xml_.check_names(link, {"inertial", "visual", "collision", "sensor"}, {"name", "type"});
  UrdfBody body;
  if (const XMLElement* inertial = xml_.find_only(link, "inertial")) {
    body.inertial = read_inertial(*inertial, link_name);
  }
  for (const XMLElement* visual = link.FirstChildElement("visual"); visual != nullptr;
       visual = visual->NextSiblingElement("visual")) {
    body.shapes.push_back(read_visual(*visual));
  }
  return body;
}

std::optional<Inertial> LinkChecker::read_inertial(const XMLElement& element,
                                                   const std::string& link_name) {
  xml_.check_names(element, {"origin", "mass", "inertia"}, {});
  const XMLElement& mass =
      xml_.get_only(element, "mass",
                    "a body needs its mass in kg (leave <inertial> out for a frame without mass)");
  xml_.check_names(mass, {}, {"value"});
  const double mass_kg = xml_.read_number(mass, "value");
  if (mass_kg < 0) {
    xml_.fail(mass, fmt::format("<mass>: value is {}; it must be > 0", mass_kg));
  }
  const XMLElement& inertia = xml_.get_only(
      element, "inertia", "a body needs its inertia about the centre of mass in kg m2");
  const Eigen::Matrix3d tensor = read_tensor(inertia, xml_);
  if (mass_kg == 0 && tensor.isZero(0)) {
    massless_.push_back(fmt::format("'{}'", link_name));
    return std::nullopt;
  }
  if (mass_kg == 0) {
    xml_.fail(mass,
              "<mass>: value is 0; it must be > 0 (a frame without mass has an inertia of zeros, "
              "or no <inertial>)");
  }
  check_tensor(inertia, tensor, xml_);
  // The matrix is symmetric because URDF names each off-diagonal entry once.
  const Inertial body{mass_kg, Eigen::Vector3d::Zero(), tensor};
  return transform(body, read_origin(element, xml_));
}

VisualShape LinkChecker::read_visual(const XMLElement& element) {
  xml_.check_names(element, {"origin", "geometry", "material"}, {"name"});
  VisualShape shape;
  shape.pose = read_origin(element, xml_);
  const XMLElement& geometry = xml_.get_only(element, "geometry", "a visual needs one");
  const std::vector<std::string> kinds{"box", "cylinder", "sphere", "mesh"};
  const XMLElement* child = geometry.FirstChildElement();
  if (child == nullptr || child->NextSiblingElement() != nullptr) {
    xml_.fail(geometry, fmt::format("<geometry> must hold exactly one of {}", join(kinds, ", ")));
  }
  xml_.check_names(geometry, kinds, {});
  read_shape(*child, kinds, shape);
  if (const XMLElement* material = xml_.find_only(element, "material")) {
    read_color(*material, shape);
  }
  return shape;
}

void LinkChecker::read_shape(const XMLElement& element, const std::vector<std::string>& kinds,
                             VisualShape& shape) {
  const std::string kind = element.Name();
  if (kind == "box") {
    xml_.check_names(element, {}, {"size"});
    const std::vector<double> size = xml_.read_numbers(element, "size", 3);
    if (*std::min_element(size.begin(), size.end()) <= 0) {
      xml_.fail(element, fmt::format("<box>: size is '{}'; all three edges must be > 0",
                                     shorten(element.Attribute("size"))));
    }
    shape.kind = ShapeKind::box;
    shape.size_m = Eigen::Vector3d(size[0], size[1], size[2]);
  } else if (kind == "cylinder") {
    xml_.check_names(element, {}, {"radius", "length"});
    shape.kind = ShapeKind::cylinder;
    const double radius = xml_.read_positive(element, "radius");
    shape.size_m = Eigen::Vector3d(radius, xml_.read_positive(element, "length"), 0);
  } else if (kind == "sphere") {
    xml_.check_names(element, {}, {"radius"});
    shape.kind = ShapeKind::sphere;
    shape.size_m = Eigen::Vector3d(xml_.read_positive(element, "radius"), 0, 0);
  } else if (kind == "mesh") {
    xml_.check_names(element, {}, {"filename", "scale"});
    shape.kind = ShapeKind::mesh;
    shape.mesh_file = xml_.get_text(element, "filename");
    const std::vector<double> scale = xml_.read_numbers(element, "scale", 3, {1, 1, 1});
    shape.size_m = Eigen::Vector3d(scale[0], scale[1], scale[2]);
  } else {
    xml_.fail(element,
              describe_unknown("shape", kind, kinds) +
                  (kind == "capsule" ? " (write a capsule as three <visual>, a cylinder and "
                                       "a sphere at each end, or leave it out: visuals only "
                                       "give looks, and mass if robot.density_kg_per_m3 is set)"
                                     : ""));
  }
}

// Sets the shape's colour. A material without a colour takes the colour of the first material of
// the same name.
void LinkChecker::read_color(const XMLElement& material, VisualShape& shape) {
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
    return;  // it has only a texture
  }
  for (int i = 0; i < 4; ++i) {
    shape.rgba[i] = static_cast<float>(
        rgba[static_cast<std::size_t>(i)]);  // rounded to float, as in version 1.0
  }
}

std::vector<std::string> LinkChecker::make_notes() const {
  if (massless_.empty()) {
    return {};
  }
  return {fmt::format("<inertial> with zeros is taken for none: {}", join(massless_, ", "))};
}

}  // namespace armwright
