#include "cli/manual/bash_completion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/manual/bash_completion_text.hpp"
#include "cli/manual/value_source.hpp"

namespace armwright {
namespace {

// "testset export"; empty for the program itself
std::string get_path(const CommandDefinition& command) {
  return join(std::span(command.words).subspan(1), " ");
}

std::vector<std::string> list_flag_names(const ArgumentDefinition& flag) {
  std::vector<std::string> names = flag.short_names;
  std::ranges::copy(flag.long_names, std::back_inserter(names));
  return names;
}

// One word for each place that values come from, as the script's _armwright_values reads them.
std::string format_source(const CommandDefinition& command, const ArgumentDefinition& argument) {
  const ValueSource source = find_value_source(command, argument).value_or(ValueSource{});
  std::vector<std::string> words;
  if (source.separated) {
    words.emplace_back("separated");
  }
  for (const std::string& choice : source.choices) {
    words.push_back("choice:" + choice);
  }
  if (!source.list.empty()) {
    words.push_back("list:" + source.list);
  }
  if (source.files) {
    words.emplace_back("file");
  }
  if (source.folders) {
    words.emplace_back("folder");
  }
  return "REPLY='" + join(words, " ") + "'";
}

// A function that sets REPLY to one text a command.
template <typename Make>
std::string make_function(const char* name, const CommandDefinition& program, Make make) {
  std::string text = fmt::format("{}() {{\n  REPLY=\n  case $1 in\n", name);
  for (const CommandDefinition* command : list_all_commands(program)) {
    const std::string body = make(*command);
    if (!body.empty()) {
      text += fmt::format("    '{}')\n{}      ;;\n", get_path(*command), body);
    }
  }
  return text + "  esac\n}\n\n";
}

std::string make_commands(const CommandDefinition& command) {
  std::vector<std::string> names;
  std::ranges::transform(command.commands, std::back_inserter(names),
                         [](const CommandDefinition& below) { return below.words.back(); });
  return names.empty() ? "" : fmt::format("      REPLY='{}'\n", join(names, " "));
}

std::string make_flags(const CommandDefinition& command) {
  std::vector<std::string> names;
  for (const ArgumentDefinition& flag : command.flags) {
    std::ranges::copy(list_flag_names(flag), std::back_inserter(names));
  }
  return fmt::format("      REPLY='{}'\n", join(names, " "));
}

// By flag, and by an argument's place from 1; what repeats stands for all places behind it.
std::string make_values(const CommandDefinition& command) {
  std::string rows;
  for (const ArgumentDefinition& flag : command.flags) {
    if (!flag.value.empty()) {
      rows += fmt::format("        {}) {} ;;\n", join(list_flag_names(flag), " | "),
                          format_source(command, flag));
    }
  }
  for (std::size_t i = 0; i < command.arguments.size(); ++i) {
    const ArgumentDefinition& argument = command.arguments[i];
    rows += fmt::format("        {}) {} ;;\n", argument.repeats ? "[0-9]*" : std::to_string(i + 1),
                        format_source(command, argument));
  }
  return rows.empty() ? "" : "      case $2 in\n" + rows + "        *) return 1 ;;\n      esac\n";
}

}  // namespace

std::string make_bash_completion(const CommandDefinition& program, const std::string& version) {
  return fmt::format(
             "# Completion of armwright {} for bash, written by 'armwright completion bash'.\n\n"
             "# The commands below a command, in REPLY.\n",
             version) +
         make_function("_armwright_commands", program, make_commands) +
         "# The flags of a command, in REPLY.\n" +
         make_function("_armwright_flags", program, make_flags) +
         "# Where the values come from that a flag of a command takes, or an argument by its place "
         "from 1, in REPLY.\n# Fails if the flag takes none.\n" +
         make_function("_armwright_sources", program, make_values) + kBashCompletionText;
}

}  // namespace armwright
