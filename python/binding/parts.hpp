// The parts of the module, a file each, and what they share.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright::python {

namespace py = pybind11;

class Host;

void add_problems(py::module_& module);
void add_designs(py::module_& module);
void add_optimizers(py::module_& module);
void add_runs(py::module_& module);
void add_studies(py::module_& module);

// A problem as it was asked for.
struct ProblemHandle {
  std::string name;
  std::vector<std::string> settings;  // KEY=VALUE
  LoadedProblem loaded;
};

// An optimizer as Python hands it over: a name, or (name, description, input hashes, run), of which
// run(evaluator, values, seed) is called for every run. The row may be copied and dropped on any
// thread; while it runs the host's work is under way.
OptimizerRow load_row(const py::object& optimizer, Host& host);

}  // namespace armwright::python
