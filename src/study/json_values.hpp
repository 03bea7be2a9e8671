// Values as the result files of this room have them: JSON knows neither NaN nor infinity, so what
// has no number is null. Only .cpp files include this.
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "study/summary.hpp"

namespace armwright {

inline nlohmann::json optional_to_json(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}
inline std::optional<double> optional_from_json(const nlohmann::json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

// Of a value to be minimised: null is infinite.
inline nlohmann::json value_to_json(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
inline double value_from_json(const nlohmann::json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

inline nlohmann::json summary_to_json(const ErrorSummary& summary) {
  return {{"cases", summary.cases},
          {"without_number", summary.without_number},
          {"failures", summary.failures},
          {"mean", optional_to_json(summary.mean)},
          {"median", optional_to_json(summary.median)},
          {"percentile_95", optional_to_json(summary.percentile_95)},
          {"worst", optional_to_json(summary.worst)}};
}
inline ErrorSummary summary_from_json(const nlohmann::json& j) {
  return {.cases = j.at("cases"),
          .without_number = j.at("without_number"),
          .failures = j.at("failures"),
          .mean = optional_from_json(j.at("mean")),
          .median = optional_from_json(j.at("median")),
          .percentile_95 = optional_from_json(j.at("percentile_95")),
          .worst = optional_from_json(j.at("worst"))};
}

}  // namespace armwright
