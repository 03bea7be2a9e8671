#include "report/page/distance_response.hpp"

#include <cmath>
#include <limits>

#include "report/page/page_json.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

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

PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points) {
  PointStatistics statistics;
  for (std::size_t k = 0; k < points; ++k) {
    double count = 0;
    double sum = 0;
    for (const TrackingResult& result : results) {
      if (result.status == SimulationStatus::ok) {
        sum += result.point_error_m[k];
        ++count;
      }
    }
    const double mean = count > 0 ? sum / count : kNone;
    double squares = 0;
    for (const TrackingResult& result : results) {
      if (result.status == SimulationStatus::ok) {
        squares += (result.point_error_m[k] - mean) * (result.point_error_m[k] - mean);
      }
    }
    statistics.mean_m.push_back(mean);
    statistics.standard_error_m.push_back(count > 1 ? std::sqrt(squares / (count - 1) / count)
                                                    : kNone);
  }
  return statistics;
}

json make_response_series(const TrackingProblem& problem, const std::string& name,
                          std::span<const TrackingResult> results,
                          const std::optional<double>& published_mean_m,
                          const std::string& command) {
  const ErrorSummary summary = summarize_cases(results);
  const auto points = static_cast<std::size_t>(problem.config().workspace.points);
  const PointStatistics statistics = calc_point_statistics(results, points);
  return {{"name", name},
          {"cases", summary.cases - summary.without_number},
          {"failures", summary.failures},
          {"mean_m", finite_or_null(statistics.mean_m)},
          {"standard_error_m", finite_or_null(statistics.standard_error_m)},
          {"overall_mean_m", finite_or_null(summary.mean)},
          {"overall_median_m", finite_or_null(summary.median)},
          {"published_mean_m", finite_or_null(published_mean_m)},
          {"command", command}};
}

json make_distance_response(const TrackingProblem& problem, const ResponseText& text, json series) {
  const WorkspaceSphere& workspace = problem.config().workspace;
  json distances = json::array();
  json counted = json::array();
  for (int k = 1; k <= workspace.points; ++k) {
    distances.push_back(workspace.calc_move_m(k));
    counted.push_back(k > 1 || problem.config().task.count_first_point);
  }
  return {{"id", text.id},
          {"title", text.title},
          {"thesis", text.thesis},
          {"remark", text.remark},
          {"distances_m", std::move(distances)},
          {"counted", std::move(counted)},
          {"series", std::move(series)}};
}

}  // namespace armwright
