#!/bin/bash
# blueos_test.bash PACKAGING PROGRAM: the extension of BlueOS without one: its labels, and its entry with services of a
# vehicle that are not real, an emulated sonar and autopilot.
# shellcheck disable=SC2016 # expressions of Perl
set -euo pipefail

packaging=$1
program=$2
here=$(dirname "$(realpath "$0")")
cases=0
failures=0
scratch=$(mktemp -d)
pids=()
clean_up() {
  kill "${pids[@]}" 2>/dev/null || true
  wait
  rm -rf -- "$scratch"
}
trap clean_up EXIT

# expect TEXT CONDITION...
expect() {
  local what=$1
  shift
  ((++cases))
  if ! "$@"; then
    echo "failed: $what"
    ((++failures))
  fi
}
same() { [[ $1 == "$2" ]] || { echo "expected '$1', got '$2'"; return 1; }; }
has() { grep -qF -- "$2" "$1" || { echo "no '$2' in:" && cat "$1" && return 1; }; }
lacks() { ! grep -F -- "$2" "$1"; }

# until_so COMMAND...: waits for it, a minute at most.
until_so() {
  for _ in {1..600}; do
    ! "$@" >/dev/null 2>&1 || return 0
    sleep 0.1
  done
  echo "not within a minute: $*"
  return 1
}

# --- The labels -----------------------------------------------------------------------------------------------------
# label NAME: its value as Docker reads it: lines joined, quotes taken off, and arguments filled in.
version=$(sed -n 's/^ARG VERSION=//p' "$packaging/Dockerfile")
homepage=$(sed -n 's/^ARG HOMEPAGE=//p' "$packaging/Dockerfile")
label() {
  sed -e ':join' -e '/\\$/{N;s/\\\n//;b join' -e '}' "$packaging/Dockerfile" | sed -n "s/^LABEL $1=//p" |
    sed -E "s/^'(.*)'\$/\\1/; t; s/^\"(.*)\"\$/\\1/; s/\\\\\"/\"/g" |
    sed "s|\${VERSION}|$version|g; s|\${HOMEPAGE}|$homepage|g"
}
# json_has JSON EXPRESSION: whether it is JSON, in $j, of which the expression of Perl holds.
json_has() {
  perl -MJSON::PP -e 'my $j = decode_json($ARGV[0]); exit(eval($ARGV[1]) ? 0 : 1)' "$1" "$2"
}
expect "the label 'version' is that of the program" same "pingvox $(label version)" "$("$program" --version)"
expect "the type is one that the store knows" grep -qxE 'device-integration|example|theme|other|tool|education' \
  <<<"$(label type)"
expect "the readme is an address with the tag" grep -qE '^https?://[^ ]+/v\{tag\}/[^ ]+\.md$' <<<"$(label readme)"
if perl -MJSON::PP -e 1 2>/dev/null; then
  expect "permissions are JSON, for the network of the vehicle and a folder of its own" json_has "$(label permissions)" \
    '$j->{HostConfig}{NetworkMode} eq "host" && $j->{HostConfig}{Binds}[0] =~ m{^/usr/blueos/extensions/pingvox:/data$}'
  expect "the program has time to write its map when it is stopped" json_has "$(label permissions)" \
    '$j->{StopTimeout} >= 30'
  expect "authors are JSON" json_has "$(label authors)" '$j->[0]{name} && $j->[0]{email}'
  expect "the company is JSON" json_has "$(label company)" '$j->{name} && $j->{about} && $j->{email}'
  expect "links are JSON" json_has "$(label links)" '$j->{website} && $j->{documentation} && $j->{support}'
  expect "tags are JSON: ten at most, of small letters, digits and dashes" json_has "$(label tags)" \
    '@$j && @$j <= 10 && !grep { !/^[a-z0-9-]+$/ } @$j'
else
  echo "JSON::PP of Perl is missing: that labels are JSON is not tested"
fi

# --- The entry ------------------------------------------------------------------------------------------------------
services=$scratch/services
mkdir "$services"
perl "$here/blueos_services.pl" "$services" &
pids+=($!)
until_so test -e "$services/port"
port=$(<"$services/port")

# What the entry starts in most tests: says with which arguments, and ends as the test wants.
cat >"$scratch/program" <<TEXT
#!/bin/bash
if [[ \$* == "live --help" ]]; then
  cat "$scratch/help"
  exit
fi
echo "\$*" >>"$scratch/started"
[[ ! -e $scratch/status ]] || exit "\$(<"$scratch/status")"
trap 'echo ended >>"$scratch/started"; exit' TERM
sleep 60 & wait
TEXT
chmod +x "$scratch/program"
echo "  --view ADDRESS:PORT  --blueos" >"$scratch/help"

entry=
folder=
# start_entry NAME [PROGRAM]: with a folder of its own, unless it is there.
start_entry() {
  folder=$scratch/$1
  : >"$services/asked"
  : >"$services/posted"
  : >"$scratch/started"
  mkdir -p "$folder"
  PINGVOX_PROGRAM=${2-$scratch/program} PINGVOX_FOLDER=$folder PINGVOX_PING_PORT=$port PINGVOX_AUTOPILOT_PORT=$port \
    PINGVOX_MAVLINK_PORT=${mavlink_port-14555} PINGVOX_PAUSE_S=0.2 "$packaging/entry" >"$folder.said" 2>&1 &
  entry=$!
  pids+=("$entry")
}
# stop_entry: its status is 0, and it ends soon.
stop_entry() {
  local status=0
  kill -TERM "$entry"
  wait "$entry" || status=$?
  expect "the entry ends in order" same 0 "$status"
  expect "the entry says that it ends" has "$folder.said" "pingvox: stopped"
}
started() { test -s "$scratch/started"; }

bridged='[{"ping_type":"PING1D","driver_status":{"udp_port":9090,"mavlink_driver_enabled":true},"port":"/dev/ttyUSB1"},
  {"ping_type":"PING360","device_id":2,"port":"/dev/ttyUSB0","ethernet_discovery_info":null,
   "driver_status":{"udp_port":9093,"mavlink_driver_enabled":false}}]'
routed='[ { "name": "GCS Server Link", "connection_type": "udpin", "place": "0.0.0.0", "argument": 14550 },
  { "name": "pingvox", "connection_type": "udpout", "place": "127.0.0.1", "argument": 14555, "enabled": true } ]'

# A vehicle that starts: first no service answers, then there is no sonar, then one behind BlueOS's bridge.
rm -f "$services"/{sensors,endpoints}
begun_us=${EPOCHREALTIME/[.,]/}
start_entry starting
until_so grep -q sensors "$services/asked"
echo '[{"ping_type":"PING1D","driver_status":{"udp_port":9090}}]' >"$services/sensors"
sleep 1
expect "nothing is started without a sonar" lacks "$scratch/started" live
asked=$(grep -c sensors "$services/asked")
pauses=$(((${EPOCHREALTIME/[.,]/} - begun_us) / 200000))
expect "it waits between its questions" test "$asked" -le $((pauses + 1))
expect "it says once what is missing" same 1 "$(grep -c 'waiting for a Ping360' "$folder.said")"
echo "$bridged" >"$services/sensors"
until_so grep -q 'waiting for the autopilot' "$folder.said"
expect "nothing is started before the autopilot can be asked" lacks "$scratch/started" live
echo "${routed/14555/14556}" >"$services/endpoints"
until_so started
expect "the sonar is the Ping360 behind the bridge" has "$scratch/started" "live ping360:udp://127.0.0.1:9093 "
expect "the autopilot's messages are followed" has "$scratch/started" "--nav mavlink:udp://127.0.0.1:14555 "
expect "the page is served, without a token" has "$scratch/started" "--view=0.0.0.0:7360 --blueos "
expect "recordings are in the folder that stays" has "$scratch/started" "--record $folder/recordings "
expect "it maps with SLAM" has "$scratch/started" " --slam"
expect "one endpoint is added to the router" same 1 "$(wc -l <"$services/posted")"
expect "an endpoint is what BlueOS takes" has "$services/posted" \
  '"connection_type": "udpout", "place": "127.0.0.1", "argument": 14555, "persistent": true'
expect "the settings are there to be changed" has "$folder/settings.conf" "navigation = auto"
stop_entry
expect "the program is told to end, too" has "$scratch/started" ended

# Settings that were changed, in a later start; Windows ends lines in its own way.
printf 'sonar = ping360:udp://192.168.2.197:12345\r\nnavigation = auto a50:tcp://192.168.2.95\r\nport=8123\n%s\n' \
  'options = --range 30 --gain low' >"$folder/settings.conf"
rm "$services/sensors"
echo "$routed" >"$services/endpoints"
start_entry starting
until_so started
expect "a sonar that is named is not looked for" has "$scratch/started" "live ping360:udp://192.168.2.197:12345 "
expect "several sources of navigation" has "$scratch/started" \
  "--nav mavlink:udp://127.0.0.1:14555 --nav a50:tcp://192.168.2.95 "
expect "the port" has "$scratch/started" "--view=0.0.0.0:8123 "
expect "the options as they are written" grep -qE -- ' --range 30 --gain low$' "$scratch/started"
expect "no endpoint is added twice" test ! -s "$services/posted"
stop_entry

# A sonar at the network, none of navigation, and a build without the page.
echo '[{"ping_type":"PingType.PING360","port":null,"ethernet_discovery_info":"192.168.2.197:12345",
  "driver_status":{"udp_port":null,"mavlink_driver_enabled":false}}]' >"$services/sensors"
mkdir "$scratch/network"
printf 'navigation = none\n' >"$scratch/network/settings.conf"
: >"$scratch/help"
start_entry network
until_so started
expect "the sonar at the network" has "$scratch/started" "live ping360:udp://192.168.2.197:12345 -o "
expect "without a page it says so" has "$folder.said" "has no page"
expect "without navigation the router is left alone" lacks "$services/asked" endpoints
stop_entry
echo "  --view ADDRESS:PORT  --blueos" >"$scratch/help"

# A program that fails is started again, in another map.
echo 1 >"$scratch/status"
start_entry failing
echo "$bridged" >"$services/sensors"
until_so bash -c "[[ \$(grep -c '^live' '$scratch/started') -ge 3 ]]"
expect "it says that it starts again" has "$folder.said" "ended with status 1; starting again"
stop_entry

# Settings that the program refuses are not tried again until they change.
echo 2 >"$scratch/status"
start_entry refused
until_so grep -q 'settings are wrong' "$folder.said"
sleep 1
expect "wrong settings are tried once" same 1 "$(grep -c '^live' "$scratch/started")"
rm "$scratch/status"
echo 'options = --slam' >>"$folder/settings.conf"
until_so bash -c "[[ \$(grep -c '^live' '$scratch/started') -ge 2 ]]"
expect "the last of two settings counts" grep -qE -- ' --slam$' <(tail -n 1 "$scratch/started")
stop_entry

# A folder that cannot be written.
expect "without a folder it says so" same 1 "$(PINGVOX_FOLDER=/proc/none "$packaging/entry" >"$scratch/said" 2>&1 || echo $?)"
expect "a reason is given" has "$scratch/said" "/proc/none cannot be written"

# The program itself, with emulated devices.
"$program" emulate ping360 --listen udp://127.0.0.1:0 --rate 200 >"$scratch/head" &
pids+=($!)
until_so test -s "$scratch/head"
head_port=$(sed -n '1s/.*:\([0-9]*\)$/\1/p' "$scratch/head")
mavlink_port=$((20000 + RANDOM % 10000))
"$program" emulate mavlink --to "udp://127.0.0.1:$mavlink_port" --rate 50 >/dev/null 2>&1 &
pids+=($!)
echo "${bridged/9093/$head_port}" >"$services/sensors"
mkdir "$scratch/emulated"
# A page needs a port that is free, and a build that has it.
printf 'options = --slam --range 4 --write-every 1\nport = %s\n' "$((30000 + RANDOM % 10000))" \
  >"$scratch/emulated/settings.conf"
start_entry emulated "$program"
has_maps() { compgen -G "$folder/maps/*.ot"; }
has_recordings() { compgen -G "$folder/recordings/*.bin" && compgen -G "$folder/recordings/*.tlog"; }
expect "a map is written" until_so has_maps
expect "sonar and autopilot are recorded" until_so has_recordings
stop_entry
expect "the map is whole" "$program" info "$folder"/maps/*.ot >/dev/null

echo "$cases cases, $failures failures"
((failures == 0))
