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
         list(Verdict::fails, "fails", true);
}

bool all_hold(std::span<const VerifyRow> rows) {
  return std::ranges::all_of(rows,
                             [](const VerifyRow& row) { return row.verdict == Verdict::holds; });
}

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

std::string describe_plant(const VerifySetting& setting) {
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
    const bool steps = row.setting.substeps != own.setting.substeps;
    const bool mass = row.setting.mass_factor != own.setting.mass_factor;
    const bool plant = row.setting.perturbation != own.setting.perturbation;
    Rows& group = engine + steps + mass + plant > 1 ? mixed
                  : engine                          ? engines
                  : steps                           ? substeps
                  : mass                            ? masses
                                                    : plants;
    group.push_back(row);
  }
  const auto holding = std::ranges::count(rows.subspan(1), Verdict::holds, &VerifyRow::verdict);
  std::string text = fmt::format("{} holds in {} of the {} settings beside its own.", design,
                                 holding, rows.size() - 1);
  const auto add = [&](const std::string& title, const Rows& group, const std::string& preposition,
                       const std::function<std::string(const VerifySetting&)>& name) {
    text +=
        group.empty() ? "" : fmt::format(" {}:{}", title, describe_all(group, preposition, name));
  };
  add("Engines", engines, "in", [](const VerifySetting& s) { return s.engine; });
  add("Time steps", substeps, "with", [](const VerifySetting& s) {
    return format_count(static_cast<unsigned long long>(s.substeps), "substep");
  });
  if (!all_hold(substeps)) {
    text +=
        " More substeps are closer to the real arm, so the design depends on the time step of the"
        " simulation.";
  }
  add("Masses", masses, "with",
      [](const VerifySetting& s) { return fmt::format("{:+.0f} %", 100 * (s.mass_factor - 1)); });
  add("Perturbed plants", plants, "with", describe_plant);
  if (!mixed.empty()) {
    const auto mixed_holding = std::ranges::count(mixed, Verdict::holds, &VerifyRow::verdict);
    text += fmt::format(" If several of these change at once, it holds in {} of {} settings.",
                        mixed_holding, mixed.size());
  }
  return text;
}

}  // namespace armwright
