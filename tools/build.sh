#!/usr/bin/env bash
# Configures and builds a CMake preset in build/PRESET with all cores; shows output only when something fails.
# Usage: tools/build.sh [release|portable|debug|asan] [target ...]      (default: release, everything with tests)
# The preset is the same with and without tests, so building the programs first and the tests later repeats nothing.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
[ $# -gt 0 ] && shift
log=$(mktemp)
trap 'rm -f "$log"' EXIT
run() {
  if ! "$@" >"$log" 2>&1; then
    echo "build: '$*' failed:" >&2
    # A failing compiler's first complaint is the one to read; the end holds only the summary.
    grep -m 40 -A 12 -E 'error|Error|FAILED' "$log" >&2 || tail -n 60 "$log" >&2
    exit 1
  fi
}
targets=()
for target in "$@"; do targets+=(--target "$target"); done
run cmake --preset "$preset"
run cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}"
