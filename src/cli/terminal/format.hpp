// Numbers, times and commands as people read them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace armwright {

// Four significant digits by default, without an exponent where that stays readable:
// 0.08241, 5.229, 963686, 1.2e-09.
std::string format_significant(double value, int digits = 4);
// A length in mm, without the unit: 0.000083 -> "0.083". "-" for what does not exist.
std::string format_mm(std::optional<double> length_m);
// With its unit; metres become millimetres, "1" is no unit.
std::string format_quantity(double value, std::string_view unit);
// "6 s", "12:05", "3:04:59"
std::string format_duration(double seconds);
// "1 case", "2 cases"
std::string format_count(unsigned long long count, std::string_view singular);

}  // namespace armwright
