#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs all tests.
#   tools/test.sh [ctest options]
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install-dependencies.sh
cmake --preset dev -DISTHMUS_TESTS=ON > /dev/null
cmake --build --preset dev
ctest --preset dev --parallel "$(nproc)" "$@"
