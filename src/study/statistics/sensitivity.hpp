// Sobol indices: which share of the variance of a function each of its variables causes. The first
// index of a variable is the share that it causes by itself, the total index the share in which it
// takes part, alone or together with others. Source: Saltelli, A. et al. 2010, Variance based
// sensitivity analysis of model output, Computer Physics Communications 181.
//
// All functions throw std::invalid_argument for lists of different lengths and for numbers that are
// not finite. The same stream name gives the same intervals.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "study/statistics/summary.hpp"

namespace armwright {

struct SobolIndices {
  double first = 0;
  double total = 0;
  Interval first_interval;  // 95 %, by bootstrap
  Interval total_interval;
};

// The terms of a model, each kind with those before it: x_i; x_i^2; x_i x_j.
enum class ModelTerms { linear, squares, products };

struct ModelSensitivity {
  ModelTerms terms = ModelTerms::linear;
  // The share of the values' variance that the model explains at points that it was not fitted to
  // (leave-one-out). At most 1; below 0 if the model is worse than the mean.
  double explained = 0;
  std::vector<SobolIndices> variables = {};  // shares of the variance of the model
};

// Fits a polynomial to points and values, and returns the indices of the polynomial for independent
// variables, each of them distributed as it is among the points.
//
// The terms are orthonormal for such variables: z_i, (z_i^2 - g_i z_i - 1) / s_i and z_i z_k, with
// z_i the variable less its mean, divided by its deviation, g_i its skewness, and s_i its scale to
// variance 1. The indices are therefore sums of squared coefficients, less the variance that the
// coefficients have from the residuals. A ridge penalty makes the fit possible with fewer points
// than terms. Terms and penalty are those with the best leave-one-out error. Source of the terms:
// Oladyshkin, S. and Nowak, W. 2012, Data-driven uncertainty quantification using the arbitrary
// polynomial chaos expansion, Reliability Engineering & System Safety 106, for degree 2.
//
// The intervals come from a wild bootstrap: the residuals, divided by 1 - leverage, with random
// signs (Liu, R. Y. 1988, Bootstrap procedures under some non-i.i.d. models, Annals of Statistics
// 16). They contain what the points leave open, but not what no polynomial of degree 2 can express.
//
// Returns nothing for less than 8 points or 2 (n + 1) for n variables, because a choice by few
// left-out points finds a model for anything, and if the values or all variables are constant. Costs
// O(p^3 + m p^2) operations for m points and p terms: 0.5 s for 20 variables and 1000 points.
std::optional<ModelSensitivity> calc_model_sensitivity(std::span<const std::vector<double>> points,
                                                       std::span<const double> values,
                                                       std::string_view stream);

// Returns `rows` (n + 2) points of n variables between the bounds, for
// calc_design_sensitivity(): two Latin hypercubes A and B of `rows` points, then for each variable
// A with the column of this variable from B.
std::vector<std::vector<double>> make_sensitivity_design(std::span<const double> lower,
                                                         std::span<const double> upper,
                                                         std::size_t rows, std::string_view stream);

// Returns the indices of n variables from the values at the points of such a design, by the
// estimators of Jansen (1999, Analysis of variance designs for model output, Computer Physics
// Communications 117):
//   first_i = 1 - mean((f_B - f_ABi)^2) / (2 V),  total_i = mean((f_A - f_ABi)^2) / (2 V)
// V is the variance of all f_A and f_B. Rows with a value that is NaN are left out: `values` may
// contain it. The intervals come from resampling rows. Returns nothing for less than 4 rows, or if
// the values are constant.
std::optional<std::vector<SobolIndices>> calc_design_sensitivity(std::span<const double> values,
                                                                 std::size_t variables,
                                                                 std::string_view stream);

}  // namespace armwright
