// Writes the verdict of a study in plain words. The verdict uses only the statistics in the result.
#pragma once

#include <span>
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

// Returns the pair of two optimizers, in either order. It must be among `pairs`.
const PairResult& find_pair(std::span<const PairResult> pairs, std::size_t a, std::size_t b);

// Says whom the first optimizer of `order` beats, who beats it, and who cannot be told apart from
// it. The first sentence begins with `where`, the others with `again`.
std::vector<std::string> describe_standing(const StudyPlan& plan, const std::string& where,
                                           const std::string& again,
                                           std::span<const std::size_t> order,
                                           std::span<const PairResult> pairs);
// Names the pairs with the leader in which the loser has the better median.
std::vector<std::string> describe_medians(const StudyPlan& plan, const ProblemResult& problem);

}  // namespace armwright
