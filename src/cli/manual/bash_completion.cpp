// The completion script for bash.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "cli/manual/completion.hpp"

namespace armwright {
namespace {

// The part of the script that is the same for all programs. It needs bash 4.4, but not the package
// bash-completion.
constexpr const char* kBashCompletionText = R"--(
# Sets `words` to the words up to the cursor; the last one may be empty. Readline also breaks words at ':' and '=', as in
# nlopt:bobyqa. Parts without a blank between them are joined again.
_armwright_join_words() {
  local rest=$COMP_LINE i word blanks
  if ((COMP_POINT < ${#rest})); then
    rest=${rest:0:COMP_POINT}
  fi
  words=()
  for ((i = 0; i <= COMP_CWORD; i++)); do
    blanks=${rest%%[![:blank:]]*}
    rest=${rest#"$blanks"}
    word=$rest
    if ((i < COMP_CWORD)); then
      word=${COMP_WORDS[i]}
      rest=${rest#"$word"}
    fi
    if [[ -z $blanks && ${#words[@]} -gt 0 ]]; then
      words[-1]+=$word
    else
      words+=("$word")
    fi
  done
}

# Adds to COMPREPLY all values of the sources $1 that begin with $2, with $3 in front. Uses `program`, `command` and
# `arguments` of its caller.
_armwright_values() {
  local value=$2 prefix=$3 source kind name
  local -a names=() found=()
  # Quotes and backslashes are not part of the name; readline adds them again.
  value=${value#[\'\"]}
  value=${value//\\/}
  if [[ " $1 " == *' separated '* && $value == *,* ]]; then
    prefix+=${value%,*},
    value=${value##*,}
  fi
  for source in $1; do
    case $source in
      choice:*) names+=("${source#choice:}") ;;
      list:@commands)
        _armwright_commands "${arguments[*]}"
        names+=($REPLY)
        ;;
      list:*)
        kind=${source#list:}
        if [[ $kind == @1 ]]; then
          kind=${arguments[0]-}
        elif [[ $kind == optimizers && $value == multistart:* ]]; then
          prefix+=multistart:
          value=${value#multistart:}
        fi
        mapfile -t found < <("$program" list "$kind" --names 2>/dev/null)
        names+=("${found[@]}")
        ;;
    esac
  done
  for name in "${names[@]}"; do
    if [[ $name == "$value"* ]]; then
      COMPREPLY+=("$prefix$name")
    fi
  done
  # With this option, readline escapes names of files and adds a slash to folders. Other names must not be changed.
  if ((${#COMPREPLY[@]} == 0)); then
    compopt -o filenames 2>/dev/null
  fi
  case " $1 " in
    *' file '*) mapfile -t found < <(compgen -f -- "$value") ;;
    *' folder '*) mapfile -t found < <(compgen -d -- "$value") ;;
    *) found=() ;;
  esac
  for name in "${found[@]}"; do
    COMPREPLY+=("$prefix$name")
  done
}

_armwright() {
  local program=${COMP_WORDS[0]} command='' flag='' i word current REPLY IFS=$' \t\n'
  local -a words arguments=()
  program=${program/#~\//$HOME/}
  COMPREPLY=()
  _armwright_join_words
  current=${words[-1]}

  # Finds the command, the flag and the number of arguments before the cursor.
  for word in "${words[@]:1:${#words[@]}-2}"; do
    _armwright_commands "$command"
    if [[ -n $flag && $word != --* ]]; then
      flag=''
    elif [[ $word == --*=* ]]; then
      flag=''
    elif [[ $word == -?* ]]; then
      flag=''
      if _armwright_sources "$command" "$word"; then
        flag=$word
      fi
    elif [[ " $REPLY " == *" $word "* ]]; then
      command+=${command:+ }$word
    else
      arguments+=("$word")
    fi
  done

  _armwright_commands "$command"
  if [[ $current == --*=* ]]; then
    flag=${current%%=*}
    if _armwright_sources "$command" "$flag"; then
      _armwright_values "$REPLY" "${current#*=}" "$flag="
    fi
  elif [[ -n $flag && $current != --* ]]; then
    _armwright_sources "$command" "$flag"
    _armwright_values "$REPLY" "$current" ''
  elif [[ $current == -* ]]; then
    _armwright_flags "$command"
    COMPREPLY=($(compgen -W "$REPLY" -- "$current"))
  elif [[ -n $REPLY ]]; then
    COMPREPLY=($(compgen -W "$REPLY" -- "$current"))
  elif _armwright_sources "$command" $((${#arguments[@]} + 1)); then
    _armwright_values "$REPLY" "$current" ''
  fi

  # Readline replaces only the part of a word after its last ':' or '='.
  local breaks=''
  if [[ $COMP_WORDBREAKS == *=* ]]; then breaks+='='; fi
  if [[ $COMP_WORDBREAKS == *:* ]]; then breaks+=':'; fi
  if [[ -n $breaks && $current == *[$breaks]* && $current != [\'\"]* ]]; then
    word=${current%"${current##*[$breaks]}"}
    COMPREPLY=("${COMPREPLY[@]#"$word"}")
  fi
}

complete -F _armwright armwright
)--";

// "testset export"; empty for the program itself
std::string get_path(const CommandDefinition& command) {
  return join(std::span(command.words).subspan(1), " ");
}

std::vector<std::string> list_flag_names(const ArgumentDefinition& flag) {
  std::vector<std::string> names = flag.short_names;
  std::ranges::copy(flag.long_names, std::back_inserter(names));
  return names;
}

// Returns one word per place that values come from, as _armwright_values in the script reads them.
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

// Returns a shell function that sets REPLY to one text per command.
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

// Returns the rows for a command: one per flag, and one per argument by its place from 1. The row
// of an argument that repeats serves all later places.
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
             "# Sets REPLY to the commands below a command.\n",
             version) +
         make_function("_armwright_commands", program, make_commands) +
         "# Sets REPLY to the flags of a command.\n" +
         make_function("_armwright_flags", program, make_flags) +
         "# Sets REPLY to the sources of the values of a flag, or of an argument by its place from "
         "1.\n"
         "# Fails if the flag has no value.\n" +
         make_function("_armwright_sources", program, make_values) + kBashCompletionText;
}

}  // namespace armwright
