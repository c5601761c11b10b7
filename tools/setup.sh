#!/usr/bin/env bash
# Installs what building, testing and plotting need and this machine lacks (Debian 12 or a relative, with apt).
# Usage: tools/setup.sh. Says nothing when everything is there.
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config git ca-certificates
  openmpi-bin libopenmpi-dev libpetsc-real-dev petsc-dev libhdf5-openmpi-dev libmetis-dev
  libtoml11-dev libudunits2-dev libcli11-dev libspdlog-dev libfmt-dev libmuparser-dev libgmsh-dev libgtest-dev clang-format
  python3 python3-h5py python3-numpy python3-scipy python3-matplotlib
)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "setup: this is not Debian or a relative of it (no apt). Install by other means what these packages hold:" >&2
  printf '  %s\n' "${packages[*]}" >&2
  echo "then run tools/build.sh; the other scripts go on without installing if STIRSPH_NO_SETUP=1." >&2
  [ "${STIRSPH_NO_SETUP:-0}" = 1 ] && exit 0
  exit 1
fi

installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  grep -qx "installed $package" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} = 0 ] && exit 0
if [ "${STIRSPH_NO_SETUP:-0}" = 1 ]; then
  echo "setup: not installing (STIRSPH_NO_SETUP=1), though these are missing: ${missing[*]}" >&2
  exit 0
fi

as_root=()
if [ "$(id -u)" != 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: these packages are missing and there is neither root nor sudo to install them: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# shellcheck disable=SC2317  # called through run
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Dpkg::Use-Pty=0 "$@"; }
run() {
  if ! "$@" >"$log" 2>&1; then
    echo "setup: '$*' failed:" >&2
    tail -n 20 "$log" >&2
    exit 1
  fi
}
echo "setup: installing ${missing[*]}"
run apt update
run apt install -y --no-install-recommends "${missing[@]}"
