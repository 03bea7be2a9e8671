// What urdf_check.cpp is made of: the parts of a URDF read strictly and written again as plain XML.
// Private to the .cpp files urdf_check*.cpp.
#pragma once

#include <tinyxml2.h>

#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "sim/robot/urdf.hpp"
#include "sim/robot/urdf_xml.hpp"

namespace armwright {

class UrdfWriter {
 public:
  UrdfWriter() : printer_(nullptr, true) {}

  void open(const char* element) { printer_.OpenElement(element); }
  void close() { printer_.CloseElement(); }
  void write(const char* attribute, const std::string& text) {
    printer_.PushAttribute(attribute, text.c_str());
  }
  void write(const char* attribute, const std::vector<double>& numbers);
  void write(const char* attribute, std::initializer_list<double> numbers) {
    write(attribute, std::vector<double>(numbers));
  }
  std::string text() const { return printer_.CStr(); }

 private:
  tinyxml2::XMLPrinter printer_;
};

// The <origin> of an element, if it has one.
void copy_origin(const tinyxml2::XMLElement& parent, const UrdfXml& xml, UrdfWriter& out);

// Links: mass and looks.
class LinkChecker {
 public:
  // Materials are known before the links that use them.
  LinkChecker(const tinyxml2::XMLElement& robot, UrdfXml& xml, UrdfWriter& out);

  void check(const tinyxml2::XMLElement& link, const std::string& link_name);
  std::vector<std::string> make_notes() const;

 private:
  void collect_colors(const tinyxml2::XMLElement& holder);
  void check_inertial(const tinyxml2::XMLElement& element, const std::string& link_name);
  void check_visual(const tinyxml2::XMLElement& element);
  void check_shape(const tinyxml2::XMLElement& shape, const std::vector<std::string>& shapes);
  void write_color(const tinyxml2::XMLElement& material);

  UrdfXml& xml_;
  UrdfWriter& out_;
  std::map<std::string, std::vector<double>> colors_;  // of materials, empty: a texture only
  std::map<const tinyxml2::XMLElement*, std::vector<double>> own_colors_;  // of each <material>
  int materials_ = 0;
  std::vector<std::string> massless_;
};

// Joints: where they are and how far they go.
class JointChecker {
 public:
  JointChecker(const UrdfChain& chain, UrdfXml& xml, UrdfWriter& out)
      : chain_(chain), xml_(xml), out_(out) {}

  void check(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  const std::map<std::string, HeldJoint>& held() const { return held_; }
  std::vector<std::string> make_notes() const;

 private:
  void write_moving(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  HeldJoint hold(const tinyxml2::XMLElement& element, const UrdfJoint& joint) const;
  std::vector<double> read_axis(const tinyxml2::XMLElement& element) const;
  void write_limit(const tinyxml2::XMLElement& element, const UrdfJoint& joint);
  void note_extras(const tinyxml2::XMLElement& element, const UrdfJoint& joint);

  const UrdfChain& chain_;
  UrdfXml& xml_;
  UrdfWriter& out_;
  std::map<std::string, HeldJoint> held_;
  std::vector<std::string> rubbing_, softly_limited_;              // joints, in the file's order
  std::map<std::string, std::vector<std::string>> without_limit_;  // by attribute of <limit>
};

}  // namespace armwright
