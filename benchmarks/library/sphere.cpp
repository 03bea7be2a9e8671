// The sphere in 20 variables as a problem in a shared library, for overhead_benchmark.
#include "armwright/problem.hpp"

namespace {

using namespace armwright::problem;

class Sphere : public Problem {
 public:
  Description describe() const override {
    Description all;
    all.name = "sphere-library";
    for (int i = 0; i < 20; ++i) {
      all.variables.push_back(real("x" + std::to_string(i), "", -5, 5));
    }
    all.objectives = {{"f"}};
    return all;
  }
  Answer evaluate(const Point& x, const Case& /*one*/) override {
    double sum = 0;
    for (const double value : x) {
      sum += (value - 1) * (value - 1);
    }
    return sum;
  }
};

}  // namespace

ARMWRIGHT_PROBLEM(Sphere)
