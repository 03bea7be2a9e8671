// The arm as the page's replay draws it: its shapes, its chain of joints, its tip.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace armwright {

// Robot of web/src/data.ts. `model` is the arm without its load; add_load() puts `load_kg` (0:
// none) onto the last body, as a box in a colour of its own. Meshes (STL, OBJ, Collada) are looked
// for as find_mesh() says from `urdf_folder`, of at most 64 MiB a file and 200 000 triangles in
// all. A mesh that cannot be read is left out; a body whose shapes are all missing, or all bodies
// of a robot without any, get plain shapes along the chain. `notes` gets a whole sentence for each
// of these. Error of add_load() if the robot cannot carry a load.
nlohmann::json make_robot(const RobotModel& model, double load_kg,
                          const std::filesystem::path& urdf_folder,
                          std::vector<std::string>& notes);

// The index in `robots` of that robot, which is added unless it is there already.
std::size_t add_robot(const RobotModel& model, double load_kg,
                      const std::filesystem::path& urdf_folder, nlohmann::json& robots,
                      std::vector<std::string>& notes);

}  // namespace armwright
