#!/usr/bin/env bash
# Installs what is missing, builds the release preset with its tests and runs them.
# Usage: tools/test.sh [ctest arguments], for example tools/test.sh -L heat
# The last line is "N passed, N failed"; the exit status is 0 only if none failed.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/setup.sh
# The packages of apt belong to Debian's own Python; another one earlier in the PATH has none of them.
export PATH=/usr/bin:$PATH
tools/build.sh release
exec tools/run_ctest.sh release "$@"
