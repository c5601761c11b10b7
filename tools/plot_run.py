#!/usr/bin/python3
"""Draws the results of a run: histories of force, torque, temperature and energy, and sections through the metal.

Usage: tools/plot_run.py RUN [--output FOLDER] [--snapshots 0,3,6]

Reads RUN/history.csv and RUN/snapshots.csv with the snapshots it lists, and writes PNG files to RUN/pictures. If
RUN/summary.json has a list `outlines` of {"name", "points": [[a, b], ...], "snapshot": number or null} in m, these lines
(tool, die) are drawn into the sections of that snapshot, or of all; a list `materials` names the materials.
"""

import argparse
import csv
import json
import re
import sys
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import BoundaryNorm, ListedColormap, Normalize

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
                     "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 150})

# Title and, where the SI unit makes awkward numbers, the larger or smaller unit to plot in.
QUANTITIES = {
    "N": ("force", [("kN", 1e3, 2e3)]),
    "N m": ("torque", [("kN m", 1e3, 2e3)]),
    "K": ("temperature", []),
    "J": ("energy", [("kJ", 1e3, 2e3)]),
    "m": ("length", [("mm", 1e-3, 0.0)]),
    "m/s": ("velocity", [("mm/s", 1e-3, 0.0)]),
    "W": ("power", [("kW", 1e3, 2e3)]),
    "Pa": ("stress", [("MPa", 1e6, 0.0)]),
    "s": ("time step", [("µs", 1e-6, 0.0)]),
    "1": ("ratio", []),
}
MATERIAL_COLOURS = ["#4477aa", "#ee9933", "#228833", "#aa3377", "#66ccee", "#bbbbbb", "#ccbb44", "#ee6677"]


class PlotError(Exception):
    """Something the user can mend; printed without a traceback."""


# Columns that serve the machine rather than the eye.
BOOKKEEPING = ("step", "dt")


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


def plotted_unit(unit, values):
    """The unit to plot in and how many SI units it is."""
    largest = np.nanmax(np.abs(values)) if np.isfinite(values).any() else 0.0
    for name, factor, threshold in QUANTITIES.get(unit, ("", []))[1]:
        if largest > threshold:
            return name, factor
    return unit, 1.0


def draw_panel(axes, time, names, unit, values):
    """One panel: all columns of one unit over time."""
    label, factor = plotted_unit(unit, values)
    title = QUANTITIES.get(unit, (unit, []))[0]
    # A column that stays (nearly) zero beside the others tells nothing and makes the legend long; ratios of any size count.
    largest = np.nanmax(np.abs(values), axis=0)
    floor = 0.0 if unit == "1" else 0.01 * np.nanmax(largest)
    shown = [k for k in range(len(names)) if largest[k] > floor] or list(range(len(names)))
    colours = plt.get_cmap("tab10" if len(shown) <= 10 else "tab20")
    for order, k in enumerate(shown):
        style = "-" if order < 20 else "--"
        axes.plot(time, values[:, k] / factor, style, lw=1.2, color=colours(order % colours.N), label=names[k])
    axes.set_ylabel(f"{title} [{label}]" if label != "1" else title)
    axes.margins(x=0.01)
    if unit == "1" and np.any(values[:, shown] > 0):
        axes.set_yscale("log")
        axes.set_ylim(bottom=max(axes.get_ylim()[0], 1e-6))
    if len(shown) > 1:
        axes.legend(loc="best", fontsize=7, ncol=2 if len(shown) > 5 else 1)
    else:
        axes.set_title(names[shown[0]], loc="left", fontsize=9)


def plot_histories(run, output):
    """history.png: one panel per unit, those the user looks for first on top. Returns the files written."""
    names, units, rows = read_history(run / "history.csv")
    chosen = [k for k in range(1, len(names)) if names[k] not in BOOKKEEPING and not names[k].endswith(".angle")]
    present = {units[k] for k in chosen}
    order = [unit for unit in QUANTITIES if unit in present] + sorted(present - set(QUANTITIES))
    lines = (len(order) + 1) // 2
    figure, panels = plt.subplots(lines, 2, figsize=(14, 3.0 * lines + 0.4), squeeze=False, sharex=True,
                                  constrained_layout=True)
    for axes, unit in zip(panels.flat, order):
        columns = [k for k in chosen if units[k] == unit]
        draw_panel(axes, rows[:, 0], [names[k] for k in columns], unit, rows[:, columns])
    for axes in panels.flat[len(order):]:
        axes.axis("off")
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    figure.suptitle(f"{run.name}: histories", x=0.01, ha="left", fontweight="bold")
    path = output / "history.png"
    figure.savefig(path)
    plt.close(figure)
    return [path]


def read_index(run):
    """(number, time, path) of every snapshot that exists."""
    path = run / "snapshots.csv"
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        rows = [(int(row["number"]), float(row["time [s]"]), run / row["file"]) for row in csv.DictReader(file)]
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


def section_of(points, spacing):
    """Which particles to draw and their coordinates in the picture: the slab |y| < dx seen along y, or a plane run."""
    if np.ptp(points[:, 2]) == 0:
        return np.ones(len(points), bool), points[:, :2], ("x", "y")
    centre = 0.5 * (points[:, 1].min() + points[:, 1].max())
    middle = 0.0 if abs(centre) < 2 * spacing else centre
    return np.abs(points[:, 1] - middle) < spacing, points[:, [0, 2]], ("x", "z")


def choose_snapshots(index, wanted):
    """First, middle and last, or the numbers asked for."""
    if wanted:
        chosen = [row for row in index if row[0] in wanted]
        if not chosen:
            raise PlotError(f"none of the snapshots {wanted} is in the run; it has {index[0][0]} to {index[-1][0]}")
        return chosen
    return [index[k] for k in sorted({0, len(index) // 2, len(index) - 1})]


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
    if high - low < 1e-9 * max(abs(high), 1.0):  # nothing has happened yet: a scale that is not all noise
        high = low + 1.0
    return plt.get_cmap("inferno" if name == "temperature" else "viridis"), Normalize(low, high)


def draw_section(axes, view, values, cmap, norm, spacing):
    """Particles as discs of their own size, so that a gap in the metal shows as a gap."""
    size = 1.35e3 * spacing
    discs = EllipseCollection(np.full(len(view), size), np.full(len(view), size), np.zeros(len(view)), units="xy",
                              offsets=1e3 * view, transOffset=axes.transData, cmap=cmap, norm=norm, linewidths=0)
    discs.set_array(values)
    axes.add_collection(discs)
    axes.set_aspect("equal")
    axes.grid(False)
    return discs


def read_summary(run):
    """summary.json, empty while the run has not reached its end."""
    path = run / "summary.json"
    if not path.exists():
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def plot_sections(run, output, wanted):
    """sections.png: a row per field, a column per snapshot. Returns the files written."""
    index = read_index(run)
    if not index:
        print(f"plot_run: {run} has no snapshots; only histories are drawn")
        return []
    fields = {"temperature": "temperature [K]", "equivalent_plastic_strain": "equivalent plastic strain",
              "material": "material"}
    pictures = []
    for number, time, path in choose_snapshots(index, wanted):
        points, data = read_snapshot(path, fields)
        if len(points) == 0:
            continue
        spacing = particle_spacing(points)
        inside, view, axis_names = section_of(points, spacing)
        pictures.append({"number": number, "time": time, "view": view[inside], "spacing": spacing, "axes": axis_names,
                         "data": {name: values[inside] for name, values in data.items()}})
    present = [name for name in fields if pictures and all(name in picture["data"] for picture in pictures)]
    if not present:
        print("plot_run: the snapshots hold neither temperature nor strain nor material; only histories are drawn")
        return []

    margin = 2 * max(picture["spacing"] for picture in pictures)
    corners = np.concatenate([picture["view"] for picture in pictures])
    low, high = 1e3 * (corners.min(axis=0) - margin), 1e3 * (corners.max(axis=0) + margin)
    height_to_width = (high[1] - low[1]) / (high[0] - low[0])
    width = 3.3 if height_to_width < 2 else 2.3
    panel_height = min(max(width * height_to_width, 1.0), 6.0)
    summary = read_summary(run)
    outlines = summary.get("outlines") or []
    figure, panels = plt.subplots(len(present), len(pictures), squeeze=False, sharex=True, sharey=True,
                                  figsize=(width * len(pictures) + 1.6, (panel_height + 0.25) * len(present) + 0.7),
                                  constrained_layout=True)
    for row, name in enumerate(present):
        cmap, norm = field_scale(name, [picture["data"][name] for picture in pictures])
        for column, picture in enumerate(pictures):
            axes = panels[row, column]
            discs = draw_section(axes, picture["view"], picture["data"][name], cmap, norm, picture["spacing"])
            for outline in outlines:
                if outline.get("snapshot") in (None, picture["number"]):
                    axes.plot(*(1e3 * np.array(outline["points"]).T), color="0.25", lw=1.0)
            axes.set_xlim(low[0], high[0])
            axes.set_ylim(low[1], high[1])
            if row == 0:
                axes.set_title(f"t = {picture['time']:.4g} s", fontsize=10)
            if row == len(present) - 1:
                axes.set_xlabel(f"{picture['axes'][0]} [mm]")
            if column == 0:
                axes.set_ylabel(f"{picture['axes'][1]} [mm]")
        whole = name in ("material", "body")
        extend = "neither" if whole else "max" if name == "equivalent_plastic_strain" else "both"
        bar = figure.colorbar(discs, ax=list(panels[row]), label=fields[name], extend=extend, pad=0.01, aspect=25)
        if whole:
            labels = summary.get("materials") or []
            bar.set_ticks(range(cmap.N), labels=[labels[k] if k < len(labels) else str(k) for k in range(cmap.N)])
            bar.ax.minorticks_off()
    where = "|y| < dx" if pictures[0]["axes"][1] == "z" else "plane strain"
    figure.suptitle(f"{run.name}: section ({where})", x=0.01, ha="left", fontweight="bold")
    path = output / "sections.png"
    figure.savefig(path)
    plt.close(figure)
    return [path]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path, help="output folder of a run")
    parser.add_argument("--output", type=Path, help="folder for the pictures (default RUN/pictures)")
    parser.add_argument("--snapshots", help="numbers of the snapshots to draw, such as 0,3,6 (default first, middle, last)")
    arguments = parser.parse_args()
    output = arguments.output or arguments.run / "pictures"
    try:
        wanted = [int(number) for number in arguments.snapshots.split(",")] if arguments.snapshots else []
        read_history(arguments.run / "history.csv")  # before a folder is made in the wrong place
        output.mkdir(parents=True, exist_ok=True)
        for path in plot_histories(arguments.run, output) + plot_sections(arguments.run, output, wanted):
            print(path)
    except (PlotError, OSError, ValueError) as failure:
        print(f"plot_run: {failure}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
