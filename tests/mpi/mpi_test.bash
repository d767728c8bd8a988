#!/bin/bash
# mpi_test.bash MPIRUN PINGVOX-MPI PINGVOX: many dives on 1 to 8 ranks give the map of one process, to the bit, also after
# a run that was killed.
set -euo pipefail

mpirun=$1
shared=$2
program=$3
cases=0
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cd "$scratch"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
unset DISPLAY

fail() {
  echo "mpi_test: $*" >&2
  exit 1
}
ranks() {
  "$mpirun" --oversubscribe -n "$1" "$shared" "${@:2}"
}
same() {
  cmp "$1" "$2" || fail "$3"
  cases=$((cases + 1))
}

# Dives of a tank, each from a place of its own, two minutes apart; cells at their clamp, so that the order matters.
"$program" simulate tank -o tank.csv --turns 2 --quiet
mkdir -p sonar nav
dives=7
for ((i = 0; i < dives; ++i)); do
  start=$((1700000000 + 120 * i))
  awk -v start="$start" 'BEGIN { FS = OFS = "," } NR > 1 { $1 = sprintf("%.6f", $1 + start) } { print }' \
    tank.csv > "sonar/dive$i.csv"
  {
    printf '# clock: unix\ntime_s,source,quantity,x,y,z\n'
    for ((t = start - 5; t < start + 60; ++t)); do
      printf '%d,ahrs,attitude,0,0,0\n' "$t"
      awk -v t="$t" -v i="$i" 'BEGIN { printf "%d,gps,fix,%.12f,0.17,0\n", t, 0.9 + 0.03 * i / 6.37e6 }'
    done
  } > "nav/nav$i.csv"
done
arguments=(map sonar --nav nav --resolution 0.1 --quiet)
"$program" "${arguments[@]}" -o one.pvx
"$program" merge one.pvx.dives/dive{0,1,2,3,4,5,6}.csv.pvx -o merged.pvx --quiet
status=0
"$program" compare one.pvx merged.pvx > /dev/null || status=$?
[[ $status == 1 ]] || fail "here the order of sums does not matter, which this has to find out"

# The text in the map is the command line, with the name of the output.
mv one.pvx expected.pvx
for n in 1 2 3 4 5 6 7 8; do
  rm -rf one.pvx one.pvx.dives
  ranks "$n" "${arguments[@]}" -o one.pvx
  same one.pvx expected.pvx "$n ranks: another map"
  [[ $(find one.pvx.dives -name '*.pvx' | wc -l) == "$dives" ]] || fail "$n ranks: not all dives are kept"
done

# A run that was killed: what is missing is made again, and nothing else.
rm one.pvx one.pvx.dives/dive{2,5}.csv.pvx
touch -d '2001-01-01' one.pvx.dives/*
ranks 3 "${arguments[@]}" -o one.pvx
same one.pvx expected.pvx "after a run that was killed: another map"
made=$(find one.pvx.dives -name '*.pvx' -newermt '2002-01-01' -printf '%f\n' | sort | tr '\n' ' ')
[[ $made == "dive2.csv.pvx dive5.csv.pvx " ]] || fail "made again: $made"
cases=$((cases + 1))
# Killed at any time.
rm -rf one.pvx one.pvx.dives
ranks 2 "${arguments[@]}" -o one.pvx &
child=$!
until [[ -e one.pvx.dives/dive0.csv.pvx || -e one.pvx ]]; do sleep 0.01; done
kill -TERM "$child" 2> /dev/null || true
wait "$child" 2> /dev/null || true
"$program" "${arguments[@]}" -o one.pvx
same one.pvx expected.pvx "what mpirun left is not what one process goes on with"

# One map each, and what cannot be mapped.
ranks 3 map sonar --nav nav --resolution 0.1 --quiet -o each/
[[ $(find each -name '*.pvx' | wc -l) == "$dives" ]] || fail "a map of each dive: not all are there"
cp one.pvx.dives/dive3.csv.pvx kept.pvx
same each/dive3.csv.pvx kept.pvx "a map of each dive: another one"
rm nav/nav4.csv
if ranks 2 map sonar --nav nav --resolution 0.1 -o less.pvx > out.txt 2> err.txt; then
  fail "a log without navigation: the exit status is 0"
fi
grep -q 'sonar/dive4.csv: skipped: has no navigation at its time' err.txt || fail "a log without navigation: $(< err.txt)"
"$program" map sonar --nav nav --resolution 0.1 -o less.pvx --quiet && fail "one process: the exit status is 0"
status=0
ranks 2 map tank.csv -o tank.bt > out.txt 2> err.txt || status=$?
[[ $status != 0 ]] || fail "one dive: the exit status is 0"
grep -q "pingvox: only 'map' of many dives" err.txt || fail "one dive: $(< err.txt)"
cases=$((cases + 2))
echo "$cases cases"
