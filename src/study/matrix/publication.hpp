// Puts a finished cell in its place, cells/PROBLEM/OPTIMIZER/rNN: by one rename, which fails where
// something is, so that of any number of finished ones exactly one gets there.
#pragma once

#include <filesystem>

#include "study/compare/study_plan.hpp"

namespace armwright {

enum class Publication {
  published,
  superfluous,  // another one was there before; cells are deterministic, so it is as good
};

// `run`: the finished cell, on the study's file system. An unfinished one in its place is moved to
// `aside` first. Error{busy} if a local comparison writes that one at this moment; Error{bad_data}
// if what is there is another cell's; Error{io}.
Publication publish_cell(const StudyPlan& plan, const Cell& cell,
                         const std::filesystem::path& study, const std::filesystem::path& run,
                         const std::filesystem::path& aside);

}  // namespace armwright
