#include "optimizers/cma/cma_box.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

constexpr double kBend = 0.05;

}  // namespace

double calc_share_in_box(double u) {
  constexpr double kLength = 1 + 2 * kBend;
  if (u < -kBend || u > 1 + kBend) {
    double t = std::fmod(u + kBend, 2 * kLength);
    t = t < 0 ? t + 2 * kLength : t;
    u = (t > kLength ? 2 * kLength - t : t) - kBend;
  }
  if (u < kBend) {
    u = (u + kBend) * (u + kBend) / (4 * kBend);
  } else if (u > 1 - kBend) {
    u = 1 - (1 + kBend - u) * (1 + kBend - u) / (4 * kBend);
  }
  return std::clamp(u, 0.0, 1.0);
}

double calc_preimage_of_share(double share) {
  if (share < kBend) {
    return 2 * std::sqrt(kBend * share) - kBend;
  }
  if (share > 1 - kBend) {
    return 1 + kBend - 2 * std::sqrt(kBend * (1 - share));
  }
  return share;
}

std::vector<double> CmaBox::make_start() const {
  std::vector<double> u;
  for (std::size_t i = 0; i < dimension(); ++i) {
    const double width = space_.upper()[i] - space_.lower()[i];
    const double share = width > 0 ? (space_.start()[i] - space_.lower()[i]) / width : 0.5;
    u.push_back(calc_preimage_of_share(std::clamp(share, 0.0, 1.0)));
  }
  return u;
}

std::vector<double> CmaBox::to_point(std::span<const double> u) const {
  std::vector<double> coordinates;
  coordinates.reserve(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double lower = space_.lower()[i];
    const double upper = space_.upper()[i];
    const double share = calc_share_in_box(u[i]);
    // Computed from the nearer bound, so that both bounds are reached exactly.
    const double value =
        share < 0.5 ? lower + share * (upper - lower) : upper - (1 - share) * (upper - lower);
    coordinates.push_back(std::clamp(value, lower, upper));
  }
  return space_.to_point(coordinates);
}

}  // namespace armwright
