// Mass, centre of mass and inertia of solid shapes of one density. A mesh is the solid that its
// triangles enclose: its integrals of 1, r and r r^T are sums over the tetrahedra between the
// triangles and one point, signed by the triangles' orientation,
//   V = sum d/6,  int r dV = sum d/24 s,  int r r^T dV = sum d/120 (s s^T + a a^T + b b^T + c c^T)
// with corners a, b, c from that point, d = a . (b x c) and s = a + b + c (the divergence theorem;
// as B. Mirtich, "Fast and accurate computation of polyhedral mass properties", J. Graphics Tools
// 1(2), 1996, and D. Eberly, "Polyhedral mass properties (revisited)", 2002, come to it by way of
// surface and line integrals).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sim/robot/mesh_file.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// Why a mesh encloses no solid: edges whose triangles are missing or lie the other way round. The
// corners of triangles are the same where they have the same coordinates. Nothing if it is closed.
std::optional<std::string> find_gap(const TriangleMesh& mesh);

// Of a mesh without gap, in the frame in which `scale` stretches its coordinates; a mirroring scale
// turns the triangles round as well. A volume that is not positive (triangles that show their backs
// outside, or a sheet without thickness) is an Error{bad_data} that says so.
Inertial calc_mesh_inertial(const TriangleMesh& mesh, const Eigen::Vector3d& scale,
                            double density_kg_per_m3);

// Of any shape, in the link's frame. Meshes are looked for from `folder`; `file` gets the one that
// was read. Error{bad_data} "what is wrong, what to do" for a mesh that is not there, cannot be
// read, or is no solid, and for a shape too small to have an inertia.
Inertial calc_shape_inertial(const VisualShape& shape, double density_kg_per_m3,
                             const std::filesystem::path& folder,
                             std::optional<std::filesystem::path>& file);

}  // namespace armwright
