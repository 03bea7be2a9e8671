#include "optimizers/cma/cma_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/random.hpp"
#include "optimizers/cma/cma_box.hpp"
#include "optimizers/cma/cma_uncertainty.hpp"
#include "optimizers/interface/feasibility.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {
namespace {

// The values with which one run of the strategy begins.
struct RunPlan {
  std::vector<double> mean;
  std::size_t population = 0;
  double sigma = 0;
  std::int64_t budget = INT64_MAX;  // evaluations; ends the run after a generation
};

class CmaSearch {
 public:
  CmaSearch(const CmaSearchSettings& settings, Evaluator& evaluator, std::uint64_t seed)
      : settings_(settings),
        evaluator_(evaluator),
        box_(evaluator.problem().variables),
        order_(evaluator.problem()),
        random_("optimizer/cmaes", seed) {
    for (std::size_t i = 0; i < box_.dimension(); ++i) {
      discrete_.push_back(box_.is_discrete(i));
    }
    has_discrete_ = has_discrete(evaluator.problem().variables);
  }

  void search() {
    const std::size_t base =
        round_up(settings_.cma.population > 0 ? settings_.cma.population
                                              : calc_default_population(box_.dimension()));
    if (settings_.cma.mu > base) {
      throw Error(
          ErrorKind::usage,
          fmt::format("optimizer 'cmaes': option 'mu' is {}; it must not be larger than the "
                      "population, which is {}",
                      settings_.cma.mu, base));
    }
    base_population_ = base;
    // The start is no sample of the distribution, so it must not enter the update. It is evaluated
    // alone, on the cases of the first generation.
    evaluator_.begin_generation();
    if (!evaluate({box_.make_start()})) {
      return;
    }
    bool goes_on = run({.mean = box_.make_start(), .population = base, .sigma = settings_.sigma});
    while (goes_on && settings_.restarts != CmaRestarts::none) {
      goes_on = settings_.restarts == CmaRestarts::ipop ? restart_larger() : restart_either();
    }
  }

 private:
  std::size_t round_up(std::size_t population) const {
    const std::size_t m = settings_.batch_multiple;
    return (population + m - 1) / m * m;
  }

  std::vector<double> draw_start() {
    std::vector<double> u;
    for (std::size_t i = 0; i < box_.dimension(); ++i) {
      u.push_back(box_.to_coordinate(i, random_.uniform()));
    }
    return u;
  }

  // Auger and Hansen 2005: every restart doubles the population.
  bool restart_larger() {
    large_population_ = std::max(large_population_, base_population_) * 2;
    return run({.mean = draw_start(),
                .population = round_up(large_population_),
                .sigma = settings_.restart_sigma});
  }

  // Hansen 2009: the same, alternating with runs of a smaller population and step that use the same
  // number of evaluations.
  bool restart_either() {
    const std::int64_t before = evaluations_;
    if (large_population_ == 0 || large_evaluations_ <= small_evaluations_) {
      const bool goes_on = restart_larger();
      last_large_run_ = evaluations_ - before;
      large_evaluations_ += last_large_run_;
      return goes_on;
    }
    const auto base = static_cast<double>(base_population_);
    const double ratio = 0.5 * static_cast<double>(large_population_) / base;
    const double u = random_.uniform();
    const auto population = static_cast<std::size_t>(base * std::pow(ratio, u * u));
    const double sigma = settings_.restart_sigma * std::pow(10.0, -2 * random_.uniform());
    const bool goes_on = run({.mean = draw_start(),
                              .population = round_up(std::max(population, base_population_)),
                              .sigma = sigma,
                              .budget = std::max(last_large_run_ / 2, std::int64_t{1})});
    small_evaluations_ += evaluations_ - before;
    return goes_on;
  }

  // Does one run. Returns true if it ended, false if the evaluator stopped.
  bool run(const RunPlan& plan) {
    CmaSettings cma = settings_.cma;
    cma.population = plan.population;
    cma.mu = cma.mu * plan.population / base_population_;
    CmaDistribution distribution(make_cma_parameters(box_.dimension(), cma), plan.mean, plan.sigma);
    CmaTermination termination(distribution.parameters(), settings_.tolerances, plan.sigma,
                               discrete_);
    widen_discrete(distribution);
    const std::int64_t first_evaluation = evaluations_;
    while (evaluations_ - first_evaluation < plan.budget) {
      if (evaluator_.stopped()) {
        return false;
      }
      if (!is_first_generation_) {
        evaluator_.begin_generation();
      }
      is_first_generation_ = false;
      const std::vector<std::vector<double>>& points = distribution.sample(random_);
      const std::optional<std::vector<double>> values = evaluate(points);
      if (!values) {
        return false;
      }
      std::optional<UncertaintyMeasure> measure;
      if (settings_.uncertainty_handling) {
        measure = evaluate_again(points, *values);
        if (!measure) {
          return false;
        }
      }
      const std::vector<std::size_t> ranking = measure ? measure->ranking : rank(*values);
      distribution.update(ranking);
      correct_margins(distribution);
      evaluator_.recommend(box_.to_point(distribution.mean()));
      if (measure && measure->s > 0) {
        enlarge(distribution);
      }
      std::vector<double> sorted = *values;
      std::ranges::sort(sorted);
      escape_plateau(distribution, sorted);
      if (const CmaEnd end = termination.check(distribution, sorted); end != CmaEnd::none) {
        evaluator_.explain_end(describe(end));
        return true;
      }
    }
    return true;
  }

  // Gives a discrete coordinate at first at least the width of its mean's cell as standard
  // deviation. A share of the box would be too little for a few values.
  void widen_discrete(CmaDistribution& distribution) const {
    if (!has_discrete_) {
      return;
    }
    const std::vector<CmaCell> cells = box_.calc_cells(distribution.mean());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (discrete_[i]) {
        CmaMarginal marginal = distribution.marginal(i);
        const double width = std::min(cells[i].upper, 1.0) - std::max(cells[i].lower, 0.0);
        marginal.scale = std::max(1.0, width / distribution.calc_standard_deviation(i));
        distribution.set_marginal(i, marginal);
      }
    }
  }

  void correct_margins(CmaDistribution& distribution) const {
    if (!has_discrete_) {
      return;
    }
    const std::vector<CmaCell> cells = box_.calc_cells(distribution.mean());
    const double alpha = 1 / (static_cast<double>(box_.dimension()) *
                              static_cast<double>(distribution.parameters().population));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (discrete_[i]) {
        distribution.set_marginal(
            i, correct_margin(distribution.marginal(i), distribution.calc_standard_deviation(i),
                              cells[i], alpha));
      }
    }
  }

  // Returns nothing if the evaluator stopped before the last point.
  std::optional<std::vector<double>> evaluate(const std::vector<std::vector<double>>& points) {
    std::vector<std::vector<double>> asked;
    asked.reserve(points.size());
    for (const std::vector<double>& point : points) {
      asked.push_back(box_.to_point(point));
    }
    const std::vector<Score> scores = evaluator_.evaluate(asked);
    evaluations_ += static_cast<std::int64_t>(scores.size());
    if (scores.size() < points.size()) {
      return std::nullopt;
    }
    if (settings_.feasibility_first) {
      return order_.rate(scores);
    }
    std::vector<double> values;
    values.reserve(scores.size());
    for (const Score& score : scores) {
      values.push_back(calc_merit(evaluator_.problem(), score, settings_.constraint_weight));
    }
    return values;
  }

  static std::vector<std::size_t> rank(const std::vector<double>& values) {
    std::vector<std::size_t> ranking(values.size());
    std::iota(ranking.begin(), ranking.end(), std::size_t{0});
    std::ranges::stable_sort(ranking, {}, [&](std::size_t i) { return values[i]; });
    return ranking;
  }

  // Evaluates a tenth of the generation again on new cases, or two points of a small generation. A
  // fraction of a point is decided at random (Hansen et al. 2009: r = max(0.1, 2 / lambda)).
  std::optional<UncertaintyMeasure> evaluate_again(const std::vector<std::vector<double>>& points,
                                                   const std::vector<double>& values) {
    const double expected = std::max(0.1 * static_cast<double>(points.size()), 2.0);
    const double whole = std::floor(expected);
    const auto count =
        static_cast<std::size_t>(whole + (random_.bernoulli(expected - whole) ? 1 : 0));
    const std::vector<std::vector<double>> some(
        points.begin(),
        points.begin() + static_cast<std::ptrdiff_t>(std::min(count, points.size())));
    evaluator_.begin_generation();
    const std::optional<std::vector<double>> again = evaluate(some);
    if (!again) {
      return std::nullopt;
    }
    return measure_uncertainty(values, *again);
  }

  // If an evaluation cannot take more time, the paper increases sigma. It never exceeds the width
  // of the box here.
  void enlarge(CmaDistribution& distribution) const {
    const double factor = 1 + 2 / (static_cast<double>(box_.dimension()) + 10);
    if (distribution.longest_axis() * factor <= 1) {
      distribution.scale_sigma(factor);
    }
  }

  // All values of the generation are equal: increase sigma (Hansen 2016, appendix B.2).
  static void escape_plateau(CmaDistribution& distribution, const std::vector<double>& sorted) {
    const std::size_t place =
        static_cast<std::size_t>(std::ceil(0.7 * static_cast<double>(sorted.size())) - 1);
    if (sorted.front() == sorted[place]) {
      const CmaParameters& p = distribution.parameters();
      distribution.scale_sigma(std::exp(0.2 + p.c_sigma / p.d_sigma));
    }
  }

  const CmaSearchSettings& settings_;
  Evaluator& evaluator_;
  CmaBox box_;
  FeasibilityOrder order_;
  RandomStream random_;
  std::size_t base_population_ = 0;
  std::size_t large_population_ = 0;  // of the last restart with a larger one
  std::int64_t large_evaluations_ = 0;
  std::int64_t small_evaluations_ = 0;
  std::int64_t last_large_run_ = 0;
  std::int64_t evaluations_ = 0;
  bool is_first_generation_ = true;
  std::vector<bool> discrete_;  // one per coordinate
  bool has_discrete_ = false;
};

}  // namespace

void search_with_cma(const CmaSearchSettings& settings, Evaluator& evaluator, std::uint64_t seed) {
  CmaSearch(settings, evaluator, seed).search();
}

}  // namespace armwright
