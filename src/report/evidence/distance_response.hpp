// Statistics of the test cases of a set, and the thesis's distance response: the mean error of each
// point of the trajectory against the length of the move to it.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/tracking/tracking_problem.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// Returns the error (m) of each case. It is NaN for a case without a number; so are the errors that
// the other functions take.
std::vector<double> get_case_errors(std::span<const TrackingResult> results);
ErrorSummary summarize_cases(std::span<const TrackingResult> results);

// The mean error of each point over the cases of a set. Only cases with a number count: the earlier
// points of a diverged case are left out too.
struct PointStatistics {
  std::vector<double> mean_m;            // per point; NaN if no case has a number
  std::vector<double> standard_error_m;  // of the mean: s / sqrt(n), NaN for n < 2
};
PointStatistics calc_point_statistics(std::span<const TrackingResult> results, std::size_t points);

// The texts of a figure.
struct ResponseText {
  std::string id;  // "distance-response" or "fig-6.4"
  std::string title;
  std::string thesis;  // "Fig. 6.4" or ""
  std::string remark;  // whole sentences, or ""
};

// Return ResponseSeries of web/src/data.ts. `command` repeats the computation. The first function
// takes the results of a design on a generated set of the problem, the second one their statistics.
nlohmann::json make_response_series(const TrackingProblem& problem, const std::string& name,
                                    std::span<const TrackingResult> results,
                                    const std::optional<double>& published_mean_m,
                                    const std::string& command);
nlohmann::json make_response_series(const std::string& name, std::span<const double> case_errors,
                                    const PointStatistics& points,
                                    const std::optional<double>& published_mean_m,
                                    const std::string& command);

// Returns DistanceResponse of web/src/data.ts. `series` is a list of ResponseSeries whose problems
// have the same points as `problem`.
nlohmann::json make_distance_response(const TrackingProblem& problem, const ResponseText& text,
                                      nlohmann::json series);

}  // namespace armwright
