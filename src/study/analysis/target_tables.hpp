// The tables of fixed targets and of failed test cases, and their parts of result.json. Internal to
// study/compare.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "study/analysis/study_result.hpp"

namespace armwright {

// A row a problem, target and optimizer: successes, expected running time, ratio to the reference.
std::string make_targets_table(const StudyPlan& plan, const StudyResult& result);
// A row a run and checkpoint: what the design chosen by then is worth on the test set.
std::string make_choices_table(const StudyResult& result);
// A row a problem and optimizer: shares of failing test cases.
std::string make_failures_table(const StudyPlan& plan, const StudyResult& result);

nlohmann::json target_times_to_json(const StudyPlan& plan, const ProblemResult& problem,
                                    const OptimizerResult& one);
nlohmann::json failures_to_json(const OptimizerResult& one);

}  // namespace armwright
