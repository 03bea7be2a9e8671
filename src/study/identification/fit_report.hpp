// The files that an identification leaves in its run's folder beside those of every run:
//   plant.toml           the robot's plant and what is uncertain (problems/config/plant_file.hpp)
//   identification.json  parameters with intervals, errors per joint, correlations, what is not
//                        determined, and the efforts of each motion (at most 1000 samples)
#pragma once

#include <map>
#include <string>
#include <vector>

#include "study/identification/fit_analysis.hpp"

namespace armwright {

struct IdentificationFiles {
  std::string plant, identification;
};
// `input_hashes` are those of the problem, `is_converged` whether the optimizer ended by itself.
IdentificationFiles make_identification_files(
    const IdentificationProblem& problem, std::span<const double> x,
    const std::map<std::string, std::string>& input_hashes, bool is_converged);
// Returns identification.json: doubts (list_doubts), parameters with intervals, errors per joint,
// correlations, what is not determined, and each motion with its recorded and modelled efforts. A
// motion is thinned to at most 1000 samples, but not below 25 per second.
std::string to_json(const IdentificationProblem& problem, std::span<const double> x,
                    const FitAnalysis& analysis, const std::vector<std::string>& doubts);

// Returns what a user should know before anything else, one sentence each: parameters at the end of
// their box, an optimizer that ended early, a fit that is no better than what was there. Empty if
// there is nothing.
std::vector<std::string> list_doubts(const FitAnalysis& analysis, bool is_converged);

}  // namespace armwright
