// A run's folder as a page reads it: what was asked for, what the journal has so far, the result if
// there is one, and the problem made anew from what the manifest records. Nothing is changed, and
// no lock is taken: another process may be writing. Only .cpp files include this.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

struct RecordedRun {
  std::filesystem::path folder;
  std::string problem_name;
  nlohmann::json configuration;              // the manifest's: "problem", "inputs", "run"
  std::map<std::string, std::string> build;  // of the program that made the run
  std::vector<std::string> command_line;
  std::string started;  // "2026-01-31T12:00:00Z", when the run was begun
  Schedule schedule;
  std::int64_t budget = 0;
  JournalContent journal;
  std::optional<RunResult> result;  // nothing before its end
  // Nothing if it cannot be made as it was; `problem_fault` and `notes` say why.
  std::optional<LoadedProblem> problem;
  std::string problem_fault;
  std::filesystem::path beside;  // where files with relative names are looked for first
  // "--problem", "q1-complex", "--set", ...: what brings `armwright evaluate` to this problem;
  // empty if nothing does.
  std::vector<std::string> problem_words;
  std::vector<std::string> notes;

  // The arm's problem, or null.
  const TrackingProblem* tracking() const { return problem ? problem->tracking() : nullptr; }
  // Of the problem; without it what the result tells: objectives and constraints, no variables.
  ProblemDescription describe() const;
  // The winner's decision vector, or of a run under way the best so far; empty if there is none.
  std::vector<double> find_best() const;
  // The robot's file; relative names of its meshes begin in its folder.
  std::filesystem::path find_urdf() const;
  // "armwright evaluate DESIGN --problem ... WORDS"; empty if no command does.
  std::string make_evaluate_command(const std::string& design,
                                    const std::vector<std::string>& words) const;
};

// Error{usage} if the folder is no run's, Error{bad_data} if its files are not what armwright
// wrote.
RecordedRun read_recorded_run(const std::filesystem::path& folder);

}  // namespace armwright
