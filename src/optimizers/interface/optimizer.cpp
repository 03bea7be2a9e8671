#include "optimizers/interface/optimizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Returns what is allowed, for messages.
std::string describe_allowed(const OptionSpec& spec) {
  if (std::holds_alternative<bool>(spec.fallback)) {
    return "true or false";
  }
  if (std::holds_alternative<std::int64_t>(spec.fallback)) {
    return fmt::format("an integer between {:.0f} and {:.0f}", spec.lower, spec.upper);
  }
  if (std::holds_alternative<double>(spec.fallback)) {
    return fmt::format("a number between {} and {}", format_exact(spec.lower),
                       format_exact(spec.upper));
  }
  return "one of: " + join(spec.choices, ", ");
}

std::optional<OptionValue> parse_value(const OptionSpec& spec, const std::string& text) {
  if (std::holds_alternative<bool>(spec.fallback)) {
    if (text == "true" || text == "false") {
      return text == "true";
    }
    return std::nullopt;
  }
  if (std::holds_alternative<std::int64_t>(spec.fallback)) {
    const auto value = parse_count(text);
    const bool allowed = value && static_cast<double>(*value) >= spec.lower &&
                         static_cast<double>(*value) <= spec.upper;
    return allowed ? std::optional<OptionValue>(std::int64_t{*value}) : std::nullopt;
  }
  if (std::holds_alternative<double>(spec.fallback)) {
    const auto value = parse_finite(text);
    const bool allowed = value && *value >= spec.lower && *value <= spec.upper;
    return allowed ? std::optional<OptionValue>(*value) : std::nullopt;
  }
  const bool allowed = spec.choices.empty() || std::ranges::count(spec.choices, text) > 0;
  return allowed ? std::optional<OptionValue>(text) : std::nullopt;
}

}  // namespace

Options Options::parse(std::string_view optimizer, std::span<const OptionSpec> specs,
                       std::span<const std::string> assignments) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::usage, fmt::format("optimizer '{}': {}", sanitize(optimizer), what));
  };
  std::map<std::string, std::string> given;
  for (const std::string& assignment : assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) {
      refuse(fmt::format("option '{}' has no value; write NAME=VALUE", sanitize(assignment)));
    }
    const std::string name = assignment.substr(0, equals);
    const std::string text = assignment.substr(equals + 1);
    const auto spec = std::ranges::find(specs, name, &OptionSpec::name);
    if (spec == specs.end()) {
      std::vector<std::string> names;
      std::ranges::transform(specs, std::back_inserter(names), &OptionSpec::name);
      const std::vector<std::string> list = {"armwright", "list", "optimizers",
                                             std::string(optimizer)};
      refuse(describe_unknown("option", name, names, sanitize(quote_command(list))));
    }
    if (const auto [earlier, is_new] = given.emplace(name, text); !is_new) {
      refuse(fmt::format("option '{}' is given twice, as '{}' and as '{}'; give it once", name,
                         sanitize(earlier->second), sanitize(text)));
    }
  }
  Options options;
  for (const OptionSpec& spec : specs) {
    const auto found = given.find(spec.name);
    if (found == given.end()) {
      options.values_[spec.name] = spec.fallback;
      continue;
    }
    const auto value = parse_value(spec, found->second);
    if (!value) {
      refuse(fmt::format("option '{}' is '{}'; it must be {}", spec.name, sanitize(found->second),
                         describe_allowed(spec)));
    }
    options.values_[spec.name] = *value;
  }
  return options;
}

// A request for an undeclared option, or with another type, is a bug: at() and get() throw an
// exception that no code catches.
bool Options::get_bool(const std::string& name) const {
  return std::get<bool>(values_.at(name));
}

std::int64_t Options::get_integer(const std::string& name) const {
  return std::get<std::int64_t>(values_.at(name));
}

double Options::get_number(const std::string& name) const {
  return std::get<double>(values_.at(name));
}

const std::string& Options::get_text(const std::string& name) const {
  return std::get<std::string>(values_.at(name));
}

bool is_recorded(std::span<const OptionSpec> specs, const std::string& option,
                 const OptionValue& value) {
  const auto spec = std::ranges::find(specs, option, &OptionSpec::name);
  return spec == specs.end() ||
         (spec->changes_result && !(spec->is_new && value == spec->fallback));
}

std::string to_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return fmt::format("{}", *integer);
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return format_exact(*number);
  }
  return std::get<std::string>(value);
}

}  // namespace armwright
