// Reads the configuration of a reproduction (configs/reproductions/*.toml): which problems the
// source optimized without printing the designs, which parameter it swept, and which figures it
// shows.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace armwright {

// A result to reproduce: one design on the test set of one problem.
struct ReproductionPart {
  // published: a shipped design with a printed error. unpublished: a shipped design without one.
  // anew: the winner of a run of the reproduction. sweep: a shipped design at one value of a sweep.
  enum class Kind { published, unpublished, anew, sweep };
  Kind kind = Kind::published;
  std::string label;   // unique: "A.10 (E6)", "E1", "q4-speed 0.5"
  std::string design;  // a shipped one; empty for the winner of `run`
  std::string run;     // the name of the run's problem, and of its folder
  std::string problem;
  std::vector<std::string> overrides;  // KEY=VALUE
  std::optional<double> published_error_m;
  std::optional<double> published_torque_n_m;
  std::string where;            // the place in the source
  std::optional<double> value;  // of a sweep
};

// A distance response: mean errors over the length of the move.
struct ResponseFigureConfig {
  std::string id;
  std::string title;
  std::string thesis;  // "Fig. 6.4"
  std::string remark;
  std::vector<std::pair<std::string, std::string>> series;  // name, and label of the part it shows
};

// A replay: the design of the published part `of` under its conditions, and other designs.
struct ReplayConfig {
  std::string id;
  std::string title;
  std::string of;                   // a part's label
  std::vector<std::string> beside;  // the other designs
  std::string training_case;        // "train/1:1"
};

struct ReproductionConfig {
  std::string title;
  std::string remark;     // whole sentences on what was optimized anew
  std::string optimizer;  // of the runs
  std::uint64_t seed = 1;
  std::string engine;  // for training and judging the runs
  std::vector<std::string>
      overrides;  // KEY=VALUE texts for all problems but those of published designs
  // The next three are incomplete: the plan completes them.
  std::vector<ReproductionPart> runs;           // label and problem
  std::vector<ReproductionPart> unpublished;    // designs whose errors the source does not print
  std::vector<ReproductionPart> reevaluations;  // winners of runs under other conditions
  std::string sweep;                            // a problem with [sweep]
  std::vector<ResponseFigureConfig> figures;
  std::map<std::string, std::string> reasons;  // why results differ; by the part's label
  std::vector<ReplayConfig> replays;
  // Errors over time in the first case of a replay: name, and id of the replay.
  std::vector<std::pair<std::string, std::string>> momentary;
};

// Loads a shipped configuration by name, or a file. Throws Error{usage} with file, line, field and
// what is allowed.
ReproductionConfig load_reproduction_config(const std::string& name_or_path);

}  // namespace armwright
