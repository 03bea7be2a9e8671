// Makes the arm as the page's replay draws it: its shapes, its chain of joints, its tip.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/tracking/task.hpp"

namespace armwright {

// Returns Robot of web/src/data.ts. `model` is the arm without its load. The load of `task`, above
// 0 kg, is a shape on the last body in its own colour (add_load()); its obstacles are shapes of the
// base, which does not move. Meshes are STL, OBJ or Collada
// files, which MeshFinder finds from `urdf_folder`; limits are 64 MiB per file and 200 000
// triangles per robot. A mesh that cannot be read is left out. A body whose shapes are all missing
// gets plain shapes, and so do all bodies of a robot without any shapes. `notes` gets a whole
// sentence for each of these cases, and one if masses of the robot are assumed.
nlohmann::json make_robot(const RobotModel& model, const TrackingTask& task,
                          const std::filesystem::path& urdf_folder,
                          std::vector<std::string>& notes);

// Returns the index of this robot in `robots`, and adds it if it is missing.
std::size_t add_robot(const RobotModel& model, const TrackingTask& task,
                      const std::filesystem::path& urdf_folder, nlohmann::json& robots,
                      std::vector<std::string>& notes);

// Return a sphere, and a cylinder between two points (m).
VisualShape make_ball(const Eigen::Vector3d& centre, double radius, const Eigen::Vector4d& rgba);
VisualShape make_cylinder(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius,
                          const Eigen::Vector4d& rgba);

// Returns plain shapes for each body, the base first, for a robot whose description has none: a
// tube with round ends from a joint to the next one or to the tip, a drum around the axis of a
// revolute joint, a rod along the axis of a prismatic one. The thickness follows from the length of
// the chain and decreases towards the tip.
std::vector<std::vector<VisualShape>> make_plain_shapes(const RobotModel& model);

}  // namespace armwright
