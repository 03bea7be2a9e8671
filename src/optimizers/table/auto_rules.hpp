// The rules by which `auto` chooses an optimizer: a TOML file of [[rule]] tables in the order in
// which they are tried. A rule has conditions on features of the problem and the run, the optimizer
// that it uses, the optimizer's options, and the reason. The shipped file is configs/auto.toml.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// One feature of a problem and a run. A flag is 1 if it holds and 0 if not.
struct AutoFeature {
  const char* name;
  bool is_flag;
  const char* meaning;  // of a flag: what holds if it is true
};

// A file has the key NAME = true or false for a flag. For a number it has NAME_at_least and
// NAME_at_most.
inline constexpr std::array<AutoFeature, 11> kAutoFeatures{{
    {"variables", false, "decision variables"},
    {"objectives", false, "objectives"},
    {"evaluations", false, "evaluations that the budget pays for"},
    {"evaluations_per_variable", false, "the same, divided by the number of variables"},
    {"residuals", true, "residuals"},
    {"constraints", true, "constraints"},
    {"integers", true, "integers"},
    {"categories", true, "categories"},
    {"logarithmic", true, "only logarithmic variables"},
    {"changing_cases", true, "training cases that may change"},
    {"rugged", true, "ruggedness"},
}};
using AutoFeatures = std::array<double, kAutoFeatures.size()>;  // one value per feature

// Returns the features, with `rugged` not met: only a probe finds it (auto_probe.hpp). They depend on
// neither time nor threads, so that a choice is the same on every machine.
AutoFeatures calc_auto_features(const ProblemDescription& problem, std::int64_t evaluations,
                                bool may_change_cases);
// Returns what the features say, for messages: "10 variables, residuals and 500 evaluations".
std::string describe_features(const AutoFeatures& features);

struct AutoCondition {
  std::size_t feature = 0;  // index into kAutoFeatures
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();  // both ends belong to the range
};

struct AutoRule {
  OptimizerRow row;
  std::vector<std::string> options;  // KEY=VALUE
  std::string why;                   // one sentence
  std::vector<AutoCondition> conditions;
};

// Returns what the rule demands as one line: "constraints, variables <= 20". "always" without
// conditions.
std::string describe_conditions(const AutoRule& rule);
// Returns "cmaes with surrogate=quadratic".
std::string describe_used(const AutoRule& rule);

// Returns the file that `path` names: the shipped one if it is empty.
std::filesystem::path find_auto_rules(const std::string& path);
// Reads a file of rules. Throws Error{usage} with file, line, key, value and what is allowed: for an
// unknown key, an optimizer that is not in the table, options that it lacks, a rule behind one
// without conditions, and a last rule that does not suit every problem. Throws Error{io} for a file
// that cannot be read.
std::vector<AutoRule> load_auto_rules(const std::filesystem::path& file);

// Returns the first rule whose conditions hold and whose optimizer can work here: this build has it,
// it suits the problem, the evaluations are within its limits, and it has generations if the cases
// may change. The last rule suits every problem. Calls `probe` at most once, if a rule depends on
// `rugged` and holds otherwise, and sets that feature to what it returns.
const AutoRule& choose_rule(const std::vector<AutoRule>& rules, AutoFeatures& features,
                            const ProblemDescription& problem, const std::function<bool()>& probe);

}  // namespace armwright
