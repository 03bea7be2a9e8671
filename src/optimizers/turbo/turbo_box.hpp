// The box of a problem as the Gaussian processes of turbo see it. A place is a vector u of one share
// of the box's width per variable, in [0, 1]; for a logarithmic variable it is the share of the
// logarithm. The box of a discrete variable reaches half a step further at both ends, so that every
// value has a cell of the same width. Every place that is evaluated or modelled is settled: its
// discrete coordinates lie where their values do, so the kernel sees the values that are evaluated
// (Garrido-Merchan and Hernandez-Lobato 2020, Dealing with categorical and integer-valued variables
// in Bayesian optimization with Gaussian processes).
//
// The features of a place are the inputs of the kernel. A real or an integer variable has one, its
// share. A category of k words has k: 1 / sqrt(2) for its word and 0 for the others. Two different
// words thus have the squared distance 1, whatever their order.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

class TurboBox {
 public:
  explicit TurboBox(std::span<const DecisionVariable> variables);

  Eigen::Index dimension() const { return start_.size(); }
  bool is_discrete(std::size_t i) const { return variables_[i].type != VariableType::real; }
  bool is_category(std::size_t i) const { return variables_[i].type == VariableType::category; }
  // Returns the variable that each feature belongs to.
  const std::vector<std::size_t>& feature_variables() const { return feature_variables_; }
  // Returns the least width of an interval around a share from which a discrete variable can reach
  // its neighbouring values; 0 for a real variable.
  double calc_least_width(std::size_t i, double share) const;

  // Returns the place of the problem's start.
  const Eigen::VectorXd& start() const { return start_; }
  // Returns a Latin hypercube of settled places, one per column.
  Eigen::MatrixXd draw_design(Eigen::Index places, RandomStream& random) const;

  // Moves the place into the box, and its discrete coordinates to the nearest values.
  void settle(Eigen::Ref<Eigen::VectorXd> u) const;
  // Returns the decision vector of a settled place. That of start() is the problem's start.
  std::vector<double> to_point(const Eigen::VectorXd& u) const;
  // Returns the features of settled places, one per column.
  Eigen::MatrixXd calc_features(const Eigen::MatrixXd& places) const;

 private:
  double to_share(std::size_t i, double coordinate) const;
  double to_coordinate(std::size_t i, double share) const;
  double to_value(std::size_t i, double share) const;  // of a discrete variable

  std::vector<DecisionVariable> variables_;
  SearchSpace space_;  // with the wider boxes of discrete variables
  std::vector<std::size_t> feature_variables_;
  Eigen::VectorXd start_;
};

}  // namespace armwright
