// Arrays of numpy's as this module takes and gives them: doubles in C order. A shape that is wrong,
// and a number that is none, is an Error{usage} that names row and column.
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

// Stands where there is no number: never NaN, and nothing that could be taken for a good one.
inline constexpr double kNothing = std::numeric_limits<double>::infinity();

// A row of a matrix, which outlives it.
inline std::span<const double> get_row(const Numbers& matrix, py::ssize_t row) {
  return {matrix.data(row, 0), static_cast<std::size_t>(matrix.shape(1))};
}

// `name`: what messages call it. `inside`: it must lie within the bounds.
void check_points(const Numbers& points, std::span<const DecisionVariable> variables,
                  const std::string& name, bool inside);

// A matrix of so many rows.
Numbers make_matrix(std::size_t rows, std::size_t columns);
Numbers to_array(std::span<const double> values);

// Rows of different lengths, and a mask: what is missing at their ends or is no finite number is
// masked, and infinite below the mask.
py::tuple make_ragged(const std::vector<std::vector<double>>& rows);

}  // namespace armwright::python
