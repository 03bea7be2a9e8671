// Writes the verdict of a study in plain words. The verdict uses only the statistics in the result.
#pragma once

#include <string>
#include <vector>

#include "study/analysis/study_result.hpp"

namespace armwright {

// Returns one or two sentences per line: first each problem, then all problems together, then the
// limits of the verdict.
std::vector<std::string> describe_verdict(const StudyPlan& plan, const StudyResult& result);

// Returns "'published' (objective at most 0.0428, at most 0 of 500 test cases failing)".
std::string describe_target(const StudyProblem& problem, const StudyTarget& target);
// Returns the verdict's sentences on the fixed targets of one problem.
std::vector<std::string> describe_target_verdict(const StudyPlan& plan, const StudyProblem& problem,
                                                 const ProblemResult& result);

// Returns the verdict's sentences on what the optimizers saw and did, where they differ.
std::vector<std::string> describe_methods(const StudyPlan& plan, const StudyResult& result);

// Returns "a, b and c".
std::string join_names(std::vector<std::string> names);

// Returns "= 0.0004" or "< 1e-06".
std::string format_p(double p);

}  // namespace armwright
