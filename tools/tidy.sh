#!/usr/bin/env bash
# clang-tidy (.clang-tidy) over sources, with clang's command for each by itself (.build/tidy).
#   tools/tidy.sh              all sources: an hour of CPU time
#   tools/tidy.sh --recent N   at most N of those that the last commits changed, CGAL's and Ceres' users left out
#   tools/tidy.sh FILE...      these
set -euo pipefail
cd "$(dirname "$0")/.."
build=.build/tidy

case ${1:-} in
  -h | --help)
    sed -n '2,5s/^# \{0,1\}//p' "$0"
    exit 0
    ;;
  --recent)
    mapfile -t files < <(git log -n 20 --pretty= --name-only --diff-filter=AM -- '*.cpp' | awk '!seen[$0]++' |
      while read -r file; do [[ ! -f $file ]] || grep -qE 'include <(CGAL|ceres)/' "$file" || echo "$file"; done | head -n "$2")
    ;;
  -*)
    echo "usage: tools/tidy.sh [--recent N | FILE...]" >&2
    exit 2
    ;;
  "") mapfile -t files < <(git ls-files '*.cpp') ;;
  *) files=("$@") ;;
esac

[[ -f $build/compile_commands.json ]] || cmake --preset tidy > /dev/null
# What lcm-gen and the build make is included by the sources.
cmake --build --preset tidy --target isthmus_lcmtypes_headers isthmus_commit > /dev/null
echo "${#files[@]} files"
printf '%s\0' "${files[@]}" | xargs -0 -r -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build" 2> >(grep -v 'warnings generated' >&2)
