// The trust region of turbo: a box around the best place, the evaluations since the last restart,
// and a Gaussian process for the objective and for each constraint.
//
// The box is u_c - L w / 2 <= u <= u_c + L w / 2, cut at the bounds, with the best place u_c and the
// weights w of the objective's length scales, whose geometric mean is 1. L is doubled after 3
// successes in a row and halved after max(4, n) / q failures in a row, for n variables and batches of
// q places. A region whose L is below 2^-7 has converged.
//
// Each place of a batch minimises one sample of the posterior (Thompson 1933). The sample is
// evaluated on a Latin hypercube of the trust region. With more than 20 variables each candidate
// keeps the centre's value of a variable with the probability 1 - 20 / n. With constraints, a sample
// of each constraint decides which candidates are feasible; if none is, the one with the smallest
// violation is chosen. Source: Eriksson, Pearce, Gardner, Turner and Poloczek 2019, Scalable global
// optimization via local Bayesian optimization; Eriksson and Poloczek 2021, Scalable constrained
// Bayesian optimization. Deviations: the best candidates are moved to the local minima of the sample
// (box_descent.hpp), so that the precision does not end at the distance of the candidates.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/evaluator.hpp"
#include "optimizers/interface/feasibility.hpp"
#include "optimizers/turbo/gaussian_process.hpp"
#include "optimizers/turbo/turbo_box.hpp"

namespace armwright {

class TurboRegion {
 public:
  // The box and the problem must outlive this object.
  TurboRegion(const TurboBox& box, const ProblemDescription& problem, double length);

  bool has_converged() const;
  // Adds the evaluations of the initial design.
  void begin(const Eigen::MatrixXd& places, std::span<const Score> scores);
  // Adds the evaluations of a batch that choose() has returned, and changes the length of the box.
  void add_batch(const Eigen::MatrixXd& places, std::span<const Score> scores);
  // Fits the processes and returns a batch of settled places, one per column. None of them has been
  // evaluated, unless the values of discrete variables leave no other.
  Eigen::MatrixXd choose(Eigen::Index batch, RandomStream& random);

 private:
  // One sample of the objective, and one per constraint.
  struct Draw {
    ProcessFunction objective;
    std::vector<ProcessFunction> constraints;
  };

  void add(const Eigen::MatrixXd& places, std::span<const Score> scores);
  std::size_t find_best() const;
  bool is_success(const Fitness& before, const Fitness& after) const;
  Eigen::VectorXd make_objective_values() const;
  Eigen::VectorXd make_constraint_values(std::size_t constraint) const;
  void fit_processes();
  void place_box();
  Eigen::MatrixXd draw_candidates(RandomStream& random) const;
  Eigen::VectorXd minimise(const Draw& draw, RandomStream& random) const;
  bool is_known(const Eigen::MatrixXd& batch, Eigen::Index place) const;

  const TurboBox& box_;
  const ProblemDescription& problem_;
  Eigen::Index n_;
  double length_;
  int successes_ = 0;
  int failures_ = 0;
  Eigen::MatrixXd places_;
  std::vector<Score> scores_;
  std::vector<Fitness> fitness_;
  GaussianProcess objective_;
  std::vector<GaussianProcess> constraints_;
  Eigen::Index next_fit_ =
      0;  // the number of places from which the hyperparameters are fitted again
  Eigen::VectorXd weights_;
  Eigen::VectorXd centre_;
  Eigen::VectorXd lower_;  // of the trust region
  Eigen::VectorXd upper_;
};

}  // namespace armwright
