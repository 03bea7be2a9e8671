// Chooses the labels of optimizers to which a plan gives none. The label is the name of the
// optimizer. A plugin whose name is a path or a command gets the name that it states itself, which
// is short enough for tables. Version 1.0 took the path or the command. Plans that it recorded keep
// these labels, because folders of cells and random streams are named after them.
#pragma once

#include <filesystem>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Gives a label to every optimizer without one. If another optimizer has the label already, a
// plugin gets its number too: "mine#2". Two entries of the same name get the same label, which the
// caller refuses. A reference that is an optimizer's name becomes its label.
void choose_labels(StudyPlan& plan);

// Takes over the labels of the recorded plan, for its optimizers to which `plan` gives none. Then
// calls choose_labels(). Throws Error{usage} if the file is not valid and Error{io} if it cannot be
// read.
void adopt_labels(const std::filesystem::path& recorded, StudyPlan& plan);

}  // namespace armwright
