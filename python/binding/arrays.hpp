// The numpy arrays of this module: doubles in C order. Functions that check arrays throw
// Error{usage} for a wrong shape, and for a number that is not finite they name row and column.
#pragma once

#include <pybind11/numpy.h>

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright::python {

namespace py = pybind11;

using Numbers = py::array_t<double, py::array::c_style>;

// Stands for a missing number. It is never NaN and never looks like a good value.
inline constexpr double kNothing = std::numeric_limits<double>::infinity();

// Returns a row of a matrix. The matrix must outlive it.
inline std::span<const double> get_row(const Numbers& matrix, py::ssize_t row) {
  return {matrix.data(row, 0), static_cast<std::size_t>(matrix.shape(1))};
}

// Checks a matrix with one point per row. Messages call it `name`. With `inside`, every point must
// lie within the bounds.
void check_points(const Numbers& points, std::span<const DecisionVariable> variables,
                  const std::string& name, bool inside);

// Returns a new matrix whose elements have no values yet.
Numbers make_matrix(std::size_t rows, std::size_t columns);
Numbers to_array(std::span<const double> values);

// Returns (values, mask) of rows with different lengths. The mask is true for elements that are
// missing at the end of a row or not finite; their values are infinite.
py::tuple make_ragged(const std::vector<std::vector<double>>& rows);

}  // namespace armwright::python
