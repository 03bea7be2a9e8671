#include "problems/user/user_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "process/json_message.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t kMostVariables = 10000;
constexpr std::size_t kMostOutputs = 1000;  // objectives, constraints and metrics, each
constexpr std::size_t kMostWords = 1000;    // per category
constexpr double kMostUserCases = 1e6;      // as kMostCases

// Reads the fields of one object of the description.
class FieldReader {
 public:
  FieldReader(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) {
      throw ProtocolError(fmt::format("sent {} that is no object: {}", where_, quote(object)));
    }
  }

  bool has(const char* key) const { return object_.contains(key); }
  const json& get(const char* key) const { return require(object_, key, where_); }
  std::string name() const { return read_name(object_, where_); }
  std::string text(const char* key, const char* otherwise) const {
    return has(key) ? read_text(object_, key, where_) : otherwise;
  }
  double number(const char* key) const { return read_number(object_, key, where_); }
  std::optional<double> find_number(const char* key) const {
    return has(key) ? std::optional(number(key)) : std::nullopt;
  }
  bool flag(const char* key, bool otherwise) const {
    if (!has(key)) {
      return otherwise;
    }
    if (!get(key).is_boolean()) {
      refuse(key, "true or false");
    }
    return get(key).get<bool>();
  }
  std::int64_t count(const char* key, std::int64_t otherwise) const {
    if (!has(key)) {
      return otherwise;
    }
    const double value = number(key);
    if (value != std::floor(value) || value < 0 || value > kMostUserCases) {
      refuse(key, fmt::format("a whole number from 0 to {:.0f}", kMostUserCases));
    }
    return static_cast<std::int64_t>(value);
  }
  // Returns the place of a text among `words`.
  std::size_t choice(const char* key, std::span<const std::string> words) const {
    if (!has(key)) {
      return 0;
    }
    const auto found = std::ranges::find(words, text(key, ""));
    if (found == words.end()) {
      std::vector<std::string> quoted;
      std::ranges::transform(words, std::back_inserter(quoted),
                             [](const std::string& word) { return "\"" + word + "\""; });
      refuse(key, join(quoted, " or "));
    }
    return static_cast<std::size_t>(found - words.begin());
  }
  // Calls `read` with each object of a list and its place. A list that is missing is empty.
  void each(const char* key, std::size_t most,
            const std::function<void(const FieldReader&)>& read) const {
    if (!has(key)) {
      return;
    }
    const json& list = get(key);
    if (!list.is_array()) {
      refuse(key, "a list");
    }
    if (list.size() > most) {
      throw ProtocolError(fmt::format("sent {} with {} {}; at most {} are possible", where_,
                                      list.size(), key, most));
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      read(FieldReader(list[i], fmt::format("{}[{}]", key, i)));
    }
  }
  [[noreturn]] void refuse(const char* key, std::string_view must) const {
    throw ProtocolError(fmt::format("sent {} whose \"{}\" is {}; it must be {}", where_, key,
                                    quote(object_.at(key)), must));
  }

 private:
  const json& object_;
  std::string where_;
};

std::vector<std::string> read_words(const FieldReader& fields) {
  const json& list = fields.get("choices");
  if (!list.is_array() || list.size() > kMostWords ||
      !std::ranges::all_of(list, [](const json& word) { return word.is_string(); })) {
    fields.refuse("choices", fmt::format("a list of at most {} texts", kMostWords));
  }
  std::vector<std::string> words;
  for (const json& word : list) {
    words.push_back(sanitize(word.get<std::string>()));
  }
  return words;
}

DecisionVariable read_variable(const FieldReader& fields) {
  DecisionVariable variable;
  variable.name = fields.name();
  variable.unit = fields.text("unit", "");
  variable.type = kVariableTypes[fields.choice("type", list_type_names())];
  if (variable.type == VariableType::category) {
    variable.choices = read_words(fields);
    variable.upper = static_cast<double>(variable.choices.size()) - 1;
    if (fields.has("start")) {
      const auto start = find_word(variable, fields.text("start", ""));
      if (!start) {
        fields.refuse("start", "one of its choices");
      }
      variable.start = *start;
    }
    return variable;
  }
  variable.lower = fields.number("lower");
  variable.upper = fields.number("upper");
  const std::array<std::string, 2> scales = {"linear", "logarithmic"};
  variable.scale = fields.choice("scale", scales) == 1 ? Scale::logarithmic : Scale::linear;
  // check_description() refuses bounds that cross, which have no middle.
  variable.start = fields.has("start")               ? fields.number("start")
                   : variable.lower < variable.upper ? choose_start(variable)
                                                     : variable.lower;
  return variable;
}

Quantity read_quantity(const FieldReader& fields) {
  return {fields.name(), fields.text("unit", "")};
}

OrderedJson write_quantity(const Quantity& quantity) {
  return {{"name", quantity.name}, {"unit", quantity.unit}};
}

OrderedJson write_variable(const DecisionVariable& variable) {
  OrderedJson written = {
      {"name", variable.name}, {"unit", variable.unit}, {"type", to_string(variable.type)}};
  if (variable.type == VariableType::category) {
    written["choices"] = variable.choices;
    written["start"] = format_value(variable, variable.start);
    return written;
  }
  written["lower"] = variable.lower;
  written["upper"] = variable.upper;
  written["scale"] = variable.scale == Scale::logarithmic ? "logarithmic" : "linear";
  written["start"] = variable.start;
  return written;
}

void check_variable(const DecisionVariable& variable, const std::string& field,
                    const RefuseField& refuse) {
  if (variable.type == VariableType::category) {
    if (variable.choices.size() < 2) {
      refuse(field + ".choices", fmt::format("has {}; a category needs two words or more",
                                             variable.choices.empty() ? "no word" : "one word"));
    }
    const std::set<std::string> different(variable.choices.begin(), variable.choices.end());
    if (different.size() < variable.choices.size() || different.contains("")) {
      refuse(field + ".choices", "has an empty word or the same word twice");
    }
    return;
  }
  const auto is_possible = [&](double value) {
    return variable.type == VariableType::real ||
           (value == std::floor(value) && std::abs(value) <= 9007199254740992);  // 2^53
  };
  for (const auto& [key, value] :
       {std::pair{"lower", variable.lower}, {"upper", variable.upper}, {"start", variable.start}}) {
    if (!is_possible(value)) {
      refuse(fmt::format("{}.{}", field, key),
             fmt::format("is {}; an integer's {} must be a whole number of at most 2^53",
                         format_exact(value), key));
    }
  }
  if (!std::isfinite(variable.upper - variable.lower)) {
    refuse(field + ".upper", fmt::format("is {}; upper - lower must be a finite number",
                                         format_exact(variable.upper)));
  }
  if (variable.lower >= variable.upper) {
    refuse(field + ".lower",
           fmt::format("is {}; it must be less than upper, which is {}",
                       format_exact(variable.lower), format_exact(variable.upper)));
  }
  if (variable.scale == Scale::logarithmic && variable.lower <= 0 && variable.upper >= 0) {
    refuse(field + ".scale",
           fmt::format("is \"logarithmic\", and the bounds {} and {} have zero between them; "
                       "both bounds must have the same sign",
                       format_exact(variable.lower), format_exact(variable.upper)));
  }
  if (variable.start < variable.lower || variable.start > variable.upper) {
    refuse(field + ".start", fmt::format("is {}; it must lie within the bounds {} to {}",
                                         format_exact(variable.start), format_exact(variable.lower),
                                         format_exact(variable.upper)));
  }
}

}  // namespace

std::vector<std::string> list_type_names() {
  std::vector<std::string> names;
  std::ranges::transform(kVariableTypes, std::back_inserter(names),
                         [](VariableType type) { return to_string(type); });
  return names;
}

void check_description(const UserDescription& description, const RefuseField& refuse) {
  if (description.variables.empty()) {
    refuse("variables", "is empty; a problem needs one variable or more");
  }
  if (description.objectives.empty()) {
    refuse("objectives", "is empty; a problem needs one objective or more");
  }
  std::set<std::string> names;
  const auto check_name = [&](const std::string& name, const std::string& field) {
    if (!names.insert(name).second) {
      refuse(field + ".name",
             fmt::format("is '{}', which another one has; every name must be different", name));
    }
  };
  for (std::size_t i = 0; i < description.variables.size(); ++i) {
    const std::string field = fmt::format("variables[{}]", i);
    check_name(description.variables[i].name, field);
    check_variable(description.variables[i], field, refuse);
  }
  names.clear();  // a variable and an objective may have the same name
  for (std::size_t i = 0; i < description.objectives.size(); ++i) {
    const UserObjective& objective = description.objectives[i];
    const std::string field = fmt::format("objectives[{}]", i);
    check_name(objective.quantity.name, field);
    if (!(objective.weight > 0)) {
      refuse(field + ".weight",
             fmt::format("is {}; it must be > 0", format_exact(objective.weight)));
    }
    if (objective.penalty && objective.bound &&
        (objective.is_maximised ? *objective.penalty > *objective.bound
                                : *objective.penalty < *objective.bound)) {
      refuse(field + ".penalty",
             fmt::format("is {}, better than the bound {}", format_exact(*objective.penalty),
                         format_exact(*objective.bound)));
    }
    if (objective.penalty.has_value() != description.objectives.front().penalty.has_value()) {
      refuse(field + ".penalty", "is given for some objectives; give it for all or none");
    }
  }
  for (std::size_t i = 0; i < description.constraints.size(); ++i) {
    const std::string field = fmt::format("constraints[{}]", i);
    check_name(description.constraints[i].quantity.name, field);
    if (description.constraints[i].limit && !(*description.constraints[i].limit > 0)) {
      refuse(field + ".limit", fmt::format("is {}; it must be > 0 (without a limit, the "
                                           "constraint is met where its value is <= 0)",
                                           format_exact(*description.constraints[i].limit)));
    }
  }
  for (std::size_t i = 0; i < description.metrics.size(); ++i) {
    check_name(description.metrics[i].name, fmt::format("metrics[{}]", i));
  }
  if (description.has_residuals &&
      (description.objectives.size() != 1 || description.objectives[0].is_maximised ||
       description.takes_worst_case)) {
    refuse("residuals",
           "is true; that needs one objective, which is minimised and the sum of the "
           "squared residuals, and the mean over the cases");
  }
  if (description.validation_cases < 1 || description.test_cases < 1) {
    refuse("cases", "has no validation or test cases; give at least one of each");
  }
}

UserDescription read_user_description(const json& message) {
  if (read_type(message) != "problem") {
    throw ProtocolError(fmt::format(
        "answered \"hello\" with {}, not with a message of the type \"problem\"", quote(message)));
  }
  const FieldReader fields(message, "a description");
  if (fields.number("protocol") != kProblemProtocol) {
    fields.refuse("protocol",
                  fmt::format("{}, the version that this armwright speaks", kProblemProtocol));
  }
  UserDescription description;
  description.name = fields.name();
  description.summary = fields.text("summary", "");
  description.version = fields.text("version", "");
  fields.each("variables", kMostVariables,
              [&](const FieldReader& one) { description.variables.push_back(read_variable(one)); });
  fields.each("objectives", kMostOutputs, [&](const FieldReader& one) {
    const std::array<std::string, 2> directions = {"minimize", "maximize"};
    description.objectives.push_back({.quantity = read_quantity(one),
                                      .is_maximised = one.choice("direction", directions) == 1,
                                      .weight = one.find_number("weight").value_or(1),
                                      .penalty = one.find_number("penalty"),
                                      .bound = one.find_number("bound")});
  });
  fields.each("constraints", kMostOutputs, [&](const FieldReader& one) {
    description.constraints.push_back({read_quantity(one), one.find_number("limit")});
  });
  fields.each("metrics", kMostOutputs,
              [&](const FieldReader& one) { description.metrics.push_back(read_quantity(one)); });
  description.has_residuals = fields.flag("residuals", false);
  if (fields.has("cases")) {
    const FieldReader cases(fields.get("cases"), "cases");
    description.training_cases = cases.count("training", 1);
    description.validation_cases = cases.count("validation", 1);
    description.test_cases = cases.count("test", 1);
  }
  const std::array<std::string, 2> ways = {"mean", "worst"};
  description.takes_worst_case = fields.choice("combine", ways) == 1;
  description.is_deterministic = fields.flag("deterministic", true);
  description.has_records = fields.flag("records", false);
  check_description(description, [](const std::string& field, const std::string& fault) {
    throw ProtocolError(fmt::format("sent a description whose {} {}", field, fault));
  });
  return description;
}

std::string to_json(const UserDescription& description) {
  OrderedJson variables = OrderedJson::array();
  for (const DecisionVariable& variable : description.variables) {
    variables.push_back(write_variable(variable));
  }
  OrderedJson objectives = OrderedJson::array();
  for (const UserObjective& objective : description.objectives) {
    OrderedJson written = write_quantity(objective.quantity);
    written["direction"] = objective.is_maximised ? "maximize" : "minimize";
    written["weight"] = objective.weight;
    if (objective.penalty) {
      written["penalty"] = *objective.penalty;
    }
    if (objective.bound) {
      written["bound"] = *objective.bound;
    }
    objectives.push_back(std::move(written));
  }
  OrderedJson constraints = OrderedJson::array();
  for (const UserConstraint& constraint : description.constraints) {
    OrderedJson written = write_quantity(constraint.quantity);
    if (constraint.limit) {
      written["limit"] = *constraint.limit;
    }
    constraints.push_back(std::move(written));
  }
  OrderedJson metrics = OrderedJson::array();
  std::ranges::transform(description.metrics, std::back_inserter(metrics), write_quantity);
  OrderedJson all = {{"type", "problem"},
                     {"protocol", kProblemProtocol},
                     {"name", description.name},
                     {"summary", description.summary},
                     {"variables", variables},
                     {"objectives", objectives},
                     {"constraints", constraints},
                     {"metrics", metrics},
                     {"residuals", description.has_residuals},
                     {"cases",
                      {{"training", description.training_cases},
                       {"validation", description.validation_cases},
                       {"test", description.test_cases}}},
                     {"combine", description.takes_worst_case ? "worst" : "mean"},
                     {"deterministic", description.is_deterministic},
                     {"records", description.has_records}};
  if (!description.version.empty()) {
    all["version"] = description.version;
  }
  return all.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

UserDescription read_recorded_description(const std::string& recorded, std::string_view name) {
  try {
    return read_user_description(read_message(recorded));
  } catch (const ProtocolError& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the recorded description of the problem '{}' is not what armwright "
                            "wrote: it {}",
                            sanitize(name), error.what()));
  }
}

void check_same_description(std::string_view name, const UserDescription& recorded,
                            const UserDescription& now) {
  const std::string before = to_json(recorded);
  const std::string after = to_json(now);
  if (before != after) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("problem '{}' describes itself differently from what is recorded:\n  {}\n"
                    "Use the problem as it was, or start a new run or study (--new)",
                    sanitize(name), join(describe_differences(before, after), "\n  ")));
  }
}

bool has_single_case(const UserDescription& description) {
  return description.training_cases == 1 && description.validation_cases == 1 &&
         description.test_cases == 1 && description.is_deterministic;
}

std::optional<double> find_word(const DecisionVariable& variable, std::string_view word) {
  const auto found = std::ranges::find(variable.choices, word);
  return found == variable.choices.end()
             ? std::nullopt
             : std::optional(static_cast<double>(found - variable.choices.begin()));
}

double choose_start(const DecisionVariable& variable) {
  if (!(variable.lower < variable.upper)) {
    return variable.lower;  // check_description() refuses these bounds
  }
  const double middle =
      variable.scale == Scale::logarithmic && variable.lower * variable.upper > 0
          ? std::copysign(std::sqrt(variable.lower * variable.upper), variable.lower)
          : variable.lower + (variable.upper - variable.lower) / 2;
  return settle_value(variable, middle);
}

ProblemDescription make_description(const UserDescription& description) {
  ProblemDescription made;
  made.name = description.name;
  made.summary = description.summary;
  made.variables = description.variables;
  for (DecisionVariable& variable : made.variables) {
    variable.lower_widening = "the variable's key 'lower' in the problem's description";
    variable.upper_widening = "the variable's key 'upper' in the problem's description";
  }
  made.metrics = description.metrics;
  bool has_weights = false;
  for (const UserObjective& objective : description.objectives) {
    made.objectives.push_back(objective.quantity);
    has_weights |= description.objectives.size() > 1;
    made.objective_weights.push_back(objective.weight);
    if (objective.is_maximised) {
      made.objectives.back().name.insert(0, 1, '-');
      made.metrics.push_back(objective.quantity);
    }
  }
  if (!has_weights) {
    made.objective_weights.clear();
  }
  for (const UserConstraint& constraint : description.constraints) {
    made.constraints.push_back(constraint.quantity);
    if (constraint.limit) {
      made.limits.push_back({constraint.quantity, *constraint.limit});
    }
  }
  if (made.limits.size() < made.constraints.size()) {
    made.limits.clear();  // all constraints have one or none has
    for (std::size_t i = 0; i < made.constraints.size(); ++i) {
      if (description.constraints[i].limit) {
        made.constraints[i].unit.clear();  // the numbers shown are then value / limit - 1
      }
    }
  }
  made.cost_unit = "simulated case";
  made.has_single_case = has_single_case(description);
  made.has_residuals = description.has_residuals;
  if (!description.has_residuals) {
    made.residuals_advice =
        "let the problem answer with residuals, whose squares add up to its objective";
  }
  return made;
}

}  // namespace armwright
