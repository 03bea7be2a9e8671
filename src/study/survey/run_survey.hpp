// The integrity of one run's folder: manifest, journal, and whether what was derived from the
// journal says what it says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/survey/journal_survey.hpp"
#include "study/survey/run_survey.hpp"

namespace armwright {

struct RunSurvey {
  enum class State {
    begun,     // it has not come to its end: the same command goes on
    finished,  // its result is there
    failed     // its optimizer failed: the same command tries again
  };
  std::filesystem::path name;  // as seen from the folder that was asked about; "." for itself
  State state = State::begun;
  std::string writer;                     // who writes it now; empty if nobody
  std::vector<std::string> command_line;  // that began it, as recorded; may be empty
  std::string made_by;  // as result.json has it: "q1-complex --optimizer ga --seed 1"; or empty
  std::vector<Finding> findings;         // files as seen from the run's folder
  bool is_manifest_lost = false;         // no repair brings it back
  std::optional<JournalSurvey> journal;  // nothing if there is none that can be read
  bool is_journal_unreadable = false;
  std::vector<std::string> damaged_files;  // derived ones: they can be made again

  // Evaluations that were recorded once and must be made again, as far as can be told.
  std::uint64_t lost = 0;

  bool is_damaged() const;
};
const char* to_string(RunSurvey::State state);  // "unfinished", "finished", "failed"

// Files that a run derives from its journal, and a comparison from its cell.
const std::vector<std::string>& derived_file_names();

// `name`: what the survey is to say. Error{io} only if the folder itself cannot be read.
RunSurvey survey_run(const std::filesystem::path& folder, const std::filesystem::path& name = ".");

// Whether a folder holds a run, damaged or not.
bool is_run_folder(const std::filesystem::path& folder);

}  // namespace armwright
