// Makes the parts of a study's page as JSON (web/src/data.ts). Only .cpp files include this.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/evidence/page_simulator.hpp"
#include "study/analysis/study_result.hpp"

namespace armwright {

// Rounds to nine significant digits, which are enough to show designs and points of fronts.
double round_shown(double value);

// Returns StudyProblem. `cells` are the problem's finished cells.
nlohmann::json make_study_problem(const StudyPlan& plan, std::size_t problem,
                                  std::span<const CellOutcome> cells, const ProblemResult& result,
                                  const std::filesystem::path& folder);

// Returns StudyFront; null for a problem with one objective.
nlohmann::json make_study_front(const StudyPlan& plan, const StudyProblem& problem,
                                std::span<const CellOutcome> cells, const ProblemResult& result);

nlohmann::json make_study_pairs(std::span<const PairResult> pairs);
nlohmann::json make_friedman(const std::optional<FriedmanTest>& test);

// Returns StudyOverall of the problems with all of their cells; null if there is no such problem.
// `notes` gets a sentence for each part that is left out.
nlohmann::json make_study_overall(const StudyPlan& plan, const StudyResult& result,
                                  std::vector<std::string>& notes);

// Returns a list of Fact that describes the plan.
nlohmann::json make_study_facts(const StudyPlan& plan);

// Returns a list of ReplaySet for the first problems with an arm. Each shows the best designs of
// the best optimizers and the problem's own start, on a few cases of the test set and on `cases`
// ("test/2:17"). The replays have at most 3 MB. `robots` gets the robots, and `notes` a sentence on
// what is left out. Throws Error{usage} if one of `cases` is not a case; WorkStopped.
nlohmann::json make_study_replays(const StudyPlan& plan, const StudyResult& result,
                                  const std::filesystem::path& folder,
                                  std::span<const std::string> cases, PageSimulator& simulator,
                                  nlohmann::json& robots, std::vector<std::string>& notes);

// Returns an optimizer's cells among a problem's cells, sorted by replicate.
std::vector<const CellOutcome*> list_cells_of(std::span<const CellOutcome> cells,
                                              const std::string& optimizer);

}  // namespace armwright
