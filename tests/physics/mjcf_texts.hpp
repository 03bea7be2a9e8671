// Texts of arms in MJCF for the tests, and what is said of those that are refused.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright::physics_test {

inline std::string describe_mjcf_refusal(const std::string& xml,
                                         const RobotOptions& options = {.dynamics = true}) {
  try {
    parse_urdf(xml, "arm.xml", options);
    return "it was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), dynamic_cast<const RobotOptionError*>(&error) != nullptr
                                ? ErrorKind::usage
                                : ErrorKind::bad_data);
    return error.what();
  }
}

// Returns an arm of one joint in MJCF, with this content of its body and after the bodies.
inline std::string make_hinge_arm(const std::string& in_body, const std::string& after = "") {
  return "<mujoco>\n<compiler angle=\"radian\"/>\n<worldbody>\n<body name=\"arm\">\n"
         "<joint name=\"hinge\" axis=\"0 1 0\" range=\"-1 1\"/>\n" +
         in_body + "\n</body>\n</worldbody>\n" + after + "</mujoco>\n";
}
inline const std::string kMjcfBar = "<geom type=\"box\" size=\"0.1 0.1 0.4\"/>";

inline void write_mjcf(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

inline const std::string kMjcfMesh =
    "<asset><mesh name=\"cover\" file=\"parts/Cover.OBJ\" scale=\"0.001 0.002 0.001\"/></asset>\n";
inline const std::string kMjcfCover =
    "<geom type=\"mesh\" mesh=\"cover\" pos=\"0.1 0.2 0.3\" quat=\"0.6 0 0.8 0\" group=\"1\"";

}  // namespace armwright::physics_test
