// Whether a result is what the journal says.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "study/run_result.hpp"
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

 private:
  RunResult result_;
  std::multimap<std::uint64_t, std::size_t> by_evaluation_;  // -> judged
  std::vector<char> trained_;    // of the judged: its evaluation is recorded as it says
  std::vector<char> validated_;  // likewise
  bool tested_ = false;
};

}  // namespace armwright
