// A user's rugged problem for the check of `auto`: eight stages of a cooler. The cost of a stage
// rises with its size and falls with its efficiency, which resonates with the flow of its neighbour.
#include <armwright/problem.hpp>
#include <cmath>
#include <string>

namespace aw = armwright::problem;

class Cooling : public aw::Problem {
 public:
  aw::Description describe() const override {
    aw::Description all;
    all.name = "cooling";
    all.summary = "Eight stages of a cooler";
    for (int i = 1; i <= kStages; ++i) {
      all.variables.push_back(aw::real("size_" + std::to_string(i), "m", 0.1, 4));
    }
    all.objectives = {{"cost", ""}};
    return all;
  }

  aw::Answer evaluate(const aw::Point& size, const aw::Case& /*one*/) override {
    double cost = 0, load = 1;
    for (int i = 0; i < kStages; ++i) {
      const double flow = size[i] / (0.5 + size[(i + 1) % kStages]);
      const double efficiency = 1 - std::exp(-size[i]) + 0.08 * std::sin(9 * flow + i);
      load *= 1 - 0.7 * efficiency;
      cost += 0.1 * size[i] + 0.03 * std::cos(11 * size[i]);
    }
    return aw::Answer(cost + 40 * load);
  }

 private:
  static constexpr int kStages = 8;
};

ARMWRIGHT_PROBLEM(Cooling)
