// Reads mesh files. Needs Assimp, which is an optional library of the build (ARMWRIGHT_WITH_ASSIMP).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace armwright {

// The largest mesh file that read_mesh() accepts.
inline constexpr std::size_t kMeshFileLimit_bytes = std::size_t{64} << 20;

struct TriangleMesh {
  std::vector<float> positions;        // three coordinates per vertex, in the mesh's units
  std::vector<std::uint32_t> indices;  // three vertex numbers per triangle
};

// Returns whether this build can read mesh files (built with Assimp).
bool can_read_meshes();

// Returns all triangles of an STL (binary or text), OBJ or Collada file, in the file's axes and
// units (Collada: in m). Opens no other file that this one refers to. Throws Error{bad_data} if the
// file exceeds kMeshFileLimit_bytes, has another format or is damaged; the message names the file.
// Throws Error{io} if the file cannot be read.
TriangleMesh read_mesh(const std::filesystem::path& file);

}  // namespace armwright
