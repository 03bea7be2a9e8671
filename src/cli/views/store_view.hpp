// What `armwright doctor` says of a folder, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/terminal/terminal.hpp"
#include "study/survey/store_repair.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {

// FOLDER.repaired.
std::filesystem::path choose_repaired_folder(const std::filesystem::path& folder);

// What is intact, what is not, and what to do. `program`: as it was called.
std::string describe_survey(const StoreSurvey& survey, const std::string& program,
                            const Style& style);
nlohmann::json to_json(const StoreSurvey& survey, const std::string& program);

// What a repair has kept and dropped, and how to go on. `copy`: what is in it now.
std::string describe_repair(const StoreRepair& repair, const StoreSurvey& copy,
                            const std::string& program);
nlohmann::json to_json(const StoreRepair& repair, const StoreSurvey& copy,
                       const std::string& program);

}  // namespace armwright
