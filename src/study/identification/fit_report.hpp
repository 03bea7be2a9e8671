// The files that an identification leaves in its run's folder beside those of every run.
#pragma once

#include <string>

#include "study/identification/fit_analysis.hpp"

namespace armwright {

// Returns identification.json: parameters with intervals, errors per joint, correlations, what is
// not determined, and the residuals of each motion (thinned to at most 1000 samples).
std::string to_json(const IdentificationProblem& problem, std::span<const double> x,
                    const FitAnalysis& analysis);

// Returns what a user should know before anything else, one sentence each: parameters at the end of
// their box, an optimizer that ended early, a fit that is no better than what was there. Empty if
// there is nothing.
std::vector<std::string> list_doubts(const FitAnalysis& analysis, bool is_converged);

}  // namespace armwright
