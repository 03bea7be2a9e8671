#include "problems/tracking/requirement.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace armwright {

const std::vector<RequirementRow>& requirement_table() {
  using Q = RequiredQuantity;
  static const std::vector<RequirementRow> table = {
      {Q::overshoot, "overshoot", "overshoot", "limit_relative", "1", false, true},
      {Q::settling_time, "settling_time", "settling time", "limit_s", "s", false, true},
      {Q::rise_time, "rise_time", "rise time", "limit_s", "s", false, true},
      {Q::tip_error, "tip_error", "tip error", "limit_m", "m"},
      {Q::peak_torque, "peak_torque", "peak torque", "limit_n_m", "N m", true, false, "peak force",
       "limit_n", "N"},
      {Q::rms_torque, "rms_torque", "RMS torque", "limit_n_m", "N m", true, false, "RMS force",
       "limit_n", "N"},
      {Q::energy, "energy", "energy", "limit_j", "J"},
      {Q::joint_speed, "joint_speed", "joint speed", "limit_rad_per_s", "rad/s", true, false,
       "joint speed", "limit_m_per_s", "m/s"},
  };
  return table;
}

const RequirementRow& get_row(RequiredQuantity quantity) {
  return *std::ranges::find(requirement_table(), quantity, &RequirementRow::quantity);
}

Quantity describe_requirement(const Requirement& requirement, const RobotModel& robot) {
  const RequirementRow& row = get_row(requirement.quantity);
  // Without a joint all are of one kind (requirement_reader).
  const bool slides =
      row.of_joints && robot.joints[requirement.joint.value_or(0)].kind == JointKind::prismatic;
  Quantity quantity{slides ? row.slider_name : row.name, slides ? row.slider_unit : row.unit};
  if (requirement.joint) {
    quantity.name += " of " + robot.joints[*requirement.joint].name;
  }
  if (requirement.quantity == RequiredQuantity::settling_time) {
    quantity.name += requirement.band_m
                         ? fmt::format(" to {:g} mm", 1000 * *requirement.band_m)
                         : fmt::format(" to {:g} % of the move", 100 * kSettlingBandShare);
  }
  return quantity;
}

std::vector<std::string> name_requirement_metrics(std::span<const Requirement> requirements,
                                                  const RobotModel& robot) {
  std::vector<std::string> names;
  for (const Requirement& requirement : requirements) {
    std::string name = "requirement." + get_row(requirement.quantity).key;
    if (requirement.joint) {
      name += "." + robot.joints[*requirement.joint].name;
    }
    std::string unique = name;
    for (int number = 2; std::ranges::count(names, unique) > 0; ++number) {
      unique = fmt::format("{}.{}", name, number);
    }
    names.push_back(std::move(unique));
  }
  return names;
}

bool needs_motion(std::span<const Requirement> requirements) {
  return std::ranges::any_of(requirements, [](const Requirement& requirement) {
    return get_row(requirement.quantity).of_moves ||
           requirement.quantity == RequiredQuantity::joint_speed;
  });
}

void describe_requirements(std::span<const Requirement> requirements, const RobotModel& robot,
                           ProblemDescription& description) {
  const auto names = name_requirement_metrics(requirements, robot);
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    const Limit limit{describe_requirement(requirements[i], robot), requirements[i].limit};
    description.requirements.push_back(
        {description.metrics.size(), limit, requirements[i].is_constraint});
    description.metrics.push_back({names[i], limit.quantity.unit});
    if (requirements[i].is_constraint) {
      description.limits.push_back(limit);
    }
  }
}

void append_constraints(std::span<const Requirement> requirements, std::span<const double> worst,
                        std::vector<double>& constraint_values) {
  for (std::size_t i = 0; i < requirements.size(); ++i) {
    if (requirements[i].is_constraint) {
      constraint_values.push_back(worst[i] / requirements[i].limit - 1);
    }
  }
}

}  // namespace armwright
