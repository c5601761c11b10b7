#!/usr/bin/env bash
# Builds tests with the address and undefined-behaviour sanitizers (preset asan, contracts checked) and runs them on
# their usual numbers of ranks, with a look for leaks at the end of each.
# Usage: tools/sanitize.sh [reduced|all] [ctest arguments]        (default: reduced)
#   reduced  what reads, writes, meshes and exchanges: the tests of the lower layers, which build without the mechanics;
#            about five minutes of one core to build, one to run; continuous integration runs it
#   all      every test; the sweeps over pairs stay without sanitizers unless the build has STIRSPH_SANITIZE_SWEEPS=ON,
#            as their files compile for minutes each
# The last line is "N passed, N failed"; the exit status is 0 only if none failed.
set -euo pipefail
cd "$(dirname "$0")/.."

reduced=(input_test geometry_test lattice_test revolved_profile_test material_test kernel_test pair_list_test
         decomposition_test repartition_rule_test checkpoint_test output_failure_test snapshot_test rigid_snapshot_test
         history_test)
extent=${1:-reduced}
[ $# -gt 0 ] && shift

tools/setup.sh
export PATH=/usr/bin:$PATH # as in tools/test.sh
if [ "$extent" = all ]; then
  tools/build.sh asan
  exec tools/run_ctest.sh asan "$@"
fi
tools/build.sh asan "${reduced[@]}"
exec tools/run_ctest.sh asan --tests-regex "^($(IFS='|' && echo "${reduced[*]}"))\\." "$@"
