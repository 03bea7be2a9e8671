// What evaluate, sweep, verify and reproduce have in common on the command line; the evaluation
// itself is in study/design_evaluation.hpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/terminal/arguments.hpp"
#include "problems/config/design_file.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {

// Error{usage} if there are not so many cases.
ChosenCases choose_cases(const LoadedProblem& problem, const CaseOptions& options);

// The problem of that name; if there is none, the one that the design was published for, saying so
// on stderr unless `quiet`. Error{usage} if the design was published for none.
LoadedProblem load_its_problem(const DesignFile& design, const std::string& problem,
                               std::vector<std::string> overrides, bool quiet);

// A design by name or path, and the problem to evaluate it under, as above. The name "start" is
// where the problem's own optimization starts.
struct DesignAndProblem {
  DesignFile design;
  LoadedProblem problem;
};
DesignAndProblem load_design_and_problem(const std::string& design, const std::string& problem,
                                         std::vector<std::string> overrides, bool quiet);

// Every case without a number, named with its reason on stderr (the first few of them).
void report_failures(std::span<const CaseFailure> failures, const std::string& what);

}  // namespace armwright
