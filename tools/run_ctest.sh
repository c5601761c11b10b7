#!/usr/bin/env bash
# Runs the tests of a preset that is built. Usage: tools/run_ctest.sh PRESET [ctest arguments]
# The last line is "N passed, N failed"; the exit status is 0 only if none failed.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
if [ "$(id -u)" = 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "$@" 2>&1 | tee "$log" || status=$?
# ctest counts the failed ones and the whole: "97% tests passed, 3 tests failed out of 104".
read -r failed total < <(sed -nE 's/^.* ([0-9]+) tests? failed out of ([0-9]+).*$/\1 \2/p' "$log" | tail -n 1) || true
if [ -z "${total:-}" ]; then
  echo "test: ctest ran no tests" >&2
  echo "0 passed, 0 failed"
  exit 1
fi
echo "$((total - failed)) passed, $failed failed"
exit "$status"
