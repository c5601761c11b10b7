#!/usr/bin/env bash
# Fails and shows the places if clang-format would change anything. Usage: format.sh CLANG_FORMAT ROOT
set -euo pipefail
cd "$2"
find src apps tests -name '*.[ch]pp' -print0 | xargs -0 -r "$1" --dry-run -Werror
