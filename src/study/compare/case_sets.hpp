// Lists the sets of test cases that a study uses, and checks that no two of them share a case.
#pragma once

#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

// One set of test cases of one problem.
struct UsedSet {
  std::string problem;  // label
  std::string role;     // "training", "validation", "test"
  std::string name;
  // Number of cases at the beginning of the set that the study uses. For a fresh schedule: as many
  // as the budget can pay for, but at most 10 000. For bred cases: those that breeding begins with.
  int cases = 0;
  std::string sha256;  // of the cases' points; empty for a function, which has no points
};

// Returns the sets problem by problem: test, validation, then the training set of each replicate.
std::vector<UsedSet> list_used_sets(const StudyPlan& plan);

// Throws Error{usage} if one test case is in two sets of a problem. Designs would then be tested on
// cases that they trained on, or two replicates would share cases. Also throws Error{usage} if the
// plan has more than a million test cases to compare. Generates every case and keeps its hash.
void check_sets_are_disjoint(const StudyPlan& plan);

}  // namespace armwright
