// Reads the requirements of a problem.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>

#include "problems/config/problem_readers.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "sim/tracking/designed_arm.hpp"

namespace armwright {
namespace {

constexpr Range kLimit{.lower = 0, .upper = 1e12, .lower_open = true};

std::vector<std::string> list_quantities() {
  std::vector<std::string> keys;
  for (const RequirementRow& row : requirement_table()) {
    keys.push_back(row.key);
  }
  return keys;
}

const Setting<std::string> kRequirementQuantity{"quantity", list_quantities, kNoDefault,
                                                "measured quantity (docs/requirements.md)"};
const Setting<std::string> kRequirementJoint{
    "joint", kNoDefault,
    "for quantities of joints: name of a joint of the robot (default: the worst of all joints)"};
const Setting<std::string> kRequirementUse{
    "use", one_of({"report", "constraint"}), "report",
    "report: it is shown as a traffic light; constraint: optimizers must also keep it"};
const Setting<double> kRequirementBand{
    "band_m",
    {.lower = 0, .upper = 100, .lower_open = true},  // farther than any arm reaches
    kNoDefault,
    "for settling_time: half the width of the band around the target (default: 2 % of the move's "
    "length)"};
const std::array kRequirementLimits{
    Setting<double>{"limit_relative", kLimit, kNoDefault,
                    "limit of overshoot, as a share of the move's length"},
    Setting<double>{"limit_s", kLimit, kNoDefault, "limit of rise_time and settling_time"},
    Setting<double>{"limit_m", kLimit, kNoDefault, "limit of tip_error"},
    Setting<double>{"limit_n_m", kLimit, kNoDefault, "limit of peak_torque and rms_torque"},
    Setting<double>{"limit_n", kLimit, kNoDefault,
                    "limit of peak_torque and rms_torque of joints that slide"},
    Setting<double>{"limit_rad_per_s", kLimit, kNoDefault, "limit of joint_speed"},
    Setting<double>{"limit_m_per_s", kLimit, kNoDefault,
                    "limit of joint_speed of joints that slide"},
    Setting<double>{"limit_j", kLimit, kNoDefault, "limit of energy"},
    Setting<double>{"limit_rad2_per_s5", kLimit, kNoDefault, "limit of jerk"},
};

std::optional<std::size_t> read_joint(const ConfigTable& table, const RequirementRow& row,
                                      const RobotModel& robot) {
  if (!table.has(kRequirementJoint)) {
    return std::nullopt;
  }
  if (!row.of_joints) {
    table.refuse(kRequirementJoint,
                 fmt::format("{} is not of a joint but of the whole arm; leave it out", row.key));
  }
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) {
    names.push_back(joint.name);
  }
  const std::string name = table.get(kRequirementJoint.among(names));
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

// Returns whether the requirement is about joints that slide. Refuses a requirement about joints of
// both kinds.
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
    table.refuse(kRequirementQuantity,
                 "some joints of this robot turn and others slide, which have no unit in common; "
                 "name one with 'joint', in a [[requirement]] each");
  }
  return sliding > 0;
}

const Setting<double>& find_limit(const std::string& key) {
  const auto* found = std::ranges::find(kRequirementLimits, key, &Setting<double>::key);
  if (found == kRequirementLimits.end()) {
    throw std::logic_error("no setting is declared for the limit " + key);
  }
  return *found;
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
  const double limit = table.get(find_limit(key));
  if (row.quantity == RequiredQuantity::overshoot && limit > 1) {
    table.refuse(key,
                 "it is a share of the move's length and must be at most 1; 0.05 is five "
                 "percent");
  }
  return limit;
}

// Returns the shortest time that a segment of a generated case takes, at the largest speed.
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

// A tip that never settles or never arrives counts as the whole time of the segment. So no limit
// may be above that time.
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
  const std::string key = table.get(kRequirementQuantity);
  const RequirementRow& row = *std::ranges::find(requirement_table(), key, &RequirementRow::key);
  Requirement requirement;
  requirement.quantity = row.quantity;
  requirement.joint = read_joint(table, row, config.robot);
  const bool slides = check_kind(table, row, requirement.joint, config.robot);
  requirement.limit = read_limit(table, row, slides);
  check_time(table, row, requirement.limit, config);
  if (table.has(kRequirementBand)) {
    if (row.quantity != RequiredQuantity::settling_time) {
      table.refuse(kRequirementBand,
                   fmt::format("only settling_time has a band, and this is {}; leave it "
                               "out",
                               row.key));
    }
    requirement.band_m = table.get(kRequirementBand);
  }
  requirement.is_constraint = table.get(kRequirementUse) == "constraint";
  return requirement;
}

bool is_same(const Requirement& a, const Requirement& b) {
  return a.quantity == b.quantity && a.joint == b.joint && a.band_m == b.band_m;
}

std::vector<const AnySetting*> list_requirement_settings() {
  std::vector<const AnySetting*> settings = {&kRequirementQuantity, &kRequirementJoint,
                                             &kRequirementUse, &kRequirementBand};
  for (const Setting<double>& limit : kRequirementLimits) {
    settings.push_back(&limit);
  }
  return settings;
}

}  // namespace

const SettingTable kRequirementSettings{
    .key = "requirement", .is_array = true, .settings = list_requirement_settings()};

std::vector<Requirement> read_requirements(std::span<const ConfigTable> tables,
                                           const TrackingConfig& config) {
  std::vector<Requirement> requirements;
  for (const ConfigTable& table : tables) {
    const Requirement requirement = read_one(table, config);
    if (std::ranges::any_of(requirements,
                            [&](const Requirement& one) { return is_same(one, requirement); })) {
      table.refuse(kRequirementQuantity,
                   "another [[requirement]] before it has the same; keep one of them");
    }
    requirements.push_back(requirement);
  }
  return requirements;
}

}  // namespace armwright
