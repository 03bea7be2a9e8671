// Surveys the integrity of one run's folder: its manifest, its journal, and whether the derived
// files agree with the journal.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "study/run/run_folder.hpp"
#include "study/survey/journal_survey.hpp"

namespace armwright {

// One thing that a survey found in a folder. Its text is for people, not for programs.
struct Finding {
  enum class Kind {
    note,    // not a fault
    damage,  // a repair makes a copy without it
    loss     // damage that no repair can remove
  };
  Kind kind = Kind::note;
  std::filesystem::path file;  // relative to the surveyed folder
  std::string what;
};

// Returns whether anything has this name, including a symbolic link whose target is missing.
inline bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

struct RunSurvey {
  enum class State {
    begun,     // the run has not ended; the same command resumes it
    finished,  // the run has a result
    failed     // its optimizer failed; the same command tries again
  };
  std::filesystem::path name;  // relative to the surveyed folder; "." if that is the run itself
  State state = State::begun;
  std::string writer;                     // process that writes it now; empty if there is none
  std::vector<std::string> command_line;  // that began the run, as recorded; may be empty
  std::string made_by;  // from result.json: "q1-complex --optimizer ga --seed 1"; may be empty
  std::vector<Finding> findings;         // with files relative to the run's folder
  bool is_manifest_lost = false;         // no repair can restore it
  bool is_asked = false;                 // its evaluations are told (armwright ask)
  bool has_checksums = false;            // the run has begun with checksums
  std::optional<JournalSurvey> journal;  // empty if there is no journal that can be read
  bool is_journal_unreadable = false;
  std::vector<std::string> damaged_files;  // derived files and SHA256SUMS, which are made again

  // Number of evaluations that were recorded once and must be simulated again, as far as known.
  std::uint64_t lost = 0;

  bool is_damaged() const;
  // Returns whether a copy needs a new journal.
  bool is_journal_damaged() const;
};
// Returns "unfinished", "finished" or "failed".
const char* to_string(RunSurvey::State state);

// Surveys a run's folder; `name` becomes RunSurvey::name. Throws Error{io} only if the folder
// itself cannot be read.
RunSurvey survey_run(const std::filesystem::path& folder, const std::filesystem::path& name = ".");

// Returns whether a folder holds a run, damaged or not.
bool is_run_folder(const std::filesystem::path& folder);

}  // namespace armwright
