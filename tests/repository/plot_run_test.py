#!/usr/bin/python3
"""Lets tools/plot_run.py draw small made-up runs, and fail on a folder that is none. Usage: plot_run_test.py ROOT"""

import importlib.util
import itertools
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import matplotlib.image
import numpy as np

HISTORY = """\
time [s],tool.force_z [N],tool.torque [N m],T_max [K],energy.plastic [J],die_temperature [K],thermocouple [K],\
die_heat [J],die_interface_heat [J],heat_particles [J],heat_rigid [J],heat_source [J],heat_residual [1]
0,0,0,300,0,300,300,0,0,0,0,0,0
0.1,-3000,12,nan,250,310,305,20,25,60,20,80,-1e-9
0.2,-32"""


def write_particles(path, number, space):
    """A small block as the simulation writes it."""
    grid = np.stack(np.meshgrid(*[np.arange(5) * 1e-3 - 2e-3] * 3), -1).reshape(-1, 3).astype("f4")
    if space == "plane_strain":
        grid = grid[grid[:, 2] == 0]
    if space == "axisymmetric":
        grid = grid[(grid[:, 1] == 0) & (grid[:, 0] > 0)]
    with h5py.File(path, "w") as file:
        file["VTKHDF/Points"] = grid
        file["VTKHDF/PointData/temperature"] = np.full(len(grid), 300.0, "f4") + number * grid[:, 0]
        file["VTKHDF/PointData/equivalent_plastic_strain"] = np.zeros(len(grid), "f4")
        file["VTKHDF/PointData/material"] = np.zeros(len(grid), "i8")


def box_mesh(low, high, counts):
    """Nodes and simplices of a box divided into cells, each of them into one simplex per order of its axes."""
    dim = len(counts)
    shape = [count + 1 for count in counts]
    index = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), -1).reshape(-1, dim)
    nodes = low + index / np.array(counts) * (np.array(high) - low)
    cells = []
    for corner in itertools.product(*[range(count) for count in counts]):
        for order in itertools.permutations(range(dim)):
            path = np.tile(corner, (dim + 1, 1))
            for step, axis in enumerate(order):
                path[step + 1:, axis] += 1
            cells.append(np.ravel_multi_index(path.T, shape))
    return nodes, np.array(cells)


def write_bodies(path, nodes, temperature, cells, half_plane=False):
    """Meshed rigid bodies as the simulation writes them; nodes in the plane get z = 0, in the half-plane y = 0."""
    corners = cells.shape[1]
    points = np.pad(nodes, ((0, 0), (0, 3 - nodes.shape[1])))
    with h5py.File(path, "w") as file:
        file["VTKHDF/Points"] = (points[:, [0, 2, 1]] if half_plane else points).astype("f4")
        file["VTKHDF/Connectivity"] = cells.ravel().astype("i8")
        file["VTKHDF/Offsets"] = np.arange(len(cells) + 1, dtype="i8") * corners
        file["VTKHDF/PointData/temperature"] = temperature.astype("f4")


def write_run(run, space, bodies):
    """Two snapshots and a history."""
    run.mkdir()
    (run / "input_as_used.toml").write_text(f'space = "{space}"\n', encoding="utf-8")
    (run / "history.csv").write_text(HISTORY, encoding="utf-8")
    index = "number,step,time [s],file,rigid file\n"
    for number in range(2):
        name = f"snapshot_{number:06d}.vtkhdf"
        rigid = f"rigid_{number:06d}.vtkhdf" if bodies else ""
        write_particles(run / name, number, space)
        if bodies:
            flat = space != "cartesian3"
            low, high, counts = ([3e-3, -4e-3], [9e-3, 4e-3], [3, 4]) if flat else ([3e-3] + [-4e-3] * 2,
                                                                                  [9e-3] + [4e-3] * 2, [3, 4, 4])
            nodes, cells = box_mesh(low, high, counts)
            write_bodies(run / rigid, nodes, np.full(len(nodes), 900.0), cells, space == "axisymmetric")
        index += f"{number},{10 * number},{0.1 * number},{name},{rigid}\n"
    (run / "snapshots.csv").write_text(index, encoding="utf-8")


def check_sections(plot_run, scratch):
    """The section of a box is a rectangle: area, outline, and a linear temperature are exact, up to the single
    precision of the file (1e-7 of the size)."""
    low, high = np.array([0.0, -1.0, 2.0]), np.array([2.0, 1.0, 3.0])
    nodes, cells = box_mesh(low, high, [3, 4, 2])
    inside = np.all((nodes > low) & (nodes < high), axis=1)  # moved: symmetry of the pieces would hide errors
    nodes[inside] += np.random.default_rng(1).uniform(-0.1, 0.1, (inside.sum(), 3))
    write_bodies(scratch / "box.vtkhdf", nodes, 300 + nodes @ [10, 20, 30], cells)
    for place in (0.13, 0.5, 0.0):  # between the layers of nodes and in them
        triangles, temperature, lines = plot_run.section_of_bodies(scratch / "box.vtkhdf", place)
        sides = triangles[:, 1:] - triangles[:, :1]
        area = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum()
        assert abs(area - 2 * 1) < 1e-5, (place, area)
        length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
        assert abs(length - 6) < 1e-5, (place, length)
        expected = 300 + triangles @ [10, 30] + 20 * place
        assert np.abs(temperature - expected).max() < 1e-4, place
    assert [len(part) for part in plot_run.section_of_bodies(scratch / "box.vtkhdf", 5.0)] == [0, 0, 0]

    nodes, cells = box_mesh(low[:2], high[:2], [3, 4])
    write_bodies(scratch / "plate.vtkhdf", nodes, np.full(len(nodes), 300.0), cells)
    triangles, _, lines = plot_run.section_of_bodies(scratch / "plate.vtkhdf", None)
    assert len(triangles) == 24 and abs(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum() - 8) < 1e-5

    # The same plate in the half-plane: an edge on the axis is inside the body.
    write_bodies(scratch / "disc.vtkhdf", nodes, np.full(len(nodes), 300.0), cells, half_plane=True)
    triangles, _, lines = plot_run.section_of_bodies(scratch / "disc.vtkhdf", None, half_plane=True)
    assert len(triangles) == 24 and abs(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum() - 6) < 1e-5


def check_mirror_image(plot_run, run):
    """A picture of a half-plane shows both sides of the axis, particles and bodies with their values."""
    index = plot_run.read_index(run)
    picture = plot_run.picture_of(*index[1], ["temperature"], half_plane=True)
    half = len(picture["view"]) // 2
    assert half == 10 and picture["axes"] == ("r", "z")
    assert np.allclose(picture["view"][:half] * [-1, 1], picture["view"][half:])
    assert np.ptp(picture["view"][:half, 1]) > 3.9e-3 and (picture["view"][:half, 0] > 0).all()
    assert (picture["data"]["temperature"][:half] == picture["data"]["temperature"][half:]).all()
    assert len(picture["triangles"]) == len(picture["body_temperature"]) == 48
    assert abs(picture["triangles"][:, :, 0].min() + 9e-3) < 1e-8


def check_panels(plot_run):
    """Temperatures share a panel, wherever they are measured; the heat of the scene and of the bodies have theirs."""
    for name, unit, title in (("die_temperature", "K", "temperature"), ("thermocouple", "K", "temperature"),
                              ("heat_ambient", "J", "heat ledger"), ("heat.rigid", "J", "heat ledger"),
                              ("die_interface_heat", "J", "heat of rigid bodies"),
                              ("die_heat", "J", "heat of rigid bodies"),
                              ("energy.plastic", "J", "energy"), ("heat_residual", "1", "ratio")):
        assert plot_run.panel_of(name, unit) == (title, unit), name
    panels = [("force", "N"), ("temperature", "K"), ("heat ledger", "J"), ("heat of rigid bodies", "J"),
              ("energy", "J")]
    assert sorted(reversed(panels), key=plot_run.panel_rank) == panels
    looks = plot_run.line_looks("heat of rigid bodies", ["die_heat", "tool_interface_heat", "die_interface_heat"])
    assert looks[0][0] == looks[2][0] != looks[1][0] and [style for _, style in looks] == ["-", "--", "--"]


def hot_pixels(picture):
    """How many pixels have the colour of the hottest place on the temperature scale."""
    pixels = matplotlib.image.imread(picture)[:, :, :3]
    hottest = matplotlib.colormaps["inferno"](1.0)[:3]
    return int((np.abs(pixels - hottest).max(axis=2) < 0.02).sum())


def main():
    script = Path(sys.argv[1]) / "tools/plot_run.py"
    sys.path.insert(0, str(script.parent))  # as when it is run: its module lies beside it
    specification = importlib.util.spec_from_file_location("plot_run", script)
    plot_run = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(plot_run)
    check_panels(plot_run)
    with tempfile.TemporaryDirectory() as scratch:
        check_sections(plot_run, Path(scratch))
        for space, bodies in (("cartesian3", False), ("cartesian3", True), ("plane_strain", True),
                              ("axisymmetric", True)):
            run = Path(scratch) / f"run {space} {bodies}"
            write_run(run, space, bodies)
            subprocess.run([sys.executable, script, run], check=True)
            for picture in ("history.png", "sections.png"):
                data = (run / "pictures" / picture).read_bytes()
                assert data.startswith(b"\x89PNG") and len(data) > 10_000, picture
            # Only the bodies are as hot as 900 K; they fill about half of the rows of the temperature in two pictures.
            hot = hot_pixels(run / "pictures/sections.png")
            assert (hot > 50_000) == bodies, (run, hot)
        check_mirror_image(plot_run, run)
        empty = Path(scratch) / "empty"
        empty.mkdir()
        result = subprocess.run([sys.executable, script, empty], capture_output=True, text=True, check=False)
        assert result.returncode == 2 and "history.csv" in result.stderr, result.stderr
        assert "Traceback" not in result.stderr and not list(empty.iterdir())
    return 0


if __name__ == "__main__":
    sys.exit(main())
