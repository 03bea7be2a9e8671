// Joint controllers behind one interface, and the explicit table of them. A controller maps
// setpoint and measurement to an effort once a control period; it knows no clock, no file and of
// its joint only the kind.
//
// Units are those of a revolute joint, as in the names: N m and rad. For a prismatic joint read N
// for N m and m for rad: gains in N/m, N/(m s) and N s/m.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot_model.hpp"

namespace armwright {

class Controller {
 public:
  virtual ~Controller() = default;
  // Effort (N m or N) for setpoint and measurement (rad or m) at this sample; dt_s is the control
  // period.
  virtual double step(double setpoint, double measurement, double dt_s) = 0;
  virtual void reset() = 0;
  // Whether the last step's effort was clamped to a limit.
  virtual bool saturated() const = 0;
};

struct EffortLimits {
  double min_n_m = 0;
  double max_n_m = 0;
};

// A discrete PID with clamped output (thesis section 5.2.2):
//   u = P e + I sum(e) h + D (e - e_prev) / h, clamped to [min, max],
//   e = setpoint - measurement, of a revolute joint wrapped to [-pi, pi].
// Anti-windup: a step whose predecessor was clamped does not integrate. The derivative of the first
// step is zero.
class PidController final : public Controller {
 public:
  PidController(double p_n_m_per_rad, double i_n_m_per_rad_s, double d_n_m_s_per_rad,
                EffortLimits limits, JointKind kind = JointKind::revolute);
  double step(double setpoint, double measurement, double dt_s) override;
  void reset() override;
  bool saturated() const override { return saturated_; }

 private:
  double p_, i_, d_;
  EffortLimits limits_;
  JointKind kind_;
  double integral_ = 0;  // rad s or m s
  double previous_error_ = 0;
  bool first_ = true;
  bool saturated_ = false;
};

struct GainSpec {
  std::string name;  // "p"
  std::string key;   // with its unit, as in design files: "p_n_m_per_rad"
  std::string unit;  // "N m/rad"
};

struct ControllerRow {
  std::string name;
  std::string summary;
  std::vector<GainSpec> gains;
  std::unique_ptr<Controller> (*make)(std::span<const double> gains, EffortLimits limits,
                                      JointKind kind);
};

const std::vector<ControllerRow>& controller_table();
std::vector<std::string> controller_names();
const ControllerRow& find_controller(std::string_view name);  // Error{usage} if there is none

}  // namespace armwright
