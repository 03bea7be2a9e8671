#include "cli/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>

#include "base/text.hpp"
#include "cli/format.hpp"

namespace armwright {
namespace {

using Rows = std::vector<VerifyRow>;

constexpr double kMassFactors[] = {0.9, 1, 1.1};

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
                                                std::span<const std::string> engines) {
  std::vector<std::string> its_first = {own.engine};
  std::ranges::copy_if(engines, std::back_inserter(its_first),
                       [&](const std::string& engine) { return engine != own.engine; });
  const std::set<int> substeps = {own.substeps, 1, 2, 5, 10};
  std::vector<VerifySetting> settings = {own};
  for (const std::string& engine : its_first) {
    for (const int count : substeps) {
      for (const double factor : kMassFactors) {
        if (engine != own.engine || count != own.substeps || factor != own.mass_factor) {
          settings.push_back({engine, count, factor});
        }
      }
    }
  }
  return settings;
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
        "{} has no median error even under its own setting: there is nothing that could hold.",
        design);
  }
  Rows engines, substeps, masses, mixed;
  for (const VerifyRow& row : rows.subspan(1)) {
    const bool engine = row.setting.engine != own.setting.engine;
    const bool steps = row.setting.substeps != own.setting.substeps;
    const bool mass = row.setting.mass_factor != own.setting.mass_factor;
    Rows& group = engine + steps + mass > 1 ? mixed : engine ? engines : steps ? substeps : masses;
    group.push_back(row);
  }
  const auto holding = std::ranges::count(rows.subspan(1), Verdict::holds, &VerifyRow::verdict);
  std::string text = fmt::format("{} holds in {} of the {} settings beside its own.", design,
                                 holding, rows.size() - 1);
  text += engines.empty()
              ? std::string(" No other engine is built in.")
              : " Engines:" +
                    describe_all(engines, "in", [](const VerifySetting& s) { return s.engine; });
  text += " Time steps:" + describe_all(substeps, "with", [](const VerifySetting& s) {
            return format_count(static_cast<unsigned long long>(s.substeps), "substep");
          });
  if (!all_hold(substeps)) {
    text +=
        " More substeps are nearer to the real arm, so the design relies on the simulation's"
        " own time step.";
  }
  text += " Masses:" + describe_all(masses, "with", [](const VerifySetting& s) {
            return fmt::format("{:+.0f} %", 100 * (s.mass_factor - 1));
          });
  const auto mixed_holding = std::ranges::count(mixed, Verdict::holds, &VerifyRow::verdict);
  text += fmt::format(" Where several of these change at once, it holds in {} of {}.",
                      mixed_holding, mixed.size());
  return text;
}

}  // namespace armwright
