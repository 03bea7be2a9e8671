// Gives the functions of an export their numbers and names, for formats that number functions.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/formats/run_traces.hpp"

namespace armwright {

// The numbers of functions. cocopp treats 1 to 92 as functions without noise and gives 1 to 24 the
// names of its own groups; therefore the first number is 25 and the format coco ends at 92.
inline constexpr std::size_t kFirstOwnFunction = 72;  // of problems that are not shipped ones
inline constexpr std::size_t kLastCocoFunction = 92;

// A function of an export: problems that differ in nothing but their number of variables.
struct ExportFunction {
  std::size_t id = 0;
  std::string name;                          // different for every function of the export
  std::vector<const ProblemRuns*> problems;  // by number of variables
};

// Returns the number of a shipped problem, from 25 to 71. The numbers never change: a new problem
// gets the next free one. Returns nothing for other names.
std::optional<std::size_t> find_function_id(std::string_view problem);

// Returns the functions, by number. A shipped problem with its own settings has the number of
// find_function_id() and its own name. All others have the numbers from kFirstOwnFunction on, in
// the order of the study's plan, and the name of the problem's label. The pointers are valid as
// long as `runs`. Throws what load_problem() throws.
std::vector<ExportFunction> number_functions(const CollectedRuns& runs);

}  // namespace armwright
