#include "cli/views/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"

namespace armwright {
namespace {

using Rows = std::vector<VerifyRow>;

// "2", "2 and 5", "2, 5 and 10"
std::string enumerate(const std::vector<std::string>& words) {
  if (words.size() < 2) {
    return join(words, "");
  }
  return join(std::vector(words.begin(), words.end() - 1), ", ") + " and " + words.back();
}

std::string describe(const VerifyRow& row, const std::string& name) {
  if (!row.ratio) {
    return name;
  }
  return fmt::format("{} (median {} times as large)", name, format_significant(*row.ratio, 3));
}

// "It holds with A and B. It gets worse with C (median 1.3 times as large). It fails with D."
std::string describe_all(const Rows& rows, const std::string& preposition,
                         const std::function<std::string(const VerifySetting&)>& name) {
  const auto list = [&](Verdict verdict, const std::string& verb, bool with_ratio) {
    std::vector<std::string> names;
    for (const VerifyRow& row : rows) {
      if (row.verdict == verdict) {
        names.push_back(with_ratio ? describe(row, name(row.setting)) : name(row.setting));
      }
    }
    return names.empty() ? std::string()
                         : fmt::format(" It {} {} {}.", verb, preposition, enumerate(names));
  };
  return list(Verdict::holds, "holds", false) + list(Verdict::worse, "gets worse", true) +
         list(Verdict::fails, "fails", true) +
         list(Verdict::missing, "could not be simulated", false);
}

struct Counts {
  std::size_t holding = 0, simulated = 0, missing = 0;
};

Counts count_verdicts(std::span<const VerifyRow> rows) {
  Counts counts;
  for (const VerifyRow& row : rows) {
    counts.holding += row.verdict == Verdict::holds ? 1 : 0;
    ++(row.verdict == Verdict::missing ? counts.missing : counts.simulated);
  }
  return counts;
}

bool is_bad(const VerifyRow& row) {
  return row.verdict == Verdict::worse || row.verdict == Verdict::fails;
}

template <class Has>
bool any_plant(const RobotModel& robot, const Has& has) {
  return std::ranges::any_of(robot.joints, [&](const Joint& joint) { return has(joint.plant); });
}

bool has_friction(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.has_friction(); });
}

bool has_armature(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.armature > 0; });
}

bool is_elastic(const RobotModel& robot) {
  return any_plant(robot, [](const JointPlant& plant) { return plant.is_elastic(); });
}

bool is_rigid_with_armature(const RobotModel& robot) {
  return has_armature(robot) && !is_elastic(robot);
}

bool lacks_armature(const RobotModel& robot) {
  return !has_armature(robot);
}

constexpr const char* kNoArmature =
    "no joint of the robot has an armature (robot.plant); try added-rotors";
// Half of the inertia that a joint moves: an assumption. The rotors of a PUMA 560 have more than
// half of its shoulder's inertia.
constexpr double kAddedArmatureShare = 0.5;
// The motors of the axes 1 to 3 of a KUKA KR300 swing at 12 to 15 Hz: their stiffnesses are 4.1 to
// 7.5e6 N m/rad, their armatures 609 to 844 kg m^2 (Weigand et al., 2021).
constexpr double kElastic_hz = 15;

}  // namespace

std::vector<VerifySetting> list_verify_settings(const VerifySetting& own,
                                                const VerifyMatrix& matrix) {
  std::vector<std::string> engines = matrix.engines;
  std::ranges::stable_partition(engines,
                                [&](const std::string& engine) { return engine == own.engine; });
  std::vector<VerifySetting> settings = {own};
  const auto add = [&](const std::string& engine, int substeps, const std::string& plant) {
    VerifySetting setting{engine, substeps, 1, plant};
    if (plant == kLighter || plant == kHeavier) {
      setting.mass_factor = plant == kLighter ? 0.9 : 1.1;
      setting.perturbation = own.perturbation;
    }
    if (std::ranges::find(settings, setting) == settings.end()) {
      settings.push_back(std::move(setting));
    }
  };
  for (const std::string& engine : engines) {
    for (const int substeps : std::set(matrix.substeps.begin(), matrix.substeps.end())) {
      for (const std::string& plant : matrix.plants) {
        add(engine, substeps, plant);
      }
    }
  }
  for (const std::string& plant : matrix.own_plants) {
    add(own.engine, own.substeps, plant);
  }
  return settings;
}

const std::vector<OtherPlant>& other_plants() {
  static const std::vector<OtherPlant> plants = {
      {"more-friction",
       "friction x 2",
       {.friction = 2},
       has_friction,
       "no joint of the robot has friction (<dynamics>, robot.plant); the preset friction adds "
       "some"},
      {"lighter-rotors", "rotors -50 %", {.armature = 0.5}, has_armature, kNoArmature},
      {"heavier-rotors", "rotors +50 %", {.armature = 1.5}, has_armature, kNoArmature},
      {"added-rotors",
       "rotors added",
       {.armature_share = kAddedArmatureShare},
       lacks_armature,
       "a joint of the robot has an armature; try heavier-rotors"},
      {"softer",
       "stiffness -50 %",
       {.stiffness = 0.5},
       is_elastic,
       "no joint of the robot is elastic (robot.plant); try elastic or elastic-rotors"},
      {"elastic",
       "elastic",
       {.elastic_hz = kElastic_hz},
       is_rigid_with_armature,
       "no joint of the robot has an armature, or one is elastic (robot.plant); try "
       "elastic-rotors or softer"},
      {"elastic-rotors",
       "elastic, rotors added",
       {.armature_share = kAddedArmatureShare, .elastic_hz = kElastic_hz},
       lacks_armature,
       "a joint of the robot has an armature; try elastic or softer"}};
  return plants;
}

const OtherPlant* find_other_plant(const std::string& name) {
  const auto found = std::ranges::find(other_plants(), name, &OtherPlant::name);
  return found == other_plants().end() ? nullptr : &*found;
}

std::string describe_plant(const VerifySetting& setting) {
  if (const OtherPlant* plant = find_other_plant(setting.perturbation)) {
    return plant->words;
  }
  if (setting.mass_factor != 1) {
    return fmt::format("masses {:+.0f} %", 100 * (setting.mass_factor - 1));
  }
  return setting.perturbation.empty() ? "own" : setting.perturbation;
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::worse:
      return "worse";
    case Verdict::fails:
      return "fails";
    case Verdict::missing:
      return "not simulated";
  }
  return "?";
}

VerifyRow judge_setting(const VerifySetting& setting, const ErrorSummary& summary,
                        const ErrorSummary& own) {
  VerifyRow row{setting, summary, {}, Verdict::holds};
  if (summary.median && own.median && *own.median > 0) {
    row.ratio = *summary.median / *own.median;
  }
  if (!summary.median || summary.failures > own.failures || row.ratio > kFailRatio) {
    row.verdict = Verdict::fails;
  } else if (row.ratio > kWorseRatio) {
    row.verdict = Verdict::worse;
  }
  return row;
}

VerifyRow make_missing_row(const VerifySetting& setting, const std::string& fault) {
  return {setting, {}, {}, Verdict::missing, fault};
}

std::string conclude(const std::string& design, std::span<const VerifyRow> rows) {
  const VerifyRow& own = rows.front();
  if (!own.summary.median) {
    return fmt::format(
        "{} has no median error even in its own setting, so the other settings say nothing.",
        design);
  }
  Rows engines, substeps, masses, plants, mixed;
  for (const VerifyRow& row : rows.subspan(1)) {
    const bool engine = row.setting.engine != own.setting.engine;
    const bool steps = !row.setting.springs && row.setting.substeps != own.setting.substeps;
    const bool mass = row.setting.mass_factor != own.setting.mass_factor;
    const bool plant = row.setting.perturbation != own.setting.perturbation;
    Rows& group = engine + steps + mass + plant > 1 ? mixed
                  : engine                          ? engines
                  : steps                           ? substeps
                  : mass                            ? masses
                                                    : plants;
    group.push_back(row);
  }
  const Counts all = count_verdicts(rows.subspan(1));
  std::string text = all.simulated == 0
                         ? fmt::format("{} was simulated in no setting beside its own.", design)
                         : fmt::format("{} holds in {} of the {} settings beside its own.", design,
                                       all.holding, all.simulated);
  if (all.missing > 0) {
    text += fmt::format(" {} could not be simulated.", format_count(all.missing, "setting"));
  }
  const auto add = [&](const std::string& title, const Rows& group, const std::string& preposition,
                       const std::function<std::string(const VerifySetting&)>& name) {
    text +=
        group.empty() ? "" : fmt::format(" {}:{}", title, describe_all(group, preposition, name));
  };
  add("Engines", engines, "in", [](const VerifySetting& s) { return s.engine; });
  add("Time steps", substeps, "with", [](const VerifySetting& s) {
    return format_count(static_cast<unsigned long long>(s.substeps), "substep");
  });
  if (std::ranges::any_of(substeps, is_bad)) {
    text +=
        " More substeps are closer to the real arm, so the design depends on the time step of the"
        " simulation.";
  }
  add("Masses", masses, "with",
      [](const VerifySetting& s) { return fmt::format("{:+.0f} %", 100 * (s.mass_factor - 1)); });
  add("Other plants", plants, "with", [](const VerifySetting& s) { return describe_plant(s); });
  if (const Counts counts = count_verdicts(mixed); counts.simulated > 0) {
    text += fmt::format(" If several of these change at once, it holds in {} of {} settings.",
                        counts.holding, counts.simulated);
  }
  return text;
}

}  // namespace armwright
