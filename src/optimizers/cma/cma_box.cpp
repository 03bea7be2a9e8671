#include "optimizers/cma/cma_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armwright {
namespace {

constexpr double kBend = 0.05;

// Returns the variables with half a step more at both ends of discrete ones.
std::vector<DecisionVariable> widen(std::span<const DecisionVariable> variables) {
  std::vector<DecisionVariable> wider(variables.begin(), variables.end());
  for (DecisionVariable& variable : wider) {
    if (variable.type != VariableType::real) {
      variable.lower -= 0.5;
      variable.upper += 0.5;
    }
  }
  return wider;
}

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

CmaBox::CmaBox(std::span<const DecisionVariable> variables)
    : variables_(variables.begin(), variables.end()), space_(widen(variables)) {}

bool CmaBox::is_discrete(std::size_t coordinate) const {
  return variables_[coordinate].type != VariableType::real;
}

double CmaBox::calc_share(std::size_t coordinate, double value) const {
  const double lower = space_.lower()[coordinate];
  const double width = space_.upper()[coordinate] - lower;
  return width > 0 ? (value - lower) / width : 0.5;
}

double CmaBox::to_coordinate(std::size_t coordinate, double share) const {
  return is_discrete(coordinate) ? share : calc_preimage_of_share(share);
}

std::vector<double> CmaBox::make_start() const {
  std::vector<double> shares;
  for (std::size_t i = 0; i < dimension(); ++i) {
    shares.push_back(calc_share(i, space_.start()[i]));
  }
  return to_coordinates(shares);
}

std::vector<double> CmaBox::calc_shares(std::span<const double> point) const {
  std::vector<double> shares = space_.to_coordinates(point);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i] = calc_share(i, shares[i]);
  }
  return shares;
}

std::vector<double> CmaBox::to_coordinates(std::span<const double> shares) const {
  std::vector<double> u;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    u.push_back(to_coordinate(i, std::clamp(shares[i], 0.0, 1.0)));
  }
  return u;
}

std::vector<double> CmaBox::to_point(std::span<const double> u) const {
  std::vector<double> coordinates;
  coordinates.reserve(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double lower = space_.lower()[i];
    const double upper = space_.upper()[i];
    const double share = is_discrete(i) ? std::clamp(u[i], 0.0, 1.0) : calc_share_in_box(u[i]);
    // Computed from the nearer bound, so that both bounds are reached exactly.
    const double value =
        share < 0.5 ? lower + share * (upper - lower) : upper - (1 - share) * (upper - lower);
    coordinates.push_back(std::clamp(value, lower, upper));
  }
  std::vector<double> point = space_.to_point(coordinates);
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (is_discrete(i)) {
      point[i] = settle_value(variables_[i], point[i]);
    }
  }
  return point;
}

std::vector<CmaCell> CmaBox::calc_cells(std::span<const double> u) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<double> point = to_point(u);
  std::vector<double> below = point;
  std::vector<double> above = point;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (is_discrete(i)) {
      below[i] -= 0.5;
      above[i] += 0.5;
    }
  }
  below = space_.to_coordinates(below);
  above = space_.to_coordinates(above);
  std::vector<CmaCell> cells;
  for (std::size_t i = 0; i < point.size(); ++i) {
    // A negative logarithmic variable has its larger values at smaller u.
    const double direction = below[i] <= above[i] ? 1 : -1;
    const double at_lower =
        point[i] > variables_[i].lower ? calc_share(i, below[i]) : -direction * kInfinity;
    const double at_upper =
        point[i] < variables_[i].upper ? calc_share(i, above[i]) : direction * kInfinity;
    cells.push_back({.lower = std::min(at_lower, at_upper), .upper = std::max(at_lower, at_upper)});
  }
  return cells;
}

}  // namespace armwright
