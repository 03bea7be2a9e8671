#include "sim/robot/shape_mass.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using std::numbers::pi;

// A volume below this fraction of the cube of the mesh's diagonal counts as rounding error. For
// comparison: a metal sheet of 1 m by 1 m by 1 um has three times this fraction.
constexpr double kThinnest = 1e-7;

constexpr std::string_view kRemedy = "repair the mesh, or give the link an <inertial> element";

Inertial make_body(double mass_kg, double ixx, double iyy, double izz) {
  return {mass_kg, Eigen::Vector3d::Zero(), Eigen::Vector3d(ixx, iyy, izz).asDiagonal()};
}

// The mass properties of solids about their centres, from the standard formulas. A cylinder's axis
// is z.
Inertial make_box(const Eigen::Vector3d& edges, double density_kg_per_m3) {
  const double mass = density_kg_per_m3 * edges.prod();
  const Eigen::Vector3d squares = edges.cwiseAbs2() * (mass / 12);
  return make_body(mass, squares.y() + squares.z(), squares.x() + squares.z(),
                   squares.x() + squares.y());
}
Inertial make_cylinder(double radius_m, double length_m, double density_kg_per_m3) {
  const double mass = density_kg_per_m3 * pi * radius_m * radius_m * length_m;
  const double across = mass / 12 * (3 * radius_m * radius_m + length_m * length_m);
  return make_body(mass, across, across, mass / 2 * radius_m * radius_m);
}
Inertial make_sphere(double radius_m, double density_kg_per_m3) {
  const double mass = density_kg_per_m3 * 4 / 3 * pi * radius_m * radius_m * radius_m;
  const double moment = 0.4 * mass * radius_m * radius_m;
  return make_body(mass, moment, moment, moment);
}

Eigen::Vector3d get_corner(const TriangleMesh& mesh, std::size_t index) {
  const float* at = mesh.positions.data() + 3 * std::size_t{mesh.indices[index]};
  return {at[0], at[1], at[2]};
}

ShapeMass calc_file_mass(const VisualShape& shape, double density_kg_per_m3, MeshFinder& meshes) {
  ShapeMass result;
  const std::string name = sanitize(shape.mesh_file);
  result.file = meshes.find(shape.mesh_file);
  if (!result.file) {
    throw Error(ErrorKind::bad_data,
                fmt::format("there is no mesh '{}' in the URDF's folder and the folders above it, "
                            "but the link's mass comes from this mesh; put it there, say where its "
                            "package is (--package NAME=DIR, robot.packages), or give the link an "
                            "<inertial> element",
                            name));
  }
  const TriangleMesh mesh = read_mesh(*result.file);
  const std::string where = sanitize(result.file->string());
  const MeshEdges edges = count_edges(mesh);
  if (const std::optional<std::string> gap = find_gap(edges)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the mesh {} gives the link no mass: {}; {}", where, *gap, kRemedy));
  }
  if (edges.open > 0) {
    result.note = fmt::format(
        "the mesh {} is not quite closed ({} of its {} edges have a triangle on one side only); "
        "its "
        "volume is that within its triangles",
        name, edges.open, edges.count);
  }
  try {
    result.inertial = calc_mesh_inertial(mesh, shape.size_m, density_kg_per_m3);
    return result;
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("the mesh {} gives the link no mass: {}; {}", where,
                                          error.what(), kRemedy));
  }
}

}  // namespace

MeshEdges count_edges(const TriangleMesh& mesh) {
  using Point = std::array<float, 3>;
  std::map<Point, std::uint32_t> points;
  std::vector<std::uint32_t> merged;
  for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
    // Adding 0 turns -0 into 0.
    const Point point{mesh.positions[i] + 0.0F, mesh.positions[i + 1] + 0.0F,
                      mesh.positions[i + 2] + 0.0F};
    merged.push_back(
        points.emplace(point, static_cast<std::uint32_t>(points.size())).first->second);
  }
  // Counts per edge its triangles, and the difference between the numbers of triangles that run
  // along it in each direction. In a closed surface this difference is 0 at every edge.
  struct Edge {
    int triangles = 0;
    int direction = 0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Edge> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::uint32_t from = merged[mesh.indices[i]];
    const std::uint32_t to = merged[mesh.indices[i % 3 == 2 ? i - 2 : i + 1]];
    if (from != to) {
      Edge& edge = edges[std::minmax(from, to)];
      ++edge.triangles;
      edge.direction += from < to ? 1 : -1;
    }
  }
  MeshEdges counts;
  counts.count = edges.size();
  for (const auto& [ends, edge] : edges) {
    counts.open += edge.triangles % 2 != 0;
    counts.turned += edge.triangles % 2 == 0 && edge.direction != 0;
  }
  return counts;
}

std::optional<std::string> find_gap(const MeshEdges& edges) {
  if (edges.open > 0 &&
      static_cast<double>(edges.open) >= kMostOpenEdges * static_cast<double>(edges.count)) {
    return fmt::format("it is not closed ({} of its {} edges have a triangle on one side only)",
                       edges.open, edges.count);
  }
  if (edges.turned > 0) {
    return fmt::format("its triangles are not all oriented alike (those at {} of {} edges are not)",
                       edges.turned, edges.count);
  }
  return std::nullopt;
}

Inertial calc_mesh_inertial(const TriangleMesh& mesh, const Eigen::Vector3d& scale,
                            double density_kg_per_m3) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    box.extend(get_corner(mesh, i).cwiseProduct(scale));
  }
  const Eigen::Vector3d centre = box.center();
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Eigen::Vector3d a = get_corner(mesh, i).cwiseProduct(scale) - centre;
    const Eigen::Vector3d b = get_corner(mesh, i + 1).cwiseProduct(scale) - centre;
    const Eigen::Vector3d c = get_corner(mesh, i + 2).cwiseProduct(scale) - centre;
    const double d = a.dot(b.cross(c));
    const Eigen::Vector3d s = a + b + c;
    volume += d / 6;
    first += d / 24 * s;
    second +=
        d / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  if (scale.prod() < 0) {
    volume = -volume;
    first = -first;
    second = -second;
  }
  const double diagonal_m = box.diagonal().norm();
  if (!(volume > kThinnest * diagonal_m * diagonal_m * diagonal_m)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("its volume is {:.3g} m3{}", volume,
                            volume < 0 ? ", as if its triangles faced inwards"
                                       : ", like that of a sheet without thickness"));
  }
  const Eigen::Vector3d com = first / volume;
  const Eigen::Matrix3d about_com = second - volume * com * com.transpose();
  Inertial body;
  body.mass_kg = density_kg_per_m3 * volume;
  body.com_m = centre + com;
  body.inertia_kg_m2 =
      density_kg_per_m3 * (about_com.trace() * Eigen::Matrix3d::Identity() - about_com);
  return body;
}

ShapeMass calc_shape_mass(const VisualShape& shape, double density_kg_per_m3, MeshFinder& meshes) {
  ShapeMass result;
  Inertial& body = result.inertial;
  switch (shape.kind) {
    case ShapeKind::box:
      body = make_box(shape.size_m, density_kg_per_m3);
      break;
    case ShapeKind::cylinder:
      body = make_cylinder(shape.size_m.x(), shape.size_m.y(), density_kg_per_m3);
      break;
    case ShapeKind::sphere:
      body = make_sphere(shape.size_m.x(), density_kg_per_m3);
      break;
    case ShapeKind::mesh:
      result = calc_file_mass(shape, density_kg_per_m3, meshes);
      break;
  }
  if (!(body.mass_kg > 0) || !(body.inertia_kg_m2.diagonal().minCoeff() > 0) ||
      !body.inertia_kg_m2.allFinite()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("a <visual> shape gives the link a mass of {:.3g} kg, which no "
                            "simulation can use; give the link an <inertial> element",
                            body.mass_kg));
  }
  body = transform(body, shape.pose);
  return result;
}

}  // namespace armwright
