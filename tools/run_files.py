#!/usr/bin/python3
"""Reading what a run wrote, and drawing particles: what the plotting programs share; not a program of its own."""

import csv
import json
import re
import tomllib

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
                     "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 150})

MATERIAL_COLOURS = ["#4477aa", "#ee9933", "#228833", "#aa3377", "#66ccee", "#bbbbbb", "#ccbb44", "#ee6677"]


class PlotError(Exception):
    """Something the user can mend; printed without a traceback."""


def read_history(path):
    """Returns (names, units, rows) of history.csv; rows cut off by a kill are skipped."""
    if not path.exists():
        raise PlotError(f"there is no {path}: is {path.parent} the output folder of a run?")
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.reader(file))
    headings = [re.fullmatch(r"(.*) \[(.*)\]", heading) for heading in (lines[0] if lines else [])]
    if not headings or not all(headings):
        raise PlotError(f"{path} has no header of the form 'time [s],name [unit],...'")
    rows = [[float(value) for value in line] for line in lines[1:] if len(line) == len(headings)]
    if not rows:
        raise PlotError(f"{path} has no rows yet: the run has not reached its first output time")
    return [h[1] for h in headings], [h[2] for h in headings], np.array(rows)


def read_input(run):
    """input_as_used.toml as nested tables; all its quantities are texts in SI units. Empty if there is none."""
    path = run / "input_as_used.toml"
    if not path.exists():
        return {}
    with open(path, "rb") as file:
        return tomllib.load(file)


def read_index(run):
    """(number, time, path, path of the meshed rigid bodies or None) of every snapshot that exists."""
    path = run / "snapshots.csv"
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        rows = [(int(row["number"]), float(row["time [s]"]), run / row["file"],
                 run / row["rigid file"] if row.get("rigid file") else None) for row in csv.DictReader(file)]
    return [row for row in rows if row[2].exists()]


def read_snapshot(path, names):
    """Points [m] and those of the named fields that the file has."""
    try:
        with h5py.File(path, "r") as file:
            data = file["VTKHDF/PointData"]
            return file["VTKHDF/Points"][:].astype(float), {name: data[name][:] for name in names if name in data}
    except (OSError, KeyError) as failure:
        raise PlotError(f"cannot read the snapshot {path}: {failure}") from failure


def particle_spacing(points):
    """Median distance [m] to the nearest neighbour over a sample of the particles."""
    sample = points[np.random.default_rng(1).choice(len(points), min(len(points), 200), replace=False)]
    nearest = []
    for point in sample:
        square = np.sum((points - point) ** 2, axis=1)
        square[square == 0] = np.inf
        nearest.append(square.min())
    spacing = float(np.sqrt(np.median(nearest)))
    return spacing if np.isfinite(spacing) and spacing > 0 else 1e-3


def read_summary(run):
    """summary.json, empty while the run has not reached its end."""
    path = run / "summary.json"
    if not path.exists():
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def field_scale(name, arrays):
    """Colour map and norm of a field over all its pictures."""
    values = np.concatenate(arrays)
    if name in ("material", "body"):
        count = int(values.max()) + 1
        colours = [MATERIAL_COLOURS[k % len(MATERIAL_COLOURS)] for k in range(count)]
        return ListedColormap(colours), BoundaryNorm(np.arange(count + 1) - 0.5, max(count, 1))
    low, high = np.nanpercentile(values, [0.2, 99.8])
    if name == "equivalent_plastic_strain":
        low = 0.0
        if high > 100:  # a shear band under a turning tool beside metal that has hardly deformed
            return plt.get_cmap("viridis"), LogNorm(0.1, high, clip=True)
    if high - low < 1e-9 * max(abs(high), 1.0):  # nothing has happened yet: a scale that is not all noise
        high = low + 1.0
    return plt.get_cmap("inferno" if name == "temperature" else "viridis"), Normalize(low, high)


def draw_section(axes, view, values, cmap, norm, spacing):
    """Particles as discs of their own size, so that a gap in the metal shows as a gap."""
    size = 1.45e3 * spacing  # a little over the diagonal of a lattice cell
    discs = EllipseCollection(np.full(len(view), size), np.full(len(view), size), np.zeros(len(view)), units="xy",
                              offsets=1e3 * view, transOffset=axes.transData, cmap=cmap, norm=norm, linewidths=0)
    discs.set_array(values)
    axes.add_collection(discs)
    axes.set_aspect("equal")
    axes.grid(False)
    return discs
