// Reads the tubes that an arm is made of: [tubes].

#include <fmt/format.h>

#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/robot/tube.hpp"

namespace armwright {
namespace {

const Setting<double> kYoungsModulus{"youngs_modulus_pa",
                                     {.lower = 1e6, .upper = 1e13},
                                     TubeMaterial{}.youngs_modulus_pa,
                                     "of the tubes' material (default: aluminium)"};
const Setting<double> kTubeDensity{"density_kg_per_m3",
                                   {.lower = 1, .upper = 30'000},
                                   TubeMaterial{}.density_kg_per_m3,
                                   "of the tubes' material (default: aluminium)"};
const Setting<std::vector<double>> kDiameters{
    "diameter_m", kSize_m, kNoDefault, "outer diameters of the tubes, one number or one per link"};
const Setting<std::vector<double>> kWalls{"wall_m", kSize_m, kNoDefault,
                                          "walls of the tubes, in the same way"};
const Setting<std::vector<double>> kLengthBounds{
    "length_bounds_m", kSize_m, kNoDefault,
    "least and largest length of each link, which is then a variable (default: as in the robot)"};
const Setting<std::vector<double>> kDiameterBounds{
    "diameter_bounds_m", kSize_m, kNoDefault, "the same of the outer diameters (default: fixed)"};
const Setting<std::vector<double>> kWallBounds{"wall_bounds_m", kSize_m, kNoDefault,
                                               "the same of the walls (default: fixed)"};
const Setting<double> kDeflectionLimit{
    "deflection_limit_m", kSize_m, kNoDefault,
    "how far the tip of the stretched arm may sag under gravity across it (default: no limit)"};

}  // namespace

const SettingTable kTubeSettings{
    .key = "tubes",
    .settings = {&kYoungsModulus, &kTubeDensity, &kDiameters, &kWalls, &kLengthBounds,
                 &kDiameterBounds, &kWallBounds, &kDeflectionLimit}};

std::optional<VariableBounds> read_bounds(const ConfigTable& table,
                                          const Setting<std::vector<double>>& setting) {
  const auto values = table.find(setting);
  if (!values) {
    return std::nullopt;
  }
  if (values->size() != 2 || (*values)[0] >= (*values)[1]) {
    table.refuse(setting, "it must be two numbers, the smaller one first");
  }
  return VariableBounds{(*values)[0], (*values)[1]};
}

ArmTubes read_tubes(const ConfigTable& root, const RobotModel& robot) {
  ArmTubes tubes;
  if (!root.has(kTubeSettings.key)) {
    return tubes;
  }
  const ConfigTable table = root.get_table(kTubeSettings);
  const std::size_t links = robot.joint_count();
  tubes.material = {table.get(kYoungsModulus), table.get(kTubeDensity)};
  const std::vector<double> diameters = read_per_joint(table, kDiameters, links);
  const std::vector<double> walls = read_per_joint(table, kWalls, links);
  tubes.length_m = read_bounds(table, kLengthBounds);
  tubes.diameter_m = read_bounds(table, kDiameterBounds);
  tubes.wall_m = read_bounds(table, kWallBounds);
  tubes.deflection_limit_m = table.find(kDeflectionLimit);
  for (std::size_t link = 0; link < links; ++link) {
    const double thinnest = tubes.diameter_m ? tubes.diameter_m->lower : diameters[link];
    const double thickest = tubes.wall_m ? tubes.wall_m->upper : walls[link];
    if (2 * walls[link] > diameters[link] || 2 * thickest > thinnest) {
      const bool at_start = 2 * walls[link] > diameters[link];
      table.refuse(
          at_start || !tubes.wall_m ? kWalls.key : kWallBounds.key,
          fmt::format("the wall of link '{}' can be {:g} m, thicker than the radius of its tube, "
                      "{:g} m; make it thinner",
                      sanitize(robot.links[link].name), at_start ? walls[link] : thickest,
                      (at_start ? diameters[link] : thinnest) / 2));
    }
    if (get_link_length_m(robot, link) == 0) {
      table.refuse(kDiameters,
                   fmt::format("the link '{}' has no length: the next joint lies in its "
                               "own; only links with a length can be tubes",
                               sanitize(robot.links[link].name)));
    }
    tubes.tubes.push_back({diameters[link], walls[link]});
  }
  return tubes;
}

void read_task_tubes(const ConfigTable& table, TrackingConfig& config) {
  config.tubes = read_tubes(table, config.robot);
  if (config.tubes.tubes.empty()) {
    return;
  }
  if (config.tubes.length_m) {
    table.get_table(kTubeSettings)
        .refuse(kLengthBounds,
                "in tracking problems, length_scale in variables.optimize makes lengths variables, "
                "and variables.length_bounds_factor bounds them");
  }
  if (config.mass_scale != 1) {
    table.get_table(kTubeSettings)
        .refuse(kTubeDensity,
                fmt::format("the masses of tubes follow from it, so that robot.mass_scale = {:g} "
                            "has no effect; leave that out",
                            config.mass_scale));
  }
  for (std::size_t link = 0; link < config.robot.joint_count(); ++link) {
    make_tube(config.robot, link, config.tubes.tubes[link], config.tubes.material);
  }
}

}  // namespace armwright
