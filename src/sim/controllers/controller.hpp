// Joint controllers behind one interface, and the explicit table of them, which is made from the
// laws of controllers/law_table.hpp. Once per control period, a controller maps setpoint and
// measurement to an effort that is clamped to the joint's limits. A controller that commands a drive
// does the same with a speed or a position (ControllerRow::interface). It reads no clock and no file.
// The only thing that it knows about its joint is the kind.
//
// The keys of gains name the units of a revolute joint: N m and rad. For a prismatic joint read N
// for N m and m for rad: gains in N/m, N/(m s) and N s/m.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/controllers/law_types.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

// The controller of one joint. It has a state, so each simulation needs its own objects.
class Controller {
 public:
  virtual ~Controller() = default;
  // Returns the effort (N m or N) for setpoint and measurement (rad or m) in this control period of
  // length dt_s. `feed_forward` (N m or N) is the effort that the target table holds for the
  // period.
  virtual double step(double setpoint, double measurement, double dt_s, double feed_forward) = 0;
  double step(double setpoint, double measurement, double dt_s) {
    return step(setpoint, measurement, dt_s, 0);
  }
  // Returns to the state before the first step, with all integrals empty.
  virtual void reset() = 0;
  // As reset(), with the integral that gives `effort` (N m or N), clamped to the limits, while the
  // measurement is at the setpoint. If the law has no such integral, or its gain is 0, the integral
  // is empty.
  virtual void hold(double effort) = 0;
  // Returns whether the last step's effort was clamped to a limit.
  virtual bool saturated() const = 0;
};

struct EffortLimits {  // N m or N
  double min = 0;
  double max = 0;
};

struct ControllerRow {
  std::string name;
  std::string summary;
  std::string formula;
  std::span<const controllers::Gain> gains;
  ControlInterface interface = ControlInterface::effort;
  FeedForward feed_forward = FeedForward::none;
  int law = 0;     // its place in the table, by which the SIMD lanes find it
  int states = 0;  // count of numbers that it keeps from step to step
  // Writes the start values of its gains (as many as `gains` has), computed from a PID's.
  void (*convert)(const controllers::PidStart& pid, double* own);
  // Writes the states (as many as `states`) with which it holds an effort, as Controller::hold().
  void (*hold)(double effort, EffortLimits limits, std::span<const double> gains, double* states);
  // Throws Error{usage} for a wrong count of gains, a gain that is not finite, or limits that are
  // not in order.
  std::unique_ptr<Controller> (*make)(std::span<const double> gains, EffortLimits limits,
                                      JointKind kind);
};

const std::vector<ControllerRow>& controller_table();
std::vector<std::string> controller_names();
const ControllerRow& find_controller(std::string_view name);  // Error{usage} if there is none
// Returns the first controller of the table with that interface, which is its plain PID.
const ControllerRow& get_plain_controller(ControlInterface interface);

// Converts the unit of a revolute joint to that of a joint of the given kind: "N m/rad" stays or
// becomes "N/m".
std::string get_joint_unit(std::string_view unit, JointKind kind);

}  // namespace armwright
