// What a study file says of targets and of methods. Internal to study/compare.
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
// Loads every problem anew for the optimizers with settings of their own. Error{usage} if one would
// be judged in another way than the others.
void load_methods(StudyPlan& plan);

}  // namespace armwright
