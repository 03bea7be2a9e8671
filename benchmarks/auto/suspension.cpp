// A user's problem for the second check of `auto`: a quarter of a car on a road of harmonics. A
// spring, a damper, a second damper for the rebound, an absorber (its mass share, frequency and
// damping) and the tyre's stiffness shall give comfort and grip.
#include <algorithm>
#include <armwright/problem.hpp>
#include <cmath>

namespace aw = armwright::problem;

class Suspension : public aw::Problem {
 public:
  aw::Description describe() const override {
    aw::Description all;
    all.name = "suspension";
    all.summary = "Springs and dampers of a quarter of a car";
    all.variables = {aw::real("stiffness", "N/m", 5e3, 8e4),
                     aw::real("compression", "N s/m", 200, 6e3),
                     aw::real("rebound", "N s/m", 200, 6e3),
                     aw::real("absorber_share", "", 0.01, 0.3),
                     aw::real("absorber_frequency", "rad/s", 20, 120),
                     aw::real("absorber_damping", "", 0.02, 0.9),
                     aw::real("tyre", "N/m", 1e5, 3e5)};
    all.objectives = {{"discomfort", ""}};
    return all;
  }

  aw::Answer evaluate(const aw::Point& x, const aw::Case& /*one*/) override {
    constexpr double body_kg = 350, wheel_kg = 45, step_s = 1e-3;
    const double absorber_kg = x[3] * wheel_kg;
    const double absorber_n_per_m = absorber_kg * x[4] * x[4];
    const double absorber_n_s_per_m = 2 * x[5] * absorber_kg * x[4];
    double z[3] = {0, 0, 0}, v[3] = {0, 0, 0};  // body, wheel, absorber
    double comfort = 0, grip = 0, travel = 0;
    for (int k = 0; k < 4000; ++k) {
      const double t = k * step_s;
      const double road_m =
          0.02 * std::sin(7 * t) + 0.008 * std::sin(31 * t + 1) + 0.003 * std::sin(67 * t + 2);
      const double speed = v[1] - v[0];
      const double strut_n = x[0] * (z[1] - z[0]) + (speed > 0 ? x[1] : x[2]) * speed;
      const double absorber_n =
          absorber_n_per_m * (z[1] - z[2]) + absorber_n_s_per_m * (v[1] - v[2]);
      const double tyre_n = x[6] * (road_m - z[1]);
      const double body = strut_n / body_kg;
      v[0] += step_s * body;
      v[1] += step_s * (tyre_n - strut_n - absorber_n) / wheel_kg;
      v[2] += step_s * absorber_n / absorber_kg;
      for (int i = 0; i < 3; ++i) {
        z[i] += step_s * v[i];
      }
      comfort += body * body;
      grip += tyre_n * tyre_n;
      travel = std::max(travel, std::abs(z[1] - z[0]));
    }
    return aw::Answer(std::sqrt(comfort / 4000) + 1e-3 * std::sqrt(grip / 4000) +
                      20 * std::max(0.0, travel - 0.05));
  }
};

ARMWRIGHT_PROBLEM(Suspension)
