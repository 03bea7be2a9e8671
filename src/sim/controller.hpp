// Joint controllers behind one interface, and the explicit table of them. A controller maps
// setpoint and measurement to an effort once a control period; it knows no clock, no joint and no
// file.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

class Controller {
 public:
  virtual ~Controller() = default;
  // Effort (N m) for setpoint and measurement (rad) at this sample; dt_s is the control period.
  virtual double step(double setpoint_rad, double measurement_rad, double dt_s) = 0;
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
//   e = setpoint - measurement wrapped to [-pi, pi].
// Anti-windup: a step whose predecessor was clamped does not integrate. The derivative of the first
// step is zero.
class PidController final : public Controller {
 public:
  PidController(double p_n_m_per_rad, double i_n_m_per_rad_s, double d_n_m_s_per_rad,
                EffortLimits limits);
  double step(double setpoint_rad, double measurement_rad, double dt_s) override;
  void reset() override;
  bool saturated() const override { return saturated_; }

 private:
  double p_, i_, d_;
  EffortLimits limits_;
  double integral_rad_s_ = 0;
  double previous_error_rad_ = 0;
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
  std::unique_ptr<Controller> (*make)(std::span<const double> gains, EffortLimits limits);
};

const std::vector<ControllerRow>& controller_table();
std::vector<std::string> controller_names();
const ControllerRow& find_controller(std::string_view name);  // Error{usage} if there is none

}  // namespace armwright
