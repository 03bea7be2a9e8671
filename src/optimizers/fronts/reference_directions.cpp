#include "optimizers/fronts/reference_directions.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/decompositions.hpp"

namespace armwright {
namespace {

void add_directions(std::vector<double>& begun, std::size_t objectives, std::int64_t left,
                    std::int64_t divisions, std::vector<std::vector<double>>& directions) {
  if (begun.size() + 1 == objectives) {
    begun.push_back(static_cast<double>(left) / static_cast<double>(divisions));
    directions.push_back(begun);
    begun.pop_back();
    return;
  }
  for (std::int64_t part = 0; part <= left; ++part) {
    begun.push_back(static_cast<double>(part) / static_cast<double>(divisions));
    add_directions(begun, objectives, left - part, divisions, directions);
    begun.pop_back();
  }
}

// Returns the achievement of a point along the axis `axis`: small if the point lies near that axis
// (the source's equation 4).
double calc_achievement(std::span<const double> objectives, std::span<const double> ideal,
                        std::size_t axis) {
  constexpr double kOffAxis = 1e-6;  // the source's weight of the other axes
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < objectives.size(); ++m) {
    largest = std::max(largest, (objectives[m] - ideal[m]) / (m == axis ? 1 : kOffAxis));
  }
  return largest;
}

}  // namespace

std::int64_t count_directions(std::size_t objectives, std::int64_t divisions, std::int64_t most) {
  std::int64_t count = 1;  // C(i + divisions, i) for i = 0
  for (std::int64_t i = 1; i < static_cast<std::int64_t>(objectives); ++i) {
    count = count * (divisions + i) / i;
    if (count > most) {
      return most + 1;
    }
  }
  return count;
}

std::vector<std::vector<double>> make_directions(std::size_t objectives, std::int64_t divisions) {
  assert(objectives > 0 && divisions > 0);
  std::vector<std::vector<double>> directions;
  std::vector<double> begun;
  add_directions(begun, objectives, divisions, divisions, directions);
  return directions;
}

void FrontScale::reset() {
  ideal_.clear();
  extremes_.clear();
  ranges_.clear();
}

void FrontScale::update(std::span<const std::vector<double>> objectives, std::size_t first_front) {
  assert(!objectives.empty() && first_front > 0);
  const std::size_t n = objectives.front().size();
  ideal_.resize(n, std::numeric_limits<double>::infinity());
  for (const std::vector<double>& one : objectives) {
    for (std::size_t m = 0; m < n; ++m) {
      ideal_[m] = std::min(ideal_[m], one[m]);
    }
  }
  if (extremes_.empty()) {
    extremes_.assign(n, objectives.front());
  }
  for (std::size_t m = 0; m < n; ++m) {
    for (const std::vector<double>& one : objectives.first(first_front)) {
      if (calc_achievement(one, ideal_, m) < calc_achievement(extremes_[m], ideal_, m)) {
        extremes_[m] = one;
      }
    }
  }
  std::vector<double> worst = objectives.front();
  for (const std::vector<double>& one : objectives.first(first_front)) {
    for (std::size_t m = 0; m < n; ++m) {
      worst[m] = std::max(worst[m], one[m]);
    }
  }
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd rows(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index m = 0; m < size; ++m) {
      const auto axis = static_cast<std::size_t>(m);
      rows(i, m) = extremes_[static_cast<std::size_t>(i)][axis] - ideal_[axis];
    }
  }
  // Not finite if the extreme points span no plane.
  const Eigen::VectorXd inverses = rows.partialPivLu().solve(Eigen::VectorXd::Ones(size));
  // A plane that meets an axis below the ideal point or far above the front says nothing about the
  // front's range. The front itself then gives the ranges.
  constexpr double kFar = 10;
  ranges_.resize(n);
  bool is_sound = true;
  for (std::size_t m = 0; m < n; ++m) {
    const double seen = worst[m] - ideal_[m];
    ranges_[m] = is_sound ? 1 / inverses[static_cast<Eigen::Index>(m)] : 0;
    is_sound = is_sound && std::isfinite(ranges_[m]) && ranges_[m] > 0 && ranges_[m] <= kFar * seen;
  }
  for (std::size_t m = 0; m < n; ++m) {
    const double seen = worst[m] - ideal_[m];
    if (!is_sound) {
      ranges_[m] = std::isfinite(seen) && seen > 0 ? seen : 1;
    }
  }
}

std::vector<double> FrontScale::normalise(std::span<const double> objectives) const {
  std::vector<double> normalised;
  for (std::size_t m = 0; m < objectives.size(); ++m) {
    normalised.push_back((objectives[m] - ideal_[m]) / ranges_[m]);
  }
  return normalised;
}

NearestDirection find_nearest_direction(std::span<const double> normalised,
                                        std::span<const std::vector<double>> directions) {
  NearestDirection nearest{.distance = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < directions.size(); ++i) {
    double length = 0;
    double product = 0;
    for (std::size_t m = 0; m < normalised.size(); ++m) {
      length += directions[i][m] * directions[i][m];
      product += directions[i][m] * normalised[m];
    }
    const double along = product / length;
    double square = 0;
    for (std::size_t m = 0; m < normalised.size(); ++m) {
      const double off = normalised[m] - along * directions[i][m];
      square += off * off;
    }
    if (const double distance = std::sqrt(square); distance < nearest.distance) {
      nearest = {.direction = i, .distance = distance};
    }
  }
  return nearest;
}

}  // namespace armwright
