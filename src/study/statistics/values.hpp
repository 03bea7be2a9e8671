// Checks of the numbers that the statistics here work on. Smaller values are better, and +infinity
// stands for a cell without a result: it is worse than all numbers. NaN and -infinity are errors of
// the caller. All functions throw std::invalid_argument with `what`, the name of the numbers.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace armwright {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Throws unless each value is finite or +infinity.
void check_values(std::span<const double> values, std::string_view what);

// As check_values() for both; also throws unless a and b have the same length.
void check_pairs(std::span<const double> a, std::span<const double> b, std::string_view what);

// As check_values() for every row; also throws unless there is a row and a column, and all rows
// have the same length. Returns the number of columns.
std::size_t check_table(std::span<const std::vector<double>> rows, std::string_view what);

// Throws unless lower <= value <= upper; always throws for NaN.
void check_range(double value, double lower, double upper, std::string_view what);

}  // namespace armwright
