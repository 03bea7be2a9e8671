// Ranks from 1, the smallest value first. Values that are equal share the mean of the ranks they
// take up together; so do infinities. Source: Kendall, M. G. 1945, The treatment of ties in ranking
// problems, Biometrika 33(3).
#pragma once

#include <span>
#include <vector>

namespace armwright {

// Throws std::invalid_argument for NaN and -infinity.
std::vector<double> calc_ranks(std::span<const double> values);

// Sum of t^3 - t over the groups of t equal values: by how much ties lessen the spread of ranks.
// What is exact for up to 200 000 values.
double calc_tie_term(std::span<const double> values);

}  // namespace armwright
