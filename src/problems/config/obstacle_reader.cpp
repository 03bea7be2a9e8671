// Reads what an arm must keep clear of: [[obstacle]], and the keys of tasks for it.

#include <fmt/format.h>

#include <map>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_finder.hpp"

namespace armwright {
namespace {

const Setting<std::string> kObstacleName{
    "name", kNoDefault, "name of the obstacle in messages (default of urdf: the file's name)"};
// The forms of obstacles in a file: those of the kinematics in their order, and a URDF.
const std::vector<std::string>& obstacle_form_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = obstacle_kind_names();
    all.emplace_back("urdf");
    return all;
  }();
  return names;
}

const Setting<std::string> kObstacleKind{"kind", obstacle_form_names, kNoDefault,
                                         "its form; a cylinder stands upright; urdf: every "
                                         "collision shape of a URDF file is an obstacle"};
const Setting<std::vector<double>> kObstacleCentre{
    "centre_m", kCellPlace, kNoDefault, "of a sphere, box or cylinder: x, y and z in the world"};
const Setting<double> kObstacleRadius{"radius_m", kSize_m, kNoDefault,
                                      "of a sphere, capsule or cylinder"};
const Setting<double> kObstacleHeight{"height_m", kSize_m, kNoDefault, "of a cylinder"};
const Setting<std::vector<double>> kObstacleEdges{"edges_m", kSize_m, kNoDefault,
                                                  "of a box: its three edges"};
const Setting<std::vector<double>> kObstacleRpy{
    "rpy_rad", kAngleRange, std::vector<double>{0, 0, 0},
    "of a box or a URDF's root link: roll, pitch and yaw"};
const Setting<std::vector<double>> kObstacleFrom{"from_m", kCellPlace, kNoDefault,
                                                 "of a capsule: one end of its axis"};
const Setting<std::vector<double>> kObstacleTo{"to_m", kCellPlace, kNoDefault,
                                               "of a capsule: the other end"};
const Setting<std::string> kObstacleFile{
    "file", kNoDefault, "of urdf: the file, looked for beside this one; its joints are at 0"};
const Setting<std::vector<double>> kObstaclePosition{
    "position_m", kCellPlace, std::vector<double>{0, 0, 0},
    "of urdf: place of the root link, x, y and z in the world"};

// Returns the obstacles of a URDF's collision shapes. Records the file and its meshes as inputs.
void read_scene(const ConfigTable& table, const RobotModel& robot, LoadedProblem& loaded,
                std::vector<Obstacle>& obstacles) {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.translation() = read_vector(table, kObstaclePosition, "x, y and z in metres");
  base.linear() = make_turn(read_vector(table, kObstacleRpy, "three angles in rad"));
  const std::filesystem::path file = find_beside(table, kObstacleFile);
  const std::string scene = table.get_or(kObstacleName, file.stem().string());
  const std::vector<CollisionShape> shapes = load_collisions(file);
  if (shapes.empty()) {
    table.refuse(kObstacleFile,
                 "none of its links has a <collision> shape, and only these are obstacles (visual "
                 "shapes do not count)");
  }
  add_input(loaded, file);
  MeshFinder meshes(file.parent_path(), robot.reading.packages);
  std::map<std::string, int> counts;
  for (const CollisionShape& one : shapes) {
    VisualShape shape = one.shape;
    shape.pose = base * shape.pose;
    std::optional<std::filesystem::path> mesh;
    if (shape.kind == ShapeKind::mesh) {
      mesh = meshes.find(shape.mesh_file);
      if (!mesh) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}:{}: link '{}': the mesh '{}' of its <collision> was not found; "
                                "put it there, or name its package's folder with robot.packages",
                                sanitize(file.string()), one.line, sanitize(one.link),
                                sanitize(shape.mesh_file)));
      }
      loaded.input_hashes[shape.mesh_file] =
          calc_sha256_hex(read_file(*mesh, kMeshFileLimit_bytes));
    }
    // The second shape of a link and those after it have numbers.
    const int count = ++counts[one.link];
    obstacles.push_back(make_obstacle(
        shape,
        fmt::format("{}/{}{}", scene, one.link, count > 1 ? fmt::format(" ({})", count) : ""),
        mesh.value_or("")));
  }
}

std::vector<Obstacle> read_obstacles(const std::vector<ConfigTable>& tables,
                                     const RobotModel& robot, LoadedProblem& loaded) {
  std::vector<Obstacle> obstacles;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const ConfigTable& table = tables[i];
    const std::size_t kind = table.get_choice(kObstacleKind);
    if (kind == obstacle_kind_names().size()) {
      read_scene(table, robot, loaded, obstacles);
      continue;
    }
    Obstacle obstacle;
    obstacle.name = table.get_or(kObstacleName, fmt::format("obstacle {}", i + 1));
    obstacle.kind = static_cast<ObstacleKind>(kind);
    if (obstacle.kind == ObstacleKind::capsule) {
      obstacle.capsule = {read_vector(table, kObstacleFrom, "x, y and z in metres"),
                          read_vector(table, kObstacleTo, "x, y and z in metres"),
                          table.get(kObstacleRadius)};
    } else {
      const Eigen::Vector3d centre_m = read_vector(table, kObstacleCentre, "x, y and z in metres");
      obstacle.pose.translation() = centre_m;
      if (obstacle.kind == ObstacleKind::sphere) {
        obstacle.capsule = {centre_m, centre_m, table.get(kObstacleRadius)};
      } else if (obstacle.kind == ObstacleKind::box) {
        obstacle.half_m = read_vector(table, kObstacleEdges, "three edges in metres") / 2;
        obstacle.pose.linear() = make_turn(read_vector(table, kObstacleRpy, "three angles in rad"));
      } else {
        const double radius_m = table.get(kObstacleRadius);
        obstacle.half_m = {radius_m, radius_m, table.get(kObstacleHeight) / 2};
      }
    }
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace

const SettingTable kObstacleSettings{
    .key = "obstacle",
    .is_array = true,
    .settings = {&kObstacleName, &kObstacleKind, &kObstacleCentre, &kObstacleRadius,
                 &kObstacleHeight, &kObstacleEdges, &kObstacleRpy, &kObstacleFrom, &kObstacleTo,
                 &kObstacleFile, &kObstaclePosition}};

std::shared_ptr<const ArmClearance> read_clearance(const ConfigTable& table,
                                                   const std::filesystem::path& urdf, bool self,
                                                   RobotModel& robot, LoadedProblem& loaded) {
  std::vector<Obstacle> obstacles =
      read_obstacles(table.get_tables_or_empty(kObstacleSettings), robot, loaded);
  if (obstacles.empty() && !self) {
    return nullptr;
  }
  std::vector<std::string> notes;
  auto capsules =
      fit_link_capsules(robot, MeshFinder(urdf.parent_path(), robot.reading.packages), notes);
  robot.notes.insert(robot.notes.end(), notes.begin(), notes.end());
  return std::make_shared<const ArmClearance>(robot, std::move(capsules), std::move(obstacles),
                                              self);
}

void read_task_clearance(const ConfigTable& table, const std::filesystem::path& urdf,
                         TrackingConfig& config, LoadedProblem& loaded) {
  const ConfigTable its = table.get_table_or_empty(kTaskSettings);
  TrackingTask& task = config.task;
  const bool self = its.get(kTaskSelfClearance);
  if (!self) {
    its.leave_out(kTaskSelfClearance);  // so recorded version 1.0
  }
  const auto least_m = its.find(kTaskClearance);
  task.clearance_m = least_m.value_or(0);
  task.clearance = read_clearance(table, urdf, self, config.robot, loaded);
  if (!task.clearance) {
    if (least_m) {
      its.refuse(kTaskClearance,
                 "there is nothing to be clear of; add an [[obstacle]], or set "
                 "task.self_clearance = true");
    }
    return;
  }
  if (task.limits == LimitPolicy::ignore) {
    its.refuse(kTaskLimits,
               "paths are not checked then, and could pass through obstacles; set it to \"warn\" "
               "or \"enforce\"");
  }
  if (task.home.empty()) {
    return;
  }
  const auto nearest = task.clearance->find_nearest(calc_link_poses(config.robot, task.home));
  if (nearest.distance_m < task.clearance_m) {
    its.refuse(kTaskHome, fmt::format("{}; move the posture or the obstacle",
                                      task.clearance->describe_gap(nearest, task.clearance_m)));
  }
}

}  // namespace armwright
