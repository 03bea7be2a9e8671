// A pattern search with a seeded order of coordinates, in a few lines: what a plugin's author
// writes.
#include <numeric>
#include <random>

#include "armwright/plugin.hpp"

namespace {

class Pattern {
 public:
  static armwright::plugin::Description describe() {
    return {.name = "pattern",
            .summary = "Steps along one variable at a time, halved when nothing improves",
            .source = "Hooke, Jeeves 1961, Direct search solution of numerical problems",
            .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_STOCHASTIC | ARMWRIGHT_LOCAL,
            .options = {
                armwright::plugin::number("step", "first step, share of the box", 0.25, 1e-6, 1),
                armwright::plugin::integer("sweeps", "at most so many", 1000, 1, 1000000),
                armwright::plugin::flag("shuffle", "variables in random order", true),
                armwright::plugin::text("start", "where to begin", "start", {"start", "middle"})}};
  }

  void minimize(armwright::plugin::Evaluator& evaluate, const armwright::plugin::Options& options,
                std::uint64_t seed) {
    const auto& variables = evaluate.problem().variables;
    std::mt19937_64 random(seed);
    std::vector<double> best = evaluate.problem().start();
    if (options.get_text("start") == "middle") {
      for (std::size_t i = 0; i < best.size(); ++i) {
        best[i] = 0.5 * (variables[i].lower + variables[i].upper);
      }
    }
    double best_value = evaluate(best);
    double step = options.get_number("step");
    std::vector<std::size_t> order(best.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::int64_t sweep = 0; sweep < options.get_integer("sweeps"); ++sweep) {
      const double before = best_value;
      for (std::size_t i = order.size(); options.get_bool("shuffle") && i > 1; --i) {
        std::swap(order[i - 1], order[random() % i]);
      }
      for (const std::size_t i : order) {
        for (const double sign : {1.0, -1.0}) {
          std::vector<double> trial = best;
          trial[i] += sign * step * (variables[i].upper - variables[i].lower);
          trial = evaluate.problem().clip(trial);
          if (const double value = evaluate(trial); value < best_value) {
            best = trial;
            best_value = value;
          }
        }
      }
      step *= best_value < before ? 1 : 0.5;
    }
    evaluate.recommend(best);
  }
};

}  // namespace

ARMWRIGHT_PLUGIN(Pattern)
