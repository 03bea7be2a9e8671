// What an engineer requires of an arm's motion: a quantity that shall not exceed a limit on any
// test case. Over cases the worst one counts, the largest value; docs/requirements.md defines each
// quantity for its readers, sim/response.hpp those of the tip's response in equations:
//   overshoot, rise_time, settling_time  the largest of the case's moves, as far as they count in
//                                        its error
//   tip_error     the largest error of such a point, of any move or path
//   peak_torque, rms_torque, joint_speed  of the named joint, or the largest of all
//   energy        the positive mechanical work of the joints on the case
//
// Every requirement is one metric of an evaluation, "requirement.overshoot". One that is used as a
// constraint adds g = value / limit - 1, after those of the objective.
//
// In training a value counts at most kWorstRatio times its limit, and a case that was cut off,
// diverged or cannot be simulated kWorstRatio (2 - its share of the case's time that was simulated)
// times: finite, worse than any design that works, and the less bad the further it got. In
// validation and test a case without a number counts nowhere, as everywhere; then no requirement is
// shown to be met (requirement_grade.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

enum class RequiredQuantity : std::uint8_t {
  overshoot,
  settling_time,
  rise_time,
  tip_error,
  peak_torque,
  rms_torque,
  energy,
  joint_speed
};

// Above what any arm exceeds a limit by that still follows its target.
inline constexpr double kWorstRatio = 1000;
// The settling band where none is given: 2 % of the move, as textbooks have it.
inline constexpr double kSettlingBandShare = 0.02;

struct RequirementRow {
  RequiredQuantity quantity;
  std::string key;        // "peak_torque", in files and metrics
  std::string name;       // "peak torque", in words
  std::string limit_key;  // "limit_n_m"
  std::string unit;
  bool of_joints = false;
  bool of_moves = false;  // of the tip's response: a path without moves has none
  // Of a joint that slides: "peak force", "limit_n", "N".
  std::string slider_name = {};
  std::string slider_limit_key = {};
  std::string slider_unit = {};
};
const std::vector<RequirementRow>& requirement_table();
const RequirementRow& get_row(RequiredQuantity quantity);

struct Requirement {
  RequiredQuantity quantity = RequiredQuantity::overshoot;
  double limit = 0;                  // > 0, in the quantity's unit
  std::optional<std::size_t> joint;  // that one only
  std::optional<double> band_m;      // of the settling time; nothing: kSettlingBandShare
  bool is_constraint = false;
};

// "peak torque of joint_2 [N m]", "settling time to 2 % of the move [s]".
Quantity describe_requirement(const Requirement& requirement, const RobotModel& robot);
// "requirement.peak_torque.joint_2", one each: where two would have the same, the second ends in
// ".2".
std::vector<std::string> name_requirement_metrics(std::span<const Requirement> requirements,
                                                  const RobotModel& robot);

// Whether simulations have to record the motion for them (RecordingOptions::motion).
bool needs_motion(std::span<const Requirement> requirements);

// Adds the metrics, and what they are to the description; and limits where they are constraints.
void describe_requirements(std::span<const Requirement> requirements, const RobotModel& robot,
                           ProblemDescription& description);
// One g for each that is a constraint, of the worst values of all.
void append_constraints(std::span<const Requirement> requirements, std::span<const double> worst,
                        std::vector<double>& constraint_values);

}  // namespace armwright
