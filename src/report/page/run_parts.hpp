// Makes the parts of a run's page as JSON (web/src/data.ts). Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/evidence/recorded_run.hpp"
#include "study/compare/incumbents.hpp"

namespace armwright {

// Returns a list of Fact: the run's settings and how it ended, as label and value.
nlohmann::json make_run_facts(const RecordedRun& run);

// Returns one RequirementLight per requirement: whether the winner meets it on the test set. Empty
// without a winner.
nlohmann::json make_requirements(const RecordedRun& run);

// Consecutive training evaluations of a journal: a generation, or a block of equal length for an
// optimizer without generations.
struct HistoryPart {
  std::uint64_t index = 0;  // of the generation, or number of the last evaluation, from 1
  std::int64_t cases = 0;   // of the budget, up to the end of the part
  std::size_t first = 0;    // the place of the first evaluation in the journal
  std::size_t count = 0;    // of evaluations
};

// The training of a run in parts.
struct History {
  bool by_generation = false;
  std::size_t left_out = 0;  // generations that are not shown
  std::vector<HistoryPart> parts;
};

// Returns at most 1000 generations (every n-th and the last) or at most 400 blocks.
History divide_history(const RecordedEvaluations& training);

// Returns Headline: what the run recorded of its result and effort. Fields without a record are null.
nlohmann::json make_headline(const RecordedRun& run, const History& history);

// Returns at most `most` incumbents, evenly spread, with the first and the last.
std::vector<Incumbent> thin_out(const std::vector<Incumbent>& incumbents, std::size_t most);

// Returns Training with the given incumbents.
nlohmann::json make_training(const RecordedRun& run, const History& history,
                             nlohmann::json incumbents);
// Returns a list of VariableHistory; empty if the problem cannot be rebuilt.
nlohmann::json make_variables(const RecordedRun& run, const History& history);
// Returns RunFront; null for a single objective or without a result.
nlohmann::json make_front(const RecordedRun& run);

// Returns a list of WinnerLimit: the winner's constraints on the test set. Empty without a winner.
nlohmann::json make_limits(const RecordedRun& run);
// Returns a list of WinnerMetric. Empty without a winner and for an arm, whose page has them already.
nlohmann::json make_metrics(const RecordedRun& run);
// Returns a list of FailureReason: how often training evaluations had no number, by reason, the
// most frequent first.
nlohmann::json make_failure_reasons(const RecordedRun& run);
// Returns Importance: which variables matter (study/analysis/importance.hpp). Null before the end of
// the run, for an identification, and if the problem cannot be rebuilt.
nlohmann::json make_importance(const RecordedRun& run);
// Sets "record" and "files" of the page from the files that the run recorded of its winner. Adds a
// note for each file that is not shown. Throws Error{bad_data} if a file differs from its checksum.
void add_winner_record(const RecordedRun& run, nlohmann::json& page,
                       std::vector<std::string>& notes);

// Sets "identification" (Identification) and the title of the page of a run that has found a robot's
// plant, and adds its arm with the recorded motions. Does nothing for other runs. Adds a note if the
// arm cannot be shown. Throws Error{bad_data} if identification.json is damaged.
void add_identification(const RecordedRun& run, nlohmann::json& page,
                        std::vector<std::string>& notes);

// Adds the arm that moves as planned, and record_limits, the limits of the signals by their names, if
// the run planned a motion.
void add_planned_motion(const RecordedRun& run, nlohmann::json& page,
                        std::vector<std::string>& notes);

}  // namespace armwright
