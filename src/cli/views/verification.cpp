#include "cli/views/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <vector>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"

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

}  // namespace

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

std::string describe_check(const std::optional<WinnerCheck>& check, const Style& style) {
  if (!check) {
    return style.bold("Under other conditions") + "\n  " +
           style.yellow("not checked; armwright verify checks it") + "\n";
  }
  std::string text = style.bold("Under other conditions") +
                     fmt::format(" (the first {} of {}; own error {} mm, at most {} mm works)\n",
                                 format_count(check->own.cases, "case"), sanitize(check->test_set),
                                 format_mm(check->own.mean), format_mm(check->limit_m));
  Table table({{"", false}, {"", false}, {"", false}});
  for (const CheckedSetting& checked : check->settings) {
    table.add_row({name_row(checked, *check), describe_outcome(checked, check->limit_m),
                   checked.verdict == Verdict::missing ? sanitize(checked.fault)
                   : checked.summary.mean              ? format_mm(checked.summary.mean) + " mm"
                                                       : ""});
  }
  std::istringstream lines(table.format(style, 2));
  std::string line;
  for (const CheckedSetting& checked : check->settings) {
    std::getline(lines, line);
    text += (checked.verdict == Verdict::fails   ? style.red(line)
             : checked.verdict == Verdict::worse ? style.yellow(line)
                                                 : line) +
            "\n";
  }
  return text;
}

}  // namespace armwright
