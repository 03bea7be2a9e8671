// Two runs of one cell side by side, to the last bit: does what was found come out again?
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

struct CellDifference {
  std::string where;     // "evaluation 17", "result.json"
  std::string field;     // "x[3]", "winner.candidate"
  std::string recorded;  // "absent" for what is not there
  std::string now;
};

struct CellComparison {
  // What was found to be the same.
  std::size_t evaluations = 0;
  std::size_t judgements = 0;
  std::vector<std::string> files;
  std::optional<CellDifference> difference;  // the first; nothing if the runs are identical
};

// Both folders hold a cell that has ended. Evaluations are taken in the order of their index, as
// threads decide in which order they come into the journal; then judgements; then result.json,
// winner.toml and cell.json. Error{io} or Error{bad_data} names a file that cannot be read.
CellComparison compare_cells(const std::filesystem::path& recorded,
                             const std::filesystem::path& now);

// What the two manifests say that could explain a difference, a sentence each: another version,
// compiler or CPU, another configuration, a changed file. If they say nothing, what is left.
std::vector<std::string> list_likely_causes(const std::filesystem::path& recorded,
                                            const std::filesystem::path& now);

}  // namespace armwright
