// The part of the completion script that is the same for all programs.
#pragma once

namespace armwright {

// Needs bash 4.4 and nothing else, not even the package bash-completion.
inline constexpr const char* kBashCompletionText = R"--(
# The words up to the cursor, in `words`, the last of them perhaps empty. Readline also breaks words at ':' and '=', as in
# nlopt:bobyqa; they are put together again where no blank stands between them.
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

# Adds to COMPREPLY what begins with $2 of the sources $1, with $3 in front. Sees `program`, `command` and `arguments` of its caller.
_armwright_values() {
  local value=$2 prefix=$3 source kind name
  local -a names=() found=()
  # Quotes and backslashes are not part of the name; readline adds its own again.
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
  # Names of files get what their characters need, and folders a slash; other names must be left alone.
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

  # Where on the line the cursor is: behind which command, which flag, how many arguments.
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

  # Of a word with ':' or '=' readline replaces only what stands behind the last of them.
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

}  // namespace armwright
