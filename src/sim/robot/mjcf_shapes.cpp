// Gives links the looks that a compiled MJCF file describes.

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/robot/mjcf_parts.hpp"

namespace armwright {
namespace {

// The program `simulate` of MuJoCo shows these groups; files keep shapes for collisions in others.
constexpr int kLastShownGroup = 2;

class ShapeReader {
 public:
  ShapeReader(const CompiledMjcf& mjcf, int geom, const Eigen::Isometry3d& body)
      : mjcf_(mjcf), m_(*mjcf.model), geom_(geom) {
    const mjtNum* const p = m_.geom_pos + 3 * geom;
    const mjtNum* const q = m_.geom_quat + 4 * geom;
    pose_ = body * Eigen::Translation3d(p[0], p[1], p[2]) *
            Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  }

  // Returns nothing for what armwright cannot show: planes, height fields, ellipsoids.
  std::vector<VisualShape> read() const {
    const mjtNum* const size = m_.geom_size + 3 * geom_;
    switch (m_.geom_type[geom_]) {
      case mjGEOM_BOX:
        return {make(ShapeKind::box, {2 * size[0], 2 * size[1], 2 * size[2]})};
      case mjGEOM_SPHERE:
        return {make(ShapeKind::sphere, {size[0], 0, 0})};
      case mjGEOM_CYLINDER:
        return {make(ShapeKind::cylinder, {size[0], 2 * size[1], 0})};
      case mjGEOM_CAPSULE:
        return {make(ShapeKind::cylinder, {size[0], 2 * size[1], 0}), make_end(size[0], size[1]),
                make_end(size[0], -size[1])};
      case mjGEOM_MESH:
        return read_mesh_shape();
      default:
        return {};
    }
  }

 private:
  VisualShape make(ShapeKind kind, const Eigen::Vector3d& size_m) const {
    VisualShape shape;
    shape.kind = kind;
    shape.size_m = size_m;
    shape.pose = pose_;
    const int material = m_.geom_matid[geom_];
    const float* rgba = m_.geom_rgba + 4 * geom_;
    const float plain[] = {0.5F, 0.5F, 0.5F, 1};  // the default, which a material replaces
    if (material >= 0 && std::equal(plain, plain + 4, rgba)) {
      rgba = m_.mat_rgba + 4 * material;
    }
    shape.rgba = Eigen::Vector4d(rgba[0], rgba[1], rgba[2], rgba[3]);
    return shape;
  }

  VisualShape make_end(double radius_m, double along_m) const {
    VisualShape shape = make(ShapeKind::sphere, {radius_m, 0, 0});
    shape.pose.translate(Eigen::Vector3d(0, 0, along_m));
    return shape;
  }

  // The library moves and scales a mesh. What it has made of the stand-in's corners says how.
  std::vector<VisualShape> read_mesh_shape() const {
    const int mesh = m_.geom_dataid[geom_];
    const char* const name = mj_id2name(&m_, mjOBJ_MESH, mesh);
    const auto file = std::ranges::find_if(mjcf_.text.meshes, [&](const MjcfMesh& one) {
      return name != nullptr && one.name == name;
    });
    if (file == mjcf_.text.meshes.end() || m_.mesh_vertnum[mesh] < 6) {
      return {};
    }
    const auto corner = [&](int number) -> Eigen::Vector3d {
      const float* const v = m_.mesh_vert + 3 * (m_.mesh_vertadr[mesh] + number);
      return pose_ * Eigen::Vector3d(v[0], v[1], v[2]);
    };
    // The first faces are (origin, y, x) and (origin, x, z).
    const Eigen::Vector3d origin = corner(0);
    Eigen::Matrix3d axes;
    axes << corner(2) - origin, corner(1) - origin, corner(5) - origin;
    axes /= kStandInEdge_m;
    Eigen::Vector3d scale = axes.colwise().norm();
    if (axes.determinant() < 0) {
      scale.x() = -scale.x();  // mirrored
    }
    const Eigen::Matrix3d turned = axes * scale.cwiseInverse().asDiagonal();
    constexpr double kFloatTolerance = 1e-4;  // the library keeps corners as 32-bit numbers
    if (!turned.allFinite() || !(turned.transpose() * turned).isIdentity(kFloatTolerance)) {
      return {};  // sheared: turned (refquat) and scaled unevenly
    }
    VisualShape shape = make(ShapeKind::mesh, scale);
    shape.mesh_file = file->file;
    shape.pose.translation() = origin;
    shape.pose.linear() = Eigen::Quaterniond(turned).normalized().toRotationMatrix();
    return {shape};
  }

  const CompiledMjcf& mjcf_;
  const mjModel& m_;
  int geom_;
  Eigen::Isometry3d pose_;  // of the geom in its link's frame
};

}  // namespace

void add_shapes(RobotModel& robot, const CompiledMjcf& mjcf, const MjcfChain& chain,
                const std::vector<Eigen::Isometry3d>& in_links) {
  const mjModel& m = *mjcf.model;
  for (int geom = 0; geom < m.ngeom; ++geom) {
    if (m.geom_group[geom] > kLastShownGroup || m.geom_rgba[4 * geom + 3] == 0) {
      continue;
    }
    const std::size_t body = to_size(m.geom_bodyid[geom]);
    const std::size_t carrier = chain.carriers[body];
    Link& link = carrier == 0 ? robot.base : robot.links[carrier - 1];
    for (VisualShape& shape : ShapeReader(mjcf, geom, in_links[body]).read()) {
      link.visuals.push_back(std::move(shape));
    }
  }
}

}  // namespace armwright

#endif
