// Makes a row of the description that a plugin in another process gives.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "optimizers/interface/capability_table.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/plugins/plugin_messages.hpp"
#include "optimizers/plugins/plugin_process.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::vector<std::string> read_choices(const json& object, const std::string& where) {
  std::vector<std::string> choices;
  const auto list = object.find("choices");
  if (list == object.end()) {
    return choices;
  }
  if (!list->is_array()) {
    throw ProtocolError(
        fmt::format("sent {} whose \"choices\" are {}, not a list of texts", where, quote(*list)));
  }
  if (list->size() > kMaxChoices) {
    throw ProtocolError(fmt::format("sent {} with {} choices; at most {} are possible", where,
                                    list->size(), kMaxChoices));
  }
  for (const json& choice : *list) {
    if (!choice.is_string()) {
      throw ProtocolError(
          fmt::format("sent {} with a choice that is no text: {}", where, quote(choice)));
    }
    choices.push_back(choice.get<std::string>());
  }
  return choices;
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
    spec.choices = read_choices(object, where);
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
      for (const char* key : {"default", "lower", "upper"}) {
        const double integer = read_number(object, key, where);
        if (integer != std::floor(integer) || std::abs(integer) > kLargestInteger) {
          throw ProtocolError(fmt::format("sent {} whose \"{}\" is {}, not an integer up to 2^53",
                                          where, key, quote(object[key])));
        }
      }
      spec.fallback = static_cast<std::int64_t>(value);
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
  std::vector<bool Capabilities::*> members;
  for (const CapabilityRow& row : kCapabilityTable) {
    capabilities.*row.member = false;
    if (row.member != &Capabilities::growing) {  // the protocol has no message that asks for cases
      names.emplace_back(row.name);
      members.push_back(row.member);
    }
  }
  for (const json& one : list) {
    const std::string text = one.is_string() ? one.get<std::string>() : quote(one);
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) {
      throw ProtocolError("described itself with an " +
                          describe_unknown("capability", text, names));
    }
    capabilities.*members[static_cast<std::size_t>(found - names.begin())] = true;
  }
  return capabilities;
}

}  // namespace

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
  if (message["options"].size() > kMaxOptions) {
    throw ProtocolError(fmt::format("described {} options; at most {} are possible",
                                    message["options"].size(), kMaxOptions));
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

}  // namespace armwright
