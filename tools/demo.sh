#!/usr/bin/env bash
# Installs what is missing, builds, simulates a team of four robots in an office and maps their log.
#   tools/demo.sh [DIRECTORY]     where the log and the map go; build/demo without
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/demo}

tools/install-dependencies.sh
cmake --preset release -DISTHMUS_TESTS=OFF > /dev/null
cmake --build --preset release
bin=.build/release/bin

mkdir -p "$out"
echo
echo "Four robots drive through an office ..."
"$bin/isthmus-simulate" --scenario office --seed 1 -o "$out/office.lcm" --truth "$out/truth"
echo "... and their log becomes a map."
"$bin/isthmus-replay" "$out/office.lcm" --output "$out/map"
echo
echo "Against the simulator's truth:"
"$bin/isthmus-evaluate" --truth "$out/truth" --output "$out/map"
echo
echo "Pictures of the islands, the largest first:"
ls "$out"/map/island-*.png
