// Joint controllers behind one interface, and the explicit table of them, made of the laws of
// controllers/laws.hpp. A controller maps setpoint and measurement to an effort once a control
// period, clamped to the joint's limits; it knows no clock, no file and of its joint only the kind.
//
// Units are those of a revolute joint, as in the names: N m and rad. For a prismatic joint read N
// for N m and m for rad: gains in N/m, N/(m s) and N s/m.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/controllers/law_types.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

class Controller {
 public:
  virtual ~Controller() = default;
  // Effort (N m or N) for setpoint and measurement (rad or m) at this sample; dt_s is the control
  // period, `feed_forward` (N m or N) what the controller's FeedForward table says for it.
  virtual double step(double setpoint, double measurement, double dt_s, double feed_forward) = 0;
  double step(double setpoint, double measurement, double dt_s) {
    return step(setpoint, measurement, dt_s, 0);
  }
  virtual void reset() = 0;
  // Whether the last step's effort was clamped to a limit.
  virtual bool saturated() const = 0;
};

struct EffortLimits {
  double min_n_m = 0;
  double max_n_m = 0;
};

// The PID (controllers/pid.hpp), by the arithmetic that the published results were reproduced with:
// a division by the period where lanes multiply by its inverse, and the library's remainder.
class PidController final : public Controller {
 public:
  PidController(double p_n_m_per_rad, double i_n_m_per_rad_s, double d_n_m_s_per_rad,
                EffortLimits limits, JointKind kind = JointKind::revolute);
  using Controller::step;
  double step(double setpoint, double measurement, double dt_s, double feed_forward) override;
  void reset() override;
  bool saturated() const override { return saturated_; }

 private:
  std::array<double, 3> gains_;
  std::array<double, 2> states_{};
  EffortLimits limits_;
  JointKind kind_;
  bool first_ = true;
  bool saturated_ = false;
};

struct GainSpec {
  std::string name;  // "p"
  std::string key;   // with its unit, as in design files: "p_n_m_per_rad"
  std::string unit;  // "N m/rad"
  // As a decision variable: 0, a factor around its start; otherwise linear, this far to either
  // side, but never below 0 unless it may have any sign.
  double range = 0;
  bool any_sign = false;
};

struct ControllerRow {
  std::string name;
  std::string summary;
  std::string formula;
  std::vector<GainSpec> gains;
  FeedForward feed_forward = FeedForward::none;
  int law = 0;     // its place in the table, by which the SIMD lanes find it
  int states = 0;  // how many numbers it keeps from step to step
  // Its own gains, as many as it has, of a PID's.
  void (*convert)(const controllers::PidStart& pid, double* own);
  std::unique_ptr<Controller> (*make)(std::span<const double> gains, EffortLimits limits,
                                      JointKind kind);
};

const std::vector<ControllerRow>& controller_table();
std::vector<std::string> controller_names();
const ControllerRow& find_controller(std::string_view name);  // Error{usage} if there is none

// A unit of a joint that turns, or of the same for one that slides: "N m/rad", "N/m".
std::string get_joint_unit(std::string_view unit, JointKind kind);

}  // namespace armwright
