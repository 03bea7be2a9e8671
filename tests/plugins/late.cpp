// Shows in C++ what armwright gives since version 2.0: recommends points that hold what it has seen,
// then spends the budget, and recommends a last point after the end.
#include <cstdint>
#include <vector>

#include "armwright/plugin.hpp"

namespace {

namespace plugin = armwright::plugin;

class Late {
 public:
  static plugin::Description describe() {
    return {.name = "late",
            .summary = "Recommends after the end of the budget",
            .source = "the tests",
            .capabilities = ARMWRIGHT_BATCH | ARMWRIGHT_RESIDUALS | ARMWRIGHT_SAMPLING,
            .options = {plugin::text("end", "how it ends", "late", {"late", "early", "at_once"})},
            .least_variables = 2};
  }

  void minimize(plugin::Evaluator& evaluate, const plugin::Options& options,
                std::uint64_t /*seed*/) {
    const plugin::Problem& problem = evaluate.problem();
    const std::vector<double> start = problem.start();
    std::vector<double> outside = start;
    outside[0] = 2 * problem.variables[0].upper + 1;
    if (options.get_text("end") == "at_once") {
      evaluate.explain_end("no licence");
      return;
    }
    const std::vector<plugin::Score> scores =
        evaluate.evaluate(std::vector<std::vector<double>>{start, outside});
    const auto show = [&](double first, double second) {
      std::vector<double> shown = start;
      shown[0] = first;
      shown[1] = second;
      evaluate.recommend(shown);
    };
    double squares = 0;
    for (const double residual : scores[0].residuals) {
      squares += residual * residual;
    }
    show(problem.calc_scalar(scores[0].objectives), evaluate(start));
    show(problem.has_residuals ? 1 : 0, squares);
    show(scores[0].clipped ? 1 : 0, scores[1].clipped ? 1 : 0);
    if (options.get_text("end") == "early") {
      evaluate.explain_end("all is seen");
      return;
    }
    try {
      while (true) {
        evaluate(start);
      }
    } catch (const plugin::Stopped&) {
      std::vector<double> zero(start.size(), 0.0);
      evaluate.recommend(zero);
    }
  }
};

}  // namespace

ARMWRIGHT_PLUGIN(Late)
