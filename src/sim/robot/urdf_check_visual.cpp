// Reads the shapes of links, and leaves out visual ones that cannot be shown.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

const std::vector<std::string> kShapes{"box", "cylinder", "sphere", "mesh"};

void read_shape(const XMLElement& element, const UrdfXml& xml, const char* holder,
                VisualShape& shape) {
  const std::string kind = element.Name();
  if (kind == "box") {
    xml.check_names(element, {}, {"size"});
    const std::vector<double> size = xml.read_numbers(element, "size", 3);
    if (std::ranges::min(size) < 0) {
      xml.fail(element, fmt::format("<box>: size is '{}'; all three edges must be > 0",
                                    shorten(element.Attribute("size"))));
    }
    shape.kind = ShapeKind::box;
    shape.size_m = Eigen::Vector3d(size[0], size[1], size[2]);
  } else if (kind == "cylinder") {
    xml.check_names(element, {}, {"radius", "length"});
    shape.kind = ShapeKind::cylinder;
    const double radius = xml.read_not_negative(element, "radius");
    shape.size_m = Eigen::Vector3d(radius, xml.read_not_negative(element, "length"), 0);
  } else if (kind == "sphere") {
    xml.check_names(element, {}, {"radius"});
    shape.kind = ShapeKind::sphere;
    shape.size_m = Eigen::Vector3d(xml.read_not_negative(element, "radius"), 0, 0);
  } else if (kind == "mesh") {
    xml.check_names(element, {}, {"filename", "scale"});
    shape.kind = ShapeKind::mesh;
    shape.mesh_file = xml.get_text(element, "filename");
    const std::vector<double> scale = xml.read_numbers(element, "scale", 3, {1, 1, 1});
    shape.size_m = Eigen::Vector3d(scale[0], scale[1], scale[2]);
  } else {
    xml.fail(element, describe_unknown("shape", kind, kShapes) +
                          (kind == "capsule"
                               ? fmt::format(" (write a capsule as three <{}>, a cylinder and a "
                                             "sphere at each end)",
                                             holder)
                               : ""));
  }
}

}  // namespace

bool has_no_size(const VisualShape& shape) {
  const Eigen::Index count = shape.kind == ShapeKind::box        ? 3
                             : shape.kind == ShapeKind::cylinder ? 2
                                                                 : 1;
  return shape.kind != ShapeKind::mesh && shape.size_m.head(count).minCoeff() == 0;
}

VisualShape read_geometry(const XMLElement& element, const UrdfXml& xml) {
  VisualShape shape;
  shape.pose = read_origin(element, xml);
  const std::string hint = fmt::format("a {} needs one", element.Name());
  const XMLElement& geometry = xml.get_only(element, "geometry", hint.c_str());
  const XMLElement* child = geometry.FirstChildElement();
  if (child == nullptr || child->NextSiblingElement() != nullptr) {
    xml.fail(geometry, fmt::format("<geometry> must hold exactly one of {}", join(kShapes, ", ")));
  }
  xml.check_names(geometry, kShapes, {});
  read_shape(*child, xml, element.Name(), shape);
  return shape;
}

VisualChecker::VisualChecker(const XMLElement& robot, UrdfXml& xml, const UrdfNumbers& numbers,
                             UrdfRepairs& repairs)
    : xml_(xml), numbers_(numbers), repairs_(repairs) {
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
void VisualChecker::collect_colors(const XMLElement& holder) {
  for (const XMLElement* e = holder.FirstChildElement("material"); e != nullptr;
       e = e->NextSiblingElement("material")) {
    try {
      const std::vector<double> rgba = read_rgba(*e);
      const char* material = e->Attribute("name");
      if (!rgba.empty() || e->FirstChildElement("texture") != nullptr) {
        colors_.emplace(material == nullptr ? "" : material, rgba);
      }
      own_colors_[e] = rgba;
    } catch (const UrdfFault& fault) {
      repairs_.add("a <material> that cannot be used is left out",
                   fmt::format("line {}: {}", fault.line(), fault.detail()),
                   {{numbers_.at(e), UrdfEdit::Kind::remove}});
    }
  }
}

// Returns the colour of a <material>, or nothing if it states none.
std::vector<double> VisualChecker::read_rgba(const XMLElement& material) const {
  xml_.check_names(material, {"color", "texture"}, {"name"});
  std::vector<double> rgba;
  if (const XMLElement* color = xml_.find_only(material, "color")) {
    xml_.check_names(*color, {}, {"rgba"});
    rgba = xml_.read_numbers(*color, "rgba", 4);
    for (const double part : rgba) {
      if (part < 0 || part > 1) {
        xml_.fail(*color,
                  fmt::format("<color>: rgba has the part {}; each must be in [0, 1]", part));
      }
    }
  }
  return rgba;
}

void VisualChecker::read(const XMLElement& link, const std::string& link_name, UrdfBody& body) {
  for (const XMLElement* visual = link.FirstChildElement("visual"); visual != nullptr;
       visual = visual->NextSiblingElement("visual")) {
    const std::vector<UrdfEdit> removed{{numbers_.at(visual), UrdfEdit::Kind::remove}};
    try {
      xml_.check_names(*visual, {"origin", "geometry", "material"}, {"name"});
      VisualShape shape = read_geometry(*visual, xml_);
      if (has_no_size(shape)) {
        repairs_.add("a <visual> of size 0 is left out",
                     fmt::format("'{}' (line {})", link_name, visual->GetLineNum()), removed);
        continue;
      }
      read_color(*visual, link_name, shape);
      body.shapes.push_back(std::move(shape));
    } catch (const UrdfFault& fault) {
      body.unshown = fmt::format("line {}: {}", fault.line(), fault.detail());
      repairs_.add("a <visual> that cannot be shown is left out",
                   fmt::format("'{}' ({})", link_name, body.unshown), removed);
    }
  }
}

// Returns whether the shape can have a colour from this material.
bool VisualChecker::is_usable(const XMLElement& material) const {
  const auto own = own_colors_.find(&material);
  if (own == own_colors_.end()) {
    return false;
  }
  const char* const name = material.Attribute("name");
  return !own->second.empty() || material.FirstChildElement("texture") != nullptr ||
         (name != nullptr && colors_.contains(name));
}

// Sets the shape's colour to that of its first usable material. A material without a colour takes
// the colour of the first material of the same name.
void VisualChecker::read_color(const XMLElement& visual, const std::string& link_name,
                               VisualShape& shape) {
  const XMLElement* used = nullptr;
  std::vector<UrdfEdit> others;
  std::string unknown;
  for (const XMLElement* material = visual.FirstChildElement("material"); material != nullptr;
       material = material->NextSiblingElement("material")) {
    if (used == nullptr && is_usable(*material)) {
      used = material;
      continue;
    }
    others.push_back({numbers_.at(material), UrdfEdit::Kind::remove});
    if (const char* const name = material->Attribute("name");
        name != nullptr && unknown.empty() && own_colors_.contains(material)) {
      unknown = xml_.get_text(*material, "name");
    }
  }
  const std::string place = fmt::format("'{}' (line {})", link_name, visual.GetLineNum());
  if (used == nullptr) {
    if (!others.empty()) {
      std::vector<std::string> known;
      for (const auto& [name, color] : colors_) {
        known.push_back(name);
      }
      repairs_.add(unknown.empty() ? "a <visual> without a usable <material> is grey"
                                   : fmt::format("{}; the shape is grey",
                                                 describe_unknown("material", unknown, known)),
                   place, std::move(others));
    }
    return;
  }
  if (!others.empty()) {
    repairs_.add("a <visual> has one <material>; the first usable one counts", place,
                 std::move(others));
  }
  std::vector<double> rgba = own_colors_.at(used);
  if (rgba.empty() && used->FirstChildElement("texture") == nullptr) {
    rgba = colors_.at(used->Attribute("name"));
  }
  if (rgba.empty()) {
    return;  // it has only a texture
  }
  for (int i = 0; i < 4; ++i) {
    shape.rgba[i] = static_cast<float>(
        rgba[static_cast<std::size_t>(i)]);  // rounded to float, as in version 1.0
  }
}

}  // namespace armwright
