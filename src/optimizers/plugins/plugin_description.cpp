#include "optimizers/plugins/plugin_description.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "armwright/problem.h"
#include "base/text.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {
namespace {

std::string take_text(const char* text, const std::string& what) {
  if (text == nullptr) {
    throw PluginRefusal(what + " is NULL");
  }
  const std::string taken = sanitize(text);
  if (taken.size() > 1000) {
    throw PluginRefusal(what + " has more than 1000 bytes");
  }
  return taken;
}

std::string take_name(const char* text, const std::string& what, std::string_view extra) {
  const std::string name = take_text(text, what);
  const auto is_allowed = [extra](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || extra.find(c) != extra.npos;
  };
  if (name.empty() || !std::ranges::all_of(name, is_allowed)) {
    throw PluginRefusal(
        fmt::format("{} is '{}'; it must be of letters, digits and {}", what, name,
                    extra == "_" ? "underscores, the letters small" : "-, _ and :"));
  }
  return name;
}

OptionSpec take_option(const armwright_option& raw, std::size_t number) {
  OptionSpec option;
  option.name = take_name(raw.name, fmt::format("the name of option {}", number), "_");
  const std::string what = fmt::format("option '{}': ", option.name);
  option.description = take_text(raw.description, what + "its description");
  option.lower = raw.lower;
  option.upper = raw.upper;
  const bool is_number = raw.type == ARMWRIGHT_NUMBER || raw.type == ARMWRIGHT_INTEGER;
  if (is_number && !(std::isfinite(raw.lower) && std::isfinite(raw.upper) &&
                     raw.lower <= raw.fallback && raw.fallback <= raw.upper)) {
    throw PluginRefusal(
        fmt::format("{}its default is {}, its range from {} to {}; the range must be "
                    "finite and hold the default",
                    what, raw.fallback, raw.lower, raw.upper));
  }
  switch (raw.type) {
    case ARMWRIGHT_BOOL:
      if (raw.fallback != 0 && raw.fallback != 1) {
        throw PluginRefusal(
            fmt::format("{}its default is {}; it must be 0 or 1", what, raw.fallback));
      }
      option.fallback = raw.fallback == 1;
      break;
    case ARMWRIGHT_INTEGER:
      for (const double value : {raw.fallback, raw.lower, raw.upper}) {
        if (value != std::floor(value) || std::abs(value) > kLargestInteger) {
          throw PluginRefusal(fmt::format("{}{} is no integer up to 2^53", what, value));
        }
      }
      option.fallback = static_cast<std::int64_t>(raw.fallback);
      break;
    case ARMWRIGHT_NUMBER:
      option.fallback = raw.fallback;
      break;
    case ARMWRIGHT_TEXT: {
      const std::string fallback = take_text(raw.fallback_text, what + "its default");
      for (std::size_t i = 0; raw.choices != nullptr && raw.choices[i] != nullptr; ++i) {
        if (i == kMaxChoices) {
          throw PluginRefusal(what + "its choices do not end with NULL");
        }
        option.choices.push_back(take_text(raw.choices[i], what + "a choice"));
      }
      if (!option.choices.empty() && std::ranges::count(option.choices, fallback) == 0) {
        throw PluginRefusal(fmt::format("{}its default '{}' is not among its choices: {}", what,
                                        fallback, join(option.choices, ", ")));
      }
      option.fallback = fallback;
      break;
    }
    default:
      throw PluginRefusal(fmt::format("{}its type is {}; there are 0 to 3", what, raw.type));
  }
  return option;
}

// The size of the struct in version 1.0, which had no requirements.
constexpr std::size_t kFirstSize = offsetof(struct armwright_plugin, least_objectives);

Requirements take_requirements(const struct armwright_plugin& plugin) {
  if (plugin.struct_size < sizeof(struct armwright_plugin)) {
    return {};
  }
  const auto take = [](std::size_t least) {
    constexpr std::size_t kMost = 1'000'000;
    return static_cast<int>(std::clamp(least, std::size_t{1}, kMost));
  };
  return {.objectives = take(plugin.least_objectives),
          .variables = take(plugin.least_variables),
          .residuals = plugin.needs_residuals != 0};
}

OptionValue unpack_value(PacketReader& reader) {
  switch (reader.get<std::uint64_t>()) {
    case 0:
      return reader.get<bool>();
    case 1:
      return reader.get<std::int64_t>();
    case 2:
      return reader.get<double>();
    default:
      return reader.get_text();
  }
}

}  // namespace

const struct armwright_plugin& open_plugin(const std::filesystem::path& file) {
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw PluginRefusal(fmt::format("is no shared library that can be opened: {}", dlerror()));
  }
  void* const symbol = dlsym(library, ARMWRIGHT_PLUGIN_SYMBOL);
  if (symbol == nullptr && dlsym(library, ARMWRIGHT_PROBLEM_SYMBOL) != nullptr) {
    throw PluginRefusal("is a problem and no optimizer; name it as the problem");
  }
  if (symbol == nullptr) {
    throw PluginRefusal(
        fmt::format("exports no function '{0}'; a plugin defines ARMWRIGHT_PLUGIN_EXPORT const "
                    "struct armwright_plugin* {0}(void), in C++ as extern \"C\" or by the macro "
                    "ARMWRIGHT_PLUGIN of armwright/plugin.hpp",
                    ARMWRIGHT_PLUGIN_SYMBOL));
  }
  const auto* const plugin = reinterpret_cast<decltype(&::armwright_plugin)>(symbol)();
  if (plugin == nullptr) {
    throw PluginRefusal("describes nothing: armwright_plugin() returned NULL");
  }
  if (plugin->abi != ARMWRIGHT_PLUGIN_ABI) {
    throw PluginRefusal(
        fmt::format("is built for version {} of the plugin interface, and this armwright has "
                    "version {}; build it against this armwright's armwright/plugin.h",
                    plugin->abi, ARMWRIGHT_PLUGIN_ABI));
  }
  if (plugin->struct_size < kFirstSize) {
    throw PluginRefusal(
        fmt::format("says that its struct armwright_plugin has {} bytes; it has {} or "
                    "more",
                    plugin->struct_size, kFirstSize));
  }
  return *plugin;
}

PluginDescription describe_plugin(const struct armwright_plugin& plugin,
                                  std::span<const std::string> own_options) {
  constexpr std::uint32_t kKnown = (ARMWRIGHT_CATEGORIES << 1) - 1;
  PluginDescription taken;
  taken.name = take_name(plugin.name, "its name", "_-:ABCDEFGHIJKLMNOPQRSTUVWXYZ");
  taken.summary = take_text(plugin.summary, "its summary");
  taken.source = take_text(plugin.source, "its source");
  taken.capabilities = plugin.capabilities;
  if ((plugin.capabilities & ~kKnown) != 0) {
    throw PluginRefusal(
        fmt::format("declares capabilities that this armwright does not know (bits {:#x})",
                    plugin.capabilities & ~kKnown));
  }
  taken.requirements = take_requirements(plugin);
  if (plugin.minimize == nullptr) {
    throw PluginRefusal("has no function minimize: it is NULL");
  }
  if (plugin.option_count > kMaxOptions || (plugin.option_count > 0 && plugin.options == nullptr)) {
    throw PluginRefusal(fmt::format("says that it has {} options{}", plugin.option_count,
                                    plugin.options == nullptr ? ", and points to none" : ""));
  }
  for (std::size_t i = 0; i < plugin.option_count; ++i) {
    OptionSpec option = take_option(plugin.options[i], i + 1);
    const bool is_taken = std::ranges::count(taken.options, option.name, &OptionSpec::name) > 0 ||
                          std::ranges::count(own_options, option.name) > 0;
    if (is_taken) {
      throw PluginRefusal(
          fmt::format("declares option '{}', which there is already; every plugin has {}",
                      option.name, join(own_options, ", ")));
    }
    taken.options.push_back(std::move(option));
  }
  return taken;
}

void pack(const PluginDescription& description, PacketWriter& writer) {
  writer.put(description.name);
  writer.put(description.summary);
  writer.put(description.source);
  writer.put(description.capabilities);
  writer.put(description.requirements.objectives);
  writer.put(description.requirements.variables);
  writer.put(description.requirements.residuals);
  writer.put(std::uint64_t{description.options.size()});
  for (const OptionSpec& option : description.options) {
    writer.put(option.name);
    writer.put(option.description);
    writer.put(std::uint64_t{option.fallback.index()});
    std::visit([&writer](const auto& value) { writer.put(value); }, option.fallback);
    writer.put(option.lower);
    writer.put(option.upper);
    writer.put(std::uint64_t{option.choices.size()});
    for (const std::string& choice : option.choices) {
      writer.put(choice);
    }
  }
}

PluginDescription unpack_description(PacketReader& reader) {
  PluginDescription description;
  description.name = reader.get_text();
  description.summary = reader.get_text();
  description.source = reader.get_text();
  description.capabilities = reader.get<std::uint32_t>();
  description.requirements.objectives = reader.get<int>();
  description.requirements.variables = reader.get<int>();
  description.requirements.residuals = reader.get<bool>();
  for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
    OptionSpec& option = description.options.emplace_back();
    option.name = reader.get_text();
    option.description = reader.get_text();
    option.fallback = unpack_value(reader);
    option.lower = reader.get<double>();
    option.upper = reader.get<double>();
    for (auto choices = reader.get<std::uint64_t>(); choices > 0; --choices) {
      option.choices.push_back(reader.get_text());
    }
  }
  return description;
}

}  // namespace armwright
