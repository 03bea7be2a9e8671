// What every statistic here asks of its numbers. Everything is minimised, and a cell without result
// counts as +infinity, worse than all others; NaN and -infinity are mistakes of the caller.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace armwright {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Throw std::invalid_argument, `what` naming the numbers, unless each is finite or +infinity;
void check_values(std::span<const double> values, std::string_view what);

// there are as many of one as of the other besides;
void check_pairs(std::span<const double> a, std::span<const double> b, std::string_view what);

// there is at least one row and one column, and rows are equally long. Returns the number of
// columns.
std::size_t check_table(std::span<const std::vector<double>> rows, std::string_view what);

// Throws std::invalid_argument unless lower <= value <= upper (never for NaN).
void check_range(double value, double lower, double upper, std::string_view what);

}  // namespace armwright
