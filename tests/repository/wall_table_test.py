#!/usr/bin/python3
"""Lets tools/wall_table.py read a made-up tube whose means are known, and refuse what has none.
Usage: wall_table_test.py ROOT"""

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

INPUT = """\
space = "axisymmetric"
[[rigid]]
name = "die"
[[rigid]]
name = "tool"
reference_point = ["0 m", "0 m", "0.012 m"]
shape = { type = "tool", radius = "0.004 m" }
rotation = { rate = "100 rad/s" }
"""


def write_run(run, with_grains=True):
    """Two snapshots. In the last one the face stands at 10 mm: a row below it, and a wall of three rings from 4 to 7 mm;
    of the middle one only the lower half has recrystallised."""
    run.mkdir()
    (run / "input_as_used.toml").write_text(INPUT, encoding="utf-8")
    (run / "history.csv").write_text("time [s],tool.displacement_z [m]\n0,0\n1,-0.002\n", encoding="utf-8")
    (run / "snapshots.csv").write_text("number,step,time [s],file,rigid file\n0,0,0,a.vtkhdf,\n1,9,1,b.vtkhdf,\n",
                                       encoding="utf-8")
    below = [(r, 9.5, 3.0, 1) for r in (0.5, 1.5, 2.5, 3.5)]
    wall = [(4.5 + k, 11.5 + row, 4.0 + k, k != 1 or row < 2) for k in range(3) for row in range(4)]
    elsewhere = [(0.5, 5.0, 9.0, 1), (4.5, 10.5, 9.0, 1)]  # deep in the billet; beside the face
    r, z, grain, known = np.array(below + wall + elsewhere).T
    for name in ("a", "b"):
        with h5py.File(run / f"{name}.vtkhdf", "w") as file:
            file["VTKHDF/Points"] = 1e-3 * np.stack([r, 0 * r, z], -1)
            data = file.create_group("VTKHDF/PointData")
            data["equivalent_plastic_strain"] = 10 * grain
            data["hardness"] = 100 + grain
            if with_grains:
                data["grain_size"] = 1e-6 * np.where(known > 0, grain, 30)
                data["recrystallised"] = known


def main():
    tool = Path(sys.argv[1]) / "tools/wall_table.py"

    def told(*arguments):
        return subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True, check=False)

    with tempfile.TemporaryDirectory() as folder:
        tube, bare = Path(folder) / "tube", Path(folder) / "bare"
        write_run(tube)
        write_run(bare, with_grains=False)
        result = told(tube)
        lines = [" ".join(line.split()) for line in result.stdout.splitlines()]
        expected = ["below the tool 4 of 4 recrystallised, 3.00 um 103.0 HV, plastic strain 30",
                    "wall, inner third 4 of 4 recrystallised, 4.00 um 104.0 HV, plastic strain 40",
                    "wall, middle 2 of 4 recrystallised, 5.00 um 105.0 HV, plastic strain 50",
                    "wall, outer third 4 of 4 recrystallised, 6.00 um 106.0 HV, plastic strain 60"]
        problems = [f"missing: {line}\n{result.stdout}{result.stderr}" for line in expected if line not in lines]
        refused = told(bare)
        if refused.returncode != 2 or "[microstructure]" not in refused.stderr:
            problems.append(f"a run without grains: {refused.returncode} {refused.stderr}")
        if told(Path(folder) / "nothing").returncode != 2:
            problems.append("a folder that does not exist is not refused")
    print("\n".join(problems) if problems else "wall_table: in order")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
