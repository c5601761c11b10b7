#!/usr/bin/env bash
# Builds the fuzzers of tests/fuzz with clang and runs each of them for some minutes, one after the other, on one core.
# Usage: tools/fuzz.sh [MINUTES [fuzz_scene|fuzz_checkpoint|fuzz_checkpoint_parts ...]]      (default: 15 minutes each)
# New inputs gather in build/fuzz/found/FUZZER; a crash ends the script and leaves its input beside them.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes=${1:-15}
[ $# -gt 0 ] && shift
fuzzers=("$@")
[ ${#fuzzers[@]} = 0 ] && fuzzers=(fuzz_scene fuzz_checkpoint fuzz_checkpoint_parts)
if ! command -v clang++ >/dev/null; then
  echo "fuzz: clang++ is missing; on Debian: apt-get install clang libclang-rt-14-dev" >&2
  exit 1
fi
tools/build.sh fuzz "${fuzzers[@]}"
if [ "$(id -u)" = 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
# HDF5 and the standard library are to answer a hopeless allocation as they do without a sanitizer.
export ASAN_OPTIONS=allocator_may_return_null=1:malloc_context_size=5

# Keys, units and punctuation of scene files, from the manual, as words the fuzzer may insert.
write_dictionary() {
  {
    grep -oE "[\`][^\`\"\\]{1,40}[\`]" inputs/PARAMETERS.md | tr -d "\`"
    printf '%s\n' '[[' ']]' ' = ' '{ ' ' }' '[' ']' inf nan true false 1e308 -1 0 ' mm' ' deg' ' degC' ' rpm' ' s' \
      ' m/s' 'sin(' x t
  } | sort -u | sed 's/.*/"&"/'
}

# Seeds: the scenes of the project without their comments, which only cost time, and with a material file that is found
# from the folder the fuzzer reads in.
gather_scenes() {
  local scene
  while IFS= read -r scene; do
    sed -E '/^ *#/d; s/ +# .*$//; s#^(file *= *)".*/materials/.*\.toml"#\1"../materials/aisi_h13.toml"#' "$scene" \
      >"$1/$(tr / _ <<<"$scene")"
  done < <(find inputs tests/verification tests/scene -name '*.toml' -not -path '*/materials/*')
}

for fuzzer in "${fuzzers[@]}"; do
  program=build/fuzz/tests/fuzz/$fuzzer log=build/fuzz/$fuzzer.log
  found=build/fuzz/found/$fuzzer seeds=build/fuzz/seeds/$fuzzer
  mkdir -p "$found" "$seeds"
  options=("-max_total_time=$((60 * minutes))" -timeout=20 -rss_limit_mb=2048 "-artifact_prefix=build/fuzz/found/$fuzzer-")
  case $fuzzer in
    fuzz_scene)
      write_dictionary >build/fuzz/scene.dict
      gather_scenes "$seeds"
      options+=(-max_len=6000 -dict=build/fuzz/scene.dict)
      ;;
    fuzz_checkpoint) # HDF5 and MPI keep memory of their own, which a look for leaks would report
      ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 "$program" --write-seed "$seeds/seed.h5"
      options+=(-max_len=6000 -detect_leaks=0)
      ;;
    fuzz_checkpoint_parts)
      options+=(-max_len=1000 -len_control=0 -detect_leaks=0)
      ;;
  esac
  echo "$fuzzer: $minutes minutes"
  if ! "$program" "${options[@]}" "$found" "$seeds" "tests/fuzz/corpus_${fuzzer#fuzz_}" >"$log" 2>&1; then
    # The leak check at the very end is no finding either.
    if ! grep -q '^Done [0-9]* runs' "$log"; then
      tail -n 60 "$log" >&2
      echo "fuzz: $fuzzer ended early; its whole output is in $log" >&2
      exit 1
    fi
  fi
  grep -E 'DONE|^Done' "$log"
done
