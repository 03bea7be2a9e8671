// Makes the problem of a setting under which a design is verified or checked, and simulates the
// design in it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/verification/verification.hpp"

namespace armwright {

// Returns the problem with these changes, KEY=VALUE texts, in the place of the user's own settings
// with the same keys. Throws Error as load_problem().
using ProblemLoader = std::function<LoadedProblem(const std::vector<std::string>& changes)>;

// Returns the setting in which the problem judges its designs.
VerifySetting get_own_setting(const TrackingProblem& problem);

// The problem of one setting, or the reason why it cannot be made.
struct PreparedSetting {
  VerifySetting setting;             // with the substeps that its springs need
  std::vector<std::string> changes;  // of the problem's settings
  std::optional<LoadedProblem> problem;
  std::string fault;
};

// Makes the problem of a setting. `base` is the problem as it is. Throws Error if the fault is in the
// design's own setting, or if a file cannot be read.
PreparedSetting prepare_setting(const VerifySetting& setting, const LoadedProblem& base,
                                const ProblemLoader& load, bool is_own);

// Simulates the design in a setting that was prepared. Returns nothing if `prepared` has a fault, also
// one that appears now, and if stopped. Throws Error as prepare_setting().
std::optional<ErrorSurvey> survey_setting(PreparedSetting& prepared, const ArmDesign& design,
                                          const ChosenCases& cases, unsigned jobs, StopSignal& stop,
                                          RunObserver& observer, const Progress& progress,
                                          bool is_own);

}  // namespace armwright
