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
#include "optimizers/cma/cma_surrogate.hpp"
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
    if (settings_.surrogate) {
      surrogate_.emplace(box_.dimension(), base);
    }
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
    if (settings_.surrogate && !is_first_generation_) {
      surrogate_.emplace(box_.dimension(), plan.population);
    }
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
      if (surrogate_ && surrogate_->is_fitted()) {
        // About as long as the steps of the samples.
        const double length = std::sqrt(static_cast<double>(box_.dimension()));
        distribution.inject(box_.to_coordinates(surrogate_->find_minimum(length)), length);
      }
      const std::optional<std::vector<double>> values =
          surrogate_ ? evaluate_some(points, distribution) : evaluate(points);
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

  // Returns nothing if the evaluator stopped before the last point. The points whose values are not
  // those of the objective, because they failed or lost a race, get a true in `failed`; the others
  // become points of the surrogate.
  std::optional<std::vector<double>> evaluate(const std::vector<std::vector<double>>& points,
                                              std::vector<bool>* failed = nullptr) {
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
    for (std::size_t i = 0; i < scores.size(); ++i) {
      values.push_back(calc_merit(evaluator_.problem(), scores[i], settings_.constraint_weight));
      const bool has_failed = scores[i].status != EvaluationStatus::ok;
      if (failed != nullptr) {
        failed->push_back(has_failed);
      }
      if (surrogate_ && !has_failed) {
        surrogate_->add(box_.calc_shares(asked[i]), values.back());
      }
    }
    return values;
  }

  // Evaluates as many points as it takes until the surrogate orders the last points as the
  // objective does, those first that it expects to be the best. Returns one value per point; the
  // points that were not evaluated have values of the surrogate. Returns nothing if the evaluator
  // stopped before. Source: Hansen 2019, algorithm 1.
  std::optional<std::vector<double>> evaluate_some(const std::vector<std::vector<double>>& points,
                                                   const CmaDistribution& distribution) {
    constexpr double kAgreement = 0.85;
    constexpr double kLeastShare = 0.02;     // of the points, evaluated in any case
    constexpr std::size_t kLeastPoints = 4;  // of the model
    CmaSurrogate& model = *surrogate_;
    std::vector<std::vector<double>> shares;
    for (const std::vector<double>& point : points) {
      shares.push_back(box_.calc_shares(box_.to_point(point)));
    }
    struct Evaluated {
      std::size_t place = 0;
      double value = 0;
      bool failed = false;
    };
    std::vector<Evaluated> evaluated;
    std::vector<std::size_t> rest(points.size());
    std::iota(rest.begin(), rest.end(), std::size_t{0});
    const std::size_t missing = kLeastPoints - std::min(kLeastPoints, model.size());
    std::size_t wanted =
        1 + std::max(missing,
                     static_cast<std::size_t>(kLeastShare * static_cast<double>(points.size())));
    std::vector<double> guesses(points.size());
    while (true) {
      if (model.is_fitted()) {
        for (const std::size_t i : rest) {
          guesses[i] = model.calc_value(shares[i]);
        }
        std::ranges::stable_sort(rest, {}, [&](std::size_t i) { return guesses[i]; });
      }
      const std::size_t count =
          std::min(rest.size(), round_up(wanted) - std::min(round_up(wanted), evaluated.size()));
      std::vector<std::vector<double>> batch;
      for (std::size_t i = 0; i < count; ++i) {
        batch.push_back(points[rest[i]]);
      }
      std::vector<bool> failed;
      const std::optional<std::vector<double>> values = evaluate(batch, &failed);
      if (!values) {
        return std::nullopt;
      }
      for (std::size_t i = 0; i < count; ++i) {
        evaluated.push_back({.place = rest[i], .value = (*values)[i], .failed = failed[i]});
      }
      rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(count));
      if (model.size() > 0) {
        model.fit(distribution);
      }
      const bool has_value = !std::ranges::all_of(evaluated, &Evaluated::failed);
      if (rest.empty() || (has_value && model.is_fitted() &&
                           model.calc_agreement(evaluated.size()) >= kAgreement)) {
        break;
      }
      wanted = evaluated.size() + (evaluated.size() + 1) / 2;
    }
    // Both kinds of values agree at the best point that was evaluated.
    std::vector<double> all(points.size());
    const Evaluated* best = nullptr;
    for (const Evaluated& one : evaluated) {
      all[one.place] = one.value;
      if (!one.failed && (best == nullptr || one.value < best->value)) {
        best = &one;
      }
    }
    for (const std::size_t i : rest) {
      all[i] = best->value + (model.calc_value(shares[i]) - model.calc_value(shares[best->place]));
    }
    return all;
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
  std::optional<CmaSurrogate> surrogate_;  // of this run, if asked for
  std::vector<bool> discrete_;             // one per coordinate
  bool has_discrete_ = false;
};

}  // namespace

void search_with_cma(const CmaSearchSettings& settings, Evaluator& evaluator, std::uint64_t seed) {
  CmaSearch(settings, evaluator, seed).search();
}

}  // namespace armwright
