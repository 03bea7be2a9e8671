// The analytic functions themselves, as formulas over z (problems/analytic.hpp), with the boxes and
// starts that make problems of them. For analytic.cpp only.
#pragma once

#include <span>
#include <vector>

#include "problems/analytic/analytic.hpp"

namespace armwright {

using AnalyticPoint = std::span<const double>;

struct AnalyticDefinition {
  AnalyticRow row;
  double lower = 0;
  double upper = 0;
  std::vector<double> start = {};      // one number: the same for every variable
  std::vector<double> minimiser = {};  // empty: the shift
  int constraint_count = 0;
  double (*calc_value)(AnalyticPoint) = nullptr;
  std::vector<double> (*calc_constraints)(AnalyticPoint) = nullptr;
  std::vector<double> (*calc_residuals)(AnalyticPoint) = nullptr;
};

const std::vector<AnalyticDefinition>& analytic_definitions();

}  // namespace armwright
