// Reads a run's folder for a page: the configuration, the journal so far, the result if the run has
// ended, and the problem, which is rebuilt from the manifest. The folder may belong to a run in
// progress: this code changes nothing in it and takes no lock. Only .cpp files include this.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"
#include "study/run/run_result.hpp"

namespace armwright {

// The contents of a run's folder.
struct RecordedRun {
  std::filesystem::path folder;
  std::string problem_name;
  nlohmann::json configuration;              // of the manifest: "problem", "inputs", "run"
  std::map<std::string, std::string> build;  // of the program that started the run
  std::vector<std::string> command_line;
  std::string started;  // "2026-01-31T12:00:00Z"
  Schedule schedule;
  std::int64_t budget = 0;
  JournalContent journal;
  std::optional<RunResult> result;  // empty before the end of the run
  // Empty if it cannot be rebuilt as it was; `problem_fault` and `notes` say why. Also empty for an
  // identification: its page needs neither the problem nor the logs, which may be gone.
  std::optional<LoadedProblem> problem;
  std::string problem_fault;
  std::filesystem::path input_folder;  // the first place to look for files with relative names
  // The arguments that make `armwright evaluate` use this problem: "--problem", "q1-complex",
  // "--set", ...; empty if no arguments do.
  std::vector<std::string> problem_arguments;
  std::vector<std::string> notes;  // whole sentences for the page

  // Returns the arm's problem; null for a function and if the problem cannot be rebuilt.
  const TrackingProblem* tracking() const { return problem ? problem->tracking() : nullptr; }
  // Returns whether the problem is an arm, also if it cannot be rebuilt.
  bool has_arm() const { return tracking() != nullptr || (result && result->tracking); }
  // Returns whether the run looked for a robot's plant in recorded motions.
  bool is_identification() const;
  // Returns Quantity of web/src/data.ts. Without an arm the page shows it in its own unit.
  nlohmann::json make_quantity(const Quantity& quantity) const;
  // Returns the problem's description. Without the problem it has what the result records:
  // objectives and constraints, but no variables.
  ProblemDescription describe() const;
  // Returns the winner's decision vector, for an unfinished run the incumbent's; empty if there is
  // none.
  std::vector<double> find_best() const;
  // Returns the robot's file. Relative names of meshes refer to its folder. Throws Error{usage} if
  // the file is missing.
  std::filesystem::path find_urdf() const;
  // Returns the robot with which the run was made, as its file has it, without loads. It needs no
  // other file of the problem. Throws Error if the robot's file is missing or not valid any more.
  RobotModel load_robot() const;
  // Returns the command that began the run, without the program's folder.
  std::string make_begin_command() const;
  // Returns "armwright evaluate DESIGN --problem ... ARGUMENTS", or an empty text if
  // `problem_arguments` is empty.
  std::string make_evaluate_command(const std::string& design,
                                    const std::vector<std::string>& arguments) const;
};

// Throws Error{usage} if the folder is not a run's; Error{bad_data} if its files are not what
// armwright wrote.
RecordedRun read_recorded_run(const std::filesystem::path& folder);

}  // namespace armwright
