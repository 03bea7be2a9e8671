// Generated arms: URDFs of three to seven joints with plausible sizes and masses. The joints are
// tilted and shifted at random so that no closed form fits.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/random.hpp"

namespace armwright {

inline constexpr int kGeneratedArms = 10;

// Returns the arm of a number from 0 to kGeneratedArms - 1. It has 3 + number % 5 joints.
inline std::string make_arm_urdf(int number) {
  RandomStream random("test/arm", static_cast<std::uint64_t>(number));
  const int joints = 3 + number % 5;
  // Like most arms: a turning base, a shoulder, an elbow, then rolls and bends.
  const std::vector<std::string> axes =
      joints == 7
          ? std::vector<std::string>{"0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1"}
          : std::vector<std::string>{"0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1"};
  const double size = random.uniform(0.5, 1.5);
  std::string urdf = fmt::format("<robot name=\"arm_{}\">\n  <link name=\"base\"/>\n", number);
  std::string parent = "base";
  double length_m = 0.3 * size;
  for (int i = 0; i < joints; ++i) {
    const double next_m = size * (i < 3 ? random.uniform(0.25, 0.45) : random.uniform(0.08, 0.2));
    const double mass_kg = 12 * size * std::pow(0.6, i) * random.uniform(0.7, 1.3);
    const double across = mass_kg * (next_m * next_m / 12 + 0.0025);
    const double tilt = 0.1;
    // Motors with more than three times the effort that holds the whole arm stretched out.
    const double effort = 400 * size * size * std::pow(0.55, i);
    urdf += fmt::format(
        R"(  <joint name="joint_{0}" type="revolute">
    <parent link="{1}"/><child link="link_{0}"/>
    <origin xyz="{2} {3} {4}" rpy="{5} {6} {7}"/><axis xyz="{8}"/>
    <limit lower="{9}" upper="{10}" velocity="{11}" effort="{12}"/>
  </joint>
  <link name="link_{0}">
    <inertial><origin xyz="0.01 {3} {13}"/><mass value="{14}"/>
      <inertia ixx="{15}" iyy="{15}" izz="{16}" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 {13}"/><geometry><cylinder radius="0.05" length="{17}"/></geometry></visual>
  </link>
)",
        i + 1, parent, random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), length_m,
        random.uniform(-tilt, tilt), random.uniform(-tilt, tilt), random.uniform(-tilt, tilt),
        axes[static_cast<std::size_t>(i)], -2.8, random.uniform(2.2, 2.8), random.uniform(2, 5),
        effort, next_m / 2, mass_kg, across, mass_kg * 0.0025, next_m);
    parent = fmt::format("link_{}", i + 1);
    length_m = next_m;
  }
  return urdf + fmt::format(R"(  <joint name="flange" type="fixed">
    <parent link="{}"/><child link="tool"/><origin xyz="0.03 0 {}" rpy="0.1 0.2 0"/>
  </joint>
  <link name="tool"/>
</robot>
)",
                            parent, length_m);
}

}  // namespace armwright
