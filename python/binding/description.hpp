// What the package shows of problems and optimizers, as JSON: it reads them with Python's own json,
// which reads every double back as it was.
#pragma once

#include <nlohmann/json.hpp>

#include "optimizers/interface/optimizer.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright::python {

nlohmann::json describe(const ProblemDescription& problem);
nlohmann::json describe(const LoadedProblem& problem);
nlohmann::json describe(const OptimizerRow& row);

}  // namespace armwright::python
