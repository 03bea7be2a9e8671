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
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Returns nothing if the mesh is closed; otherwise the reason why it encloses no solid: an edge
// lacks a triangle, or two triangles at an edge have opposite orientations. Corners with equal
// coordinates count as the same corner.
std::optional<std::string> find_gap(const TriangleMesh& mesh);

// Returns the mass properties of a mesh without gaps, after `scale` has multiplied its coordinates.
// A scale that mirrors the mesh also reverses the triangles' orientation. Throws Error{bad_data} if
// the volume is not positive: the triangles face inwards, or the mesh is a sheet without thickness.
Inertial calc_mesh_inertial(const TriangleMesh& mesh, const Eigen::Vector3d& scale,
                            double density_kg_per_m3);

// Returns the mass properties of any shape, in the link's frame. Searches meshes from `folder`
// (find_mesh()) and writes the path of the mesh that it read into `file`. Throws Error{bad_data}
// "what is wrong, what to do" for a mesh that does not exist, cannot be read or is not a solid, and
// for a shape that is too small to have an inertia.
Inertial calc_shape_inertial(const VisualShape& shape, double density_kg_per_m3,
                             const std::filesystem::path& folder,
                             std::optional<std::filesystem::path>& file);

}  // namespace armwright
