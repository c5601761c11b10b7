#!/usr/bin/env bash
# The main job from one command: installs what is missing, builds the programs, extrudes a tube (heating, onset of flow,
# extrusion) in the axisymmetric space and draws the results. Usage: tools/demo.sh [folder for the results]     (default runs/demo)
set -euo pipefail
cd "$(dirname "$0")/.."

out=${1:-runs/demo}
tools/setup.sh
export PATH=/usr/bin:$PATH
tools/build.sh release stirsph
if [ "$(id -u)" = 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

# One rank: 1,750 rings are too few for two. One thread: the numerical libraries must not start more behind its back.
OMP_NUM_THREADS=1 mpirun --oversubscribe --bind-to none -n 1 build/release/stirsph inputs/demo_tube/scene.toml --output "$out"
tools/plot_run.py "$out" >/dev/null

echo
echo "histories: $out/history.csv"
echo "pictures:  $out/pictures/history.png $out/pictures/sections.png"
echo "snapshots: $out/snapshots.vtkhdf.series (ParaView opens it, or any snapshot_*.vtkhdf)"
python3 - "$out" <<'PYTHON'
import json, sys
out = sys.argv[1]
with open(out + "/summary.json", encoding="utf-8") as file:
    summary = json.load(file)
keys = ["wall_s", "tube_length_mm", "T_max_K", "lost_particles", "energy_residual"]
missing = [key for key in keys if key not in summary]
if missing:
    sys.exit("demo: %s/summary.json lacks %s" % (out, ", ".join(missing)))
print("demo: " + " ".join("%s=%.4g" % (key, summary[key]) for key in keys) + " out=" + out)
PYTHON
