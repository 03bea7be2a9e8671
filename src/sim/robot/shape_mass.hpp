// Computes mass, centre of mass and inertia of solid shapes of uniform density. A mesh stands for
// the solid that its triangles enclose. Each triangle forms a tetrahedron with one common point.
// The integrals of 1, r and r r^T over the solid are sums over these tetrahedra, with the signs of
// the triangles' orientations:
//   V = sum d/6,  int r dV = sum d/24 s,  int r r^T dV = sum d/120 (s s^T + a a^T + b b^T + c c^T)
// Here a, b, c are the triangle's corners relative to the common point, d = a . (b x c), and s = a
// + b + c. This follows from the divergence theorem. B. Mirtich, "Fast and accurate computation of
// polyhedral mass properties", J. Graphics Tools 1(2), 1996, and D. Eberly, "Polyhedral mass
// properties (revisited)", 2002, derive it from surface and line integrals.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// The edges of a mesh. Corners with equal coordinates count as the same corner.
struct MeshEdges {
  std::size_t count = 0;
  std::size_t open = 0;    // with a triangle on one side only
  std::size_t turned = 0;  // between triangles of opposite orientations
};
MeshEdges count_edges(const TriangleMesh& mesh);

// A mesh with fewer open edges than this share of all counts as closed. Its volume has an error of
// the same order.
inline constexpr double kMostOpenEdges = 0.01;

// Returns nothing if the mesh encloses a solid; otherwise the reason why it does not: too many open
// edges, or turned ones.
std::optional<std::string> find_gap(const MeshEdges& edges);

// Returns the mass properties of a mesh, after `scale` has multiplied its coordinates.
// A scale that mirrors the mesh also reverses the triangles' orientation. Throws Error{bad_data} if
// the volume is not positive: the triangles face inwards, or the mesh is a sheet without thickness.
Inertial calc_mesh_inertial(const TriangleMesh& mesh, const Eigen::Vector3d& scale,
                            double density_kg_per_m3);

struct ShapeMass {
  Inertial inertial;                          // in the link's frame
  std::optional<std::filesystem::path> file;  // the mesh that was read
  std::string note;                           // about the mesh; may be empty
};

// Returns the mass properties of any shape. Throws Error{bad_data} "what is wrong, what to do" for a
// mesh that does not exist, cannot be read or is not a solid, and for a shape that is too small to
// have an inertia.
ShapeMass calc_shape_mass(const VisualShape& shape, double density_kg_per_m3, MeshFinder& meshes);

}  // namespace armwright
