#!/usr/bin/env bash
# Installs what is missing, builds, simulates a team of four robots that enter an office by two entrances, and
# maps their log: before their maps merge, in the middle, and to the end. Then four robots explore the same office
# by themselves, by the goals of a server, for 80 s at most.
#   tools/demo.sh [DIRECTORY]     where the log and the maps go; build/demo without
set -euo pipefail
cd "$(dirname "$0")/.."
if [[ ${1:-} == -* ]]; then
  sed -n '2,/^set/s/^# \?//p' tools/demo.sh
  [[ $1 == -h || $1 == --help ]] && exit 0
  echo "tools/demo.sh: no such option: $1" >&2
  exit 2
fi
out=${1:-build/demo}

tools/install-dependencies.sh
cmake --preset release -DISTHMUS_TESTS=OFF > /dev/null
cmake --build --preset release
bin=.build/release/bin

# A whole number of report.json: `number islands DIRECTORY`.
number() { sed -n "s/^  \"$1\": \([0-9]*\),\$/\1/p" "$2/report.json"; }

# What joined islands or closed loops: `start_s end_s kind robots`, in order of time.
accepted() {
  awk '
    /^  "closures"/ { inside = 1 }
    /^  \]/ { inside = 0 }
    !inside { next }
    { gsub(/[",]/, "") }
    /^    {/ { robots = ""; listing = 0 }
    $1 == "kind:" { kind = $2 }
    $1 == "state:" { state = $2 }
    $1 == "start_s:" { start = $2 }
    $1 == "end_s:" { end = $2 }
    $1 == "]" { listing = 0 }
    listing { robots = robots " " $1 }
    $1 == "robots:" { listing = 1 }
    /^    }/ && state == "accepted" { printf "%.1f %.1f %s%s\n", start, end, kind, robots }
  ' "$1/report.json" | sort -n
}

# The map of the log's first seconds, a little less than so many, while there were so many islands.
map_until() {
  local directory=$1 before_s=$2 islands=$3 back until_s
  for back in 0.2 0.4 0.6 0.8 1 1.5 2 3 4 5; do
    until_s=$(awk "BEGIN { print ($before_s > $back ? $before_s - $back : 0) }")
    "$bin/isthmus-replay" "$out/office.lcm" --output "$directory" --until "$until_s" --force > /dev/null
    if [[ $(number islands "$directory") -eq $islands ]]; then break; fi
  done
  printf '  %6.1f s  %s: ' "$until_s" "$(number islands "$directory") island(s)"
  echo "$directory"/island-*-trajectory.png
}

mkdir -p "$out"
echo
echo "Four robots enter an office by two entrances ..."
"$bin/isthmus-simulate" --scenario office --seed 1 -o "$out/office.lcm" --truth "$out/truth" --force
echo "... and their log becomes a map."
"$bin/isthmus-replay" "$out/office.lcm" --output "$out/map" --force > "$out/replay.txt"
merges=$(accepted "$out/map" | grep ' merge ' || true)

echo
echo "When maps merged and loops closed, in seconds of the log:"
accepted "$out/map" | while read -r start end kind robots; do
  printf '  %6.1f to %6.1f s  %-7s of %s\n' "$start" "$end" "$kind" "${robots// /, }"
done
echo
echo "Against the simulator's truth, relations between poses of one robot (intra) and of two (inter):"
"$bin/isthmus-evaluate" --relations "$out/truth/relations.csv" --output "$out/map" | grep -v squared | sed 's/^/  /'
echo
echo "Cost, the slowest event among it:"
grep -E '^(time|event)' "$out/replay.txt" | sed 's/^/  /'
echo
echo "Pictures, the largest island first:"
if [[ -n "$merges" ]]; then
  map_until "$out/before" "$(head -n 1 <<< "$merges" | cut -d ' ' -f 1)" 4
  map_until "$out/middle" "$(tail -n 1 <<< "$merges" | cut -d ' ' -f 1)" 2
fi
printf '  %8s  %s: ' "the end" "$(number islands "$out/map") island(s)"
echo "$out"/map/island-*-trajectory.png

echo
echo "Four robots explore the office by themselves, four times as fast as the clock, for 80 s at most ..."
url="udpm://239.255.76.67:7695?ttl=0"
printf '[exploration]\nenabled = true\n' > "$out/explore.toml"
rm -rf "$out/explored" "$out/drive"
: > "$out/server.txt"
"$bin/isthmus-server" --config "$out/explore.toml" --lcm-url "$url" --status-period 0.25 --output "$out/explored" \
  2> "$out/server.txt" &
server=$!
trap 'kill "$server" 2> /dev/null || true' EXIT
for _ in $(seq 50); do  # until it listens
  if grep -q listening "$out/server.txt"; then break; fi
  sleep 0.1
done
"$bin/isthmus-simulate" --scenario office --seed 1 --live --lcm-url "$url" --speed 4 --max-time 320 \
  --pictures "$out/drive" | sed 's/^/  /'
kill -INT "$server"
wait "$server"
trap - EXIT
printf '  %s island(s): ' "$(number islands "$out/explored")"
drawn=("$out"/drive/*.png)
echo "$out"/explored/island-*-trajectory.png "${drawn[-1]}"
