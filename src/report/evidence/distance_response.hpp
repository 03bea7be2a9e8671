// The average error of each trajectory point over the cases of a set, against how long the move to
// it was: the thesis's distance response. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "report/evidence/point_statistics.hpp"

namespace armwright {

struct ResponseText {
  std::string id;  // "distance-response" or "fig-6.4"
  std::string title;
  std::string thesis;  // "Fig. 6.4" or ""
  std::string remark;  // whole sentences, or ""
};

struct SeriesText {
  std::string name;
  std::string command;  // that makes it anew
};

// ResponseSeries: of a design's results on a generated set of the problem; or of the cases' errors
// (NaN for a case without number) and what has been made of the points' before.
nlohmann::json make_response_series(const TrackingProblem& problem, const std::string& name,
                                    std::span<const TrackingResult> results,
                                    const std::optional<double>& published_mean_m,
                                    const std::string& command);
nlohmann::json make_response_series(const SeriesText& text, std::span<const double> case_errors,
                                    const PointStatistics& points,
                                    const std::optional<double>& published_mean_m);

// DistanceResponse; `series` is a list of ResponseSeries of problems with the problem's points.
nlohmann::json make_distance_response(const TrackingProblem& problem, const ResponseText& text,
                                      nlohmann::json series);

}  // namespace armwright
