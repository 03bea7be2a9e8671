// Meshes that a URDF names: where they lie and what is in them. Read with Assimp, which is an
// optional library of the build (ARMWRIGHT_WITH_ASSIMP).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

inline constexpr std::size_t kMeshFileLimit_bytes = std::size_t{64} << 20;

struct TriangleMesh {
  std::vector<float> positions;        // 3 a vertex
  std::vector<std::uint32_t> indices;  // 3 a triangle
};

// The file that `name` means in a URDF of the folder: "package://NAME/REST" is NAME/REST beside the
// folder or one of its parents, or REST in that of them which is called NAME; "file://PATH" and
// absolute paths stand for themselves; anything else is looked for in the folder, then in its
// parents. Nothing if there is no such file.
std::optional<std::filesystem::path> find_mesh(const std::string& name,
                                               const std::filesystem::path& folder);

// Whether this build can read any.
bool can_read_meshes();

// All triangles of an STL (binary or text), OBJ or Collada file of that size, in its own axes and
// in units of it (Collada: in m). No other file is opened, whatever it refers to. Error{bad_data}
// names the file and says what is wrong with it; Error{io} if it cannot be read.
TriangleMesh read_mesh(const std::filesystem::path& file);

}  // namespace armwright
