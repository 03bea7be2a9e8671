// Whether a result is what the journal says.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/run/run_result.hpp"
#include "study/survey/journal_survey.hpp"

namespace armwright {

class ResultSurvey {
 public:
  explicit ResultSurvey(RunResult result);

  const RunResult& result() const { return result_; }
  // Each record of the journal.
  void look(const EvaluationRecord& record);
  // After all of them: empty, or the first thing that the journal says otherwise.
  std::string find_difference(const JournalSurvey& journal) const;
  // The number of evaluations in the last row of convergence.csv; nothing if that cannot be told.
  std::optional<std::uint64_t> calc_last_row() const;

 private:
  RunResult result_;
  std::multimap<std::uint64_t, std::size_t> by_evaluation_;  // -> judged
  std::vector<char> trained_;    // of the judged: its evaluation is recorded as it says
  std::vector<char> validated_;  // likewise
  bool tested_ = false;
  // Of the feasible evaluations: the last, the best, and whether some are in generations.
  std::optional<std::uint64_t> last_;
  std::uint64_t last_generation_ = 0;
  std::optional<std::pair<double, std::uint64_t>> best_;
  bool has_generations_ = false;
};

}  // namespace armwright
