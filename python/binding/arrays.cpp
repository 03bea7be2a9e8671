#include "arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright::python {

void check_points(const Numbers& points, std::span<const DecisionVariable> variables,
                  const std::string& name, bool inside) {
  if (points.ndim() != 2 || points.shape(1) != static_cast<py::ssize_t>(variables.size())) {
    std::vector<std::string> shape;
    for (py::ssize_t i = 0; i < points.ndim(); ++i) {
      shape.push_back(std::to_string(points.shape(i)));
    }
    throw Error(
        ErrorKind::usage,
        fmt::format("{} has the shape ({}); it must be (n, {}), one row per point and one column "
                    "per decision variable, or ({},)",
                    name, join(shape, ", "), variables.size(), variables.size()));
  }
  for (py::ssize_t row = 0; row < points.shape(0); ++row) {
    const auto x = get_row(points, row);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const DecisionVariable& variable = variables[i];
      if (!std::isfinite(x[i]) || (inside && !(x[i] >= variable.lower && x[i] <= variable.upper))) {
        throw Error(
            ErrorKind::usage,
            fmt::format(
                "{}[{}, {}] ({}) is {}; it must be {}", name, row, i, variable.name,
                format_exact(x[i]),
                inside ? fmt::format("between {} and {}{}: clip() moves points to the bounds",
                                     format_exact(variable.lower), format_exact(variable.upper),
                                     variable.unit.empty() ? "" : " " + variable.unit)
                       : std::string("a finite number")));
      }
      if (inside && settle_value(variable, x[i]) != x[i]) {
        throw Error(
            ErrorKind::usage,
            fmt::format("{}[{}, {}] ({}) is {}; this variable is {}, so it must be a whole "
                        "number: clip() rounds",
                        name, row, i, variable.name, format_exact(x[i]),
                        variable.type == VariableType::integer ? "an integer" : "a category"));
      }
    }
  }
}

Numbers make_matrix(std::size_t rows, std::size_t columns) {
  return Numbers({static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

Numbers to_array(std::span<const double> values) {
  return Numbers(static_cast<py::ssize_t>(values.size()), values.data());
}

py::tuple make_ragged(const std::vector<std::vector<double>>& rows) {
  std::size_t columns = 0;
  for (const auto& row : rows) {
    columns = std::max(columns, row.size());
  }
  Numbers values = make_matrix(rows.size(), columns);
  py::array_t<bool> mask(
      {static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(columns)});
  double* value = values.mutable_data();
  bool* masked = mask.mutable_data();
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < columns; ++i) {
      const bool is_there = i < row.size() && std::isfinite(row[i]);
      *value++ = is_there ? row[i] : kNothing;
      *masked++ = !is_there;
    }
  }
  return py::make_tuple(values, mask);
}

}  // namespace armwright::python
