#include "optimizers/builtin/random_search.hpp"

#include <algorithm>
#include <cmath>

#include "optimizers/interface/treated_problem.hpp"

namespace armwright {
namespace {

class RandomSearch : public Optimizer {
 public:
  explicit RandomSearch(const Options& options)
      : batch_(static_cast<std::size_t>(options.get_integer("batch"))) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const std::vector<DecisionVariable>& variables = evaluator.problem().variables;
    // In these ranges every value of a discrete variable has the same share.
    const std::vector<DecisionVariable> ranges = adapt_variables(variables, {});
    RandomStream random("optimizer/random", seed);
    std::vector<std::vector<double>> points;
    bool is_start = true;
    while (!evaluator.stopped()) {
      points.assign(batch_, std::vector<double>(variables.size()));
      for (std::vector<double>& point : points) {
        for (std::size_t i = 0; i < variables.size(); ++i) {
          point[i] = is_start ? variables[i].start
                              : settle_value(variables[i], draw_coordinate(ranges[i], random));
        }
        is_start = false;
      }
      evaluator.evaluate(points);
    }
  }

 private:
  std::size_t batch_;
};

// Evaluates the problem's start and nothing else: what the others have to be better than.
class StartOnly : public Optimizer {
 public:
  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    const std::vector<double> start = list_starts(evaluator.problem().variables);
    evaluator.evaluate(std::span(&start, 1));
    evaluator.explain_end("it evaluates the start only");
  }
};

}  // namespace

double draw_coordinate(const DecisionVariable& variable, RandomStream& random) {
  const double u = random.uniform();
  if (variable.scale == Scale::linear) {
    return std::clamp(variable.lower + u * (variable.upper - variable.lower), variable.lower,
                      variable.upper);
  }
  const double log_lower = std::log(std::abs(variable.lower));
  const double log_upper = std::log(std::abs(variable.upper));
  const double magnitude = std::exp(log_lower + u * (log_upper - log_lower));
  return std::clamp(std::copysign(magnitude, variable.lower), variable.lower, variable.upper);
}

std::vector<OptimizerRow> make_random_search_rows() {
  return {
      {
          .name = "random",
          .summary = "Random search: independent points, uniform on every variable's scale",
          .source = "Brooks 1958, A discussion of random methods for seeking maxima",
          .capabilities = {.bounds = true,
                           .batch = true,
                           .stochastic = true,
                           .sampling = true,
                           .integer = true,
                           .categorical = true},
          .options = {{.name = "batch",
                       .description = "points asked for at a time; has no influence on the points",
                       .fallback = std::int64_t{32},
                       .lower = 1,
                       .upper = 100000}},
          .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
            return std::make_unique<RandomSearch>(options);
          },
      },
      {
          .name = "start",
          .summary = "The problem's start, evaluated once: the least to be better than",
          .source = "the problem itself",
          .capabilities = {.bounds = true, .sampling = true, .integer = true, .categorical = true},
          .options = {},
          .make = [](const Options&) -> std::unique_ptr<Optimizer> {
            return std::make_unique<StartOnly>();
          },
      }};
}

}  // namespace armwright
