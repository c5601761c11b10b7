#!/usr/bin/python3
"""Lets tools/plot_run.py draw small made-up runs, and fail on a folder that is none. Usage: plot_run_test.py ROOT"""

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np


def write_run(run, plane):
    """Two snapshots of a small block and a history, as the simulation writes them."""
    run.mkdir()
    (run / "history.csv").write_text(
        "time [s],tool.force_z [N],tool.torque [N m],T_max [K],energy.plastic [J]\n"
        "0,0,0,300,0\n0.1,-3000,12,nan,250\n0.2,-32", encoding="utf-8")
    index = "number,step,time [s],file\n"
    grid = np.stack(np.meshgrid(*[np.arange(5) * 1e-3] * 3), -1).reshape(-1, 3).astype("f4")
    if plane:
        grid = grid[grid[:, 2] == 0]
    for number in range(2):
        name = f"snapshot_{number:06d}.vtkhdf"
        index += f"{number},{10 * number},{0.1 * number},{name}\n"
        with h5py.File(run / name, "w") as file:
            file["VTKHDF/Points"] = grid
            file["VTKHDF/PointData/temperature"] = np.full(len(grid), 300.0, "f4") + number * grid[:, 0]
            file["VTKHDF/PointData/equivalent_plastic_strain"] = np.zeros(len(grid), "f4")
            file["VTKHDF/PointData/material"] = np.zeros(len(grid), "i8")
    (run / "snapshots.csv").write_text(index, encoding="utf-8")


def main():
    script = Path(sys.argv[1]) / "tools/plot_run.py"
    with tempfile.TemporaryDirectory() as scratch:
        for name, plane in (("solid", False), ("plane", True)):
            run = Path(scratch) / name
            write_run(run, plane)
            subprocess.run([sys.executable, script, run], check=True)
            for picture in ("history.png", "sections.png"):
                data = (run / "pictures" / picture).read_bytes()
                assert data.startswith(b"\x89PNG") and len(data) > 10_000, picture
        empty = Path(scratch) / "empty"
        empty.mkdir()
        result = subprocess.run([sys.executable, script, empty], capture_output=True, text=True, check=False)
        assert result.returncode == 2 and "history.csv" in result.stderr, result.stderr
        assert "Traceback" not in result.stderr and not list(empty.iterdir())
    return 0


if __name__ == "__main__":
    sys.exit(main())
