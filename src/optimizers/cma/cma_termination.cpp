#include "optimizers/cma/cma_termination.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace armwright {
namespace {

double calc_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// True if the median of the last 30 % is no better than the median of the first 30 %.
bool is_without_progress(std::span<const double> history) {
  const std::size_t share = history.size() * 3 / 10;
  const auto early = history.first(share);
  const auto late = history.last(share);
  return calc_median({late.begin(), late.end()}) >= calc_median({early.begin(), early.end()});
}

}  // namespace

const char* describe(CmaEnd end) {
  switch (end) {
    case CmaEnd::none:
      return "";
    case CmaEnd::tol_hist_fun:
      return "the best values of the last generations differ by less than tol_fun";
    case CmaEnd::equal_values:
      return "the values of many generations are equal";
    case CmaEnd::tol_x:
      return "its steps are smaller than tol_x";
    case CmaEnd::tol_x_up:
      return "its steps have grown without limit";
    case CmaEnd::condition_cov:
      return "its covariance matrix is too ill-conditioned";
    case CmaEnd::no_effect_axis:
      return "a step along an axis changes no number";
    case CmaEnd::no_effect_coord:
      return "a step along a coordinate changes no number";
    case CmaEnd::stagnation:
      return "its values have stopped improving";
    case CmaEnd::generations:
      return "it has reached its largest number of generations";
  }
  return "";
}

CmaTermination::CmaTermination(const CmaParameters& parameters, const CmaTolerances& tolerances,
                               double sigma, std::vector<bool> discrete)
    : tolerances_(tolerances), initial_sigma_(sigma), discrete_(std::move(discrete)) {
  discrete_.resize(parameters.dimension);
  const auto n = static_cast<double>(parameters.dimension);
  const auto population = static_cast<double>(parameters.population);
  short_history_ = static_cast<std::size_t>(10 + std::ceil(30 * n / population));
  long_history_ = static_cast<std::size_t>(std::ceil(120 + 30 * n / population));
  generation_limit_ =
      static_cast<std::int64_t>(100 + 150 * (n + 3) * (n + 3) / std::sqrt(population));
}

CmaEnd CmaTermination::check(const CmaDistribution& distribution,
                             std::span<const double> sorted_values) {
  best_.push_back(sorted_values.front());
  median_.push_back(sorted_values[sorted_values.size() / 2]);
  const CmaEnd end = check_values(sorted_values);
  if (end != CmaEnd::none) {
    return end;
  }
  if (distribution.generation() >= generation_limit_) {
    return CmaEnd::generations;
  }
  return check_distribution(distribution);
}

CmaEnd CmaTermination::check_values(std::span<const double> sorted_values) const {
  if (best_.size() >= short_history_) {
    const auto [least, most] = std::ranges::minmax(std::span(best_).last(short_history_));
    if (most - least == 0) {
      return CmaEnd::equal_values;
    }
    if (std::max(most, sorted_values.back()) - std::min(least, sorted_values.front()) <
        tolerances_.function) {
      return CmaEnd::tol_hist_fun;
    }
  }
  return is_stagnating() ? CmaEnd::stagnation : CmaEnd::none;
}

bool CmaTermination::is_stagnating() const {
  constexpr std::size_t kLongest = 20000;
  const std::size_t length =
      std::clamp(best_.size() / 5, long_history_, std::max(long_history_, kLongest));
  return best_.size() >= length && is_without_progress(std::span(best_).last(length)) &&
         is_without_progress(std::span(median_).last(length));
}

CmaEnd CmaTermination::check_distribution(const CmaDistribution& distribution) const {
  const std::size_t n = distribution.parameters().dimension;
  const std::span<const double> mean = distribution.mean();
  const std::span<const double> path = distribution.covariance_path();
  const double smallest_step = tolerances_.step * initial_sigma_;
  bool is_small = std::ranges::find(discrete_, false) != discrete_.end();
  for (std::size_t i = 0; i < n; ++i) {
    if (discrete_[i]) {
      continue;
    }
    const double deviation = distribution.calc_standard_deviation(i);
    if (mean[i] == mean[i] + 0.2 * deviation) {
      return CmaEnd::no_effect_coord;
    }
    is_small = is_small && deviation < smallest_step &&
               distribution.sigma() * std::abs(path[i]) < smallest_step;
  }
  if (is_small) {
    return CmaEnd::tol_x;
  }
  if (distribution.longest_axis() > 1e4 * initial_sigma_) {
    return CmaEnd::tol_x_up;
  }
  if (distribution.longest_axis() > 1e7 * distribution.shortest_axis()) {
    return CmaEnd::condition_cov;
  }
  const std::vector<double> axis =
      distribution.calc_axis(static_cast<std::size_t>(distribution.generation()) % n);
  for (std::size_t i = 0; i < n; ++i) {
    if (mean[i] != mean[i] + 0.1 * axis[i]) {
      return CmaEnd::none;
    }
  }
  return CmaEnd::no_effect_axis;
}

}  // namespace armwright
