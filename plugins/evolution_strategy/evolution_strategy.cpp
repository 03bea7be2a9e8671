// A (mu/mu, lambda) evolution strategy with cumulative step-size adaptation (Ostermeier, Gawelczyk
// and Hansen 1994, Step-size adaptation based on non-local use of selection information):
//
//   x_k   = m + sigma w z_k,  z_k normal, k = 1..lambda, w the widths of the box
//   <z>   = mean of the mu best z_k,   m <- m + sigma w <z>
//   s     <- (1 - c) s + sqrt(mu c (2 - c)) <z>,   c = 1 / sqrt(n)
//   sigma <- sigma exp((|s|^2 - n) / (2 D n)),     D = sqrt(n)
//
// The equations hold in coordinates: a linear variable is its own coordinate, and the coordinate of
// a logarithmic variable is the logarithm of its magnitude. The rule for sigma in |s|^2 is by
// Arnold and Beyer (2004); it needs no table of chi. Points outside the box are moved onto its
// edge. m stays inside the box.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "armwright/plugin.hpp"

namespace {

namespace plugin = armwright::plugin;

// A random generator: SplitMix64 (Steele, Lea and Flood 2014) and the transform of Box and Muller.
// It gives the same numbers with every compiler. std::normal_distribution does not promise that.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform() { return (static_cast<double>(next() >> 11) + 0.5) * 0x1p-53; }
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

// The bounds and the start in coordinates.
struct Box {
  explicit Box(const plugin::Problem& problem) : problem_(problem) {
    for (const plugin::Variable& v : problem.variables) {
      const auto [low, high] = std::minmax({to_coordinate(v, v.lower), to_coordinate(v, v.upper)});
      lower.push_back(low);
      upper.push_back(high);
      start.push_back(to_coordinate(v, v.start));
    }
  }
  static double to_coordinate(const plugin::Variable& v, double x) {
    return v.is_logarithmic ? std::log(std::abs(x)) : x;
  }
  std::vector<double> to_point(const std::vector<double>& coordinates) const {
    std::vector<double> x = coordinates;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const plugin::Variable& v = problem_.variables[i];
      x[i] = v.is_logarithmic ? std::copysign(std::exp(x[i]), v.lower) : x[i];
    }
    return problem_.clip(x);
  }

  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<double> start;

 private:
  const plugin::Problem& problem_;
};

class EvolutionStrategy {
 public:
  static plugin::Description describe() {
    return {
        .name = "evolution-strategy",
        .summary = "(mu/mu, lambda) evolution strategy with cumulative step-size adaptation",
        .source =
            "Ostermeier, Gawelczyk and Hansen 1994, Step-size adaptation based on "
            "non-local use of selection information",
        .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_BATCH | ARMWRIGHT_STOCHASTIC |
                        ARMWRIGHT_NOISY | ARMWRIGHT_GENERATIONS,
        .options = {
            plugin::integer("lambda", "offspring a generation", 16, 4, 100000),
            plugin::integer("mu", "how many of them are parents", 4, 1, 50000),
            plugin::number("sigma", "first step, as a share of the box", 0.05, 1e-12, 10),
            plugin::number("violation_weight",
                           "of violated constraints, added to the first objective", 1e6, 0, 1e15)}};
  }

  void minimize(plugin::Evaluator& evaluator, const plugin::Options& options, std::uint64_t seed) {
    const auto lambda = static_cast<std::size_t>(options.get_integer("lambda"));
    const auto mu = static_cast<std::size_t>(options.get_integer("mu"));
    if (mu > lambda) {
      throw std::invalid_argument("option mu must not be above lambda");
    }
    const double weight = options.get_number("violation_weight");
    double sigma = options.get_number("sigma");
    const Box box(evaluator.problem());
    const std::size_t n = box.start.size();
    const double root_n = std::sqrt(static_cast<double>(n));
    const double c = 1 / root_n;
    Random random(seed);
    std::vector<double> mean = box.start;
    std::vector<double> path(n);
    bool is_first = true;
    while (!evaluator.stopped()) {
      std::vector<std::vector<double>> steps(lambda, std::vector<double>(n));
      std::vector<std::vector<double>> points;
      for (std::vector<double>& z : steps) {
        std::vector<double> coordinates = mean;
        for (std::size_t i = 0; i < n; ++i) {
          z[i] = is_first ? 0 : random.normal();  // the first point is the start itself
          coordinates[i] = move(box, mean, i, sigma, z[i]);
        }
        is_first = false;
        points.push_back(box.to_point(coordinates));
      }
      evaluator.begin_generation();
      const std::vector<plugin::Score> scores = evaluator.evaluate(points);
      if (scores.size() < lambda) {
        break;
      }
      const std::vector<double> z =
          calc_mean_of_best(evaluator.problem(), steps, scores, mu, weight);
      double square = 0;
      for (std::size_t i = 0; i < n; ++i) {
        mean[i] = move(box, mean, i, sigma, z[i]);
        path[i] = (1 - c) * path[i] + std::sqrt(static_cast<double>(mu) * c * (2 - c)) * z[i];
        square += path[i] * path[i];
      }
      const double dimension = static_cast<double>(n);
      sigma = std::clamp(sigma * std::exp((square - dimension) / (2 * root_n * dimension)), 1e-15,
                         10.0);
    }
    evaluator.recommend(box.to_point(mean));
  }

 private:
  static double move(const Box& box, const std::vector<double>& from, std::size_t i, double sigma,
                     double z) {
    return std::clamp(from[i] + sigma * (box.upper[i] - box.lower[i]) * z, box.lower[i],
                      box.upper[i]);
  }

  static std::vector<double> calc_mean_of_best(const plugin::Problem& problem,
                                               const std::vector<std::vector<double>>& steps,
                                               const std::vector<plugin::Score>& scores,
                                               std::size_t mu, double weight) {
    std::vector<double> merits;
    for (const plugin::Score& score : scores) {
      merits.push_back(problem.calc_scalar(score.objectives));
      for (const double g : score.constraint_values) {
        merits.back() += weight * std::max(0.0, g);
      }
    }
    std::vector<std::size_t> order(steps.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return merits[k]; });
    std::vector<double> mean(steps.front().size());
    for (std::size_t rank = 0; rank < mu; ++rank) {
      for (std::size_t i = 0; i < mean.size(); ++i) {
        mean[i] += steps[order[rank]][i] / static_cast<double>(mu);
      }
    }
    return mean;
  }
};

}  // namespace

ARMWRIGHT_PLUGIN(EvolutionStrategy)
