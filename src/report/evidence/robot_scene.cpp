#include "report/evidence/robot_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <string_view>

#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "sim/kinematics/obstacle.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_finder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostTriangles = 200'000;
const Eigen::Vector4d kLoadColour(0.16, 0.47, 0.71, 1.0);  // blue; no shipped arm has it
const Eigen::Vector4d kObstacleColour(0.84, 0.37, 0, 0.6);

json make_numbers(const Eigen::VectorXd& values) {
  return std::vector<double>(values.begin(), values.end());
}

// Rounds, because the URDF reader keeps colours as 32-bit numbers: 0.2 becomes 0.200000003.
json make_colour(const Eigen::Vector4d& rgba) {
  return make_numbers((rgba * 1e4).array().round() / 1e4);
}

json make_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond rotation(pose.linear());
  return {{"position", make_numbers(pose.translation())},
          {"quaternion", make_numbers(rotation.normalized().coeffs())}};  // x y z w
}

std::string_view name_of(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::box:
      return "box";
    case ShapeKind::cylinder:
      return "cylinder";
    case ShapeKind::sphere:
      return "sphere";
    case ShapeKind::mesh:
      break;
  }
  return "mesh";
}

json make_shape(const VisualShape& shape, std::optional<std::size_t> mesh) {
  return {{"kind", name_of(shape.kind)},
          {"size", make_numbers(shape.size_m)},
          {"mesh", mesh ? json(*mesh) : json(nullptr)},
          {"pose", make_pose(shape.pose)},
          {"rgba", make_colour(shape.rgba)}};
}

json make_joint(const Joint& joint) {
  return {{"name", joint.name},
          {"kind", joint.kind == JointKind::revolute ? "revolute" : "prismatic"},
          {"origin", make_pose(joint.origin)},
          {"axis", make_numbers(joint.axis)},
          {"lower", finite_or_null(joint.lower)},
          {"upper", finite_or_null(joint.upper)}};
}

// The meshes of a robot. Each file is read once.
class Meshes {
 public:
  Meshes(MeshFinder finder, std::vector<std::string>& notes)
      : finder_(std::move(finder)), notes_(notes) {}

  // Returns the index of the mesh. If it cannot be read, returns nothing and adds a note the first
  // time.
  std::optional<std::size_t> add(const std::string& name) {
    const auto known = indices_.find(name);
    if (known != indices_.end()) {
      return known->second;
    }
    return indices_[name] = read(name);
  }
  // Returns the meshes, and adds a note about those that were not found.
  json take() {
    if (missing_ > 0) {
      notes_.push_back(fmt::format("Plain shapes stand for meshes: {}.",
                                   describe_missing_meshes(missing_, example_)));
    }
    return std::move(meshes_);
  }

 private:
  std::optional<std::size_t> read(const std::string& name) {
    const std::optional<std::filesystem::path> file = finder_.find(name);
    if (!file) {
      example_ = missing_++ == 0 ? name : example_;
      return std::nullopt;
    }
    try {
      const TriangleMesh mesh = read_mesh(*file);
      const std::size_t count = mesh.indices.size() / 3;
      if (triangles_ + count > kMostTriangles) {
        return skip(name, fmt::format("it has {} triangles, and at most {} of a robot are shown",
                                      count, kMostTriangles));
      }
      triangles_ += count;
      meshes_.push_back(
          {{"positions", pack_f32(mesh.positions)}, {"indices", pack_u32(mesh.indices)}});
      return meshes_.size() - 1;
    } catch (const std::exception& error) {  // the reader may throw anything for a damaged file
      return skip(name, error.what());
    }
  }
  std::nullopt_t skip(const std::string& name, const std::string& reason) {
    notes_.push_back(
        fmt::format("The mesh {} of the robot is not shown: {}.", sanitize(name), reason));
    return std::nullopt;
  }

  MeshFinder finder_;
  std::vector<std::string>& notes_;
  std::size_t missing_ = 0;
  std::string example_;  // the name of a mesh that was not found
  std::map<std::string, std::optional<std::size_t>> indices_;
  std::size_t triangles_ = 0;
  json meshes_ = json::array();
};

json make_shapes(const std::vector<VisualShape>& visuals, Meshes& meshes) {
  json shapes = json::array();
  for (const VisualShape& visual : visuals) {
    if (visual.kind != ShapeKind::mesh) {
      shapes.push_back(make_shape(visual, std::nullopt));
    } else if (const std::optional<std::size_t> mesh = meshes.add(visual.mesh_file)) {
      shapes.push_back(make_shape(visual, mesh));
    }
  }
  return shapes;
}

void add_shapes(const Obstacle& obstacle, json& shapes) {
  const auto add = [&](const VisualShape& shape) {
    shapes.push_back(make_shape(shape, std::nullopt));
  };
  if (obstacle.kind == ObstacleKind::box || obstacle.kind == ObstacleKind::cylinder) {
    const bool is_box = obstacle.kind == ObstacleKind::box;
    add({.kind = is_box ? ShapeKind::box : ShapeKind::cylinder,
         .size_m = is_box ? Eigen::Vector3d(2 * obstacle.half_m)
                          : Eigen::Vector3d(obstacle.half_m.x(), 2 * obstacle.half_m.z(), 0),
         .mesh_file = "",
         .pose = obstacle.pose,
         .rgba = kObstacleColour});
    return;
  }
  const Capsule& its = obstacle.capsule;
  add(make_ball(its.from_m, its.radius_m, kObstacleColour));
  if (its.from_m != its.to_m) {
    add(make_cylinder(its.from_m, its.to_m, its.radius_m, kObstacleColour));
    add(make_ball(its.to_m, its.radius_m, kObstacleColour));
  }
}

}  // namespace

json make_robot(const RobotModel& model, const TrackingTask& task,
                const std::filesystem::path& urdf_folder, std::vector<std::string>& notes) {
  const auto link = [&](std::size_t body) -> const Link& {
    return body == 0 ? model.base : model.links[body - 1];
  };
  const std::size_t body_count = model.links.size() + 1;
  bool has_visuals = false;
  for (std::size_t body = 0; body < body_count; ++body) {
    has_visuals = has_visuals || !link(body).visuals.empty();
  }
  if (!has_visuals) {
    notes.push_back(
        fmt::format("The description of the robot {} has no visual shapes, so the replay shows "
                    "plain ones along "
                    "its chain of joints.",
                    sanitize(model.name)));
  }

  if (const auto& links = model.reading.assumed_links; !links.empty()) {
    notes.push_back(
        fmt::format("The description of the robot {} states no mass for {}. Masses are assumed, "
                    "and all results "
                    "depend on them.",
                    sanitize(model.name), sanitize(join(links, ", "))));
  }
  const std::vector<std::vector<VisualShape>> plain = make_plain_shapes(model);
  Meshes meshes(MeshFinder(urdf_folder, model.reading.packages), notes);
  json bodies = json::array();
  for (std::size_t body = 0; body < body_count; ++body) {
    json shapes = make_shapes(link(body).visuals, meshes);
    if (shapes.empty() && (!has_visuals || !link(body).visuals.empty())) {
      shapes = make_shapes(plain[body], meshes);
    }
    bodies.push_back({{"name", link(body).name}, {"shapes", std::move(shapes)}});
  }
  const RobotModel loaded = add_load(model, task.load_kg, task.load_body);
  if (task.load_kg > 0) {
    VisualShape load = loaded.links.back().visuals.back();
    load.rgba = kLoadColour;
    bodies.back()["shapes"].push_back(make_shape(load, std::nullopt));
  }
  for (std::size_t i = 0; task.clearance && i < task.clearance->obstacles().size(); ++i) {
    add_shapes(task.clearance->obstacles()[i], bodies.front()["shapes"]);
  }
  json joints = json::array();
  for (const Joint& joint : model.joints) {
    joints.push_back(make_joint(joint));
  }
  return {{"name", model.name},
          {"bodies", std::move(bodies)},
          {"joints", std::move(joints)},
          {"tip", make_pose(model.tip_pose)},
          {"meshes", meshes.take()}};
}

std::size_t add_robot(const RobotModel& model, const TrackingTask& task,
                      const std::filesystem::path& urdf_folder, json& robots,
                      std::vector<std::string>& notes) {
  std::vector<std::string> its_notes;
  json robot = make_robot(model, task, urdf_folder, its_notes);
  const auto known = std::ranges::find(robots, robot);
  if (known != robots.end()) {
    return static_cast<std::size_t>(known - robots.begin());
  }
  robots.push_back(std::move(robot));
  for (std::string& note : its_notes) {  // arms with other links may lack the same meshes
    if (std::ranges::find(notes, note) == notes.end()) {
      notes.push_back(std::move(note));
    }
  }
  return robots.size() - 1;
}

}  // namespace armwright
