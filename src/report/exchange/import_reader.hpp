// Every run of an export and the best it has found, from csv, json or ioh.
#pragma once

#include <filesystem>
#include <vector>

#include "report/exchange/import.hpp"

namespace armwright {

// A run of an export, and its best evaluation if there is a feasible one.
struct ImportedRun {
  ImportedPoint point;
  bool feasible = false;
};

// Error{usage} if the folder holds no export that can be read; Error{bad_data} names the file that
// cannot be used.
std::vector<ImportedRun> read_export(const std::filesystem::path& folder);

}  // namespace armwright
