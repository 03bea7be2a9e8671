#include "study/statistics/values.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace armwright {

void check_values(std::span<const double> values, std::string_view what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i]) || values[i] == -std::numeric_limits<double>::infinity()) {
      throw std::invalid_argument(
          fmt::format("{}: number {} is {}; it must be finite, or +infinity for a failure", what, i,
                      values[i]));
    }
  }
}

void check_pairs(std::span<const double> a, std::span<const double> b, std::string_view what) {
  if (a.size() != b.size()) {
    throw std::invalid_argument(
        fmt::format("{}: {} numbers cannot be paired with {}", what, a.size(), b.size()));
  }
  check_values(a, what);
  check_values(b, what);
}

std::size_t check_table(std::span<const std::vector<double>> rows, std::string_view what) {
  if (rows.empty() || rows.front().empty()) {
    throw std::invalid_argument(fmt::format("{}: there are no numbers", what));
  }
  for (const std::vector<double>& row : rows) {
    if (row.size() != rows.front().size()) {
      throw std::invalid_argument(fmt::format("{}: one row has {} numbers, another {}", what,
                                              rows.front().size(), row.size()));
    }
    check_values(row, what);
  }
  return rows.front().size();
}

void check_range(double value, double lower, double upper, std::string_view what) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(
        fmt::format("{} is {}; it must lie from {} to {}", what, value, lower, upper));
  }
}

}  // namespace armwright
