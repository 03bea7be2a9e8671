// Whether a design holds where nothing that matters of the arm has changed: under other physics
// engines, finer time steps and slightly different masses. Settings to try, a verdict on each, and
// what follows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/summary.hpp"

namespace armwright {

// What a design is simulated under.
struct VerifySetting {
  std::string engine;
  int substeps = 1;
  double mass_factor = 1;  // on top of the problem's own
};

// `own` combined with every engine, 1, 2, 5 and 10 substeps (and its own number of them), and
// masses of -10 %, 0 and +10 %. `own` comes first, its engine before the others.
std::vector<VerifySetting> list_verify_settings(const VerifySetting& own,
                                                std::span<const std::string> engines);

enum class Verdict { holds, worse, fails };
const char* to_string(Verdict verdict);

// Above these ratios of its median error to that under its own setting a design is worse, or fails.
inline constexpr double kWorseRatio = 1.1;
inline constexpr double kFailRatio = 10;

struct VerifyRow {
  VerifySetting setting;
  ErrorSummary summary;
  std::optional<double> ratio;  // of the medians, to its own setting
  Verdict verdict = Verdict::holds;
};

// fails: more cases fail than under its own setting, there is no median, or it exceeds kFailRatio
// times its own; worse: the median exceeds kWorseRatio times its own; holds: otherwise.
VerifyRow judge_setting(const VerifySetting& setting, const ErrorSummary& summary,
                        const ErrorSummary& own);

// A paragraph in plain words. The first row is the design's own setting.
std::string conclude(const std::string& design, std::span<const VerifyRow> rows);

}  // namespace armwright
