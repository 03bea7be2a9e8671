#include "problems/config/requirement_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "problems/tracking/tracking_config.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

constexpr Range kLimit{.lower = 0, .upper = 1e12, .lower_open = true};
constexpr Range kBand{.lower = 0, .upper = 100, .lower_open = true};  // m: beyond any arm's reach

std::optional<std::size_t> read_joint(const ConfigTable& table, const RequirementRow& row,
                                      const RobotModel& robot) {
  if (!table.has("joint")) {
    return std::nullopt;
  }
  if (!row.of_joints) {
    table.refuse("joint",
                 fmt::format("{} is not of a joint but of the whole arm; leave it out", row.key));
  }
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) {
    names.push_back(joint.name);
  }
  const std::string name = table.get_choice("joint", names);
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

// Whether it is of joints that slide; all that it is of must do so, or none.
bool check_kind(const ConfigTable& table, const RequirementRow& row,
                std::optional<std::size_t> joint, const RobotModel& robot) {
  if (!row.of_joints) {
    return false;
  }
  const auto slides = [](const Joint& one) { return one.kind == JointKind::prismatic; };
  if (joint) {
    return slides(robot.joints[*joint]);
  }
  const auto sliding = std::ranges::count_if(robot.joints, slides);
  if (sliding > 0 && sliding < std::ssize(robot.joints)) {
    table.refuse("quantity",
                 "some joints of this robot turn and others slide, which have no unit in common; "
                 "name one with 'joint', in a [[requirement]] each");
  }
  return sliding > 0;
}

double read_limit(const ConfigTable& table, const RequirementRow& row, bool slides) {
  const std::string& key = slides ? row.slider_limit_key : row.limit_key;
  const std::string& unit = slides ? row.slider_unit : row.unit;
  std::set<std::string> others = {"limit"};
  for (const RequirementRow& other : requirement_table()) {
    others.insert({other.limit_key, other.slider_limit_key});
  }
  others.erase(key);
  others.erase("");
  for (const std::string& other : others) {
    if (table.has(other)) {
      table.refuse(other,
                   fmt::format("the limit of {} is {}; write {} instead", row.key,
                               unit == "1" ? "a share of the move's length" : "in " + unit, key));
    }
  }
  const double limit = table.get_number(key, kLimit);
  if (row.quantity == RequiredQuantity::overshoot && limit > 1) {
    table.refuse(key,
                 "it is a share of the move's length and must be at most 1; 0.05 is five "
                 "percent");
  }
  return limit;
}

// The least time that a segment of a generated case takes, at the greatest speed.
double calc_shortest_segment_s(const TrackingConfig& config) {
  const TrackingTask task = make_task(config.task, config.start);
  const double speed_m_per_s =
      task.speed_m_per_s * (changes_speed(config) ? config.speed_bounds_factor : 1);
  double shortest_m = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= config.workspace.points; ++k) {
    shortest_m =
        std::min(shortest_m, std::max(config.workspace.calc_move_m(k), task.distance_limit_m));
  }
  return shortest_m / speed_m_per_s + task.rest_s;
}

// A tip that never settles or never arrives counts the time it had: no limit may be above that.
void check_time(const ConfigTable& table, const RequirementRow& row, double limit_s,
                const TrackingConfig& config) {
  const TrackingTask& task = config.task;
  if (row.quantity == RequiredQuantity::settling_time &&
      limit_s > task.rest_s - task.control_period_s) {
    table.refuse(row.limit_key,
                 fmt::format("the target rests for task.rest_s = {:g} s after each move, so that "
                             "settling can be seen up to {:g} s; lower it, or raise task.rest_s",
                             task.rest_s, std::max(0.0, task.rest_s - task.control_period_s)));
  }
  const double shortest_s = calc_shortest_segment_s(config);
  if (row.quantity == RequiredQuantity::rise_time && limit_s >= shortest_s) {
    table.refuse(row.limit_key,
                 fmt::format("the quickest move takes {:.4g} s with its rest, and a tip that did "
                             "not come along at all would be within the limit; lower it",
                             shortest_s));
  }
}

Requirement read_one(const ConfigTable& table, const TrackingConfig& config) {
  std::vector<std::string> keys;
  for (const RequirementRow& row : requirement_table()) {
    keys.push_back(row.key);
  }
  const std::string key = table.get_choice("quantity", keys);
  const RequirementRow& row = *std::ranges::find(requirement_table(), key, &RequirementRow::key);
  Requirement requirement;
  requirement.quantity = row.quantity;
  requirement.joint = read_joint(table, row, config.robot);
  const bool slides = check_kind(table, row, requirement.joint, config.robot);
  requirement.limit = read_limit(table, row, slides);
  check_time(table, row, requirement.limit, config);
  if (table.has("band_m")) {
    if (row.quantity != RequiredQuantity::settling_time) {
      table.refuse("band_m", fmt::format("only settling_time has a band, and this is {}; leave it "
                                         "out",
                                         row.key));
    }
    requirement.band_m = table.get_number("band_m", kBand);
  }
  static const std::vector<std::string> uses = {"report", "constraint"};
  requirement.is_constraint = table.get_choice("use", uses, "report") == "constraint";
  if (requirement.is_constraint &&
      config.objective.kind == TrackingObjective::Kind::error_vs_torque) {
    table.refuse("use",
                 "objective.kind error_vs_torque has two objectives, beside which there are no "
                 "constraints; use \"report\", or another kind of objective");
  }
  return requirement;
}

bool is_same(const Requirement& a, const Requirement& b) {
  return a.quantity == b.quantity && a.joint == b.joint && a.band_m == b.band_m;
}

}  // namespace

std::vector<Requirement> read_requirements(std::span<const ConfigTable> tables,
                                           const TrackingConfig& config) {
  std::vector<Requirement> requirements;
  for (const ConfigTable& table : tables) {
    const Requirement requirement = read_one(table, config);
    if (std::ranges::any_of(requirements,
                            [&](const Requirement& one) { return is_same(one, requirement); })) {
      table.refuse("quantity", "another [[requirement]] before it has the same; keep one of them");
    }
    requirements.push_back(requirement);
  }
  return requirements;
}

}  // namespace armwright
