#include "optimizers/turbo/turbo_box.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optimizers/builtin/latin_hypercube.hpp"
#include "optimizers/interface/treated_problem.hpp"

namespace armwright {

using Eigen::Index;

TurboBox::TurboBox(std::span<const DecisionVariable> variables)
    : variables_(variables.begin(), variables.end()),
      space_(adapt_variables(variables, {})),
      start_(static_cast<Index>(variables.size())) {
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    feature_variables_.insert(feature_variables_.end(),
                              is_category(i) ? variables_[i].choices.size() : 1, i);
    start_[static_cast<Index>(i)] = to_share(i, space_.start()[i]);
  }
  settle(start_);
}

double TurboBox::to_share(std::size_t i, double coordinate) const {
  const double width = space_.upper()[i] - space_.lower()[i];
  return width > 0 ? std::clamp((coordinate - space_.lower()[i]) / width, 0.0, 1.0) : 0.5;
}

double TurboBox::to_coordinate(std::size_t i, double share) const {
  const double lower = space_.lower()[i];
  const double upper = space_.upper()[i];
  return std::clamp(lower + share * (upper - lower), lower, upper);
}

double TurboBox::to_value(std::size_t i, double share) const {
  const DecisionVariable& variable = variables_[i];
  const double coordinate = to_coordinate(i, share);
  return settle_value(variable, variable.scale == Scale::linear
                                    ? coordinate
                                    : std::copysign(std::exp(coordinate), variable.lower));
}

double TurboBox::calc_least_width(std::size_t i, double share) const {
  if (!is_discrete(i)) {
    return 0;
  }
  // A logarithmic integer has its wider neighbouring cell below.
  const double value = std::abs(to_value(i, share));
  const double width = space_.upper()[i] - space_.lower()[i];
  const double cell =
      variables_[i].scale == Scale::linear ? 1 : std::log(value / std::max(value - 1, 0.5));
  return width > 0 ? 2.5 * cell / width : 1;
}

Eigen::MatrixXd TurboBox::draw_design(Index places, RandomStream& random) const {
  Eigen::MatrixXd design(dimension(), places);
  const std::vector<std::vector<double>> drawn =
      draw_latin_hypercube(space_, static_cast<std::size_t>(places), random);
  for (Index k = 0; k < places; ++k) {
    for (Index i = 0; i < dimension(); ++i) {
      design(i, k) = to_share(static_cast<std::size_t>(i),
                              drawn[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)]);
    }
    settle(design.col(k));
  }
  return design;
}

void TurboBox::settle(Eigen::Ref<Eigen::VectorXd> u) const {
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    double& share = u[static_cast<Index>(i)];
    share = std::clamp(share, 0.0, 1.0);
    if (is_discrete(i)) {
      const double value = to_value(i, share);
      share = to_share(i, variables_[i].scale == Scale::linear ? value : std::log(std::abs(value)));
    }
  }
}

std::vector<double> TurboBox::to_point(const Eigen::VectorXd& u) const {
  if (u == start_) {  // the way to a share and back may miss the start by a rounding
    return list_starts(variables_);
  }
  std::vector<double> coordinates;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    coordinates.push_back(to_coordinate(i, u[static_cast<Index>(i)]));
  }
  std::vector<double> point = space_.to_point(coordinates);
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    point[i] = settle_value(variables_[i], point[i]);
  }
  return point;
}

Eigen::MatrixXd TurboBox::calc_features(const Eigen::MatrixXd& places) const {
  Eigen::MatrixXd features =
      Eigen::MatrixXd::Zero(static_cast<Index>(feature_variables_.size()), places.cols());
  Index row = 0;
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const Index place = static_cast<Index>(i);
    if (!is_category(i)) {
      features.row(row++) = places.row(place);
      continue;
    }
    for (Index k = 0; k < places.cols(); ++k) {
      features(row + static_cast<Index>(to_value(i, places(place, k))), k) =
          1 / std::numbers::sqrt2;
    }
    row += static_cast<Index>(variables_[i].choices.size());
  }
  return features;
}

}  // namespace armwright
