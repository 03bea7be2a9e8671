// Numbers and times as text, for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "problems/interface/problem.hpp"

namespace armwright {

// Returns the value with `digits` significant digits, without an exponent for sizes from 1e-4 to
// 1e9: 0.08241, 5.229, 963686, 1.2e-09.
std::string format_significant(double value, int digits = 4);
// Returns a length in mm without the unit: 0.000083 -> "0.083". Returns "-" if there is no value.
std::string format_mm(std::optional<double> length_m);
// Returns the value with its unit. Metres become millimetres; the unit "1" is left out.
std::string format_quantity(double value, std::string_view unit);
// Returns "6 s", "12:05" or "3:04:59".
std::string format_duration(double seconds);
// Returns "1 case", "2 cases".
std::string format_count(unsigned long long count, std::string_view singular);

// Returns null for a missing value and for NaN or infinity, which JSON cannot hold.
nlohmann::json to_json_value(std::optional<double> value);
// Returns the value of a variable: a whole number of an integer, the word of a category.
nlohmann::json to_json_value(const DecisionVariable& variable, double value);

}  // namespace armwright
