// The search distribution of the CMA evolution strategy, x = m + sigma y with y ~ N(0, C), and how
// one ranked sample changes m, sigma and C:
//
//   recombination          m     <- m + sum_{i <= mu} w_i (x_i - m)
//   path of the step size  p_s   <- (1 - c_s) p_s + sqrt(c_s (2 - c_s) mu_eff) C^(-1/2) <y>_w
//   step size              sigma <- sigma exp(c_s / d_s (|p_s| / E|N(0, I)| - 1))
//   path of the covariance p_c   <- (1 - c_c) p_c + h sqrt(c_c (2 - c_c) mu_eff) <y>_w
//   covariance             C     <- (1 + c_1 delta(h) - c_1 - c_mu sum_i w_i) C
//                                   + c_1 p_c p_c^T + c_mu sum_i v_i y_i y_i^T
//
// i counts from the best individual to the worst. <y>_w is the sum of w_i y_i over the mu best, n
// is the number of variables, and E|N(0, I)| is the mean length of a standard normal vector. p_c^T
// is the transpose of p_c. h is 0 while p_s is long, otherwise 1; delta(h) = (1 - h) c_c (2 - c_c).
// The weights after mu are negative ("active" update). For them v_i = w_i n / |C^(-1/2) y_i|^2,
// which keeps C positive definite; for all others v_i = w_i. Source: Hansen 2016, The CMA Evolution
// Strategy: A Tutorial (arXiv:1604.00772v2), section 6, figure 6 and table 1.
//
// The y of a generation are drawn at right angles to each other in the metric of C, n at a time.
// Each of them is still distributed as N(0, C), and none repeats the direction of another. Source:
// Wang, Emmerich and Baeck 2014, Mirrored orthogonal sampling with pairwise selection in evolution
// strategies; this class does not mirror. C is decomposed every max(1, floor(1 / (10 n (c_1 +
// c_mu)))) generations, as appendix B.2 of the tutorial advises.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/cma/cma_margin.hpp"

namespace armwright {

// The settings of a user. 0 means the value of the tutorial.
struct CmaSettings {
  std::size_t population = 0;  // lambda
  std::size_t mu = 0;
  bool active = true;
  bool orthogonal = true;
  double c_1 = 0;
  double c_mu = 0;
  double c_sigma = 0;
  double d_sigma = 0;
  double c_c = 0;
};

// The complete parameters of a strategy.
struct CmaParameters {
  std::size_t dimension = 0;
  std::size_t population = 0;
  std::size_t mu = 0;
  std::vector<double>
      weights;        // one per individual, best first; the first mu are positive, with the sum 1
  double mu_eff = 0;  // variance-effective selection mass of the positive weights
  double c_1 = 0;
  double c_mu = 0;
  double c_sigma = 0;
  double d_sigma = 0;
  double c_c = 0;
  bool orthogonal = true;                   // samples of up to n individuals are at right angles
  double expected_norm = 0;                 // E|N(0, I)|
  std::int64_t decomposition_interval = 1;  // generations
};

// Returns 4 + floor(3 ln n).
std::size_t calc_default_population(std::size_t dimension);
// Completes the settings by table 1 of the tutorial. Requires population >= 2 and 1 <= mu <=
// population where they are not 0.
CmaParameters make_cma_parameters(std::size_t dimension, const CmaSettings& settings);

// The distribution with its paths and step size.
class CmaDistribution {
 public:
  CmaDistribution(CmaParameters parameters, std::span<const double> mean, double sigma);
  ~CmaDistribution();
  CmaDistribution(CmaDistribution&&) noexcept;
  CmaDistribution& operator=(CmaDistribution&&) noexcept;

  const CmaParameters& parameters() const { return parameters_; }

  // Draws `population` points m + sigma a_i y_i and keeps the y for update(). The scales a_i are 1,
  // except along discrete coordinates (cma_margin.hpp).
  const std::vector<std::vector<double>>& sample(RandomStream& random);
  // Puts `point` in the place of the first point of the last sample, so that update() learns from
  // it. A step longer than `most` standard deviations is shortened to that length, because one
  // that no sample has would make sigma and C grow without limit. Source: Hansen 2011, Injecting
  // external solutions into CMA-ES (arXiv:1110.4181).
  void inject(std::span<const double> point, double most);
  // Adapts the distribution. `ranking` holds the indices of all points of the last sample, the best
  // first.
  void update(std::span<const std::size_t> ranking);
  void scale_sigma(double factor);

  std::span<const double> mean() const;
  double sigma() const { return sigma_; }
  std::int64_t generation() const { return generation_; }
  double calc_standard_deviation(std::size_t coordinate) const;  // sigma sqrt(C_ii)
  CmaMarginal marginal(std::size_t coordinate) const;
  void set_marginal(std::size_t coordinate, const CmaMarginal& marginal);
  double covariance(std::size_t row, std::size_t column) const;
  std::span<const double> covariance_path() const;  // p_c
  // Return sigma times the longest and the shortest axis of the ellipsoid at the last
  // decomposition.
  double longest_axis() const;
  double shortest_axis() const;
  std::vector<double> calc_axis(std::size_t number) const;  // sigma d_i b_i

 private:
  struct State;

  void decompose();

  CmaParameters parameters_;
  double sigma_;
  std::int64_t generation_ = 0;
  std::int64_t decomposed_at_ = 0;
  std::vector<std::vector<double>> points_;
  std::unique_ptr<State> state_;
};

}  // namespace armwright
