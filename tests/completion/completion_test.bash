#!/bin/bash
# completion_test.bash COMPLETION [PROGRAM]: what bash offers after some lines, and that the options and words it offers
# are those of the program's own --help.
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

offers "map|info|compare|convert|render|simulate|slam|locate|live|emulate|bench" pingvox ""
offers "map" pingvox m
offers "compare|convert" pingvox co
offers "--help|--version" pingvox -
offers "--resolution" pingvox map --reso
offers "ray|fan|cone" pingvox map --beam ""
offers "cone" pingvox map tank.csv --beam c
offers "ray|fan|cone" pingvox map --beam =
offers "csv|bt|ot|pvx|ply|pcd|xyz|pgm|yaml|asc|tum" pingvox convert --format ""
offers "low|normal|high" pingvox live --gain ""
offers "ply" pingvox map --format pl
offers "cone" pingvox map --beam = c
offers "" pingvox map --resolution ""
offers "tank.csv" pingvox map tank
offers "tank.csv" pingvox map tank.csv -o tank
offers "two words.csv" pingvox info two
offers "tank|harbour|marina|seabed|cave" pingvox simulate ""
offers "tank.csv" pingvox simulate tank.
offers "lawn-mower" pingvox simulate harbour --trajectory la
offers "--json" pingvox compare a b --j
offers "all|accuracy" pingvox bench a
offers "tank-3d|tank-3d-cells" pingvox bench rays tank-3
offers "--pictures" pingvox bench --p
offers "tank.csv" pingvox bench all --pictures tank

# same WHAT FIRST SECOND: two lists of lines, in any order.
same() {
  local difference
  ((++cases))
  difference=$(comm -3 <(sort -u <<<"$2") <(sort -u <<<"$3"))
  if [[ -n $difference ]]; then
    printf '%s\n%s\n' "$1: only in the completion (left) or only in --help (right):" "$difference"
    ((++failures))
  fi
}

if [[ -n $program ]]; then
  for command in map info compare convert render simulate slam locate live emulate; do
    help=$("$program" "$command" --help)
    # Lines as in `  -o, --output FILE     what it is`.
    in_help=$(sed -nE 's/^ {2,}(-[a-zA-Z], )?(--[a-z-]+)( .*)?$/\2/p' <<<"$help")
    same "$command" "$(_pingvox_options "$command")" "$in_help"
    for option in $in_help; do
      words=$(sed -nE "s/^ {2,}(-[a-zA-Z], )?$option \[?([a-z0-9-]+(\|[a-z0-9-]+)*)]?( .*)?\$/\\2/p" <<<"$help" | tr '|' '\n')
      same "$command $option" "$(_pingvox_words "$option" "$command")" "$words"
    done
  done
  if benches=$("$program" bench list 2>/dev/null); then
    same "benches" "$(_pingvox_benches)" "$(cut -d ' ' -f 1 <<<"$benches")"
    same "bench" "$(_pingvox_options bench)" \
      "$(sed -nE 's/^ {2,}(--[a-z]+)( .*)?$/\1/p' <<<"$("$program" bench --help)"; echo --help)"
  fi
  same "commands" "$(_pingvox_commands)" "$("$program" --help | sed -nE '/^Commands:/,/^$/s/^ {2,}([a-z]+) .*/\1/p')"
fi

echo "$cases cases, $failures failures"
((failures == 0))
