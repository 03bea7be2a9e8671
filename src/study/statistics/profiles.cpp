#include "study/statistics/profiles.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "study/statistics/running_time.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

std::size_t check_costs(std::span<const std::vector<double>> costs) {
  const std::size_t solvers = check_table(costs, "profile");
  for (const std::vector<double>& row : costs) {
    for (const double cost : row) {
      check_range(cost, 0, kInfinity, "profile: a cost");
    }
  }
  return solvers;
}

// A profile is the distribution of costs in units of the problem's own.
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
