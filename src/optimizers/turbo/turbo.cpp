#include "optimizers/turbo/turbo.hpp"

#include <algorithm>
#include <memory>

#include "optimizers/turbo/turbo_region.hpp"

namespace armwright {
namespace {

constexpr int kMostVariables = 40;
constexpr int kMostEvaluations = 2000;

class Turbo : public Optimizer {
 public:
  explicit Turbo(const Options& options)
      : batch_(options.get_integer("batch")),
        initial_(options.get_integer("initial")),
        length_(options.get_number("length")) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const TurboBox box(evaluator.problem().variables);
    const Eigen::Index n = box.dimension();
    // Batches divide a run into at most a few hundred steps, also in many variables.
    const Eigen::Index batch = batch_ > 0 ? batch_ : std::max<Eigen::Index>(n / 5, 1);
    const Eigen::Index initial = initial_ > 0 ? initial_ : std::max<Eigen::Index>(2 * n, 5);
    RandomStream random("optimizer/turbo", seed);
    std::int64_t evaluations = 0;
    const auto evaluate = [&](const Eigen::MatrixXd& places) {
      std::vector<std::vector<double>> points;
      for (Eigen::Index k = 0; k < places.cols(); ++k) {
        points.push_back(box.to_point(places.col(k)));
      }
      evaluations += places.cols();
      return evaluator.evaluate(points);
    };
    for (bool is_first = true;; is_first = false) {
      TurboRegion region(box, evaluator.problem(), length_);
      Eigen::MatrixXd design(n, initial);
      if (is_first) {
        design << box.start(), box.draw_design(initial - 1, random);
      } else {
        design = box.draw_design(initial, random);
      }
      const std::vector<Score> scores = evaluate(design);
      if (evaluator.stopped()) {
        return;
      }
      region.begin(design, scores);
      while (!region.has_converged()) {
        if (evaluations + batch > kMostEvaluations) {
          evaluator.explain_end("it has made the 2000 evaluations that its models are made for");
          return;
        }
        const Eigen::MatrixXd places = region.choose(batch, random);
        const std::vector<Score> found = evaluate(places);
        if (evaluator.stopped()) {
          return;
        }
        region.add_batch(places, found);
      }
    }
  }

 private:
  Eigen::Index batch_;
  Eigen::Index initial_;
  double length_;
};

}  // namespace

std::vector<OptimizerRow> make_turbo_rows() {
  return {{
      .name = "turbo",
      .summary = "Gaussian processes in a trust region, for a few hundred evaluations",
      .source =
          "Eriksson, Pearce, Gardner, Turner and Poloczek 2019, Scalable global optimization via "
          "local Bayesian optimization; Eriksson and Poloczek 2021, Scalable constrained Bayesian "
          "optimization; Wilson, Borovitskiy, Terenin, Mostowsky and Deisenroth 2020, Efficiently "
          "sampling functions from Gaussian process posteriors; Garrido-Merchan and "
          "Hernandez-Lobato 2020, Dealing with categorical and integer-valued variables in "
          "Bayesian "
          "optimization with Gaussian processes",
      .capabilities = {.bounds = true,
                       .constraints = true,
                       .batch = true,
                       .stochastic = true,
                       .integer = true,
                       .categorical = true},
      .options = {{.name = "batch",
                   .description = "points asked for at a time, each from a sample of its own; more "
                                  "need more evaluations; 0: n/5 for n variables, at least 1",
                   .fallback = std::int64_t{0},
                   .lower = 0,
                   .upper = 200},
                  {.name = "initial",
                   .description =
                       "points of the Latin hypercube with which it begins and restarts; "
                       "0: 2n for n variables, at least 5",
                   .fallback = std::int64_t{0},
                   .lower = 0,
                   .upper = 1000},
                  {.name = "length",
                   .description =
                       "initial width of the trust region, as a share of the box's width",
                   .fallback = 0.8,
                   .lower = 0.01,
                   .upper = 1.6}},
      .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<Turbo>(options);
      },
      .limits = {.variables = kMostVariables,
                 .evaluations = kMostEvaluations,
                 .alternative = "cmaes"},
      .tuned_on = {"rosenbrock", "rastrigin", "ellipsoid", "bbob-f3", "bbob-f10"},
      .tuning = "the size of a batch and the objective as it is, without a transformation, were "
                "chosen on instances 101 to 103 of these functions",
  }};
}

}  // namespace armwright
