// Checks whether a design holds, that is, whether it works about as well under conditions that
// differ little from its own: other physics engines, finer time steps, slightly different masses,
// and perturbed plants.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/statistics/summary.hpp"

namespace armwright {

// One set of conditions that a design is simulated under.
struct VerifySetting {
  std::string engine;
  int substeps = 1;
  double mass_factor = 1;  // multiplies the problem's own factor
  // A preset of perturbed plants, "none" (kNoPerturbation), or "" for the problem's own plants.
  std::string perturbation = "none";

  bool operator==(const VerifySetting&) const = default;
};

inline constexpr const char* kNoPerturbation = "none";
inline constexpr const char* kLighter = "lighter";  // all masses -10 %, the same in all cases
inline constexpr const char* kHeavier = "heavier";  // all masses +10 %

// The conditions that are combined with each other. Plants are kNoPerturbation, kLighter, kHeavier
// and names of presets.
struct VerifyMatrix {
  std::vector<std::string> engines;
  std::vector<int> substeps;
  std::vector<std::string> plants;
  std::vector<std::string> own_plants;  // tried only with the design's own engine and substeps
};
inline const std::vector<int> kUsualSubsteps = {1, 2, 5, 10};
inline const std::vector<std::string> kUsualPlants = {kNoPerturbation, kLighter, kHeavier};

// Returns all combinations, each once. `own`, the design's own setting, is the first, and its
// engine comes before the others.
std::vector<VerifySetting> list_verify_settings(const VerifySetting& own,
                                                const VerifyMatrix& matrix);
// Returns "masses -10 %", the preset's name, or "own" for the problem's own plants.
std::string describe_plant(const VerifySetting& setting);

enum class Verdict { holds, worse, fails };
const char* to_string(Verdict verdict);

// Limits of the ratio between the median error in a setting and the median error in the design's
// own setting. Above the first limit the design is worse, above the second it fails.
inline constexpr double kWorseRatio = 1.1;
inline constexpr double kFailRatio = 10;

// The result of one setting.
struct VerifyRow {
  VerifySetting setting;
  ErrorSummary summary;
  std::optional<double> ratio;  // of its median error to that in the design's own setting
  Verdict verdict = Verdict::holds;
};

// Returns the verdict on one setting. It is `fails` if more cases fail than in the design's own
// setting, if there is no median, or if the ratio exceeds kFailRatio. It is `worse` if the ratio
// exceeds kWorseRatio, and `holds` otherwise.
VerifyRow judge_setting(const VerifySetting& setting, const ErrorSummary& summary,
                        const ErrorSummary& own);

// Returns the conclusion as one paragraph. The first row must be the design's own setting.
std::string conclude(const std::string& design, std::span<const VerifyRow> rows);

}  // namespace armwright
