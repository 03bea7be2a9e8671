// What the cases of a set say together: their errors, and the average error of each trajectory
// point.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "problems/tracking/tracking_problem.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// Errors of cases, one each, NaN for a case without number; and what is said of them.
std::vector<double> get_case_errors(std::span<const TrackingResult> results);
ErrorSummary summarize_cases(std::span<const TrackingResult> results);
// Of the mean of the errors that are numbers, s / sqrt(n); NaN of fewer than two.
double calc_standard_error(std::span<const double> errors);

struct PointStatistics {
  std::vector<double> mean_m;            // one a point; NaN: no case has a number
  std::vector<double> standard_error_m;  // of the mean, s / sqrt(n); NaN of fewer than two
};

// Over the cases with a number: a diverged one says nothing of points that it reached before.
PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points);

}  // namespace armwright
