#!/bin/bash
# completion_test.bash COMPLETION [PROGRAM]: what bash offers after some lines, and that the options it offers are those
# of the program's own --help.
set -euo pipefail

completion=$1
program=${2-}
cases=0
failures=0
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd "$scratch"
touch tank.csv "two words.csv"

# shellcheck disable=SC1090 # the file under test
source "$completion"
compopt() { :; } # only allowed while bash completes

# offers EXPECTED WORD...: the reply to a line that ends with the last WORD (which may be empty), joined by `|`.
offers() {
  local expected=$1 reply
  shift
  # shellcheck disable=SC2034 # what the completion function reads
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _pingvox
  reply=$(IFS='|' && echo "${COMPREPLY[*]}")
  ((++cases))
  if [[ $reply != "$expected" ]]; then
    echo "'$*': expected '$expected', got '$reply'"
    ((++failures))
  fi
}

offers "map|info|compare|convert|render|simulate" pingvox ""
offers "map" pingvox m
offers "compare|convert" pingvox co
offers "--help|--version" pingvox -
offers "--resolution" pingvox map --reso
offers "ray|fan|cone" pingvox map --beam ""
offers "cone" pingvox map tank.csv --beam c
offers "ray|fan|cone" pingvox map --beam =
offers "cone" pingvox map --beam = c
offers "" pingvox map --resolution ""
offers "tank.csv" pingvox map tank
offers "tank.csv" pingvox map tank.csv -o tank
offers "two words.csv" pingvox info two
offers "tank" pingvox simulate ""
offers "--json" pingvox compare a b --j

# Long options in a help text, without those that only a negation or the help itself shows.
options_in_help() { "$program" "$@" --help | grep -oE -- '(^|[ ,[])--[a-z][a-z-]+' | grep -oE -- '--.*' | sort -u; }

if [[ -n $program ]]; then
  for command in map info compare convert render simulate; do
    ((++cases))
    difference=$(comm -3 <(_pingvox_options "$command" | sort -u) <(
      words=("$command")
      [[ $command != simulate ]] || words+=(tank)
      options_in_help "${words[@]}"
    ))
    if [[ -n $difference ]]; then
      echo "$command: options only in the completion (left) or only in --help (right):"
      echo "$difference"
      ((++failures))
    fi
  done
fi

echo "$cases cases, $failures failures"
((failures == 0))
