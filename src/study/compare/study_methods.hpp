// What a study file says of targets and of methods. Internal to study/compare.
#pragma once

#include <string>
#include <vector>

#include "base/config.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// `value`, `reference` and [[target]] of a study file.
void read_targets(const ConfigTable& table, StudyPlan& plan);
// Completes and checks them, once problems and optimizers are loaded. Error{usage}.
void check_targets(StudyPlan& plan);

// `set` of an [[optimizer]]. Error{usage} for a key that would change what is asked of a
// design.
std::vector<std::string> read_method_settings(const ConfigTable& optimizer);
// Loads every problem anew for the optimizers with settings of their own. Error{usage} if one would
// be judged in another way than the others.
void load_methods(StudyPlan& plan);

}  // namespace armwright
