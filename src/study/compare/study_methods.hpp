// Reads and checks the parts of a study file about targets and methods. Internal to study/compare.
#pragma once

#include <string>
#include <vector>

#include "base/config.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Completes and checks the targets, once problems and optimizers are loaded. Throws Error{usage}.
void check_targets(StudyPlan& plan);

// Refuses, at the key of `set`, settings of an [[optimizer]] that would change what a design is
// worth. Throws Error{usage}.
void check_method_settings(const ConfigTable& optimizer, const AnySetting& set,
                           const std::vector<std::string>& settings);
// Loads every problem again for each optimizer that has settings of its own. Throws Error{usage} if
// the settings would change how the optimizer's designs are judged.
void load_methods(StudyPlan& plan);

}  // namespace armwright
