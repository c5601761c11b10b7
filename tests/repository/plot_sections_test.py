#!/usr/bin/python3
"""Lets tools/plot_sections.py draw small made-up runs of three spaces, and refuse what cannot be drawn.
Usage: plot_sections_test.py ROOT"""

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

INPUT = """\
space = "{space}"
[[material]]
name = "AA2024"
[[material]]
name = "AA5754"
[[body]]
name = "core"
[[rigid]]
name = "die"
[[rigid]]
name = "tool"
reference_point = ["0 m", "0 m", "0.0045 m"]
[rigid.rotation]
rate = "100 rad/s"
"""
HISTORY = "time [s],tool.displacement_z [m]\n0,0\n10,-0.002\n"


def write_run(run, space):
    """Snapshots at 0, 5 and 10 s of a block of 9 x 9 x 5 particles (a plane, a half-plane); two materials."""
    run.mkdir()
    x, y, z = np.meshgrid(np.arange(-4, 5), np.arange(-4, 5), np.arange(5), indexing="ij")
    if space == "plane_strain":
        x, y, z = x[:, :, :1], y[:, :, :1], z[:, :, :1]
    if space == "axisymmetric":
        x, y, z = (a[5:, 4:5] for a in (x, y, z))
    points = 1e-3 * np.stack([x, y, z], -1).reshape(-1, 3).astype("f4")
    (run / "input_as_used.toml").write_text(INPUT.format(space=space), encoding="utf-8")
    (run / "history.csv").write_text(HISTORY, encoding="utf-8")
    index = "number,step,time [s],file,rigid file\n"
    for number in range(3):
        name = f"snapshot_{number:06d}.vtkhdf"
        index += f"{number},{number},{5.002 * number},{name},\n"
        with h5py.File(run / name, "w") as file:
            file["VTKHDF/Points"] = points
            data = file.create_group("VTKHDF/PointData")
            data["material"] = (points[:, 0] > 0).astype("i8")
            data["temperature"] = 300 + 1e4 * points[:, 2] * number
            data["grain_size"] = np.full(len(points), 3e-6, "f4") + 1e-3 * points[:, 2]
            data["recrystallised"] = (points[:, 2] > 1e-3).astype("i8") * (number > 0)
            data["stress"] = np.zeros((len(points), 6), "f4")
            data["temperature"].attrs["unit"] = np.bytes_("K")
            data["grain_size"].attrs["unit"] = np.bytes_("m")
    (run / "snapshots.csv").write_text(index, encoding="utf-8")


def check_places(plot, scratch):
    """The top section lies under the tool where it was at that time; the mirrored half-plane is whole."""
    arguments = plot.parser().parse_args([str(scratch / "cartesian3")])
    run = scratch / "cartesian3"
    scene = plot.read_input(run)
    assert abs(plot.tool_face(run, scene, 0) - 4.5e-3) < 1e-12
    assert abs(plot.tool_face(run, scene, 5) - 3.5e-3) < 1e-12
    rows = plot.nearest_snapshots(plot.read_index(run), [10])
    assert rows[0][0] == 2
    arguments.thickness = 1.0
    top = plot.picture_of(run, rows[0], "top", "material", arguments, scene)
    assert len(top["view"]) == 81 and top["axes"] == ("x", "y"), "one layer, z = 2 mm, under the tool at 2.5 mm"
    grain = plot.picture_of(run, rows[0], "longitudinal", "grain_size", arguments, scene)
    assert len(grain["view"]) == 45 and np.isnan(grain["values"]).sum() == 18, "y = 0; z <= 1 mm is not recrystallised"
    assert abs(np.nanmax(grain["values"]) - 7.0) < 1e-3, "micrometres"
    run = scratch / "axisymmetric"
    mirrored = plot.picture_of(run, rows[0][:2] + (run / rows[0][2].name, None), "longitudinal", "material", arguments,
                               plot.read_input(run))
    assert len(mirrored["view"]) == 40 and abs(mirrored["view"][:, 0].sum()) < 1e-9


def refused(script, *arguments):
    """The message of a call that must fail."""
    result = subprocess.run([sys.executable, script, *arguments], capture_output=True, text=True, check=False)
    assert result.returncode == 2 and "Traceback" not in result.stderr, result.stderr
    return result.stderr


def main():
    script = Path(sys.argv[1]) / "tools/plot_sections.py"
    sys.path.insert(0, str(script.parent))  # as when it is run: its module lies beside it
    specification = importlib.util.spec_from_file_location("plot_sections", script)
    plot = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(plot)
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        for space in ("cartesian3", "plane_strain", "axisymmetric"):
            write_run(scratch / space, space)
            planes = ["longitudinal", "top"] if space == "cartesian3" else ["longitudinal"]
            subprocess.run([sys.executable, script, scratch / space, "--times", "5", "10", "--plane", *planes, "--colour",
                            "material", "temperature"] + (["grain_size"] if space != "plane_strain" else []),
                           check=True)
            for plane in planes:
                data = (scratch / space / f"pictures/section_{plane}_temperature.png").read_bytes()
                assert data.startswith(b"\x89PNG") and len(data) > 5_000
        check_places(plot, scratch)
        run = scratch / "cartesian3"
        assert "use --plane longitudinal" in refused(script, scratch / "axisymmetric", "--plane", "top")
        assert "material, recrystallised, temperature" in refused(script, run, "--colour", "hardness")
        assert "several components" in refused(script, run, "--colour", "stress")
        assert "reach from 0 to 10 s" in refused(script, run, "--times", "50")
        assert "no metal in the section" in refused(script, run, "--plane", "top", "--height", "20")
        assert "no snapshots" in refused(script, scratch)
    return 0


if __name__ == "__main__":
    sys.exit(main())
