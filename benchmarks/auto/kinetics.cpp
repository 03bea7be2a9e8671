// A user's fit for the check of `auto`: the rates of the reactions A -> B -> C, of which the first
// can go back, from concentrations of B and C at twelve times. The residuals are those of the fit.
#include <armwright/problem.hpp>
#include <vector>

namespace aw = armwright::problem;

class Kinetics : public aw::Problem {
 public:
  Kinetics() : recorded_(simulate({2.1, 0.35, 0.8, 1.3, 0.05})) {
    // Errors of a sensor: the same in every run, and no design removes them.
    for (std::size_t i = 0; i < recorded_.size(); ++i) {
      recorded_[i] += 0.004 * (static_cast<double>((7 * i + 3) % 11) / 5 - 1);
    }
  }

  aw::Description describe() const override {
    aw::Description all;
    all.name = "kinetics";
    all.summary = "Rates of a reaction from concentrations";
    all.variables = {aw::logarithmic("forward", "1/s", 0.01, 100),
                     aw::logarithmic("back", "1/s", 0.01, 100),
                     aw::logarithmic("second", "1/s", 0.01, 100), aw::real("amount", "mol", 0.2, 5),
                     aw::real("offset", "mol", -0.5, 0.5)};
    all.objectives = {{"squares", "mol2"}};
    all.has_residuals = true;
    return all;
  }

  aw::Answer evaluate(const aw::Point& x, const aw::Case& /*one*/) override {
    const std::vector<double> computed = simulate({x[0], x[1], x[2], x[3], x[4]});
    aw::Answer answer(0);
    double sum = 0;
    for (std::size_t i = 0; i < computed.size(); ++i) {
      answer.residuals.push_back(computed[i] - recorded_[i]);
      sum += answer.residuals.back() * answer.residuals.back();
    }
    answer.objectives = {sum};
    return answer;
  }

 private:
  struct Rates {
    double forward, back, second, amount, offset;
  };

  // Returns B and C at twelve times, by implicit Euler steps, which stay stable for fast reactions.
  static std::vector<double> simulate(const Rates& rates) {
    constexpr double kStep_s = 0.01;
    std::vector<double> seen;
    double a = rates.amount, b = 0, c = 0;
    for (int step = 1; step <= 600; ++step) {
      // (1 + h f) a' - h r b' = a and (1 + h (r + s)) b' - h f a' = b
      const double h = kStep_s, f = rates.forward, r = rates.back, s = rates.second;
      const double determinant = (1 + h * f) * (1 + h * (r + s)) - h * r * h * f;
      const double next_b = ((1 + h * f) * b + h * f * a) / determinant;
      a = (a + h * r * next_b) / (1 + h * f);
      b = next_b;
      c += h * s * b;
      if (step % 50 == 0) {
        seen.insert(seen.end(), {b + rates.offset, c});
      }
    }
    return seen;
  }

  std::vector<double> recorded_;
};

ARMWRIGHT_PROBLEM(Kinetics)
