// A user's smooth problem for the check of `auto`: a chain of six masses hangs on springs between two
// hooks. Its energy is smallest where it comes to rest.
#include <armwright/problem.hpp>
#include <cmath>
#include <string>

namespace aw = armwright::problem;

class Chain : public aw::Problem {
 public:
  aw::Description describe() const override {
    aw::Description all;
    all.name = "chain";
    all.summary = "The rest of a hanging chain";
    for (int i = 1; i <= kMasses; ++i) {
      all.variables.push_back(aw::real("x_" + std::to_string(i), "m", -1, 5));
      all.variables.push_back(aw::real("y_" + std::to_string(i), "m", -5, 1));
    }
    all.objectives = {{"energy", "J"}};
    return all;
  }

  aw::Answer evaluate(const aw::Point& place, const aw::Case& /*one*/) override {
    constexpr double kLength_m = 0.8, kStiffness_n_per_m = 300, kGravity_m_per_s2 = 9.81;
    double energy = 0, x = 0, y = 0;  // the first hook
    for (int i = 0; i <= kMasses; ++i) {
      const double next_x = i < kMasses ? place[2 * i] : 4;  // the second hook is at (4, -0.5)
      const double next_y = i < kMasses ? place[2 * i + 1] : -0.5;
      const double stretch = std::hypot(next_x - x, next_y - y) - kLength_m;
      energy += 0.5 * kStiffness_n_per_m * stretch * stretch;
      energy += i < kMasses ? (0.5 + 0.1 * i) * kGravity_m_per_s2 * next_y : 0;
      x = next_x;
      y = next_y;
    }
    return aw::Answer(energy);
  }

 private:
  static constexpr int kMasses = 6;
};

ARMWRIGHT_PROBLEM(Chain)
