// Checks whether a design holds, that is, whether it works about as well under conditions that
// differ little from its own: other physics engines, finer time steps, slightly different masses,
// perturbed plants, and other friction, rotors and elasticity.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

// One set of conditions that a design is simulated under.
struct VerifySetting {
  std::string engine;
  int substeps = 1;
  double mass_factor = 1;  // multiplies the problem's own factor
  // A preset of perturbed plants, "none" (kNoPerturbation), a name of other_plants(), or "" for the
  // problem's own plants.
  std::string perturbation = "none";
  // Whether the substeps are the fewest that the springs of the plant allow. Then they are a part
  // of the plant, and no change of the time step.
  bool springs = false;

  bool operator==(const VerifySetting&) const = default;
};

inline constexpr const char* kNoPerturbation = "none";
inline constexpr const char* kLighter = "lighter";  // all masses -10 %, the same in all cases
inline constexpr const char* kHeavier = "heavier";  // all masses +10 %
// The presets of the short check.
inline constexpr const char* kFrictionPreset = "friction";
inline constexpr const char* kSensorPreset = "sensor";

inline constexpr int kMostSubsteps = 1000;  // that the key physics.substeps may have

// A plant whose friction, rotors or elasticity differ from the robot's, the same in all cases.
struct OtherPlant {
  std::string name;     // "more-friction"
  std::string words;    // "friction x 2"
  PlantScales changes;  // beside the problem's own; `friction`, `armature` and `stiffness` multiply
  // Returns whether the robot has what the plant changes.
  bool (*suits)(const RobotModel& robot);
  const char* lack;  // why it cannot be made for another robot
};
const std::vector<OtherPlant>& other_plants();
const OtherPlant* find_other_plant(const std::string& name);  // null: none has that name

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

// The substeps of the short check, as far as they are more than the own ones.
inline const std::vector<int> kCheckSubsteps = {2, 10};
// Returns the settings of the short check at the end of a run. Each differs from the own setting in
// one condition: another one of `engines`, more substeps, the masses, friction, or a sensor. With 10
// substeps or more of its own, twice as many are tried.
std::vector<VerifySetting> list_check_settings(const VerifySetting& own,
                                               const std::vector<std::string>& engines);

// Returns "masses -10 %", the words of another plant, the preset's name, or "own" for the problem's
// own plants.
std::string describe_plant(const VerifySetting& setting);

// `missing`: the setting could not be simulated.
enum class Verdict { holds, worse, fails, missing };
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
  std::string fault = {};  // why it could not be simulated
};

// Returns the verdict on one setting. It is `fails` if more cases fail than in the design's own
// setting, if there is no median, or if the ratio exceeds kFailRatio. It is `worse` if the ratio
// exceeds kWorseRatio, and `holds` otherwise.
VerifyRow judge_setting(const VerifySetting& setting, const ErrorSummary& summary,
                        const ErrorSummary& own);

// Returns the row of a setting that could not be simulated.
VerifyRow make_missing_row(const VerifySetting& setting, const std::string& fault);

}  // namespace armwright
