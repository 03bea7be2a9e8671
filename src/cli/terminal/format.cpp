#include "cli/terminal/format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.hpp"

namespace armwright {

std::string format_significant(double value, int digits) {
  const double size = std::abs(value);
  if (!std::isfinite(value)) {
    return describe_number(value, "");
  }
  if (size == 0) {
    return "0";
  }
  if (!(size >= 1e-4 && size < 1e9)) {
    return fmt::format("{:.{}e}", value, digits - 1);
  }
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.{}f}", value, std::max(0, decimals));
}

std::string format_mm(std::optional<double> length_m) {
  return length_m ? format_significant(*length_m * 1000) : "-";
}

nlohmann::json to_json_value(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json to_json_value(const DecisionVariable& variable, double value) {
  switch (variable.type) {
    case VariableType::category:
      return format_value(variable, value);
    case VariableType::integer:
      return static_cast<std::int64_t>(value);
    case VariableType::real:
      break;
  }
  return value;
}

std::string format_quantity(double value, std::string_view unit) {
  if (!std::isfinite(value)) {
    return describe_number(value, unit);
  }
  if (unit == "m") {
    return format_mm(value) + " mm";
  }
  return format_significant(value) + (unit.empty() || unit == "1" ? "" : fmt::format(" {}", unit));
}

std::string format_duration(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  if (whole < 60) {
    return fmt::format("{} s", whole);
  }
  if (whole < 3600) {
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
  }
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string format_count(unsigned long long count, std::string_view singular) {
  return fmt::format("{} {}{}", count, singular, count == 1 ? "" : "s");
}

}  // namespace armwright
