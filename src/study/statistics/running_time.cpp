#include "study/statistics/running_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/random.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();

int count_successes(std::span<const Trial> trials) {
  if (trials.empty()) {
    throw std::invalid_argument("running time: there are no trials");
  }
  int successes = 0;
  for (const Trial& trial : trials) {
    check_range(trial.cost, 0, kLargest, "running time: the cost of a trial");
    successes += trial.reached ? 1 : 0;
  }
  return successes;
}

void check_running_times(std::span<const double> running_times) {
  if (running_times.empty()) {
    throw std::invalid_argument("running time: there are none");
  }
  for (const double time : running_times) {
    check_range(time, 0, kInfinity, "a running time");
  }
}

std::vector<std::size_t> draw_numbers(std::size_t count, RandomStream& random) {
  std::vector<std::size_t> numbers(count);
  for (std::size_t& number : numbers) {
    number = random.below(count);
  }
  return numbers;
}

double calc_expected_of(std::span<const Trial> trials, std::span<const std::size_t> numbers) {
  std::vector<Trial> drawn;
  for (const std::size_t number : numbers) {
    drawn.push_back(trials[number]);
  }
  return calc_expected_running_time(drawn);
}

// Returns nothing for infinite / infinite and 0 / 0.
std::optional<double> divide(double a, double b) {
  if ((std::isinf(a) && std::isinf(b)) || (a == 0 && b == 0)) {
    return std::nullopt;
  }
  return a / b;
}

std::size_t check_costs(std::span<const std::vector<double>> costs) {
  const std::size_t solvers = check_table(costs, "profile");
  for (const std::vector<double>& row : costs) {
    for (const double cost : row) {
      check_range(cost, 0, kInfinity, "profile: a cost");
    }
  }
  return solvers;
}

// Returns the distribution of costs, where each problem has its own unit of cost.
std::vector<std::vector<double>> calc_shares(std::span<const std::vector<double>> costs,
                                             std::span<const double> units,
                                             std::span<const double> abscissae) {
  std::vector<std::vector<double>> shares;
  for (std::size_t solver = 0; solver < costs.front().size(); ++solver) {
    std::vector<double> scaled;
    for (std::size_t problem = 0; problem < costs.size(); ++problem) {
      const double cost = costs[problem][solver];
      const double unit = units[problem];
      if (unit == 0 || cost == kInfinity) {
        scaled.push_back(cost == unit && cost < kInfinity ? 1 : kInfinity);
      } else {
        scaled.push_back(cost / unit);
      }
    }
    shares.push_back(calc_runtime_ecdf(scaled, abscissae));
  }
  return shares;
}

}  // namespace

double calc_cost_to_target(std::span<const TracePoint> trace, double target) {
  if (std::isnan(target)) {
    throw std::invalid_argument("trace: the target is NaN");
  }
  double cost = 0;
  double reached_at = kInfinity;
  for (const TracePoint& point : trace) {
    check_range(point.cost, cost, kLargest, "trace: a cost");
    check_values({&point.best_value, 1}, "trace");
    cost = point.cost;
    if (point.best_value <= target && point.best_value < kInfinity) {
      reached_at = std::min(reached_at, cost);
    }
  }
  return reached_at;
}

double calc_expected_running_time(std::span<const Trial> trials) {
  const int successes = count_successes(trials);
  double cost = 0;
  for (const Trial& trial : trials) {
    cost += trial.cost;
  }
  return successes == 0 ? kInfinity : cost / successes;
}

Interval calc_resampled_running_time_interval(std::span<const Trial> trials, double level,
                                              int resamples, std::string_view stream) {
  count_successes(trials);
  RandomStream random(stream);
  std::vector<double> resampled;
  for (int resample = 0; resample < resamples; ++resample) {
    resampled.push_back(calc_expected_of(trials, draw_numbers(trials.size(), random)));
  }
  return calc_percentile_interval(resampled, level);
}

RunningTimeRatio calc_running_time_ratio(std::span<const Trial> trials,
                                         std::span<const Trial> reference, double level,
                                         int resamples, std::string_view stream) {
  if (trials.size() != reference.size()) {
    throw std::invalid_argument("running time: a ratio needs pairs of trials");
  }
  RunningTimeRatio result{.ratio = {}, .interval = {.lower = 0, .upper = kInfinity}};
  const double of_reference = calc_expected_running_time(reference);
  if (std::isinf(of_reference)) {
    return result;
  }
  result.ratio = divide(calc_expected_running_time(trials), of_reference);
  RandomStream random(stream);
  std::vector<double> least, most;
  for (int resample = 0; resample < resamples; ++resample) {
    const auto numbers = draw_numbers(trials.size(), random);
    const auto ratio =
        divide(calc_expected_of(trials, numbers), calc_expected_of(reference, numbers));
    least.push_back(ratio.value_or(0));
    most.push_back(ratio.value_or(kInfinity));
  }
  result.interval = {.lower = calc_percentile_interval(least, level).lower,
                     .upper = calc_percentile_interval(most, level).upper};
  return result;
}

std::vector<double> calc_runtime_ecdf(std::span<const double> running_times,
                                      std::span<const double> costs) {
  check_running_times(running_times);
  std::vector<double> shares;
  for (const double cost : costs) {
    // A target that was never reached is not reached at any cost, not even at an infinite one.
    const auto reached = std::ranges::count_if(
        running_times, [&](double time) { return time <= cost && time < kInfinity; });
    shares.push_back(static_cast<double>(reached) / static_cast<double>(running_times.size()));
  }
  return shares;
}

double calc_anytime_area(std::span<const double> running_times, double lowest, double highest) {
  check_running_times(running_times);
  if (!(lowest > 0 && lowest < highest && highest < kInfinity)) {
    throw std::invalid_argument("anytime area: costs must be 0 < lowest < highest < infinity");
  }
  double sum = 0;
  for (const double time : running_times) {
    sum += std::log(highest / std::clamp(time, lowest, highest));
  }
  return sum / std::log(highest / lowest) / static_cast<double>(running_times.size());
}

double calc_convergence_target(double start_value, double best_value, double tau) {
  check_values({&start_value, 1}, "convergence: the start's value");
  check_values({&best_value, 1}, "convergence: the best value");
  check_range(tau, 0, 1, "convergence: tau");
  const double best = std::min(start_value, best_value);
  if (start_value == kInfinity) {
    return std::numeric_limits<double>::max();
  }
  return best + tau * (start_value - best);
}

std::vector<std::vector<double>> calc_performance_profiles(
    std::span<const std::vector<double>> costs, std::span<const double> alphas) {
  check_costs(costs);
  std::vector<double> smallest;
  for (const std::vector<double>& row : costs) {
    smallest.push_back(*std::ranges::min_element(row));
  }
  return calc_shares(costs, smallest, alphas);
}

std::vector<std::vector<double>> calc_data_profiles(std::span<const std::vector<double>> costs,
                                                    std::span<const int> dimensions,
                                                    std::span<const double> kappas) {
  check_costs(costs);
  if (dimensions.size() != costs.size()) {
    throw std::invalid_argument("data profile: every problem needs its dimension");
  }
  std::vector<double> units;
  for (const int dimension : dimensions) {
    check_range(dimension, 1, std::numeric_limits<int>::max(), "data profile: a dimension");
    units.push_back(static_cast<double>(dimension) + 1);
  }
  return calc_shares(costs, units, kappas);
}

}  // namespace armwright
