// Whether a design holds where nothing that matters of the arm has changed: under other physics
// engines, finer time steps, slightly different masses and perturbed plants. Settings to try, a
// verdict on each, and what follows.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/statistics/summary.hpp"

namespace armwright {

// What a design is simulated under.
struct VerifySetting {
  std::string engine;
  int substeps = 1;
  double mass_factor = 1;  // on top of the problem's own
  // A preset of perturbed plants, "none" (kNoPerturbation), or "" for the problem's own ones.
  std::string perturbation = "none";

  bool operator==(const VerifySetting&) const = default;
};

inline constexpr const char* kNoPerturbation = "none";
inline constexpr const char* kLighter = "lighter";  // all masses -10 %, not drawn
inline constexpr const char* kHeavier = "heavier";  // +10 %

// What is combined with what. Plants: kNoPerturbation, kLighter, kHeavier and names of presets.
struct VerifyMatrix {
  std::vector<std::string> engines;
  std::vector<int> substeps;
  std::vector<std::string> plants;
  std::vector<std::string> own_plants;  // only under the design's own engine and substeps
};
inline const std::vector<int> kUsualSubsteps = {1, 2, 5, 10};
inline const std::vector<std::string> kUsualPlants = {kNoPerturbation, kLighter, kHeavier};

// All combinations, each once. `own` comes first, its engine before the others.
std::vector<VerifySetting> list_verify_settings(const VerifySetting& own,
                                                const VerifyMatrix& matrix);
// "0 %", "-10 %", or the preset's name; "own" for the problem's own plants.
std::string describe_plant(const VerifySetting& setting);

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
