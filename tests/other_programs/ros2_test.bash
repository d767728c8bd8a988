#!/bin/bash
# Maps echoes that another maker's DDS publishes by its odometry or tf, and has the published map received by it.
# Usage: ros2_test.bash PROGRAM PEER TOPIC DOMAIN
set -euo pipefail
program=$1 peer=$2 topic=$3 domain=$4
folder=$(mktemp -d)
trap 'kill "$peer_id" "$live_id" 2>/dev/null || true; rm -rf "$folder"' EXIT
live_id= peer_id=

"$peer" "$domain" "$folder/received" 60 >"$folder/peer.txt" 2>&1 &
peer_id=$!
status=0
timeout 55 "$program" live ros2:/scan_echo --nav "ros2:$topic" -o "$folder/map.bt" --publish ros2 --publish-every 1 \
  --ros-domain "$domain" --ros-interface lo --ros-distribution jazzy --beams 600 --json \
  >"$folder/live.txt" 2>"$folder/messages.txt" || status=$?
if grep -q "built without Cyclone DDS" "$folder/messages.txt"; then
  echo "skipped: the program was built without Cyclone DDS"
  exit
fi
cat "$folder/messages.txt"
tail -1 "$folder/live.txt"
((status == 0)) || { echo "live: status $status"; exit 1; }
wait "$peer_id" || { cat "$folder/peer.txt"; echo "the peer did not receive a map of a node"; exit 1; }
cat "$folder/peer.txt"
# The tree is what is behind the header of the file.
header=$(grep -abom1 '^data$' "$folder/map.bt" | cut -d: -f1)
tail -c +$((header + 6)) "$folder/map.bt" >"$folder/tree"
cmp "$folder/tree" "$folder/received"
echo "the map that was received is that of the file: $(stat -c %s "$folder/received") bytes"
