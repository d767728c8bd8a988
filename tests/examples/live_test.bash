#!/bin/bash
# live_test.bash PINGVOX EXAMPLE: examples/02_live against an emulated head on the loopback address. It ends in good
# order on a signal, and its map is that of its recording.
set -eu
pingvox=$1 example=$2

folder=$(mktemp -d)
pids=()
clean_up() {
  kill "${pids[@]}" 2> /dev/null || true
  rm -rf "$folder"
}
trap clean_up EXIT
cd "$folder"

# wait_for COMMAND...: until it succeeds, a minute at most.
wait_for() {
  for _ in $(seq 600); do
    if "$@"; then return; fi
    sleep 0.1
  done
  echo "not within a minute: $*" >&2
  exit 1
}
has_line() { [[ $(wc -l < "$1") -gt 0 ]]; }
has_bytes() { [[ -e $1 && $(stat -c %s "$1") -gt $2 ]]; }

"$pingvox" emulate ping360 --listen udp://127.0.0.1:0 --rate 1000 > address &
pids+=($!)
wait_for has_line address
"$example" live.ot dive.bin "$(head -1 address)" > said &
live=$!
pids+=($live)
wait_for has_bytes dive.bin 1000000
kill -INT $live
wait $live
cat said
"$pingvox" map dive.bin -o map.ot --resolution 0.1 --quiet
cmp live.ot map.ot
