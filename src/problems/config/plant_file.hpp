// The file of a plant: rotor inertia, friction, elasticity and counterbalance of a robot's joints
// (sim/robot/joint_plant.hpp), as TOML with one table [joint.NAME] per joint. Keys end with their
// units, so revolute and prismatic joints have keys of their own (plant_settings()).
//
// A rotor of inertia J behind a gear of ratio G gives the joint the armature G^2 J. G is the
// motor's angle per joint position, rad/rad or rad/m.
//
// A counterbalance is given by points, straight between them, or as a gas spring. Its link is at
// the distance D from the joint's axis, its other end at k. With x = q + angle offset:
//   dl = sqrt(D^2 + k^2 - 2 D k cos x) - (D - k)   the spring's lengthening
//   h  = D k sin x / (dl + D - k)                  its lever arm
//   s  = -h A c / (V - A dl)                       its effort on the joint
// A is the area that the gas acts on, (pi / 4) (piston^2 - rod^2). c is pressure times volume, and V
// the gas volume at dl = 0. The spring pulls the joint to x = 0. Source: Weigand, Gafur and
// Ruskowski (2021), the hydraulic counterbalance of a KUKA KR300, with constant temperature. Both
// forms may have the corrections scale and slope of sim/robot/joint_plant.hpp.
//
// Beside the joints, a file may have a payload, other mass properties of links, and the uncertainty
// that an identification left ([identification], sim/identification/fitted_plant.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/setting.hpp"
#include "sim/identification/fitted_plant.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// The value of robot.plant that takes the file beside the URDF, if it exists.
inline constexpr const char* kPlantBeside = "auto";

// Returns "arm.plant.toml" for "arm.urdf" and for "arm", in the same folder.
std::filesystem::path name_plant_file(std::filesystem::path urdf);

// Sets the plants of the robot's joints, and its payload and links where the file has them. A value
// of the file replaces that of the model; the other values stay. Counterbalances get 1025 points.
// Tables of joints that the URDF has beside the chain are checked for unknown keys and ignored.
// Returns what an identification left uncertain, or nothing if the file does not say it.
//
// Throws Error{io} if the file cannot be read, and Error{bad_data} that names file, line and key for
// - a joint that the robot does not have, and keys for the other kind of joint,
// - a negative armature, viscous or Coulomb friction, stiffness or damping,
// - Stribeck friction below -Coulomb friction,
// - a transition rate that is not positive, a Stribeck rate below the transition rate,
// - an unactuated joint without spring and damper, with a counterbalance, or with a range without 0,
// - stiffness without armature, and damping or a measured side without stiffness,
// - a counterbalance on a joint without finite range or with more than one turn,
// - points whose positions do not increase or do not cover the joint's range,
// - a gas spring whose volume is used up within the range,
// - a body that cannot exist, a parameter that the robot does not have, a covariance that is none.
std::optional<FittedPlant> load_plant(const std::filesystem::path& file, RobotModel& robot);

// Returns the text of a file with all that `robot` has beyond `urdf`, the same robot without a
// plant's file, and with `fitted`. The robot that load_plant() makes of both is the same up to the
// rounding of counterbalances. `head` is written before it as a comment.
std::string write_plant(const RobotModel& robot, const RobotModel& urdf, const FittedPlant& fitted,
                        const std::string& head);

// Returns the declarations of the file's settings, for joints called NAME.
const SettingTable& plant_settings();

// Returns the numbers of a joint's plant by their keys in the file, but no counterbalance.
std::map<std::string, double> list_plant_numbers(const Joint& joint);

// Returns the plant of a joint as words with units: "armature 1.2 kg m^2, Coulomb friction 5 N m".
// Empty for the ideal joint.
std::string describe_plant(const Joint& joint);

}  // namespace armwright
