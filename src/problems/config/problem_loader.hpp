// From a name or a TOML file to a problem that is ready to run, with the settings that go with it.
// Everything is validated here, before the first evaluation; messages name file, line, field, value
// and what is allowed. Files that a problem names by a relative path are looked for beside it
// first.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/interface/schedule.hpp"
#include "problems/tracking/tracking_problem.hpp"

namespace armwright {

struct CaseSets {
  std::string training = "train/1";
  std::string validation = "validation/1";
  std::string test = "test/2";
  int validation_cases = 100;
  int test_cases = 500;
};

// What the source of a problem reports of its winner.
struct PublishedWinner {
  std::optional<double> error_m;
  std::optional<double> total_torque_n_m;
  std::string design;
  std::string where;
};

// A sweep of one setting with a given design, without optimization.
struct SweepPlan {
  std::string parameter;  // "task.speed_m_per_s"
  std::vector<double> values;
  std::string design;
};

struct LoadedProblem {
  std::string name;   // also of folders
  std::string title;  // one line
  std::shared_ptr<const Problem> problem;
  // Returns the tracking problem; null for an analytic function. Valid as long as `problem`.
  const TrackingProblem* tracking() const { return problem->tracking(); }
  Schedule schedule;
  int fixed_cases = 5;  // K for optimizers without generations where the schedule needs them
  Racing racing;
  CaseSets sets;
  std::string optimizer;    // what `optimize` uses unless told otherwise
  std::int64_t budget = 0;  // in cases, likewise
  PublishedWinner published;
  std::optional<SweepPlan> sweep;
  // The whole configuration after inheritance and overrides; of engines with SIMD with the level
  // that they use, and of perturbed plants with what a preset says in place of its name.
  std::string resolved_json;
  std::map<std::string, std::string>
      input_hashes;  // file name -> SHA-256 of every file that the configuration refers to
};

// `overrides` are KEY=VALUE texts on top of the file ("task.speed_m_per_s=2"); `engines` are those
// to choose from.
LoadedProblem load_problem(std::string_view name_or_path,
                           std::span<const std::string> overrides = {},
                           std::span<const EngineRow> engines = engine_table());

struct ProblemTitle {
  std::string name;
  std::string title;
};
std::vector<ProblemTitle> list_problems();

}  // namespace armwright
