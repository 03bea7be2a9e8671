// Gains of ros2_control: what is read has a controller with usable numbers for every joint.
#include <cmath>

#include "fuzz/harness.hpp"
#include "problems/config/gains_file.hpp"

namespace armwright::fuzz {

void fuzz_gains(std::string_view input) {
  RobotModel robot;
  for (const char* name : {"a", "b"}) {
    Joint joint;
    joint.name = name;
    joint.effort_limit = 10;
    robot.joints.push_back(joint);
  }
  for (const ControlInterface interface :
       {ControlInterface::effort, ControlInterface::velocity, ControlInterface::position}) {
    is_read([&] {
      ArmDrives drives;
      drives.interface = interface;
      const ArmDesign design = parse_gains(input, "gains.yaml", robot, drives);
      const ControllerRow& row = find_controller(design.controller);
      require(row.interface == interface, "a controller of another interface");
      require(design.joints.size() == robot.joint_count(), "gains of other joints");
      for (const JointDrive& drive : design.joints) {
        require(drive.gains.size() == row.gains.size(), "a wrong number of gains");
        for (const double gain : drive.gains) {
          require(std::isfinite(gain) && gain >= 0, "a gain that is no number");
        }
        require(drive.limits.min <= 0 && drive.limits.max >= 0, "limits that are not in order");
      }
    });
  }
}

}  // namespace armwright::fuzz
