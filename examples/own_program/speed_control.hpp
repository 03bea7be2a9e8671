// A problem: the speed control of a motor. The program of this folder computes it itself, and the
// library shows it to `armwright optimize`.
#pragma once

#include <algorithm>
#include <armwright/problem.hpp>
#include <cmath>

namespace aw = armwright::problem;

// A PI controller turns a motor with inertia and friction to 1 rad/s, within its torque limit.
class SpeedControl : public aw::Problem {
 public:
  aw::Description describe() const override {
    return {.name = "speed-control",
            .summary = "A PI controller for a motor, as fast as an overshoot of 5 % allows",
            .variables = {aw::logarithmic("kp", "N m s/rad", 0.01, 100),
                          aw::logarithmic("ki", "N m/rad", 0.01, 100),
                          aw::category("filter", {"none", "slow", "fast"})},
            .objectives = {{"itae", "rad s", false, 1, 1000.0}},
            .constraints = {{"overshoot", "rad/s", 0.05}}};
  }

  // Several threads call this at the same time: it changes nothing but its own variables.
  aw::Answer evaluate(const aw::Point& x, const aw::Case& /*one*/) override {
    const double kp = x.get("kp"), ki = x.get("ki");
    const std::string filter = x.word("filter");
    const double smoothing = filter == "none" ? 1 : filter == "fast" ? 0.1 : 0.01;
    constexpr double kStep_s = 1e-4, kInertia_kg_m2 = 0.02, kFriction_n_m_s = 0.05, kTorque_n_m = 2;
    double speed = 0, measured = 0, integral = 0, itae = 0, overshoot = 0;
    for (double time_s = 0; time_s < 2; time_s += kStep_s) {
      measured += smoothing * (speed - measured);
      integral += (1 - measured) * kStep_s;
      const double wanted = kp * (1 - measured) + ki * integral;
      const double torque = std::clamp(wanted, -kTorque_n_m, kTorque_n_m);
      speed += (torque - kFriction_n_m_s * speed) / kInertia_kg_m2 * kStep_s;
      itae += time_s * std::abs(1 - speed) * kStep_s;
      overshoot = std::max(overshoot, speed - 1);
    }
    aw::Answer answer(itae);
    answer.constraints = {overshoot};
    return answer;
  }
};
