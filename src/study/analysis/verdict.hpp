// The verdict in plain words, from the statistics and nothing else.
#pragma once

#include <string>
#include <vector>

#include "study/analysis/study_result.hpp"

namespace armwright {

// One sentence or two a line: problem by problem, then over problems, then what limits it.
std::vector<std::string> describe_verdict(const StudyPlan& plan, const StudyResult& result);

// "= 0.0004", "< 1e-06"
std::string format_p(double p);

}  // namespace armwright
