// The findings of `armwright doctor FOLDER`, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/terminal/terminal.hpp"
#include "study/survey/store_repair.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {

// Returns FOLDER.repaired, the default folder of a repaired copy.
std::filesystem::path choose_repaired_folder(const std::filesystem::path& folder);

// Returns what is intact, what is damaged and what to do. `program` is the program's name as the
// user typed it.
std::string describe_survey(const StoreSurvey& survey, const std::string& program,
                            const Style& style);
nlohmann::json to_json(const StoreSurvey& survey, const std::string& program);

// Returns what a repair has kept and dropped, and the command that resumes the copy. `copy` is the
// survey of the copy.
std::string describe_repair(const StoreRepair& repair, const StoreSurvey& copy,
                            const std::string& program);
nlohmann::json to_json(const StoreRepair& repair, const StoreSurvey& copy,
                       const std::string& program);

}  // namespace armwright
