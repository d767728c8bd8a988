#!/bin/bash
# completion_test.bash COMPLETION PROGRAM: what bash offers after some lines, made of the program's own --help.
set -euo pipefail

completion=$1
program=$2
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
  COMP_WORDS=("$program" "${@:2}") COMP_CWORD=$(($# - 1))
  COMPREPLY=()
  _pingvox
  reply=$(IFS='|' && echo "${COMPREPLY[*]}")
  ((++cases))
  if [[ $reply != "$expected" ]]; then
    echo "'$*': expected '$expected', got '$reply'"
    ((++failures))
  fi
}

offers "map|info|compare|convert|render|mosaic|view|simulate|slam|locate|evaluate|merge|query|live|emulate|bench" pingvox ""
offers "map|mosaic|merge" pingvox m
offers "compare|convert" pingvox co
offers "evaluate" pingvox ev
offers "sound-speed|mount-yaw|nav-offset|mount-xy" pingvox evaluate --fit ""
offers "--help|--version" pingvox -
offers "--resolution" pingvox map --reso
offers "ray|fan|cone" pingvox map --beam ""
offers "cone" pingvox map tank.csv --beam c
offers "ray|fan|cone" pingvox map --beam =
offers "csv|bt|ot|pvx|ply|pcd|xyz|pgm|yaml|asc|tum|las|glb|tif|tiff|geojson|mcap" pingvox convert --format ""
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
offers "auto|always|never" pingvox map --progress ""
offers "mean|maximum" pingvox mosaic --blend ""
offers "polar|cartesian|above|side|slice" pingvox render --view ""
offers "on|off" pingvox render --echoes ""
offers "first|all" pingvox convert --echoes ""
offers "still|loop" pingvox emulate --trajectory ""
offers "still|line|lawn-mower|loop|by-hand" pingvox simulate --trajectory ""
offers "bt|ot|pvx" pingvox live --format ""
offers "1|2" pingvox emulate --lines ""
offers "ping360|micron|mavlink|a50" pingvox emulate ""
offers "tank.csv" pingvox compare a b --visible-from tank
offers "tank.csv" pingvox simulate tank --truth tank
offers "" pingvox simulate tank --gain ""
offers "" pingvox live --nav ""
commands=$(_pingvox_words "")
if "$program" bench list >/dev/null 2>&1; then
  offers "all|accuracy" pingvox bench a
  offers "tank-3d|tank-3d-cells" pingvox bench rays tank-3
  offers "--json|--markdown|--pictures|--quiet" pingvox bench --
  offers "tank.csv" pingvox bench all --pictures tank
else
  commands=$(grep -v '^bench$' <<<"$commands")
fi

# Each command offers an option for each line of its help that begins with one.
while read -r command; do
  help=$("$program" "$command" --help)
  options=$(grep -cE '^ {2,6}-' <<<"$help")
  COMP_WORDS=("$program" "$command" --) COMP_CWORD=2 COMPREPLY=()
  _pingvox
  ((++cases))
  if ((${#COMPREPLY[@]} != options)); then
    echo "$command: ${#COMPREPLY[@]} options are offered, and its help has $options"
    ((++failures))
  fi
done <<<"$commands"

# The words by hand are those of the help.
for command in simulate emulate; do
  help=$("$program" "$command" --help)
  while read -r word; do
    ((++cases))
    grep -qw -- "$word" <<<"$help" && continue
    echo "$command: its help knows no '$word'"
    ((++failures))
  done < <(_pingvox_words "$command")
done

echo "$cases cases, $failures failures"
((failures == 0))
