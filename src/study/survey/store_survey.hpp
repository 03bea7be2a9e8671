// Surveys the integrity of a store and everything in it. A store is a folder that armwright made: a
// run, a study with its cells, or a reproduction with its runs.
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
  std::string writer;                                // process that writes it now; empty if none
  std::vector<Finding> findings;                     // about files outside of runs
  std::vector<std::filesystem::path> damaged_files;  // those of them that are derived again
  bool is_record_lost = false;  // manifest.json, study.toml or reproduction.json is lost
  std::vector<RunSurvey> runs;  // sorted by name; a run has only itself
  // Only for a study.
  std::size_t planned_cells = 0;   // 0 if the plan cannot be read
  std::size_t finished_cells = 0;  // cells with a cell.json that can be read

  bool is_damaged() const;
};
// Returns "run", "study" or "reproduction".
const char* to_string(StoreSurvey::Kind kind);

// Throws Error{usage} if the folder is not a store, or Error{io}.
StoreSurvey survey_store(const std::filesystem::path& folder);

// Returns the command line that resumes the store in `folder`, which may be a copy of the surveyed
// folder. `program` is the command that starts armwright. Returns no words if the command is
// unknown.
std::vector<std::string> make_command(const StoreSurvey& survey, const std::string& program,
                                      const std::filesystem::path& folder);

// Returns advice, in whole sentences, for a store whose record is lost, which no repair can
// restore.
std::string advise_on_lost_record(const StoreSurvey& survey, const std::string& program);

}  // namespace armwright
