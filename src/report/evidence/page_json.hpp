// Values as the pages' JSON has them (web/src/data.ts): SI units, null for a number that does not
// exist. Only .cpp files include this.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "problems/interface/problem.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

inline nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
inline nlohmann::json finite_or_null(const std::optional<double>& value) {
  return value ? finite_or_null(*value) : nlohmann::json(nullptr);
}
nlohmann::json finite_or_null(std::span<const double> values);

nlohmann::json make_quantity(const Quantity& quantity);
nlohmann::json make_fact(std::string_view label, std::string_view value);
// The program that makes the page.
nlohmann::json make_program();

// The whole page as text. Text that is no UTF-8 is made so.
std::string dump_page(const nlohmann::json& page);

}  // namespace armwright
