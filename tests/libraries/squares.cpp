// The problem "slow-squares" of tests/plugins/problem.py as a library: a sum of squares of variables
// of each type. A case takes a millisecond, so that a run can be killed before it ends.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "armwright/problem.hpp"

namespace {

using namespace armwright::problem;

class Squares : public Problem {
 public:
  Description describe() const override {
    Description all;
    all.name = "squares";
    all.variables = {real("x", "mm", -5, 5), integer("n", "", -3, 8),
                     category("word", {"plain", "dear"})};
    all.variables[0].start = 3;
    all.variables[1].start = 2;
    all.objectives = {{"f", "N"}};
    all.has_residuals = true;
    return all;
  }

  Answer evaluate(const Point& x, const Case& /*one*/) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (const char* const gate = std::getenv("TEST_GATE")) {
      while (x[0] > 1 && !std::filesystem::exists(gate)) {  // like a case without end
        std::ofstream(std::string(gate) + ".reached");
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    }
    Answer answer(0);
    answer.residuals = {x[0] - 1.5, 0.5 * x[1], x.word("word") == "dear" ? 1.0 : 0.25,
                        std::sin(3 * x[0])};
    for (const double residual : answer.residuals) {
      answer.objectives[0] += residual * residual;
    }
    return answer;
  }
};

}  // namespace

ARMWRIGHT_PROBLEM(Squares)
