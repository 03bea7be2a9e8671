// A study's folder as the commands find it that run, merge or look at cells: the plan that it
// records, which must come out here as it was recorded.
#pragma once

#include <filesystem>
#include <string>

#include "study/compare/study_plan.hpp"

namespace armwright {

struct RecordedStudy {
  std::filesystem::path folder;
  StudyPlan plan;
};

// `name`: a study's folder, or the study.toml in it. Error{usage} for anything else, and where an
// optimizer, a plugin or a version of ours makes another plan of it.
RecordedStudy load_recorded_study(const std::filesystem::path& name);

}  // namespace armwright
