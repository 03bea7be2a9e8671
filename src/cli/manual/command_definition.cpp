#include "cli/manual/command_definition.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/terminal/arguments.hpp"

namespace armwright {
namespace {

std::vector<std::string> add_dashes(const char* dashes, const std::vector<std::string>& names) {
  std::vector<std::string> flags;
  std::ranges::transform(names, std::back_inserter(flags),
                         [dashes](const std::string& name) { return dashes + name; });
  return flags;
}

// Returns "NAME" of "NAME:{light,dark}". The parser adds the values that a check allows.
std::string get_value_name(const CLI::Option& option) {
  const std::string name = option.get_type_name();
  return name.substr(0, name.find(":{"));
}

ArgumentDefinition describe_argument(const CLI::Option& option) {
  ArgumentDefinition argument;
  const bool is_flag = option.nonpositional();
  argument.name = is_flag ? "" : option.get_name(true);
  argument.long_names = add_dashes("--", option.get_lnames());
  argument.short_names = add_dashes("-", option.get_snames());
  if (is_flag && option.get_items_expected_max() > 0) {
    argument.value = get_value_name(option);
    argument.is_value_optional = option.get_items_expected_min() == 0;
  }
  argument.is_required = option.get_required();
  argument.repeats = option.get_expected_max() > 1;
  argument.group = option.get_group();
  argument.environment = option.get_envname();
  argument.description = option.get_description();
  for (const CLI::Option* other : option.get_excludes()) {
    argument.excludes.push_back(other->get_name());
  }
  std::ranges::sort(argument.excludes);  // the parser's order depends on addresses
  return argument;
}

CommandDefinition describe_below(const CLI::App& app, std::vector<std::string> words) {
  CommandDefinition command;
  words.push_back(app.get_name());
  command.words = words;
  command.summary = app.get_description();
  std::ranges::replace(command.summary, '\n', ' ');  // --help needs line breaks in long ones
  command.notes = app.get_footer();
  if (command.notes.ends_with(kSeeExitCodes)) {
    command.notes.resize(command.notes.size() - kSeeExitCodes.size());
  }
  for (const CLI::Option* option : app.get_options({})) {
    ArgumentDefinition argument = describe_argument(*option);
    if (!argument.group.empty()) {  // otherwise it is hidden
      (argument.name.empty() ? command.flags : command.arguments).push_back(std::move(argument));
    }
  }
  for (const CLI::App* below : app.get_subcommands({})) {
    if (!below->get_group().empty()) {
      command.commands.push_back(describe_below(*below, words));
    }
  }
  return command;
}

}  // namespace

const std::string& ArgumentDefinition::get_key() const {
  return name.empty() ? long_names.empty() ? short_names.front() : long_names.front() : name;
}

std::string CommandDefinition::get_title() const {
  return join(words, " ");
}

CommandDefinition describe_command(const CLI::App& app) {
  return describe_below(app, {});
}

const CommandDefinition& find_command(const CommandDefinition& program,
                                      const std::vector<std::string>& words) {
  const CommandDefinition* command = &program;
  for (const std::string& word : words) {
    if (command->commands.empty()) {
      throw Error(ErrorKind::usage, "'" + command->get_title() + "' has no commands of its own: '" +
                                        sanitize(word) + "' is one too many");
    }
    const auto found = std::ranges::find_if(
        command->commands,
        [&word](const CommandDefinition& below) { return below.words.back() == word; });
    if (found == command->commands.end()) {
      std::vector<std::string> names;
      for (const CommandDefinition& below : command->commands) {
        names.push_back(below.words.back());
      }
      throw Error(ErrorKind::usage, describe_unknown("command", word, names));
    }
    command = &*found;
  }
  return *command;
}

std::vector<const CommandDefinition*> list_all_commands(const CommandDefinition& command) {
  std::vector<const CommandDefinition*> all = {&command};
  for (const CommandDefinition& below : command.commands) {
    std::ranges::copy(list_all_commands(below), std::back_inserter(all));
  }
  return all;
}

}  // namespace armwright
