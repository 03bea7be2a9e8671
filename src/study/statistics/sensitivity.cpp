#include "study/statistics/sensitivity.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

constexpr int kBootstraps = 500;
constexpr double kLevel = 0.95;
constexpr std::size_t kFewestPoints = 8;
constexpr std::size_t kFewestRows = 4;

// Which variables a term contains; `second` is `first` for the terms of one variable.
struct Term {
  std::size_t first = 0;
  std::size_t second = 0;
};

// The columns of the terms, with mean 0, and what they stand for.
struct Terms {
  std::vector<Term> names;
  Eigen::MatrixXd columns;
};

void check_number(double value, const char* what) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::string(what) + " must be finite");
  }
}

Terms make_terms(const Eigen::MatrixXd& x, ModelTerms kind) {
  // A discrete variable of two values has no square of its own.
  constexpr double kLeastVariance = 1e-8;
  std::vector<std::size_t> varying;
  Eigen::MatrixXd z(x.rows(), x.cols());
  std::vector<Eigen::VectorXd> columns;
  Terms terms;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::VectorXd centered = (x.col(i).array() - x.col(i).mean()).matrix();
    const double deviation = std::sqrt(centered.squaredNorm() / static_cast<double>(x.rows()));
    if (deviation > 1e-12 * (std::abs(x.col(i).mean()) + deviation)) {
      z.col(i) = centered / deviation;
      varying.push_back(static_cast<std::size_t>(i));
      columns.emplace_back(z.col(i));
      terms.names.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(i)});
    }
  }
  if (kind != ModelTerms::linear) {
    for (const std::size_t i : varying) {
      const auto zi = z.col(static_cast<Eigen::Index>(i)).array();
      const Eigen::ArrayXd square = zi.square() - zi.cube().mean() * zi - 1;
      const double variance = square.square().mean();
      if (variance > kLeastVariance) {
        columns.emplace_back((square / std::sqrt(variance)).matrix());
        terms.names.push_back({i, i});
      }
    }
  }
  if (kind == ModelTerms::products) {
    for (std::size_t a = 0; a < varying.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        columns.emplace_back(z.col(static_cast<Eigen::Index>(varying[a]))
                                 .cwiseProduct(z.col(static_cast<Eigen::Index>(varying[b]))));
        terms.names.push_back({varying[b], varying[a]});
      }
    }
  }
  terms.columns.resize(x.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    terms.columns.col(static_cast<Eigen::Index>(i)) =
        (columns[i].array() - columns[i].mean()).matrix();
  }
  return terms;
}

struct Fit {
  ModelTerms kind = ModelTerms::linear;
  Terms terms = {};
  Eigen::MatrixXd solution = {};  // coefficients = solution * values
  Eigen::VectorXd coefficients = {};
  Eigen::VectorXd fitted = {};    // without the mean
  Eigen::VectorXd left_out = {};  // error at each point of the model without it
  double error = kInfinity;       // sum of the squares of left_out
};

// Returns the ridge regression with the least leave-one-out error. `y` has the mean 0.
Fit fit_ridge(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, ModelTerms kind) {
  Fit best{.kind = kind, .terms = make_terms(x, kind)};
  const Eigen::MatrixXd& a = best.terms.columns;
  const auto m = static_cast<double>(a.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(a.transpose() * a));
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(0.0);
  const Eigen::MatrixXd scores = a * solver.eigenvectors();
  const Eigen::VectorXd projected = scores.transpose() * y;
  double best_penalty = 0;
  for (int power = -16; power <= 2; ++power) {
    const double penalty = m * std::pow(10.0, 0.5 * power);
    const Eigen::ArrayXd inverse = (values.array() + penalty).inverse();
    const Eigen::VectorXd fitted = scores * (inverse * projected.array()).matrix();
    const Eigen::VectorXd leverage =
        (scores.cwiseAbs2() * inverse.matrix()).array().min(1 - 1 / m - 1e-9).matrix();
    const Eigen::VectorXd left_out =
        ((y - fitted).array() / (1 - 1 / m - leverage.array())).matrix();
    if (left_out.squaredNorm() < best.error) {
      best.error = left_out.squaredNorm();
      best.fitted = fitted;
      best.left_out = left_out;
      best_penalty = penalty;
    }
  }
  if (std::isfinite(best.error)) {
    best.solution = solver.eigenvectors() *
                    (values.array() + best_penalty).inverse().matrix().asDiagonal() *
                    scores.transpose();
    best.coefficients = best.solution * y;
  }
  return best;
}

// Sums of variance: of each variable alone, with others, and of all terms.
struct Shares {
  std::vector<double> first;
  std::vector<double> total;
};

// Returns the shares for squared coefficients, of which `noise` is not the function's.
Shares calc_shares(const std::vector<Term>& names, const Eigen::VectorXd& coefficients,
                   const Eigen::VectorXd& noise, std::size_t variables) {
  Shares shares{std::vector<double>(variables), std::vector<double>(variables)};
  double sum = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto place = static_cast<Eigen::Index>(k);
    const double part = coefficients(place) * coefficients(place) - noise(place);
    sum += part;
    shares.total[names[k].first] += part;
    if (names[k].first == names[k].second) {
      shares.first[names[k].first] += part;
    } else {
      shares.total[names[k].second] += part;
    }
  }
  for (std::vector<double>* list : {&shares.first, &shares.total}) {
    for (double& share : *list) {
      share = sum > 0 ? std::clamp(share / sum, 0.0, 1.0) : 0;
    }
  }
  return shares;
}

// Adds the intervals of resampled shares.
std::vector<SobolIndices> make_indices(const Shares& shares, std::span<const Shares> resampled) {
  std::vector<SobolIndices> indices(shares.first.size());
  std::vector<double> values(resampled.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i].first = shares.first[i];
    indices[i].total = shares.total[i];
    std::ranges::transform(resampled, values.begin(), [&](const Shares& s) { return s.first[i]; });
    indices[i].first_interval = calc_percentile_interval(values, kLevel);
    std::ranges::transform(resampled, values.begin(), [&](const Shares& s) { return s.total[i]; });
    indices[i].total_interval = calc_percentile_interval(values, kLevel);
  }
  return indices;
}

}  // namespace

std::optional<ModelSensitivity> calc_model_sensitivity(std::span<const std::vector<double>> points,
                                                       std::span<const double> values,
                                                       std::string_view stream) {
  if (points.size() != values.size()) {
    throw std::invalid_argument("points and values must have the same length");
  }
  const std::size_t variables = points.empty() ? 0 : points.front().size();
  if (points.size() < std::max(kFewestPoints, 2 * (variables + 1))) {
    return std::nullopt;
  }
  Eigen::MatrixXd x(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(variables));
  Eigen::VectorXd y(x.rows());
  for (Eigen::Index row = 0; row < x.rows(); ++row) {
    const std::vector<double>& point = points[static_cast<std::size_t>(row)];
    if (point.size() != variables) {
      throw std::invalid_argument("all points must have the same length");
    }
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      check_number(x(row, i) = point[static_cast<std::size_t>(i)], "points");
    }
    check_number(y(row) = values[static_cast<std::size_t>(row)], "values");
  }
  y.array() -= y.mean();
  const double scale = y.cwiseAbs().maxCoeff();
  if (scale == 0 || make_terms(x, ModelTerms::linear).names.empty()) {
    return std::nullopt;
  }
  y /= scale;

  Fit fit = fit_ridge(x, y, ModelTerms::linear);
  for (const ModelTerms kind : {ModelTerms::squares, ModelTerms::products}) {
    Fit other = fit_ridge(x, y, kind);
    if (other.error < fit.error) {
      fit = std::move(other);
    }
  }
  ModelSensitivity sensitivity{.terms = fit.kind};
  // The mean of the other points leaves this error at each point.
  const auto m = static_cast<double>(points.size());
  sensitivity.explained = 1 - fit.error / (y.squaredNorm() * m * m / ((m - 1) * (m - 1)));

  const Eigen::VectorXd noise = fit.solution.cwiseAbs2() * fit.left_out.cwiseAbs2();
  RandomStream random(stream);
  std::vector<Shares> resampled;
  Eigen::VectorXd again(y.size());
  for (int i = 0; i < kBootstraps; ++i) {
    for (Eigen::Index row = 0; row < y.size(); ++row) {
      again(row) = fit.fitted(row) + (random.bernoulli(0.5) ? 1 : -1) * fit.left_out(row);
    }
    resampled.push_back(calc_shares(fit.terms.names, fit.solution * again, 2 * noise, variables));
  }
  sensitivity.variables =
      make_indices(calc_shares(fit.terms.names, fit.coefficients, noise, variables), resampled);
  return sensitivity;
}

std::vector<std::vector<double>> make_sensitivity_design(std::span<const double> lower,
                                                         std::span<const double> upper,
                                                         std::size_t rows,
                                                         std::string_view stream) {
  if (lower.size() != upper.size()) {
    throw std::invalid_argument("both bounds must have the same length");
  }
  const std::size_t n = lower.size();
  RandomStream random(stream);
  std::vector<std::vector<double>> points(rows * (n + 2), std::vector<double>(n));
  std::vector<std::size_t> order(rows);
  for (std::size_t block = 0; block < 2; ++block) {
    for (std::size_t i = 0; i < n; ++i) {
      std::iota(order.begin(), order.end(), std::size_t{0});
      for (std::size_t left = rows; left > 1; --left) {
        std::swap(order[left - 1], order[random.below(left)]);
      }
      for (std::size_t row = 0; row < rows; ++row) {
        const double share =
            (static_cast<double>(order[row]) + random.uniform()) / static_cast<double>(rows);
        points[block * rows + row][i] = lower[i] + share * (upper[i] - lower[i]);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t row = 0; row < rows; ++row) {
      points[(i + 2) * rows + row] = points[row];
      points[(i + 2) * rows + row][i] = points[rows + row][i];
    }
  }
  return points;
}

std::optional<std::vector<SobolIndices>> calc_design_sensitivity(std::span<const double> values,
                                                                 std::size_t variables,
                                                                 std::string_view stream) {
  if (variables == 0 || values.size() % (variables + 2) != 0) {
    throw std::invalid_argument("a design has variables + 2 values per row");
  }
  const std::size_t rows = values.size() / (variables + 2);
  std::vector<std::size_t> usable;
  for (std::size_t row = 0; row < rows; ++row) {
    bool has_all = true;
    for (std::size_t block = 0; block < variables + 2; ++block) {
      const double value = values[block * rows + row];
      if (std::isinf(value)) {
        throw std::invalid_argument("values must not be infinite");
      }
      has_all = has_all && !std::isnan(value);
    }
    if (has_all) {
      usable.push_back(row);
    }
  }
  if (usable.size() < kFewestRows) {
    return std::nullopt;
  }
  // Returns no shares if the values of the chosen rows are constant.
  const auto calc = [&](std::span<const std::size_t> chosen) {
    const auto count = static_cast<double>(chosen.size());
    double mean = 0;
    for (const std::size_t row : chosen) {
      mean += (values[row] + values[rows + row]) / (2 * count);
    }
    double variance = 0;
    for (const std::size_t row : chosen) {
      variance +=
          (std::pow(values[row] - mean, 2) + std::pow(values[rows + row] - mean, 2)) / (2 * count);
    }
    Shares shares{std::vector<double>(variables), std::vector<double>(variables)};
    for (std::size_t i = 0; i < variables && variance > 0; ++i) {
      double from_a = 0;
      double from_b = 0;
      for (const std::size_t row : chosen) {
        const double mixed = values[(i + 2) * rows + row];
        from_a += std::pow(values[row] - mixed, 2);
        from_b += std::pow(values[rows + row] - mixed, 2);
      }
      shares.first[i] = std::clamp(1 - from_b / (2 * count * variance), 0.0, 1.0);
      shares.total[i] = std::clamp(from_a / (2 * count * variance), 0.0, 1.0);
    }
    return std::pair(shares, variance > 0);
  };
  const auto [shares, varies] = calc(usable);
  if (!varies) {
    return std::nullopt;
  }
  RandomStream random(stream);
  std::vector<Shares> resampled;
  std::vector<std::size_t> chosen(usable.size());
  for (int i = 0; i < kBootstraps; ++i) {
    std::ranges::generate(chosen, [&] { return usable[random.below(usable.size())]; });
    resampled.push_back(calc(chosen).first);
  }
  return make_indices(shares, resampled);
}

}  // namespace armwright
