#include "study/statistics/power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "base/random.hpp"
#include "study/statistics/significance.hpp"

namespace armwright {
namespace {

constexpr int kStudies = 5000;
constexpr double kLargestShift = 8;  // A12 = 1 - 6e-16

const boost::math::normal kNormal;

double calc_probability(double z) {
  return cdf(kNormal, z);
}

double calc_shift(double a12) {
  if (!(a12 > 0 && a12 < 1)) {
    throw std::invalid_argument(fmt::format("power: A12 is {}; it must lie between 0 and 1", a12));
  }
  return std::clamp(quantile(kNormal, a12), -kLargestShift, kLargestShift);
}

double calc_level(std::size_t tests) {
  if (tests < 1) {
    throw std::invalid_argument("power: there must be at least one test");
  }
  return kSignificance / static_cast<double>(tests);
}

std::optional<int> find_critical_sum(int pairs, std::size_t tests) {
  const double level = calc_level(tests);
  return pairs < kFewestPairs ? std::nullopt : calc_critical_rank_sum(pairs, level);
}

// Draws the paired differences of kStudies studies, without the shift. They depend only on the
// number of pairs, so that the power never falls if the shift grows.
std::vector<std::vector<double>> draw_studies(int pairs) {
  std::vector<std::vector<double>> studies(kStudies);
  for (std::size_t study = 0; study < studies.size(); ++study) {
    RandomStream random("power", study);
    for (int i = 0; i < pairs; ++i) {
      studies[study].push_back(random.normal());
    }
  }
  return studies;
}

// Returns the sum of the ranks of the negative differences.
int calc_negative_sum(std::vector<double> differences, double shift) {
  for (double& difference : differences) {
    difference += shift;
  }
  std::ranges::sort(differences, {}, [](double difference) { return std::abs(difference); });
  int sum = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    sum += differences[i] < 0 ? static_cast<int>(i) + 1 : 0;
  }
  return sum;
}

double simulate_power(const std::vector<std::vector<double>>& studies, double shift, int critical) {
  const auto found = std::ranges::count_if(studies, [&](const std::vector<double>& study) {
    return calc_negative_sum(study, shift) <= critical;
  });
  return static_cast<double>(found) / static_cast<double>(studies.size());
}

// Returns the probability that the negative rank sum is at most `critical`. The sum counts the
// pairs i <= j with D_i + D_j < 0, D normal with mean `shift`:
//   p1 = P(D < 0),  p2 = P(D + D' < 0),  p3 = P(D + D' < 0 and D + D'' < 0).
double approximate_power(int pairs, double shift, int critical) {
  const double n = pairs;
  const double p1 = calc_probability(-shift);
  const double p2 = calc_probability(-std::sqrt(2.0) * shift);
  // p3 is the mean of Phi(-D - shift)^2 over D = shift + g, by Simpson's rule over g.
  constexpr int kSteps = 400;
  constexpr double kReach = 8;
  double p3 = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double g = kReach * (2.0 * i / kSteps - 1);
    const double weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
    const double both = calc_probability(-g - 2 * shift);
    p3 += weight * pdf(kNormal, g) * both * both;
  }
  p3 *= 2 * kReach / kSteps / 3;
  const double mean = n * p1 + n * (n - 1) / 2 * p2;
  const double variance = n * p1 * (1 - p1) +
                          n * (n - 1) / 2 * (2 * (p1 - p2) * (p1 - p2) + 3 * p2 * (1 - p2)) +
                          n * (n - 1) * (n - 2) * (p3 - p2 * p2);
  if (!(variance > 0)) {
    return mean <= critical ? 1 : 0;
  }
  return calc_probability((critical + 0.5 - mean) / std::sqrt(variance));  // the sum is whole
}

}  // namespace

bool can_be_significant(int pairs, std::size_t tests) {
  return find_critical_sum(pairs, tests).has_value();
}

int find_fewest_pairs(std::size_t tests) {
  int pairs = kFewestPairs;
  while (!can_be_significant(pairs, tests)) {
    ++pairs;
  }
  return pairs;
}

double calc_power(int pairs, double a12, std::size_t tests) {
  const double shift = calc_shift(a12);
  const auto critical = find_critical_sum(pairs, tests);
  if (!critical) {
    return 0;
  }
  return pairs <= kExactPairs ? simulate_power(draw_studies(pairs), shift, *critical)
                              : approximate_power(pairs, shift, *critical);
}

double find_detectable_a12(int pairs, std::size_t tests) {
  const auto critical = find_critical_sum(pairs, tests);
  if (!critical) {
    throw std::invalid_argument("power: no outcome of so few pairs is significant");
  }
  const bool is_simulated = pairs <= kExactPairs;
  const auto studies = is_simulated ? draw_studies(pairs) : std::vector<std::vector<double>>();
  double lower = 0.5;
  double upper = 1;
  while (upper - lower > 0.001) {
    const double a12 = (lower + upper) / 2;
    const double shift = calc_shift(a12);
    const double power = is_simulated ? simulate_power(studies, shift, *critical)
                                      : approximate_power(pairs, shift, *critical);
    (power < kPower ? lower : upper) = a12;
  }
  return upper;
}

int find_needed_pairs(double a12, std::size_t tests) {
  if (!(a12 > 0.5)) {
    throw std::invalid_argument(fmt::format("power: A12 is {}; it must be above 0.5", a12));
  }
  int lower = kFewestPairs - 1;  // too few
  int upper = kFewestPairs;
  while (calc_power(upper, a12, tests) < kPower) {
    lower = upper;
    upper *= 2;
  }
  while (upper - lower > 1) {
    const int middle = lower + (upper - lower) / 2;
    (calc_power(middle, a12, tests) < kPower ? lower : upper) = middle;
  }
  return upper;
}

}  // namespace armwright
