// A compiled MJCF file and the chain that is simulated of it. Only mjcf_*.cpp include this header,
// and only with ARMWRIGHT_WITH_MUJOCO.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "sim/robot/mjcf.hpp"
#include "sim/robot/mujoco_library.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {

// Numbers of bodies, joints and so on are int in the library.
inline std::size_t to_size(int number) {
  return static_cast<std::size_t>(number);
}

// The edge of the tetrahedron that stands for a mesh. Its corners are the origin and the points at
// this distance on the axes.
inline constexpr double kStandInEdge_m = 10;

struct CompiledMjcf {
  std::string name;  // the file's name in messages
  MjcfText text;
  // Tetrahedrons stand for all meshes in files, so files that only give the looks are not needed.
  MujocoModelHandle model;

  // Return the names in the file. A part without a name is named after its number.
  std::string body_name(int body) const;
  std::string joint_name(int joint) const;
  // Throw Error{bad_data} with the place of the body or joint, if it has a name.
  [[noreturn]] void fail_body(int body, const std::string& what) const;
  [[noreturn]] void fail_joint(int joint, const std::string& what) const;
};

// Throws Error{bad_data} "FILE:LINE: what the library says" if the library refuses the file.
CompiledMjcf compile_prepared(MjcfText text, const std::string& name);

// Gives the bodies of the model for which `moves` is true the masses that their meshes decide, if
// any. Returns the mesh files that it read, by name as written. Throws Error{bad_data} for a mesh
// that decides a mass and is missing.
std::map<std::string, std::filesystem::path> load_mesh_masses(
    CompiledMjcf& mjcf, const std::map<std::string, std::filesystem::path>& packages,
    const std::function<bool(int body)>& moves);

// The part of the tree of bodies that is simulated as the chain.
struct MjcfChain {
  int base = 0, tip = 0;    // bodies
  int site = -1;            // the site of the tip body whose frame is the tip; -1: the body's own
  std::vector<int> joints;  // from the base to the tip
  // For each body: i if joint i - 1 of the chain moves it, 0 if it is part of the fixed base.
  std::vector<std::size_t> carriers;
  UrdfChain choice;  // of links; the tip may be the name of a site
};

// Returns the chain that `options` selects. Throws as parse_urdf() does, and Error{bad_data} if a
// joint, an equality constraint or a tendon of the chain cannot be simulated.
MjcfChain choose_mjcf_chain(const CompiledMjcf& mjcf, const RobotOptions& options);

inline constexpr double kNoMjcfLimit = std::numeric_limits<double>::infinity();

// Returns the largest effort that the joint's actuators exert in both directions, in N m or N;
// infinity if nothing bounds it. Adds a note if they exert more in one direction.
double find_effort_limit(const CompiledMjcf& mjcf, int joint, std::vector<std::string>& notes);

// Returns the plant of a joint whose limits are those of `joint`. A spring (stiffness, springref)
// is a counterbalance. Throws Error{bad_data} for negative values and for a spring without a range.
JointPlant read_plant(const CompiledMjcf& mjcf, int id, const Joint& joint);

// Adds the visual shapes. `in_links` has the pose of each body in the frame of the link that
// carries it.
void add_shapes(RobotModel& robot, const CompiledMjcf& mjcf, const MjcfChain& chain,
                const std::vector<Eigen::Isometry3d>& in_links);

}  // namespace armwright
