// The average error of each trajectory point over the cases of a set, against how long the move to
// it was: the thesis's distance response. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/tracking_problem.hpp"
#include "study/summary.hpp"

namespace armwright {

// Errors of cases, one each, NaN for a case without number; and what is said of them.
std::vector<double> get_case_errors(std::span<const TrackingResult> results);
ErrorSummary summarize_cases(std::span<const TrackingResult> results);

struct PointStatistics {
  std::vector<double> mean_m;            // one a point; NaN: no case has a number
  std::vector<double> standard_error_m;  // of the mean, s / sqrt(n); NaN of fewer than two
};

// Over the cases with a number: a diverged one says nothing of points that it reached before.
PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points);

struct ResponseText {
  std::string id;  // "distance-response" or "fig-6.4"
  std::string title;
  std::string thesis;  // "Fig. 6.4" or ""
  std::string remark;  // whole sentences, or ""
};

// ResponseSeries: of a design's results on a generated set of the problem.
nlohmann::json make_response_series(const TrackingProblem& problem, const std::string& name,
                                    std::span<const TrackingResult> results,
                                    const std::optional<double>& published_mean_m,
                                    const std::string& command);

// DistanceResponse; `series` is a list of ResponseSeries of problems with the problem's points.
nlohmann::json make_distance_response(const TrackingProblem& problem, const ResponseText& text,
                                      nlohmann::json series);

}  // namespace armwright
