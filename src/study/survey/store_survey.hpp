// The integrity of everything below a folder that armwright made: a run, a study with its cells, a
// reproduction with its runs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/survey/run_survey.hpp"

namespace armwright {

struct StoreSurvey {
  enum class Kind { run, study, reproduction };
  std::filesystem::path folder;
  Kind kind = Kind::run;
  std::string writer;                                // who writes it now; empty if nobody
  std::vector<Finding> findings;                     // of files that belong to no run
  std::vector<std::filesystem::path> damaged_files;  // of these, those that are made again
  bool is_record_lost = false;  // the run's manifest, the study's or the reproduction's record
  std::vector<RunSurvey> runs;  // by name; of a run it alone
  // Of a study.
  std::size_t planned_cells = 0;   // 0 if the plan cannot be read
  std::size_t finished_cells = 0;  // with a cell.json that can be read

  bool is_damaged() const;
};
const char* to_string(StoreSurvey::Kind kind);  // "run", "study", "reproduction"

// Error{usage} if the folder is none of these; Error{io}.
StoreSurvey survey_store(const std::filesystem::path& folder);

// The words that go on with what is in `folder`, having been begun elsewhere perhaps. `program`:
// how the program is called. Empty if it is not known.
std::vector<std::string> make_command(const StoreSurvey& survey, const std::string& program,
                                      const std::filesystem::path& folder);

// What can be done where the record is lost, which no repair brings back: whole sentences.
std::string advise_on_lost_record(const StoreSurvey& survey, const std::string& program);

}  // namespace armwright
