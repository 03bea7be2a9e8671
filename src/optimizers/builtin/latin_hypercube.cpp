#include "optimizers/builtin/latin_hypercube.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "optimizers/interface/scalar_function.hpp"

namespace armwright {
namespace {

class LatinHypercube : public Optimizer {
 public:
  explicit LatinHypercube(const Options& options)
      : samples_(static_cast<std::size_t>(options.get_integer("samples"))),
        batch_(static_cast<std::size_t>(options.get_integer("batch"))) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    ScalarFunction function(evaluator);
    RandomStream random("optimizer/lhs", seed);
    try {
      function.evaluate(function.space().start());
      while (true) {
        evaluate_in_batches(function, draw_latin_hypercube(function.space(), samples_, random));
      }
    } catch (const EvaluatorStopped&) {
    }
  }

 private:
  void evaluate_in_batches(ScalarFunction& function,
                           const std::vector<std::vector<double>>& design) const {
    const std::span<const std::vector<double>> points = design;
    const std::size_t size = batch_ == 0 ? points.size() : batch_;
    for (std::size_t first = 0; first < points.size(); first += size) {
      function.evaluate_batch(points.subspan(first, std::min(size, points.size() - first)));
    }
  }

  std::size_t samples_;
  std::size_t batch_;
};

}  // namespace

std::vector<std::vector<double>> draw_latin_hypercube(const SearchSpace& space, std::size_t samples,
                                                      RandomStream& random) {
  std::vector<std::vector<double>> design(samples, std::vector<double>(space.dimension()));
  std::vector<std::size_t> intervals(samples);
  for (std::size_t i = 0; i < space.dimension(); ++i) {
    std::iota(intervals.begin(), intervals.end(), std::size_t{0});
    for (std::size_t last = samples; last > 1; --last) {  // Fisher and Yates 1938
      std::swap(intervals[last - 1], intervals[random.below(last)]);
    }
    const double lower = space.lower()[i];
    const double upper = space.upper()[i];
    for (std::size_t k = 0; k < samples; ++k) {
      const double share =
          (static_cast<double>(intervals[k]) + random.uniform()) / static_cast<double>(samples);
      design[k][i] = std::clamp(lower + share * (upper - lower), lower, upper);
    }
  }
  return design;
}

std::vector<OptimizerRow> make_latin_hypercube_rows() {
  return {{
      .name = "lhs",
      .summary = "Latin hypercube sampling: covers every variable's range evenly",
      .source = "McKay, Beckman and Conover 1979, A comparison of three methods for selecting "
                "values of input variables in the analysis of output from a computer code",
      .capabilities = {.bounds = true,
                       .batch = true,
                       .stochastic = true,
                       .sampling = true,
                       .integer = true,
                       .categorical = true},
      .options = {{.name = "samples",
                   .description = "points of a design; one design follows another",
                   .fallback = std::int64_t{100},
                   .lower = 1,
                   .upper = 1000000},
                  {.name = "batch",
                   .description =
                       "points asked for at a time, 0: a design; has no influence on the "
                       "points",
                   .fallback = std::int64_t{0},
                   .lower = 0,
                   .upper = 1000000}},
      .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<LatinHypercube>(options);
      },
  }};
}

}  // namespace armwright
