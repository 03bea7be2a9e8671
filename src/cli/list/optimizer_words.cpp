#include "cli/list/optimizer_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/text.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {
namespace {

struct Meaning {
  bool Capabilities::*member;
  const char* with;
  const char* without;
};

constexpr std::array<Meaning, kCapabilityNames.size()> kMeanings{{
    {&Capabilities::bounds, "keeps its points within the bounds",
     "may propose points outside the bounds: the nearest point inside is evaluated"},
    {&Capabilities::constraints, "sees the constraints apart from the objective",
     "knows no constraints: their violation is added to the objective where it has an option "
     "constraint_weight, and ignored where it has none"},
    {&Capabilities::multi_objective, "looks for the front of several objectives",
     "minimises one number: of several objectives, their weighted sum"},
    {&Capabilities::batch, "asks for several points at a time, which are simulated in parallel",
     "asks for one point at a time: only its test cases are simulated in parallel"},
    {&Capabilities::noisy, "copes with values that change with the training cases",
     "takes every value for exact"},
    {&Capabilities::residuals, "uses the residuals, of whose squares the objective is the sum",
     "uses no residuals, only the objective"},
    {&Capabilities::stochastic, "draws by chance: another --seed, another run",
     "draws nothing by chance: --seed has no influence"},
    {&Capabilities::generations,
     "works in generations: --schedule fresh:K gives each of them new training cases",
     "wants the same training cases throughout: --schedule fixed:K"},
    {&Capabilities::local,
     "descends from the start and ends by itself: multistart:NAME begins again elsewhere",
     "is no descent that ends by itself: multistart: does not take it"},
    {&Capabilities::sampling, "learns nothing from what it has seen: a yardstick for the others",
     "learns from what it has seen"},
    {&Capabilities::paced,
     "divides the budget up beforehand: a larger one changes the run from its beginning",
     "does not plan with the budget: a larger one only makes the run longer"},
}};

static_assert(std::ranges::all_of(kCapabilityNames, [](const CapabilityName& capability) {
  return std::ranges::count(kMeanings, capability.member, &Meaning::member) == 1;
}));

// 1e+12 rather than a row of noughts.
std::string format_bound(double value) {
  const std::string brief = fmt::format("{:g}", value);
  return parse_finite(brief) == value ? brief : format_exact(value);
}

}  // namespace

const std::vector<CapabilityWords>& capability_words() {
  static const std::vector<CapabilityWords> words = [] {
    std::vector<CapabilityWords> all;
    for (const auto& [name, member] : kCapabilityNames) {
      const auto& found = *std::ranges::find(kMeanings, member, &Meaning::member);
      all.push_back({name, member, found.with, found.without});
    }
    return all;
  }();
  return words;
}

std::vector<std::string> list_capabilities(const Capabilities& capabilities) {
  std::vector<std::string> names;
  for (const CapabilityWords& words : capability_words()) {
    if (capabilities.*words.member) {
      names.emplace_back(words.name);
    }
  }
  return names;
}

std::string describe_capability(const OptimizerRow& row, const CapabilityWords& words) {
  const bool has = row.capabilities.*words.member;
  if (words.member == &Capabilities::constraints && !has) {
    const bool weighs = std::ranges::count(row.options, "constraint_weight", &OptionSpec::name) > 0;
    return weighs ? "knows no constraints: their violation, times constraint_weight, is added to "
                    "the objective"
                  : "knows no constraints and ignores them";
  }
  return has ? words.with : words.without;
}

std::vector<std::string> list_requirements(const Requirements& requirements) {
  std::vector<std::string> list;
  if (requirements.objectives > 1) {
    list.push_back(fmt::format("at least {} objectives", requirements.objectives));
  }
  if (requirements.variables > 1) {
    list.push_back(fmt::format("at least {} decision variables", requirements.variables));
  }
  if (requirements.residuals) {
    list.emplace_back("residuals (all robot problems have them)");
  }
  return list;
}

std::string describe_isolation(const OptimizerRow& row) {
  if (row.isolated.empty()) {
    return "in armwright's own process";
  }
  constexpr const char* kElsewhere =
      "in a process of its own, where a hang or a crash costs this run and nothing else";
  return row.isolated == "always"
             ? kElsewhere
             : fmt::format("{} {}, otherwise in armwright's own", row.isolated, kElsewhere);
}

const char* get_option_type(const OptionValue& value) {
  constexpr const char* kNames[] = {"true or false", "integer", "number", "text"};
  return kNames[value.index()];
}

std::string describe_range(const OptionSpec& option) {
  if (std::holds_alternative<std::int64_t>(option.fallback)) {
    return fmt::format("{:.0f} to {:.0f}", option.lower, option.upper);
  }
  if (std::holds_alternative<double>(option.fallback)) {
    return fmt::format("{} to {}", format_bound(option.lower), format_bound(option.upper));
  }
  return "";
}

}  // namespace armwright
