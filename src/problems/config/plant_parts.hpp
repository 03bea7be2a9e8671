// The parts of a plant's file (plant_file.hpp) that are not joints: bodies, and what an identification
// left uncertain. Internal to the readers and writers of these files.
#pragma once

#include "base/config.hpp"
#include "sim/identification/fitted_plant.hpp"

namespace armwright {

// The tables [payload] and [identification]; the tables [link.NAME] have the keys of [payload].
extern const SettingTable kPayloadSettings, kFittedSettings;

// Both throw Error{usage} for a body that cannot exist. A link must have a mass.
Inertial read_body(const ConfigTable& table);
Inertial read_link_body(const ConfigTable& table);
// Throws Error{usage} for a parameter that the robot does not have, and a covariance that is none.
FittedPlant read_fitted(const ConfigTable& table, const RobotModel& robot);

}  // namespace armwright
