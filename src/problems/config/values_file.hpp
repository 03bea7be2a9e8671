// The file of a decision vector of a problem without an arm, as TOML: one table [[variable]] per
// variable with name and value, or word for a category. The winner.toml of such a run is one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// A number with its name and unit, or the word of a category.
struct FileValue {
  Quantity quantity;
  double value = 0;
  std::string word = {};  // of a category; empty for numbers
};

struct ValuesFile {
  std::string title;
  std::string source;
  std::vector<FileValue> variables;
  std::vector<FileValue> objectives;  // on the test set; for people
};

// Returns the values as a file that load_values() reads back bit for bit.
std::string to_toml(const ValuesFile& file);
// Throws Error{bad_data} that names file, line and key, and Error{io}.
ValuesFile load_values(const std::filesystem::path& path);
// Returns the values of a decision vector, in the order of the variables.
std::vector<FileValue> list_values(const std::vector<DecisionVariable>& variables,
                                   const std::vector<double>& x);
// Returns the decision vector. Throws Error{bad_data} if a variable is missing or unknown, or if its
// value is outside of the bounds or none of its type.
std::vector<double> read_values(const ValuesFile& file, const std::filesystem::path& path,
                                const std::vector<DecisionVariable>& variables);

}  // namespace armwright
