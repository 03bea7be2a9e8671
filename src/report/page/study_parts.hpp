// The parts of a study's page. Only .cpp files include this.
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

// Nine significant digits: what designs and points of fronts need for looking at.
double round_shown(double value);

// StudyProblem. `cells` are the problem's that have ended; `complete` if that is all of them.
nlohmann::json make_study_problem(const StudyPlan& plan, std::size_t problem,
                                  std::span<const CellOutcome> cells, const ProblemResult& result,
                                  const std::filesystem::path& folder);

// StudyFront: nothing of a problem with one objective.
nlohmann::json make_study_front(const StudyPlan& plan, const ProblemDescription& problem,
                                std::span<const CellOutcome> cells, const ProblemResult& result);

nlohmann::json make_study_pairs(std::span<const PairResult> pairs);
nlohmann::json make_friedman(const std::optional<FriedmanTest>& test);

// StudyOverall of the problems that have all their cells, which are those of the result; null if
// there is none. `notes` gets a sentence for what is left out.
nlohmann::json make_study_overall(const StudyPlan& plan, const StudyResult& result,
                                  std::vector<std::string>& notes);

// The plan in words.
nlohmann::json make_study_facts(const StudyPlan& plan);

// ReplaySet of the first problems with an arm: the best designs of the best optimizers and the
// problem's own start, on few cases of the test set and those of `cases` ("test/2:17"). Robots go
// to `robots`, and to `notes` what was left out, for 3 MB at most. Error{usage} for a case that is
// none.
nlohmann::json make_study_replays(const StudyPlan& plan, const StudyResult& result,
                                  const std::filesystem::path& folder,
                                  std::span<const std::string> cases, PageSimulator& simulator,
                                  nlohmann::json& robots, std::vector<std::string>& notes);

// What every optimizer's numbers on a problem are of: its cells, by replicate.
std::vector<const CellOutcome*> list_cells_of(std::span<const CellOutcome> cells,
                                              const std::string& optimizer);

}  // namespace armwright
