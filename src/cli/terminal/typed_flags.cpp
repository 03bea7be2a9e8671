#include "cli/terminal/typed_flags.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "base/text.hpp"

namespace armwright {
namespace {

struct FlagSetting {
  std::string_view flag;
  std::string_view key;
};

// Without --judging-engine, --engine stands for both engines.
constexpr FlagSetting kFlagSettings[] = {
    {"--engine", "physics.engine"},
    {"--judging-engine", "physics.judging_engine"},
    {"--engine", "physics.judging_engine"},
    {"--precision", "physics.precision"},
    {"--simd", "physics.simd"},
    {"--robot", "robot.urdf"},
    {"--base", "robot.base"},
    {"--tip", "robot.tip"},
    {"--package", "robot.packages"},
    {"--validation-cases", "sets.validation_cases"},
};

// Returns the value of a flag, in "--flag VALUE" or "--flag=VALUE"; nothing if it was not typed.
std::optional<std::string> find_value(std::span<const std::string> words, std::string_view flag) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == flag && i + 1 < words.size()) {
      return words[i + 1];
    }
    if (words[i].starts_with(flag) && words[i].substr(flag.size()).starts_with('=')) {
      return words[i].substr(flag.size() + 1);
    }
  }
  return std::nullopt;
}

// Returns what the message says about the setting, without the setting's value, which the flag shows.
std::string describe_fault(const std::string& fault, std::string_view key) {
  if (fault.starts_with("unknown key ")) {
    return fmt::format("this problem has no setting {}", key);
  }
  const std::size_t end = fault.find("; ");
  const bool repeats = fault.starts_with(fmt::format("{} is ", key)) && end != std::string::npos;
  return repeats ? fault.substr(end + 2) : fault;
}

}  // namespace

std::string name_typed_flags(const std::string& message,
                             std::span<const std::string> command_line) {
  for (const auto& [flag, key] : kFlagSettings) {
    const std::optional<std::string> value = find_value(command_line, flag);
    const std::string setting = fmt::format("--set {}=", key);
    const std::size_t begin = message.find(setting);
    const std::size_t end = message.find(": ", begin == std::string::npos ? 0 : begin);
    const bool is_place =
        begin == 0 || (begin != std::string::npos && message.substr(0, begin).ends_with(": "));
    if (value && is_place && end != std::string::npos) {
      return fmt::format("{}{} {}: {}", message.substr(0, begin), flag, sanitize(*value),
                         describe_fault(message.substr(end + 2), key));
    }
  }
  return message;
}

}  // namespace armwright
