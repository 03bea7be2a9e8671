// Names the random streams of a plan's optimizers. The name of a stream depends on what the
// optimizer is: its name, its options, its own schedule and its own settings. It does not depend on
// the label, so another label does not change a result.
#pragma once

#include <filesystem>

#include "study/compare/study_plan.hpp"

namespace armwright {

// Gives a name to the stream of every optimizer that has none. A second optimizer that is the same
// as another one gets its occurrence number, "...-2". Throws Error{usage} if two optimizers have
// been given the same stream.
void name_streams(StudyPlan& plan);

// Takes over the streams of the recorded plan, for the optimizers that it has. The others get names
// as in name_streams(). Throws Error{usage} if the file is not valid and Error{io} if it
// cannot be read.
void adopt_streams(const std::filesystem::path& recorded, StudyPlan& plan);

}  // namespace armwright
