#include "optimizers/plugin_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "optimizers/plugin_process.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kQuoted = 80;  // characters of a bad line that are shown

constexpr std::array<std::pair<const char*, bool Capabilities::*>, 11> kCapabilities{{
    {"bounds", &Capabilities::bounds},
    {"constraints", &Capabilities::constraints},
    {"multi_objective", &Capabilities::multi_objective},
    {"batch", &Capabilities::batch},
    {"noisy", &Capabilities::noisy},
    {"residuals", &Capabilities::residuals},
    {"stochastic", &Capabilities::stochastic},
    {"generations", &Capabilities::generations},
    {"local", &Capabilities::local},
    {"sampling", &Capabilities::sampling},
    {"paced", &Capabilities::paced},
}};

std::string quote(const std::string& text) {
  return fmt::format("'{}'{}", sanitize(text.substr(0, kQuoted)),
                     text.size() > kQuoted ? "..." : "");
}

std::string quote(const json& value) {
  return quote(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

// With the type first, as people read it.
using OrderedJson = nlohmann::ordered_json;

// Names of problems come from files: never refuse to send one.
std::string to_line(const OrderedJson& message) {
  return message.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

const json& require(const json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) {
    throw ProtocolError(fmt::format("sent {} without \"{}\"", where, key));
  }
  return *found;
}

// One line for a person, of a field that may be missing.
std::string read_text(const json& object, const char* key, const std::string& where) {
  const json& value = require(object, key, where);
  if (!value.is_string()) {
    throw ProtocolError(
        fmt::format("sent {} whose \"{}\" is {}, not a text", where, key, quote(value)));
  }
  return sanitize(value.get<std::string>());
}

bool is_name(const std::string& text) {
  constexpr std::size_t kLongestName = 64;
  return !text.empty() && text.size() <= kLongestName &&
         std::isalnum(static_cast<unsigned char>(text[0])) != 0 &&
         std::ranges::all_of(text, [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ||
                  c == '.';
         });
}

std::string read_name(const json& object, const std::string& where) {
  const std::string name = read_text(object, "name", where);
  if (!is_name(name)) {
    throw ProtocolError(
        fmt::format("sent {} named {}; a name begins with a letter or digit, goes on with letters, "
                    "digits, '_', '-' and '.', and has at most 64 of them",
                    where, quote(name)));
  }
  return name;
}

// Whether or not a number is written with a point, it is one.
double read_number(const json& object, const char* key, const std::string& where) {
  const json& value = require(object, key, where);
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw ProtocolError(
        fmt::format("sent {} whose \"{}\" is {}, not a number", where, key, quote(value)));
  }
  return value.get<double>();
}

OptionSpec read_option(const json& object) {
  if (!object.is_object()) {
    throw ProtocolError(
        fmt::format("sent a description with an option that is no object: {}", quote(object)));
  }
  OptionSpec spec;
  spec.name = read_name(object, "an option");
  const std::string where = fmt::format("option '{}'", spec.name);
  spec.description = object.contains("description") ? read_text(object, "description", where) : "";
  const json& fallback = require(object, "default", where);
  if (fallback.is_boolean()) {
    spec.fallback = fallback.get<bool>();
  } else if (fallback.is_string()) {
    spec.fallback = fallback.get<std::string>();
    for (const json& choice : object.value("choices", json::array())) {
      if (!choice.is_string()) {
        throw ProtocolError(
            fmt::format("sent {} with a choice that is no text: {}", where, quote(choice)));
      }
      spec.choices.push_back(choice.get<std::string>());
    }
    if (!spec.choices.empty() &&
        std::ranges::count(spec.choices, std::get<std::string>(spec.fallback)) == 0) {
      throw ProtocolError(
          fmt::format("sent {} whose default {} is none of its choices", where, quote(fallback)));
    }
  } else if (fallback.is_number()) {
    const double value = read_number(object, "default", where);
    spec.lower = read_number(object, "lower", where);
    spec.upper = read_number(object, "upper", where);
    if (!(spec.lower <= value && value <= spec.upper)) {
      throw ProtocolError(fmt::format("sent {} whose default {} lies outside its range {} to {}",
                                      where, quote(fallback), format_exact(spec.lower),
                                      format_exact(spec.upper)));
    }
    if (fallback.is_number_integer()) {
      spec.fallback = fallback.get<std::int64_t>();
    } else {
      spec.fallback = value;
    }
  } else {
    throw ProtocolError(
        fmt::format("sent {} whose default is {}; it must be a truth value, a number or a text",
                    where, quote(fallback)));
  }
  return spec;
}

Capabilities read_capabilities(const json& list) {
  Capabilities capabilities;
  std::vector<std::string> names;
  for (const auto& [name, member] : kCapabilities) {
    names.emplace_back(name);
    capabilities.*member = false;
  }
  for (const json& one : list) {
    const std::string text = one.is_string() ? one.get<std::string>() : quote(one);
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) {
      throw ProtocolError("described itself with an " +
                          describe_unknown("capability", text, names));
    }
    capabilities.*(kCapabilities[static_cast<std::size_t>(found - names.begin())].second) = true;
  }
  return capabilities;
}

std::vector<double> read_point(const json& list, const std::string& what,
                               const ProblemDescription& problem) {
  if (!list.is_array()) {
    throw ProtocolError(fmt::format("sent {} that is no list: {}", what, quote(list)));
  }
  if (list.size() != problem.variables.size()) {
    throw ProtocolError(fmt::format("sent {} of {} coordinates; the problem has {} variables", what,
                                    list.size(), problem.variables.size()));
  }
  std::vector<double> point;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number() || !std::isfinite(list[i].get<double>())) {
      throw ProtocolError(fmt::format("sent {} whose coordinate {} ({}) is {}, not a finite number",
                                      what, i + 1, sanitize(problem.variables[i].name),
                                      quote(list[i])));
    }
    point.push_back(list[i].get<double>());
  }
  return point;
}

void check_inside(const std::vector<double>& point, const std::string& what,
                  const ProblemDescription& problem) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    const DecisionVariable& variable = problem.variables[i];
    if (point[i] < variable.lower || point[i] > variable.upper) {
      throw ProtocolError(fmt::format(
          "declares the capability \"bounds\" and sent {} whose coordinate {} ({}) is {}, outside "
          "{} to {}",
          what, i + 1, sanitize(variable.name), format_exact(point[i]),
          format_exact(variable.lower), format_exact(variable.upper)));
    }
  }
}

OrderedJson describe_quantities(std::span<const Quantity> quantities) {
  OrderedJson list = OrderedJson::array();
  for (const Quantity& quantity : quantities) {
    list.push_back({{"name", quantity.name}, {"unit", quantity.unit}});
  }
  return list;
}

}  // namespace

std::string make_hello() {
  return to_line({{"type", "hello"}, {"protocol", kPluginProtocol}});
}

std::string make_quit() {
  return to_line({{"type", "quit"}});
}

std::string make_minimize(const ProblemDescription& problem, std::uint64_t seed,
                          const Options& options, std::span<const std::string> own_options,
                          std::int64_t remaining) {
  OrderedJson variables = OrderedJson::array();
  for (const DecisionVariable& variable : problem.variables) {
    variables.push_back(
        {{"name", variable.name},
         {"unit", variable.unit},
         {"lower", variable.lower},
         {"upper", variable.upper},
         {"start", variable.start},
         {"scale", variable.scale == Scale::logarithmic ? "logarithmic" : "linear"}});
  }
  OrderedJson values = OrderedJson::object();
  for (const auto& [name, value] : options.values()) {
    if (std::ranges::count(own_options, name) == 0) {
      values[name] = std::visit([](const auto& v) { return OrderedJson(v); }, value);
    }
  }
  return to_line({{"type", "minimize"},
                  {"seed", seed},
                  {"options", values},
                  {"problem",
                   {{"name", problem.name},
                    {"variables", variables},
                    {"objectives", describe_quantities(problem.objectives)},
                    {"objective_weights", problem.objective_weights},
                    {"constraints", describe_quantities(problem.constraints)},
                    {"has_residuals", problem.has_residuals}}},
                  {"remaining", remaining}});
}

std::string make_tell(std::span<const Score> scores, std::int64_t remaining, bool stopped,
                      bool with_residuals) {
  OrderedJson list = OrderedJson::array();
  for (const Score& score : scores) {
    OrderedJson one = {{"objectives", score.objectives},
                       {"constraints", score.constraint_values},
                       {"status", to_string(score.status)},
                       {"clipped", score.clipped}};
    if (with_residuals) {
      one["residuals"] = score.residuals;
    }
    list.push_back(std::move(one));
  }
  return to_line(
      {{"type", "tell"}, {"scores", list}, {"remaining", remaining}, {"stopped", stopped}});
}

json read_message(const std::string& line) {
  json message;
  try {
    message = json::parse(line);
  } catch (const json::exception&) {
    const bool has_nan =
        line.find("NaN") != std::string::npos || line.find("Infinity") != std::string::npos;
    throw ProtocolError(fmt::format(
        "sent a line that is not JSON: {}{}", quote(line),
        has_nan ? " (JSON knows no NaN and no Infinity; points must be finite)"
                : " (its standard output is for the protocol; notes belong on standard error)"));
  }
  if (!message.is_object() || !message.contains("type") || !message["type"].is_string()) {
    throw ProtocolError(
        fmt::format("sent JSON that is no object with a \"type\": {}", quote(line)));
  }
  return message;
}

std::string read_type(const json& message) {
  return message.at("type").get<std::string>();
}

OptimizerRow read_description(const json& message) {
  const std::string where = "a description";
  if (read_type(message) != "description") {
    throw ProtocolError(
        fmt::format("answered \"hello\" with {}, not with a description", quote(message)));
  }
  const json& protocol = require(message, "protocol", where);
  if (!protocol.is_number_integer() || protocol.get<std::int64_t>() != kPluginProtocol) {
    throw ProtocolError(
        fmt::format("speaks version {} of the plugin protocol; this armwright speaks version {}",
                    quote(protocol), kPluginProtocol));
  }
  OptimizerRow row;
  row.name = read_name(message, where);
  row.summary = read_text(message, "summary", where);
  row.source = message.contains("source") ? read_text(message, "source", where) : "";
  for (const char* list : {"capabilities", "options"}) {
    if (!require(message, list, where).is_array()) {
      throw ProtocolError(fmt::format("sent a description whose \"{}\" is no list", list));
    }
  }
  row.capabilities = read_capabilities(message["capabilities"]);
  for (const json& option : message["options"]) {
    OptionSpec spec = read_option(option);
    if (std::ranges::count(row.options, spec.name, &OptionSpec::name) > 0) {
      throw ProtocolError(fmt::format("described option '{}' twice", spec.name));
    }
    row.options.push_back(std::move(spec));
  }
  if (const auto needs = message.find("requirements"); needs != message.end()) {
    const auto read_least = [&](const char* key) {
      return needs->contains(key)
                 ? static_cast<int>(std::clamp(read_number(*needs, key, "requirements"), 1.0, 1e6))
                 : 1;
    };
    if (!needs->is_object()) {
      throw ProtocolError("sent a description whose \"requirements\" are no object");
    }
    row.requirements.objectives = read_least("objectives");
    row.requirements.variables = read_least("variables");
    row.requirements.residuals = needs->contains("residuals") && (*needs)["residuals"] == true;
  }
  return row;
}

AskMessage read_ask(const json& message, const ProblemDescription& problem, bool inside) {
  AskMessage ask;
  if (const auto generation = message.find("generation"); generation != message.end()) {
    ask.begins_generation = *generation == true;
  }
  const json& points = require(message, "points", "a question");
  if (!points.is_array() || points.empty()) {
    throw ProtocolError(
        fmt::format("asked for no points: \"points\" is {}, not a list of points", quote(points)));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string what =
        points.size() == 1 ? "a point" : fmt::format("point {} of {}", i + 1, points.size());
    ask.points.push_back(read_point(points[i], what, problem));
    if (inside) {
      check_inside(ask.points.back(), what, problem);
    }
  }
  return ask;
}

std::vector<double> read_recommendation(const json& message, const ProblemDescription& problem) {
  return read_point(require(message, "x", "a recommendation"), "a recommended point", problem);
}

}  // namespace armwright
