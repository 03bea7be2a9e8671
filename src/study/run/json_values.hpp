// Conversions between values and JSON in result files. JSON has neither NaN nor infinity, so a
// missing number is null. The readers throw nlohmann::json::exception for a value of another type.
// Only .cpp files include this header.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sim/tracking/response.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

inline nlohmann::json optional_to_json(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}
inline std::optional<double> optional_from_json(const nlohmann::json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

// Reads a count or an index. Unlike nlohmann's own conversion it refuses numbers that are not
// whole, negative or too large: that turns -1 into the largest number, and 1e300 into any.
template <class Number = std::uint64_t>
Number whole_from_json(const nlohmann::json& value) {
  if (!value.is_number_unsigned() ||
      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<Number>::max()}) {
    const std::string found = value.is_number() ? value.dump() : value.type_name();
    throw nlohmann::json::type_error::create(302, "must be a whole number from 0, but is " + found,
                                             &value);
  }
  return value.get<Number>();
}

// Returns whether the settings of a run in its manifest are those of a run whose evaluations are told
// (ask_tell.hpp).
inline bool is_asked_run(const nlohmann::json& run) {
  return run.value("selection", nlohmann::json::object()).value("evaluated_only", false);
}

// For values that are minimised: infinity is written as null.
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
  return {.cases = whole_from_json<std::size_t>(j.at("cases")),
          .without_number = whole_from_json<std::size_t>(j.at("without_number")),
          .failures = whole_from_json<std::size_t>(j.at("failures")),
          .mean = optional_from_json(j.at("mean")),
          .median = optional_from_json(j.at("median")),
          .percentile_95 = optional_from_json(j.at("percentile_95")),
          .worst = optional_from_json(j.at("worst"))};
}

inline nlohmann::json motion_to_json(const MotionSummary& motion) {
  return {{"error_while_moving_rms_m", motion.moving_rms_m},
          {"error_while_moving_peak_m", motion.moving_peak_m},
          {"error_after_start_up_m", optional_to_json(motion.start_up_m)}};
}
inline MotionSummary motion_from_json(const nlohmann::json& j) {
  return {.moving_rms_m = j.at("error_while_moving_rms_m"),
          .moving_peak_m = j.at("error_while_moving_peak_m"),
          .start_up_m = optional_from_json(j.at("error_after_start_up_m"))};
}

// Adds the errors in motion, and the total force if a joint slides, to the summary of an evaluation.
inline void add_motion(const std::optional<MotionSummary>& motion, const EffortTotals& efforts,
                       nlohmann::json& summary) {
  if (motion) {
    summary.update(motion_to_json(*motion));
  }
  if (efforts.force_n) {
    summary["total_force_n"] = *efforts.force_n;
  }
}

inline nlohmann::json efforts_to_json(const EffortTotals& efforts) {
  return {{"total_torque_n_m", optional_to_json(efforts.torque_n_m)},
          {"total_force_n", optional_to_json(efforts.force_n)}};
}

}  // namespace armwright
