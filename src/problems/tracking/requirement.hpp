// Requirements: quantities of an arm's motion that shall not exceed a limit on any test case. Over
// the cases the largest value counts. docs/requirements.md defines each quantity for users;
// sim/tracking/response.hpp has the equations of the tip's response:
//   overshoot, rise_time, settling_time  the largest value over the moves that count in the case's
//                                        error
//   tip_error     the largest error of such a point, of any move or path
//   peak_torque, rms_torque, joint_speed  of the named joint, or the largest of all joints
//   energy        the positive mechanical work of the joints on the case
//   jerk          the sum over the joints of the integral of the squared jerk
//
// Every requirement is one metric of an evaluation, such as "requirement.overshoot". A requirement
// that is used as a constraint adds g = value / limit - 1, after the constraints of the objective.
//
// In training, a value counts at most kWorstRatio times its limit; with FailureRule::ordered, that
// of a failing case at least. A case that was cut off, diverged or cannot be simulated counts
// kWorstRatio (2 - s) times it, where s is the simulated share of the case's time. So the value is
// finite, and smaller the longer a lost case was simulated. In validation and test, a case without
// an error does not count; then no requirement is shown as met (requirement_grade.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/tracking/physics_engine.hpp"
#include "sim/tracking/response.hpp"

namespace armwright {

enum class RequiredQuantity : std::uint8_t {
  overshoot,
  settling_time,
  rise_time,
  tip_error,
  peak_torque,
  rms_torque,
  energy,
  joint_speed,
  jerk
};

// A ratio of value to limit that no arm exceeds while it follows its target.
inline constexpr double kWorstRatio = 1000;
// The default settling band: 2 % of the move, as in textbooks.
inline constexpr double kSettlingBandShare = 0.02;

// A row of the table of quantities.
struct RequirementRow {
  RequiredQuantity quantity;
  std::string key;        // "peak_torque", in files and metrics
  std::string name;       // "peak torque", in words
  std::string limit_key;  // "limit_n_m"
  std::string unit;
  bool of_joints = false;  // measured per joint
  bool of_moves = false;   // measured on the tip's moves; a path without moves has no value
  // The same for a joint that slides: "peak force", "limit_n", "N".
  std::string slider_name = {};
  std::string slider_limit_key = {};
  std::string slider_unit = {};
};
const std::vector<RequirementRow>& requirement_table();
const RequirementRow& get_requirement_row(RequiredQuantity quantity);

// One requirement of a problem.
struct Requirement {
  RequiredQuantity quantity = RequiredQuantity::overshoot;
  double limit = 0;                  // > 0, in the quantity's unit
  std::optional<std::size_t> joint;  // the only joint that counts; nothing: all joints
  std::optional<double> band_m;      // of the settling time; nothing: kSettlingBandShare
  bool is_constraint = false;
};

// Returns the name and unit: "peak torque of joint_2 [N m]", "settling time to 20 mm [s]".
Quantity describe_requirement(const Requirement& requirement, const RobotModel& robot);
// Returns one metric name per requirement: "requirement.peak_torque.joint_2". If two requirements
// have the same name, the second one ends in ".2".
std::vector<std::string> name_requirement_metrics(std::span<const Requirement> requirements,
                                                  const RobotModel& robot);
// Appends the requirements and their metrics to the description, and the limits of those that are
// constraints.
void describe_requirements(std::span<const Requirement> requirements, const RobotModel& robot,
                           ProblemDescription& description);

// The value of a required quantity on one case, and its place.
struct RequiredValue {
  std::optional<double> value;       // nothing if the case has nothing to measure
  std::optional<std::size_t> joint;  // the joint with this value
  std::optional<std::size_t> point;  // the point with this value; 1 is the first after the start
};

// A simulated case and what was measured on it.
struct MeasuredCase {
  TrackingResult result;                // without the motion, unless its job asked for it
  std::vector<RequiredValue> required;  // one per requirement
  MotionErrors motion = {};             // if the job recorded its errors and came to its end
};

// Simulates the jobs and measures the requirements. Returns one result per job, whatever its
// status; a simulation that ended early is measured up to its end. If the motion must be recorded,
// the engine gets small batches that just fill its lanes, because the motion of a case of 4000
// periods takes about 200 kB until it is measured.
std::vector<MeasuredCase> simulate_measured(const PhysicsEngine& engine, const TrackingSetup& setup,
                                            std::span<const TrackingJob> jobs,
                                            std::span<const Requirement> requirements);

// Throws Error{bad_data} if a requirement is measured on moves and no move of the case counts.
void check_moves(std::span<const Requirement> requirements, const TrackingTask& task,
                 const TargetTable& targets, const std::string& set, std::uint64_t number);

// Returns the metrics of the requirements on one case, one per requirement, as described above.
std::vector<double> make_required_metrics(std::span<const Requirement> requirements,
                                          const MeasuredCase& measured, const TargetTable& targets,
                                          bool in_training);
// Returns the worst values over the outcomes that have an error: the largest of each of the metrics
// first, ..., first + count - 1.
std::vector<double> calc_worst_required(std::span<const CaseOutcome> outcomes, std::size_t first,
                                        std::size_t count);
// Appends g for each requirement that is a constraint. `worst` has one value per requirement.
void append_constraints(std::span<const Requirement> requirements, std::span<const double> worst,
                        std::vector<double>& constraint_values);

}  // namespace armwright
