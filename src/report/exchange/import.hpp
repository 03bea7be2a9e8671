// Reads the best decision vector of an export.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

// Selects runs of an export. An empty field selects all.
struct ImportChoice {
  std::optional<std::string> problem = {};
  std::optional<std::string> label = {};
  std::optional<std::uint64_t> replicate = {};
};

// A run of an export with its best feasible evaluation.
struct ImportedRun {
  std::string problem;
  std::string label;
  std::uint64_t replicate = 1;
  bool feasible = false;  // without a feasible evaluation, the next fields have no meaning
  std::uint64_t evaluation = 0;
  double objective = 0;
  std::vector<std::string> variables;
  std::vector<double> x;
};

// Returns every run of an export as csv, json or ioh. An export as ioh may also be the folder of
// one label. Throws Error{usage} if the folder holds none of these; Error{bad_data} names the file
// that cannot be used; Error{io}.
std::vector<ImportedRun> read_export(const std::filesystem::path& folder);

// Returns the run with the best feasible evaluation among the chosen runs of an export, the first
// of equals. Throws Error{usage} if no run matches the choice, none of them found anything
// feasible, or they are runs on several problems, whose objectives cannot be compared; and what
// read_export() throws.
ImportedRun import_best(const std::filesystem::path& folder, const ImportChoice& choice);

}  // namespace armwright
