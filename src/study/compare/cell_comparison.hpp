// Compares two runs of one cell bit by bit, to show whether a recorded result can be reproduced.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

// One difference between the two runs.
struct CellDifference {
  std::string where;     // "evaluation 17", "result.json"
  std::string field;     // "x[3]", "winner.candidate"
  std::string recorded;  // "absent" if the field is missing
  std::string now;
};

struct CellComparison {
  // Counts and names of the parts that are identical.
  std::size_t evaluations = 0;
  std::size_t judgements = 0;
  std::vector<std::string> files;
  std::optional<CellDifference> difference;  // the first one; nothing if the runs are identical
};

// Compares two folders that each hold a finished cell. Evaluations are compared first, in the order
// of their index, because threads decide their order in the journal. Judgements follow, then
// result.json, winner.toml and cell.json. Throws Error{io} or Error{bad_data} that names a file
// which cannot be read.
CellComparison compare_cells(const std::filesystem::path& recorded,
                             const std::filesystem::path& now);

// Returns one sentence per difference between the two manifests that could explain different
// results: another version, compiler or CPU, another configuration, a changed file. If the
// manifests agree, one sentence lists the causes that remain. Throws Error{bad_data} or Error{io}.
std::vector<std::string> list_likely_causes(const std::filesystem::path& recorded,
                                            const std::filesystem::path& now);

}  // namespace armwright
