# bash completion for pingvox: commands, options and words as the program's own --help lists them. Needs nothing of the
# bash-completion package, and uses nothing of it.

# _pingvox_help [COMMAND]: what the program that is being typed says of itself.
_pingvox_help() { "${COMP_WORDS[0]/#\~/$HOME}" "$@" --help 2>/dev/null; }

# _pingvox_value OPTION: what a help text on standard input calls the value of an option; nothing for a flag. Its lines
# are as in `  -o, --output FILE     what it is`.
_pingvox_value() { sed -nE "s/^ {2,6}(-[a-zA-Z], )?$1 ([^ ]+)( .*)?\$/\\2/p"; }

# _pingvox_words COMMAND: what the first argument of a command can be besides a file, one word a line.
_pingvox_words() {
  case "$1" in
    "") _pingvox_help | sed -nE '/^Commands:/,/^$/s/^ {2,}([a-z]+) .*/\1/p' ;;
    simulate) printf '%s\n' tank harbour marina seabed cave ;;
    emulate) printf '%s\n' ping360 micron mavlink a50 ;;
  esac
}

_pingvox() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command="" words="" value="" i
  COMPREPLY=()

  # The first word that is no option is the command.
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then
      command=${COMP_WORDS[i]}
      break
    fi
  done

  # --option=word arrives as three words.
  if [[ $current == "=" ]]; then
    current=""
  elif [[ $previous == "=" ]] && ((COMP_CWORD >= 2)); then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi

  if [[ $previous == --* ]]; then
    value=$(_pingvox_help ${command:+"$command"} | _pingvox_value "$previous")
  fi
  if [[ $value =~ ^\[?([a-z0-9|-]+)\]?$ ]]; then # the words that it can be, as in ray|fan|cone
    words=${BASH_REMATCH[1]//|/ }
  elif [[ -n $value && $value != FILE* && $value != DIR ]]; then
    return # a number or a text: nothing to offer
  elif [[ -n $value || $previous == -o ]]; then
    words=""
  elif [[ $current == -* ]]; then
    words=$(_pingvox_help ${command:+"$command"} | sed -nE 's/^ {2,6}(-[a-zA-Z], )?(--[a-z-]+)([ [].*)?$/\2/p')
  elif [[ $command == bench ]]; then
    words="all list $("${COMP_WORDS[0]/#\~/$HOME}" bench list 2>/dev/null | cut -d ' ' -f 1)"
  elif [[ $previous == "$command" || -z $command ]]; then
    words=$(_pingvox_words "$command")
    # What begins no world's name is the file of a mesh.
    [[ -n $(compgen -W "$words" -- "$current") ]] || words=""
  fi

  local IFS=$' \t\n'
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}

complete -F _pingvox pingvox
