// Treats integers and categories itself. It recommends what it is told of the variables, one point
// per variable (type, lower bound, upper bound, length of the last word), and asks for one point
// that clip() has rounded.
#include "armwright/plugin.hpp"

namespace {

class Typed {
 public:
  static armwright::plugin::Description describe() {
    return {.name = "typed",
            .summary = "Says what it sees of the variables",
            .source = "a test",
            .capabilities = ARMWRIGHT_INTEGERS | ARMWRIGHT_CATEGORIES};
  }

  void minimize(armwright::plugin::Evaluator& evaluate,
                const armwright::plugin::Options& /*options*/, std::uint64_t /*seed*/) {
    const armwright::plugin::Problem& problem = evaluate.problem();
    for (const armwright::plugin::Variable& v : problem.variables) {
      const std::size_t length = v.choices.empty() ? 0 : v.choices.back().size();
      evaluate.recommend(std::vector<double>{static_cast<double>(v.type), v.lower, v.upper,
                                             static_cast<double>(length)});
    }
    std::vector<double> x = problem.start();
    for (double& value : x) {
      value += 0.625;
    }
    evaluate(problem.clip(x));
  }
};

}  // namespace

ARMWRIGHT_PLUGIN(Typed)
