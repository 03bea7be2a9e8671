#include "report/evidence/distance_response.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "problems/tracking/tracking_config.hpp"
#include "report/evidence/page_json.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr double kNoError = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::vector<double> get_case_errors(std::span<const TrackingResult> results) {
  std::vector<double> errors;
  for (const TrackingResult& result : results) {
    errors.push_back(result.status == SimulationStatus::ok ? result.mean_error_m : kNoError);
  }
  return errors;
}

ErrorSummary summarize_cases(std::span<const TrackingResult> results) {
  return summarize(get_case_errors(results), kFailureError_m);
}

PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points) {
  PointStatistics statistics;
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> errors;
    for (const TrackingResult& result : results) {
      errors.push_back(result.status == SimulationStatus::ok ? result.point_error_m[k] : kNoError);
    }
    const MeanAndError point = calc_mean_and_error(errors);
    statistics.mean_m.push_back(point.mean);
    statistics.standard_error_m.push_back(point.standard_error);
  }
  return statistics;
}

json make_response_series(const TrackingProblem& problem, const std::string& name,
                          std::span<const TrackingResult> results,
                          const std::optional<double>& published_mean_m,
                          const std::string& command) {
  const std::size_t points = list_moves_m(problem.config()).size();
  return make_response_series(name, get_case_errors(results),
                              calc_point_statistics(results, points), published_mean_m, command);
}

json make_response_series(const std::string& name, std::span<const double> case_errors,
                          const PointStatistics& points,
                          const std::optional<double>& published_mean_m,
                          const std::string& command) {
  const ErrorSummary summary = summarize(case_errors, kFailureError_m);
  return {{"name", name},
          {"cases", summary.cases - summary.without_number},
          {"failures", summary.failures},
          {"mean_m", finite_or_null(points.mean_m)},
          {"standard_error_m", finite_or_null(points.standard_error_m)},
          {"overall_mean_m", finite_or_null(summary.mean)},
          {"overall_median_m", finite_or_null(summary.median)},
          {"published_mean_m", finite_or_null(published_mean_m)},
          {"command", command}};
}

json make_distance_response(const TrackingProblem& problem, const ResponseText& text, json series) {
  const std::vector<double> distances = list_moves_m(problem.config());
  json counted = json::array();
  for (std::size_t k = 0; k < distances.size(); ++k) {
    counted.push_back(k > 0 || problem.config().task.count_first_point);
  }
  return {{"id", text.id},
          {"title", text.title},
          {"thesis", text.thesis},
          {"remark", text.remark},
          {"distances_m", distances},
          {"counted", std::move(counted)},
          {"series", std::move(series)}};
}

}  // namespace armwright
