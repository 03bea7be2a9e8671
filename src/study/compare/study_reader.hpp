// Reads a study's file, without loading the problems and optimizers that it names. Internal to this
// module; study_plan.hpp declares study_settings(), read_study_title() and read_study_outline().
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/config.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// The setting of a problem with the description that its program gave of it.
inline constexpr std::string_view kRecordedDescription = "program.description=";

struct NamedOptimizer {
  std::string name;
  std::string label = {};
  std::vector<std::string> options = {};
  bool baseline = false;  // true only in resolved plans
  std::optional<Schedule> schedule = {};
  std::vector<std::string> settings = {};
  // A resolved plan has these two for a plugin and for an optimizer of the program that made it.
  std::string description = {};
  std::vector<std::string> inputs = {};  // "NAME HASH"
  // A resolved plan has these two.
  std::optional<Schedule> own_schedule = {};
  std::string stream = {};
  std::string place = {};   // of the name, "FILE:LINE: KEY"; empty if a flag gives it
  bool is_problem = false;  // the program of a problem (plugin_consent.hpp), no optimizer
};

struct NamedProblem {
  std::string name;
  std::string label = {};
  std::vector<std::string> settings = {};
  std::optional<StudySchedule> schedule = {};
  std::string configuration_sha256 = {};  // as a resolved plan records it; empty: not known
  std::vector<std::string> inputs = {};   // of a program, as NamedOptimizer::inputs
  std::string place = {};                 // as NamedOptimizer::place
};

// The names that file and flags give.
struct RawPlan {
  std::vector<NamedProblem> problems;
  std::vector<NamedOptimizer> optimizers;
  std::vector<std::string> settings;  // of every problem; a problem's own settings replace them
  std::vector<std::string> last_settings;  // of every problem; they replace all others
  std::optional<StudySchedule> schedule;
  bool is_recorded = false;  // the file is a resolved plan: it has a plan_sha256
};

// Reads the file into the returned plan and, for all that needs no loading, into `plan`. Throws
// Error{usage} that names file, line and key, Error{io} for a file that cannot be read.
RawPlan read_study_file(const std::filesystem::path& file, StudyPlan& plan);

// Reads the entries of NamedProblem::inputs and NamedOptimizer::inputs: file -> SHA-256.
std::map<std::string, std::string> read_inputs(std::span<const std::string> inputs);

// Returns the optimizers of a resolved plan. Throws as read_study_file().
std::vector<NamedOptimizer> read_recorded_optimizers(const std::filesystem::path& file);

}  // namespace armwright
