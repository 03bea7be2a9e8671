// What an identification found, and how sure it is.
//
// With J the derivatives of the residuals r at the solution, the covariance of the parameters is
//   C = N / (N - n) (J^T J)^-1 (sum_i s_i^2 J_i^T R_i J_i) (J^T J)^-1.
// J_i are the rows of one channel: the efforts, or the deflections, of one joint, or what is known
// beforehand of a parameter. s_i^2 is its mean squared residual, and R_i has the autocorrelations of
// its residuals, which a filter and an imperfect model make larger than 0 (Newey and West 1987, A
// simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix,
// Econometrica 55, 703-708). N counts the independent samples of all channels: K samples are
// K / (1 + 2 sum_l rho_l), the sum ending before the first autocorrelation that is not above 0 (Geyer
// 1992, Practical Markov chain Monte Carlo, Statistical Science 7, 473-483), and at most what the
// low-pass filter leaves of white noise. The intervals use Student's t with N - n degrees of freedom,
// n being the number of parameters that the motions determine.
//
// Residuals are white if a model leaves nothing to explain. The test is that of Ljung and Box (1978,
// On a measure of lack of fit in time series models, Biometrika 65, 297-303) on the residuals thinned
// to independent samples of the filter.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "problems/identification/identification_problem.hpp"
#include "sim/identification/fitted_plant.hpp"

namespace armwright {

struct FittedParameter {
  std::string name, unit;
  double before = 0;  // the robot's own value
  double start = 0;   // where the optimizer began
  double value = 0;
  double standard_error = 0;
  double lower = 0, upper = 0;  // of the 95 % interval
  bool is_at_bound = false;
  bool is_determined = true;
};

// Root mean squares of one joint's effort error over all motions of a set, N m or N.
struct JointFit {
  std::string joint, unit;
  double deviation = 0;  // of the recorded effort
  double before = 0, after = 0;
  double whiteness_p = 0;    // of the residuals; below 0.05 they are not white
  double independent_s = 0;  // time after which a residual tells something new
};

struct FitSet {
  std::vector<std::string> logs;
  std::vector<JointFit> joints;
  // Means over the joints of rms / deviation.
  double before = 0, after = 0;
};

struct FitAnalysis {
  std::vector<FittedParameter> parameters;
  Eigen::MatrixXd covariance;
  FitSet fitted;
  FitSet judged;  // empty joints if no log is held back
  // What the motions do not tell, one sentence each.
  std::vector<std::string> undetermined;
  // Pairs of parameters whose estimates depend on each other: |correlation| above 0.9.
  struct Correlation {
    std::string first, second;
    double value = 0;
  };
  std::vector<Correlation> correlations;
  double condition = 0;  // of J with columns in units of the parameters' boxes
};

// `before` has the values that the fit is compared with: the robot's own.
FitAnalysis analyse_fit(const IdentificationProblem& problem, std::span<const double> x);

// Returns the robot with the fitted values, and the fitted distribution.
RobotModel make_fitted_robot(const IdentificationProblem& problem, std::span<const double> x);
FittedPlant make_fitted_plant(const IdentificationProblem& problem, std::span<const double> x,
                              const FitAnalysis& analysis);

}  // namespace armwright
