// Strict reading of XML elements, links and joints. Only urdf_xml.cpp and urdf_check*.cpp include
// this header. Every error is a UrdfFault and names the file, the line, the link or joint, the
// element and the attribute.
#pragma once

#include <tinyxml2.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/urdf.hpp"

namespace armwright {

// Returns the beginning of a text from a file, safe to print in a message.
std::string shorten(std::string_view text);

// A reader of single XML elements that throws for everything it does not accept.
class UrdfXml {
 public:
  // `name` is the file's name in messages.
  explicit UrdfXml(std::string name) : name_(std::move(name)) {}

  // Sets how messages name the current link or joint, for example "link 'link_1'".
  void set_context(std::string where) { where_ = std::move(where); }
  // Throws UrdfFault with the file's name, the element's line and the context.
  [[noreturn]] void fail(const tinyxml2::XMLElement& element, const std::string& what) const;
  // Throws Error{bad_data} about text that xacro must expand first. It is no UrdfFault, because all
  // other faults are of no use then.
  [[noreturn]] void fail_as_xacro(const tinyxml2::XMLElement& element,
                                  const std::string& what) const;

  // Throws for a child or attribute whose name looks misspelt, and for elements of xacro. Ignores
  // other extensions of URDF.
  void check_names(const tinyxml2::XMLElement& element, const std::vector<std::string>& children,
                   const std::vector<std::string>& attributes) const;

  // Return the only child of that name and throw if there is a second one. If there is none,
  // find_only() returns null and get_only() throws.
  const tinyxml2::XMLElement* find_only(const tinyxml2::XMLElement& parent,
                                        const char* child_name) const;
  const tinyxml2::XMLElement& get_only(const tinyxml2::XMLElement& parent, const char* child_name,
                                       const char* hint) const;

  // Returns an attribute's text. Throws if it is missing, empty or not printable.
  std::string get_text(const tinyxml2::XMLElement& element, const char* attribute) const;

  // Returns the `count` finite numbers of an attribute, or `fallback` if the attribute is missing.
  // Throws if it is missing and `fallback` is empty.
  std::vector<double> read_numbers(const tinyxml2::XMLElement& element, const char* attribute,
                                   std::size_t count,
                                   const std::vector<double>& fallback = {}) const;
  double read_number(const tinyxml2::XMLElement& element, const char* attribute) const;
  double read_number(const tinyxml2::XMLElement& element, const char* attribute,
                     double fallback) const;
  double read_not_negative(const tinyxml2::XMLElement& element, const char* attribute) const;

 private:
  void check_spelling(const tinyxml2::XMLElement& at, const std::string& what,
                      const std::string& found, const std::vector<std::string>& valid) const;
  void refuse_xacro(const tinyxml2::XMLElement& element, const char* attribute,
                    std::string_view text) const;

  std::string name_;
  std::string where_ = "the file";
};

// Returns the pose of an element's <origin>, or the identity if it has none.
Eigen::Isometry3d read_origin(const tinyxml2::XMLElement& parent, const UrdfXml& xml);
// Returns the pose and the <geometry> of a <visual> or <collision>.
VisualShape read_geometry(const tinyxml2::XMLElement& element, const UrdfXml& xml);
// Returns whether a box, cylinder or sphere has an edge, a radius or a length of 0.
bool has_no_size(const VisualShape& shape);

// The numbers of the elements of a file (UrdfEdit).
using UrdfNumbers = std::map<const tinyxml2::XMLElement*, std::size_t>;

// A reader of the <visual> elements of links. It leaves out what cannot be shown.
class VisualChecker {
 public:
  // Reads the robot's materials, which visuals refer to by name.
  VisualChecker(const tinyxml2::XMLElement& robot, UrdfXml& xml, const UrdfNumbers& numbers,
                UrdfRepairs& repairs);

  // Adds the shapes of a link to `body`.
  void read(const tinyxml2::XMLElement& link, const std::string& link_name, UrdfBody& body);

 private:
  void collect_colors(const tinyxml2::XMLElement& holder);
  std::vector<double> read_rgba(const tinyxml2::XMLElement& material) const;
  void read_color(const tinyxml2::XMLElement& visual, const std::string& link_name,
                  VisualShape& shape);
  bool is_usable(const tinyxml2::XMLElement& material) const;

  UrdfXml& xml_;
  const UrdfNumbers& numbers_;
  UrdfRepairs& repairs_;
  std::map<std::string, std::vector<double>> colors_;  // by material; empty: only a texture
  std::map<const tinyxml2::XMLElement*, std::vector<double>> own_colors_;  // by <material>
};

// A reader of the <inertial> elements of links.
class InertialChecker {
 public:
  // `repair`: as RobotOptions::repair.
  InertialChecker(const UrdfChain& chain, bool repair, UrdfXml& xml, const UrdfNumbers& numbers,
                  UrdfRepairs& repairs)
      : chain_(chain), repair_(repair), xml_(xml), numbers_(numbers), repairs_(repairs) {}

  // Sets the mass properties of a link, if it has some. Adds what is wrong with them to the faults
  // if the link moves.
  void read(const tinyxml2::XMLElement& link, const std::string& link_name, UrdfBody& body,
            UrdfFaults& faults);
  std::vector<std::string> make_notes() const;

 private:
  void read_inertial(const tinyxml2::XMLElement& element, const std::string& link_name,
                     UrdfBody& body, UrdfFaults& faults);
  Eigen::Matrix3d check_tensor(const tinyxml2::XMLElement& inertia, const Eigen::Matrix3d& tensor,
                               double mass_kg, const std::string& link_name);

  const UrdfChain& chain_;
  bool repair_;
  UrdfXml& xml_;
  const UrdfNumbers& numbers_;
  UrdfRepairs& repairs_;
  std::vector<std::string> massless_;
};

// A reader of <joint> elements: their origins, axes, limits and friction.
class JointChecker {
 public:
  // `dynamics`: as RobotOptions::dynamics.
  JointChecker(const UrdfChain& chain, bool dynamics, UrdfXml& xml, UrdfFaults& faults)
      : chain_(chain), dynamics_(dynamics), xml_(xml), faults_(faults) {}

  // Adds what is wrong with the joint to the faults.
  UrdfPlacement read(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  std::vector<std::string> make_notes() const;

 private:
  Joint read_motion(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  void refuse_kind(const tinyxml2::XMLElement& element, const UrdfJoint& joint) const;
  void hold(const tinyxml2::XMLElement& element, const UrdfJoint& joint,
            UrdfPlacement& placement) const;
  Eigen::Vector3d read_axis(const tinyxml2::XMLElement& element) const;
  void read_limit(const tinyxml2::XMLElement& element, const UrdfJoint& joint, Joint& motion);
  void read_dynamics(const tinyxml2::XMLElement& element, const UrdfJoint& joint, Joint& motion);

  const UrdfChain& chain_;
  bool dynamics_;
  UrdfXml& xml_;
  UrdfFaults& faults_;
  std::vector<std::string> rubbing_, softly_limited_;              // joints, in the file's order
  std::map<std::string, std::vector<std::string>> without_limit_;  // by attribute of <limit>
};

}  // namespace armwright
