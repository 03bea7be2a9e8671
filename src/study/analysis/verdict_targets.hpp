// The verdict's sentences on fixed targets. Internal to study/compare.
#pragma once

#include <string>
#include <vector>

#include "study/analysis/study_result.hpp"

namespace armwright {

// "'published' (objective at most 0.0428, at most 0 of 500 test cases failing)"
std::string describe_target(const StudyProblem& problem, const StudyTarget& target);
std::vector<std::string> describe_target_verdict(const StudyPlan& plan, const StudyProblem& problem,
                                                 const ProblemResult& result);

}  // namespace armwright
