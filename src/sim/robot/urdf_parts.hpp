// The parts of urdf_check.cpp: they read links and joints strictly.
// Private to the .cpp files urdf_check*.cpp.
#pragma once

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

#include "sim/robot/urdf.hpp"
#include "sim/robot/urdf_xml.hpp"

namespace armwright {

// The pose that the <origin> of an element gives; the identity if it has none.
Eigen::Isometry3d read_origin(const tinyxml2::XMLElement& parent, const UrdfXml& xml);

// Links: mass and looks.
class LinkChecker {
 public:
  // Materials are known before the links that use them.
  LinkChecker(const tinyxml2::XMLElement& robot, UrdfXml& xml);

  UrdfBody read(const tinyxml2::XMLElement& link, const std::string& link_name);
  std::vector<std::string> make_notes() const;

 private:
  void collect_colors(const tinyxml2::XMLElement& holder);
  std::optional<Inertial> read_inertial(const tinyxml2::XMLElement& element,
                                        const std::string& link_name);
  VisualShape read_visual(const tinyxml2::XMLElement& element);
  void read_shape(const tinyxml2::XMLElement& element, const std::vector<std::string>& kinds,
                  VisualShape& shape);
  void read_color(const tinyxml2::XMLElement& material, VisualShape& shape);

  UrdfXml& xml_;
  std::map<std::string, std::vector<double>> colors_;  // of materials, empty: a texture only
  std::map<const tinyxml2::XMLElement*, std::vector<double>> own_colors_;  // of each <material>
  std::vector<std::string> massless_;
};

// Joints: where they are and how far they go.
class JointChecker {
 public:
  JointChecker(const UrdfChain& chain, UrdfXml& xml) : chain_(chain), xml_(xml) {}

  UrdfPlacement read(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  std::vector<std::string> make_notes() const;

 private:
  Joint read_motion(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  void hold(const tinyxml2::XMLElement& element, const UrdfJoint& joint,
            UrdfPlacement& placement) const;
  Eigen::Vector3d read_axis(const tinyxml2::XMLElement& element) const;
  void read_limit(const tinyxml2::XMLElement& element, const UrdfJoint& joint, Joint& motion);
  void note_extras(const tinyxml2::XMLElement& element, const UrdfJoint& joint);

  const UrdfChain& chain_;
  UrdfXml& xml_;
  std::vector<std::string> rubbing_, softly_limited_;              // joints, in the file's order
  std::map<std::string, std::vector<std::string>> without_limit_;  // by attribute of <limit>
};

}  // namespace armwright
