// A bash script that runs cells of a study chunk by chunk: by itself, as the entries of a batch
// system's job array, or under GNU parallel.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "study/matrix/chunks.hpp"

namespace armwright {

struct CellScriptRequest {
  std::filesystem::path study;
  std::filesystem::path program;       // absolute
  std::filesystem::path folder;        // to run in: plans may name files relative to it
  std::optional<std::string> configs;  // ARMWRIGHT_CONFIGS
  unsigned jobs = 1;                   // threads a cell
};

std::string make_cell_script(const StudyPlan& plan, std::span<const Chunk> chunks,
                             const CellScriptRequest& request);

}  // namespace armwright
