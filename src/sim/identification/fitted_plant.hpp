// What an identification leaves uncertain: parameters (plant_parameters.hpp) with a normal
// distribution. With C = D R D the covariance, D the standard errors and R = V diag(l) V^T the
// correlations, the plants are
//   draw      x + D V diag(sqrt(l)) z,   z standard normal,
//   corner k  x +- 2 sqrt(l_j) D v_j,    j = k / 2, plus for even k.
// Values beyond the parameters' range are moved to its end (set_parameters()).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "sim/identification/plant_parameters.hpp"

namespace armwright {

struct FittedPlant {
  std::vector<PlantParameter> parameters;
  std::vector<double> values;
  Eigen::MatrixXd covariance;     // one row and column per parameter
  std::vector<std::string> logs;  // "NAME SHA-256" of each log
  double delay_s = 0;             // the age of the recorded efforts, if it was fitted

  // Return the values of one plant. Corners are counted round, from 0.
  std::vector<double> draw(RandomStream& random) const;
  std::vector<double> get_corner(std::uint64_t number) const;

 private:
  // Returns D V diag(sqrt(l)).
  Eigen::MatrixXd calc_axes() const;
};

}  // namespace armwright
