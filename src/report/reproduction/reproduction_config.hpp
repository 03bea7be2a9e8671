// What a shipped reproduction (configs/reproductions/*.toml) says: what its source optimized
// without printing the designs, what it swept, and which figures it made of all that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

struct AnewConfig {
  std::string label;  // "E1"
  std::string problem;
};

// A shipped design of which its source prints no error.
struct UnpublishedConfig {
  std::string label;
  std::string design;
  std::string problem;
  std::optional<double> total_torque_n_m;
  std::string where;
};

// The winner of a run under other conditions than those it was optimized for.
struct ReevaluationConfig {
  std::string label;  // "E4, IK bug off"
  std::string run;    // its problem
  std::vector<std::string> overrides;
  std::string where;
};

// A figure of average errors over the distance. `of` is the label of what is drawn: of a published
// result, a run or a re-evaluation.
struct ResponseFigureConfig {
  struct Series {
    std::string name;
    std::string of;
  };
  std::string id;
  std::string title;
  std::string thesis;  // "Fig. 6.4"
  std::string remark;
  std::vector<Series> series;
};

// Motions to look at: the design of the published result `of` under its conditions, beside others.
struct ReplayConfig {
  std::string id;
  std::string title;
  std::string of;
  std::vector<std::string> beside;  // designs
  std::string training_case;        // "train/1:1"
};

// A momentary error that is drawn over the time, of the first case of a replay.
struct MomentaryConfig {
  std::string name;
  std::string replay;
};

struct ReproductionConfig {
  std::string title;
  std::string remark;  // whole sentences on what was optimized anew
  std::string optimizer;
  std::uint64_t seed = 1;
  std::string engine;  // that the runs are trained and judged with
  std::vector<AnewConfig> runs;
  std::vector<UnpublishedConfig> unpublished;
  std::vector<ReevaluationConfig> reevaluations;
  std::string sweep;  // a problem with a sweep of its own
  std::vector<ResponseFigureConfig> figures;
  std::vector<ReplayConfig> replays;
  std::vector<MomentaryConfig> momentary;
};

// A shipped one by name, or a file. Error{usage} names file, line, field and what is allowed.
ReproductionConfig load_reproduction_config(const std::string& name_or_path);

}  // namespace armwright
