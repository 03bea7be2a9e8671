#include "report/evidence/point_statistics.hpp"

#include <cmath>
#include <limits>

namespace armwright {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct MeanAndError {
  double mean = kNone;
  double standard_error = kNone;
};

// Of the values that are numbers.
MeanAndError calc_mean(std::span<const double> values) {
  double count = 0;
  double sum = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      sum += value;
      ++count;
    }
  }
  if (count == 0) {
    return {};
  }
  const double mean = sum / count;
  double squares = 0;
  for (const double value : values) {
    if (!std::isnan(value)) {
      squares += (value - mean) * (value - mean);
    }
  }
  return {mean, count > 1 ? std::sqrt(squares / (count - 1) / count) : kNone};
}

}  // namespace

std::vector<double> get_case_errors(std::span<const TrackingResult> results) {
  std::vector<double> errors;
  for (const TrackingResult& result : results) {
    errors.push_back(result.status == SimulationStatus::ok ? result.mean_error_m : kNone);
  }
  return errors;
}

ErrorSummary summarize_cases(std::span<const TrackingResult> results) {
  return summarize(get_case_errors(results), kFailureError_m);
}

double calc_standard_error(std::span<const double> errors) {
  return calc_mean(errors).standard_error;
}

PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points) {
  PointStatistics statistics;
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> errors;
    for (const TrackingResult& result : results) {
      errors.push_back(result.status == SimulationStatus::ok ? result.point_error_m[k] : kNone);
    }
    const MeanAndError point = calc_mean(errors);
    statistics.mean_m.push_back(point.mean);
    statistics.standard_error_m.push_back(point.standard_error);
  }
  return statistics;
}

}  // namespace armwright
