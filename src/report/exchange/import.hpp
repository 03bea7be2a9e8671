// The way back: the best decision vector out of an export.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

// Which runs to look at; nothing: all.
struct ImportChoice {
  std::optional<std::string> problem = {};
  std::optional<std::string> label = {};
  std::optional<std::uint64_t> replicate = {};
};

// The best feasible evaluation of a run.
struct ImportedPoint {
  std::string problem;
  std::string label;
  std::uint64_t replicate = 1;
  std::uint64_t evaluation = 0;
  double objective = 0;
  std::vector<std::string> variables;
  std::vector<double> x;
};

// The best of the runs that are chosen, the first of equals, from an export as csv, json or ioh (of
// all labels, or the folder of one). Error{usage} if the folder holds none of these, no run suits
// the choice, none of them found anything feasible, or they are runs on several problems, whose
// objectives cannot be compared. Error{bad_data} names the file that cannot be used.
ImportedPoint import_best(const std::filesystem::path& folder, const ImportChoice& choice);

}  // namespace armwright
