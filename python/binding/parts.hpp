// Declares the parts of the module, one per file, and what they share.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/interface/schedule.hpp"

namespace armwright::python {

namespace py = pybind11;

class Host;
struct PythonProblem;

void add_problems(py::module_& module);
void add_designs(py::module_& module);
void add_optimizers(py::module_& module);
void add_runs(py::module_& module);
void add_studies(py::module_& module);

// A problem, and the arguments that it was loaded with.
struct ProblemHandle {
  std::string name;
  std::vector<std::string> settings;  // KEY=VALUE
  LoadedProblem loaded;
  std::shared_ptr<const PythonProblem> python = {};  // null: the library has the problem
};

// Returns the problem for one call with `jobs` threads. A problem of Python may be simulated only
// while `host` runs work.
LoadedProblem load_for_call(const ProblemHandle& handle, Host& host, unsigned jobs);

// Returns the row of an optimizer that Python passes: a name, or the tuple (name, description,
// input hashes, run). Each run of the optimizer calls run(evaluator, values, seed). Any thread may
// copy and destroy the row. An optimizer of the row may run only while `host` runs work.
OptimizerRow load_row(const py::object& optimizer, Host& host);

// Return the description of a problem or an optimizer as JSON. The package reads it with Python's
// own json, which restores every double exactly.
nlohmann::json describe(const ProblemDescription& problem);
nlohmann::json describe(const LoadedProblem& problem);
nlohmann::json describe(const OptimizerRow& row);

inline constexpr std::int64_t kMostBudget = 1'000'000'000'000;

// The arguments that runs and studies have in common.
struct Place {
  std::optional<std::string> out;
  bool another = false;
  unsigned jobs = 1;  // threads
  std::optional<double> time_limit_s;

  // Returns `out`, or results/NAME if it is empty. With `another`, returns the first of NAME,
  // NAME-002, ... that does not exist.
  std::filesystem::path choose(const std::string& name) const;
};

// Returns the value. Throws Error{usage} if it is not from `lower` to `upper`.
std::int64_t check_number(std::string_view name, std::int64_t value, std::int64_t lower,
                          std::int64_t upper);
// Throws Error{usage} for any other text than a schedule.
Schedule parse_schedule(const std::string& text);

}  // namespace armwright::python
