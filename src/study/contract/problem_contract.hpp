// The contract of problems: what every problem must do. It answers the same question with the same
// numbers, in any order and in any process, and with finite numbers within its bounds.
// `armwright check-problem` runs this suite over a user's problem.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "study/contract/contract.hpp"

namespace armwright {

struct ProblemTrial {
  // Loads the problem again, with processes of its own.
  std::function<LoadedProblem()> load;
  std::size_t cases = 2;  // training cases per design, at most as many as the problem has; >= 1
  unsigned jobs = 2;      // threads that simulate at the same time; >= 1
};

struct ProblemCheck {
  const char* name;     // one word for tests: "Repeatable"
  const char* promise;  // "same design and case, same answer"
  const char* advice;   // what to do if the promise is broken
  ContractFinding (*run)(const ProblemTrial& trial);
};

// The checks in the order in which a problem is best mended.
const std::vector<ProblemCheck>& problem_checks();

// Runs one check. An exception of the problem counts as `broken`. Adds the advice to the detail of
// what is broken. An answer against the protocol ends the checks (ContractFinding::ends).
ContractFinding run_problem_check(const ProblemCheck& check, const ProblemTrial& trial);

}  // namespace armwright
