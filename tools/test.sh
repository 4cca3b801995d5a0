#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs all tests.
#   tools/test.sh [-- CTEST OPTIONS]     # such as: tools/test.sh -- -L unit
set -euo pipefail
cd "$(dirname "$0")/.."
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  sed -n '2,3s/^# \{0,1\}//p' tools/test.sh
  exit 0
fi
if [[ $# -gt 0 && $1 != -- ]]; then
  echo "test.sh: '$1' is no option of its own; those of ctest stand behind --" >&2
  exit 2
fi
[[ $# -eq 0 ]] || shift

tools/install-dependencies.sh
# Debug information, a quarter of the compiler's time, is left out: a test that fails names its line.
cmake --preset dev -DISTHMUS_TESTS=ON -DCMAKE_UNITY_BUILD=ON -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 > /dev/null
cmake --build --preset dev
ctest --preset dev --parallel "$(nproc)" "$@"
