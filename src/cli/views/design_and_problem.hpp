// Loads the design, the problem and the cases for the commands that evaluate designs. The
// evaluation itself is in study/run/design_evaluation.hpp.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/terminal/arguments.hpp"
#include "problems/config/design_file.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {

// Returns the cases that the options choose, or the problem's test set. Throws Error{usage} if the
// set has fewer cases than --cases asks for, and the errors of TestSet::load().
ChosenCases choose_cases(const LoadedProblem& problem, const CaseOptions& options);

// Loads the problem named `problem`. If it is empty, loads the problem that the design was
// published for, and says so on stderr unless `quiet`. `overrides` are KEY=VALUE texts. Throws
// Error{usage} if no problem is named and the design was not published, and the errors of
// load_problem().
LoadedProblem load_problem_of_design(const DesignFile& design, const std::string& problem,
                                     std::vector<std::string> overrides, bool quiet);

// Loads a design by name or path, and its problem as load_problem_of_design() does. The name
// "start" is the design from which the problem's optimization starts; it needs a problem.
std::pair<DesignFile, LoadedProblem> load_design_and_problem(const std::string& design,
                                                             const std::string& problem,
                                                             std::vector<std::string> overrides,
                                                             bool quiet);

// Prints each case without a number and the reason on stderr, at most 5 of them. `what` stands in
// front of each line.
void report_failures(std::span<const CaseFailure> failures, const std::string& what);

}  // namespace armwright
