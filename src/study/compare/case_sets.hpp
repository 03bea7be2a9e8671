// The sets of test cases that a study uses, and that no case is in two of them.
#pragma once

#include <string>
#include <vector>

#include "study/compare/study_plan.hpp"

namespace armwright {

struct UsedSet {
  std::string problem;  // label
  std::string role;     // "training", "validation", "test"
  std::string name;
  int cases = 0;  // the first of the set; of a fresh schedule as many as the budget could reach, of
                  // bred ones those that breeding begins with
  std::string sha256;  // of their points; empty for a function, which has none
};

// Problem by problem: test, validation, then every replicate's training set.
std::vector<UsedSet> list_used_sets(const StudyPlan& plan);

// Error{usage} if there are more than a million test cases to look at, or if one is in two sets of
// a problem: what was learnt would be tested, or two replicates be the same.
void check_sets_are_disjoint(const StudyPlan& plan);

}  // namespace armwright
