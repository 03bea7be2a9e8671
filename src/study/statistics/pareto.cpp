#include "study/statistics/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "study/statistics/values.hpp"

namespace armwright {
namespace {

using Point = std::vector<double>;

bool dominates(const Point& a, const Point& b) {
  return a != b && std::ranges::equal(a, b, std::less_equal<>{});
}

// Only the first `objectives` objectives count; all points are smaller than the reference in these.
double calc_volume(std::vector<const Point*> points, std::span<const double> reference,
                   std::size_t objectives) {
  const std::size_t last = objectives - 1;
  std::ranges::sort(points, {}, [&](const Point* p) { return (*p)[last]; });
  double volume = 0;
  if (objectives == 1) {
    return points.empty() ? 0 : reference[0] - points.front()->front();
  }
  if (objectives == 2) {
    double lowest = reference[0];
    for (const Point* point : points) {
      if ((*point)[0] < lowest) {
        volume += (reference[1] - (*point)[1]) * (lowest - (*point)[0]);
        lowest = (*point)[0];
      }
    }
    return volume;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double end = i + 1 < points.size() ? (*points[i + 1])[last] : reference[last];
    const double depth = end - (*points[i])[last];
    if (depth > 0) {
      volume +=
          depth * calc_volume({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(i) + 1},
                              reference, last);
    }
  }
  return volume;
}

struct FrontPoint {
  double first = 0;
  double second = 0;
  std::size_t front = 0;
};

std::vector<FrontPoint> collect_points(std::span<const std::vector<Point>> fronts) {
  std::vector<FrontPoint> points;
  for (std::size_t front = 0; front < fronts.size(); ++front) {
    for (const Point& point : fronts[front]) {
      check_values(point, "attainment");
      if (point.size() != 2) {
        throw std::invalid_argument("attainment: points must have two objectives");
      }
      if (std::isfinite(point[0]) && std::isfinite(point[1])) {
        points.push_back({point[0], point[1], front});
      }
    }
  }
  std::ranges::sort(points, {}, &FrontPoint::first);
  return points;
}

// Returns the smallest number that is at least the share `level` of `all`.
std::size_t count_needed(std::size_t all, double level) {
  std::size_t needed = 1;
  while (static_cast<double>(needed) / static_cast<double>(all) < level) {
    ++needed;
  }
  return needed;
}

}  // namespace

std::vector<std::size_t> find_non_dominated(std::span<const std::vector<double>> points) {
  if (!points.empty()) {
    check_table(points, "front");
  }
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::ranges::none_of(points, [&](const Point& p) { return dominates(p, points[i]); })) {
      front.push_back(i);
    }
  }
  return front;
}

double calc_hypervolume(std::span<const std::vector<double>> points,
                        std::span<const double> reference) {
  if (reference.empty() ||
      !std::ranges::all_of(reference, [](double r) { return std::isfinite(r); })) {
    throw std::invalid_argument("hypervolume: the reference point must be finite");
  }
  if (!points.empty() && check_table(points, "hypervolume") != reference.size()) {
    throw std::invalid_argument("hypervolume: the reference point has another dimension");
  }
  std::vector<const Point*> inside;
  for (const Point& point : points) {
    if (std::ranges::equal(point, reference, std::less<>{})) {
      inside.push_back(&point);
    }
  }
  return calc_volume(std::move(inside), reference, reference.size());
}

double calc_igd_plus(std::span<const std::vector<double>> points,
                     std::span<const std::vector<double>> reference,
                     std::span<const double> extent) {
  const auto is_finite = [](const Point& point) {
    return std::ranges::all_of(point, [](double value) { return std::isfinite(value); });
  };
  if (reference.empty() || !std::ranges::all_of(reference, is_finite)) {
    throw std::invalid_argument("IGD+: the reference front must be finite and not empty");
  }
  if (check_table(reference, "IGD+") != extent.size() ||
      (!points.empty() && check_table(points, "IGD+") != extent.size())) {
    throw std::invalid_argument("IGD+: the points have different dimensions");
  }
  if (!std::ranges::all_of(extent, [](double one) { return std::isfinite(one) && one > 0; })) {
    throw std::invalid_argument("IGD+: the extent must be positive");
  }
  double sum = 0;
  for (const Point& z : reference) {
    double least = kInfinity;
    for (const Point& point : points) {
      double square = is_finite(point) ? 0 : kInfinity;
      for (std::size_t k = 0; k < extent.size(); ++k) {
        const double worse = std::max(0.0, (point[k] - z[k]) / extent[k]);
        square += worse * worse;
      }
      least = std::min(least, square);
    }
    sum += std::sqrt(least);
  }
  return sum / static_cast<double>(reference.size());
}

std::vector<std::vector<double>> calc_attainment_surface(
    std::span<const std::vector<std::vector<double>>> fronts, double level) {
  if (!(level > 0 && level <= 1)) {
    throw std::invalid_argument("attainment: the level must lie above 0 and up to 1");
  }
  const std::vector<FrontPoint> points = collect_points(fronts);
  const std::size_t needed = count_needed(fronts.size(), level);
  std::vector<std::vector<double>> corners;
  // The best second objective of each run so far, while the first objective grows. The `needed`
  // best runs attain the surface.
  std::vector<double> best(fronts.size(), kInfinity);
  double lowest = kInfinity;
  for (std::size_t i = 0; i < points.size(); ++i) {
    best[points[i].front] = std::min(best[points[i].front], points[i].second);
    if (i + 1 < points.size() && points[i + 1].first == points[i].first) {
      continue;
    }
    std::vector<double> sorted = best;
    std::ranges::sort(sorted);
    if (sorted[needed - 1] < lowest) {
      lowest = sorted[needed - 1];
      corners.push_back({points[i].first, lowest});
    }
  }
  return corners;
}

}  // namespace armwright
