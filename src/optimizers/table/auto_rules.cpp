#include "optimizers/table/auto_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/table/multistart.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

const Setting<std::string> kRuleUse{
    "use", kNoDefault, "optimizer of armwright's own, as multistart:nlopt:bobyqa (not auto)"};
const Setting<std::vector<std::string>> kRuleOptions{"options", std::vector<std::string>{},
                                                     "options of that optimizer, as KEY=VALUE"};
const Setting<std::string> kRuleWhy{"why", kNoDefault, "reason of the choice, one sentence"};
// The features that need more than a comparison.
constexpr std::size_t kEvaluations = 2, kChangingCases = 9, kRugged = 10;
static_assert(std::string_view(kAutoFeatures[kEvaluations].name) == "evaluations");
static_assert(std::string_view(kAutoFeatures[kChangingCases].name) == "changing_cases");
static_assert(std::string_view(kAutoFeatures[kRugged].name) == "rugged");

constexpr std::string_view kAtLeast = "_at_least";
constexpr std::string_view kAtMost = "_at_most";

// The keys of one feature. A flag has the first, a number the others.
struct FeatureSettings {
  explicit FeatureSettings(const AutoFeature& feature)
      : flag(feature.name, kNoDefault, feature.meaning),
        at_least(feature.name + std::string(kAtLeast), Range{.lower = 0, .upper = 1e15}, kNoDefault,
                 feature.meaning),
        at_most(feature.name + std::string(kAtMost), Range{.lower = 0, .upper = 1e15}, kNoDefault,
                feature.meaning) {}

  Setting<bool> flag;
  Setting<double> at_least, at_most;
};

const std::vector<FeatureSettings>& feature_settings() {
  static const std::vector<FeatureSettings> all(kAutoFeatures.begin(), kAutoFeatures.end());
  return all;
}

const SettingTable& rule_settings() {
  static const SettingTable table = [] {
    SettingTable rule{
        .key = "rule", .is_array = true, .settings = {&kRuleUse, &kRuleOptions, &kRuleWhy}};
    for (std::size_t i = 0; i < kAutoFeatures.size(); ++i) {
      const FeatureSettings& own = feature_settings()[i];
      if (kAutoFeatures[i].is_flag) {
        rule.settings.push_back(&own.flag);
      } else {
        rule.settings.insert(rule.settings.end(), {&own.at_least, &own.at_most});
      }
    }
    return rule;
  }();
  return table;
}

OptimizerRow find_used(const ConfigTable& table) {
  constexpr std::string_view kMultistart = "multistart:";
  const std::string name = table.get(kRuleUse);
  if (name == "auto") {
    table.refuse(kRuleUse, "it must be another optimizer, because auto cannot choose itself");
  }
  try {
    return name.starts_with(kMultistart)
               ? make_multistart_row(find_optimizer(name.substr(kMultistart.size())))
               : find_optimizer(name);
  } catch (const Error& error) {
    table.refuse(kRuleUse, error.what());
  }
}

std::vector<AutoCondition> read_conditions(const ConfigTable& table) {
  std::vector<AutoCondition> conditions;
  for (std::size_t i = 0; i < kAutoFeatures.size(); ++i) {
    const FeatureSettings& own = feature_settings()[i];
    AutoCondition condition{.feature = i};
    if (kAutoFeatures[i].is_flag) {
      if (const auto wanted = table.find(own.flag)) {
        condition.lower = condition.upper = *wanted ? 1 : 0;
        conditions.push_back(condition);
      }
      continue;
    }
    const auto lower = table.find(own.at_least);
    const auto upper = table.find(own.at_most);
    if (lower && upper && *lower > *upper) {
      table.refuse(own.at_most, fmt::format("it must be at least {}, which is {}", own.at_least.key,
                                            format_exact(*lower)));
    }
    if (lower || upper) {
      condition.lower = lower.value_or(condition.lower);
      condition.upper = upper.value_or(condition.upper);
      conditions.push_back(condition);
    }
  }
  return conditions;
}

AutoRule read_rule(const ConfigTable& table) {
  AutoRule rule{.row = find_used(table),
                .options = table.get(kRuleOptions),
                .why = table.get(kRuleWhy),
                .conditions = read_conditions(table)};
  try {
    Options::parse(rule.row.name, rule.row.options, rule.options);
  } catch (const Error& error) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {}", table.describe_place(kRuleOptions), error.what()));
  }
  if (rule.why.empty() || !rule.why.ends_with('.')) {
    table.refuse(kRuleWhy, "it must be a sentence that ends with a period");
  }
  return rule;
}

// Returns why the optimizer cannot work on some problem or in some run; empty if it can.
std::string explain_narrow(const OptimizerRow& row) {
  const Requirements& needs = row.requirements;
  if (!row.unavailable.empty() || !row.backend.empty()) {
    return "not every build has it";
  }
  if (needs.objectives > 1 || needs.variables > 1 || needs.residuals || row.limits.variables > 0 ||
      row.limits.evaluations > 0) {
    return "it does not suit every problem and budget";
  }
  return row.capabilities.generations ? "" : "it has no generations, which some schedules need";
}

bool can_work(const AutoRule& rule, const AutoFeatures& features,
              const ProblemDescription& problem) {
  const OptimizerRow& row = rule.row;
  const double limit = row.limits.evaluations;
  return row.unavailable.empty() && explain_unsuitable(row, problem).empty() &&
         (limit == 0 || features[kEvaluations] <= limit) &&
         (features[kChangingCases] == 0 || row.capabilities.generations);
}

bool holds(const AutoCondition& condition, const AutoFeatures& features) {
  return features[condition.feature] >= condition.lower &&
         features[condition.feature] <= condition.upper;
}

}  // namespace

AutoFeatures calc_auto_features(const ProblemDescription& problem, std::int64_t evaluations,
                                bool may_change_cases) {
  const auto has = [&](VariableType type) {
    return std::ranges::count(problem.variables, type, &DecisionVariable::type) > 0 ? 1.0 : 0.0;
  };
  const auto variables = static_cast<double>(problem.variables.size());
  const bool is_logarithmic = std::ranges::all_of(
      problem.variables, [](const auto& variable) { return variable.scale == Scale::logarithmic; });
  return {variables,
          static_cast<double>(problem.objectives.size()),
          static_cast<double>(evaluations),
          static_cast<double>(evaluations) / variables,
          problem.has_residuals ? 1.0 : 0.0,
          problem.constraints.empty() ? 0.0 : 1.0,
          has(VariableType::integer),
          has(VariableType::category),
          is_logarithmic ? 1.0 : 0.0,
          may_change_cases ? 1.0 : 0.0,
          0.0};
}

std::string describe_features(const AutoFeatures& features) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < kAutoFeatures.size(); ++i) {
    const std::string_view name = kAutoFeatures[i].name;
    const double value = features[i];
    if (kAutoFeatures[i].is_flag) {
      if (value != 0) {
        parts.emplace_back(kAutoFeatures[i].meaning);
      }
    } else if (name != "evaluations_per_variable") {
      const std::string_view word = value == 1 ? name.substr(0, name.size() - 1) : name;
      parts.push_back(fmt::format("{:.0f} {}", value, word));
    }
  }
  const std::string last = parts.back();
  parts.pop_back();
  return join(parts, ", ") + " and " + last;
}

std::string describe_conditions(const AutoRule& rule) {
  std::vector<std::string> parts;
  for (const AutoCondition& condition : rule.conditions) {
    const AutoFeature& feature = kAutoFeatures[condition.feature];
    if (feature.is_flag) {
      const bool is_only = std::string_view(feature.meaning).starts_with("only");
      const char* const negation = is_only ? "not " : "no ";
      parts.push_back(fmt::format("{}{}", condition.lower == 0 ? negation : "", feature.meaning));
      continue;
    }
    if (std::isfinite(condition.lower)) {
      parts.push_back(fmt::format("{} >= {}", feature.name, format_exact(condition.lower)));
    }
    if (std::isfinite(condition.upper)) {
      parts.push_back(fmt::format("{} <= {}", feature.name, format_exact(condition.upper)));
    }
  }
  return parts.empty() ? "always" : join(parts, ", ");
}

std::string describe_used(const AutoRule& rule) {
  return rule.row.name + (rule.options.empty() ? "" : " with " + join(rule.options, ", "));
}

std::filesystem::path find_auto_rules(const std::string& path) {
  return path.empty() ? find_config_folder() / "auto.toml" : std::filesystem::path(path);
}

std::vector<AutoRule> load_auto_rules(const std::filesystem::path& file) {
  static const SettingTable kFile{.key = "", .tables = {&rule_settings()}};
  const ConfigTable table = ConfigTable::load(kFile, file);
  const std::vector<ConfigTable> tables = table.get_tables(rule_settings());
  std::vector<AutoRule> rules;
  for (const ConfigTable& one : tables) {
    if (!rules.empty() && rules.back().conditions.empty()) {
      one.refuse(kRuleUse,
                 "it must stand before the rule without conditions, because that one always holds");
    }
    rules.push_back(read_rule(one));
  }
  table.refuse_unknown();
  if (rules.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: has no rule; it must have at least one [[rule]], without "
                            "conditions",
                            file.string()));
  }
  const AutoRule& last = rules.back();
  const std::string narrow = explain_narrow(last.row);
  if (!last.conditions.empty()) {
    tables.back().refuse(kRuleUse,
                         fmt::format("the last rule must have no conditions, so that one always "
                                     "holds; it has: {}",
                                     describe_conditions(last)));
  }
  if (!narrow.empty()) {
    tables.back().refuse(kRuleUse,
                         fmt::format("the last rule must have an optimizer for every problem, as "
                                     "cmaes or ga: {}",
                                     narrow));
  }
  return rules;
}

const AutoRule& choose_rule(const std::vector<AutoRule>& rules, AutoFeatures& features,
                            const ProblemDescription& problem, const std::function<bool()>& probe) {
  bool has_probed = false;
  for (const AutoRule& rule : rules) {
    const auto holds_with = [&](bool with_rugged) {
      return std::ranges::all_of(rule.conditions, [&](const AutoCondition& one) {
        return (one.feature == kRugged && !with_rugged) || holds(one, features);
      });
    };
    if (!can_work(rule, features, problem) || !holds_with(false)) {
      continue;
    }
    const bool asks = std::ranges::count(rule.conditions, kRugged, &AutoCondition::feature) > 0;
    if (asks && !has_probed) {
      features[kRugged] = probe() ? 1 : 0;
      has_probed = true;
    }
    if (holds_with(true)) {
      return rule;
    }
  }
  return rules.back();
}

}  // namespace armwright
