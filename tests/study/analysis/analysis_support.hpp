// Cells with chosen values, for tests of the analysis.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "study/analysis/study_result.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Returns a plan that compares these optimizers on the sphere.
inline StudyPlan make_sphere_plan(std::vector<std::string> optimizers, int replicates) {
  StudyRequest request;
  request.problems = {"sphere"};
  request.optimizers = std::move(optimizers);
  request.settings = {"function.dimension=3"};
  request.replicates = replicates;
  request.budget = 1000;
  request.baselines = false;
  return make_study_plan(request);
}

inline CellOutcome make_value_cell(const StudyPlan& plan, std::size_t optimizer, int replicate,
                                   double value) {
  CellOutcome cell;
  cell.problem = plan.problems.front().label;
  cell.optimizer = plan.optimizers[optimizer].label;
  cell.replicate = replicate;
  cell.cases = static_cast<std::uint64_t>(plan.budget);
  cell.value = cell.validation_value = value;
  cell.start_value = 100;
  cell.curve = {{plan.budget, value, 0}};
  cell.trace = {{plan.budget, value, 0}};
  return cell;
}

// Analyzes the sphere with these values: one row per optimizer, one number per replicate.
inline StudyResult analyze_values(const StudyPlan& plan,
                                  const std::vector<std::vector<double>>& values) {
  StudyResult result;
  for (std::size_t o = 0; o < values.size(); ++o) {
    for (std::size_t r = 0; r < values[o].size(); ++r) {
      result.cells.push_back(make_value_cell(plan, o, static_cast<int>(r) + 1, values[o][r]));
    }
  }
  result.problems = {analyze_problem(plan, 0, result.cells)};
  return result;
}

}  // namespace armwright
