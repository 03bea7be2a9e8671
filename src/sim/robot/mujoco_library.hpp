// Compiles MJCF with the library MuJoCo. Only .cpp files of this room include this header, and only
// with ARMWRIGHT_WITH_MUJOCO.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <memory>
#include <string>

namespace armwright {

static_assert(sizeof(mjtNum) == sizeof(double), "armwright needs MuJoCo in double precision");

// Frees an object of MuJoCo with the given function.
template <auto kFree>
struct MujocoDeleter {
  void operator()(auto* object) const { kFree(object); }
};
using MujocoModelHandle = std::unique_ptr<mjModel, MujocoDeleter<mj_deleteModel>>;
using MujocoDataHandle = std::unique_ptr<mjData, MujocoDeleter<mj_deleteData>>;

// Returns the model of the file `main`, or null and the library's reason in `message`. `files` has
// the content of the main file and of all files that it refers to, by names of less than 1000 bytes
// without a folder. Thread-safe.
MujocoModelHandle compile_mjcf(const std::string& main,
                               const std::map<std::string, std::string>& files,
                               std::string& message);

}  // namespace armwright
