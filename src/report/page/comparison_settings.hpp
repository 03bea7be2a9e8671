// The settings of two runs or two studies that a page compares, and the parts of their basis that
// they share. Only .cpp files include this.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "report/evidence/recorded_run.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

struct OneSetting {
  std::string text;
  std::string basis;  // what of the comparison's basis it belongs to; empty if to nothing
};
using ComparedSettings = std::map<std::string, OneSetting>;

// Two parts of the basis, in words. With both in common, both sides have the same test cases.
inline constexpr const char* kBasisProblem = "the problem";
inline constexpr const char* kBasisTestSet = "the test set";

// Returns what decides the run's course and result.
ComparedSettings list_settings(const RecordedRun& run);
// Returns the settings of a problem of a study. Budget and default optimizer of the problem itself
// count for no study.
ComparedSettings list_settings(const StudyProblem& problem);
// Returns the settings of a study. Those of a problem or an optimizer count only if the other study
// has it, too.
ComparedSettings list_settings(const StudyPlan& plan, const StudyPlan& other);

// Returns the parts of the basis in which both sides differ.
std::set<std::string> list_obstacles(const ComparedSettings& a, const ComparedSettings& b);
// Returns a list of ComparedSetting of web/src/data.ts: one per key of either side, in the order of
// the keys.
nlohmann::json make_compared_settings(const ComparedSettings& a, const ComparedSettings& b);

}  // namespace armwright
