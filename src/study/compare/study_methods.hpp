// Reads and checks the parts of a study file about targets and methods. Internal to study/compare.
#pragma once

#include <string>
#include <vector>

#include "base/config.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Reads `value`, `reference` and every [[target]] of a study file. Throws Error{usage}.
void read_targets(const ConfigTable& table, StudyPlan& plan);
// Completes and checks the targets after problems and optimizers are loaded. Throws Error{usage}.
void check_targets(StudyPlan& plan);

// Reads `set` of an [[optimizer]]. Throws Error{usage} for a key that would change the requirements
// on a design.
std::vector<std::string> read_method_settings(const ConfigTable& optimizer);
// Loads every problem again for each optimizer that has settings of its own. Throws Error{usage} if
// the settings would change how the optimizer's designs are judged.
void load_methods(StudyPlan& plan);

}  // namespace armwright
