#!/usr/bin/python3
"""Draws the results of a run: histories of force, torque, temperature, heat and energy, and sections through metal and
meshed rigid bodies.

Usage: tools/plot_run.py RUN [--output FOLDER] [--snapshots 0,3,6]

Reads RUN/history.csv and RUN/snapshots.csv with the files it lists (particles, meshed rigid bodies), and writes PNG
files to RUN/pictures. A run in the axisymmetric space knows the half-plane only: its mirror image is drawn beside it. If RUN/summary.json has a list `outlines` of {"name", "points": [[a, b], ...], "snapshot": number
or null} in m, these lines (tool, die) are drawn into the sections of that snapshot, or of all; a list `materials` names
the materials.
"""

import argparse
import re
import sys
from pathlib import Path

import h5py
import numpy as np
from matplotlib.collections import LineCollection

from run_files import (PlotError, draw_section, field_scale, particle_spacing, plt, read_history, read_index,
                       read_input, read_snapshot, read_summary)

# Title and, where the SI unit makes awkward numbers, the larger or smaller unit to plot in.
QUANTITIES = {
    "N": ("force", [("kN", 1e3, 2e3)]),
    "N m": ("torque", [("kN m", 1e3, 2e3)]),
    "K": ("temperature", []),
    "J": ("energy", [("kJ", 1e3, 2e3)]),
    "m": ("length", [("mm", 1e-3, 0.0)]),
    "m2": ("area", [("mm²", 1e-6, 0.0)]),
    "m/s": ("velocity", [("mm/s", 1e-3, 0.0)]),
    "W": ("power", [("kW", 1e3, 2e3)]),
    "Pa": ("stress", [("MPa", 1e6, 0.0)]),
    "s": ("time step", [("µs", 1e-6, 0.0)]),
    "1": ("ratio", []),
}
# Columns that get a panel of their own beside others of the same unit: where the heat of the whole scene went, and that
# of each rigid body.
HEAT_PANELS = {
    "heat ledger": re.compile(r"heat[._](particles|rigid|source|fixed|ambient)"),
    "heat of rigid bodies": re.compile(r"(.*?)[._](interface_heat|surface_heat|friction_heat|heat)"),
}
# Of a rigid body's heats: one colour per body, one style per kind.
HEAT_STYLES = {"heat": "-", "interface_heat": "--", "surface_heat": ":", "friction_heat": "-."}
# Columns that serve the machine rather than the eye.
BOOKKEEPING = ("step", "dt")


def plotted_unit(unit, values):
    """The unit to plot in and how many SI units it is."""
    largest = np.nanmax(np.abs(values)) if np.isfinite(values).any() else 0.0
    for name, factor, threshold in QUANTITIES.get(unit, ("", []))[1]:
        if largest > threshold:
            return name, factor
    return unit, 1.0


def panel_of(name, unit):
    """Title and unit of the panel that a column belongs to."""
    for title, pattern in HEAT_PANELS.items():
        if unit == "J" and pattern.fullmatch(name):
            return title, unit
    return QUANTITIES.get(unit, (unit, []))[0], unit


def panel_rank(panel):
    """Panels in the order of QUANTITIES, those of heat behind the temperature."""
    title, unit = panel
    order = list(QUANTITIES)
    if title in HEAT_PANELS:
        return order.index("K"), 1 + list(HEAT_PANELS).index(title), unit
    return (order.index(unit) if unit in order else len(order)), 0, unit


def line_looks(title, names):
    """(colour, style) of every curve of a panel."""
    if title == "heat of rigid bodies":
        parts = [HEAT_PANELS[title].fullmatch(name).groups() for name in names]
        bodies = list(dict.fromkeys(body for body, _ in parts))
        colours = plt.get_cmap("tab10")
        return [(colours(bodies.index(body) % colours.N), HEAT_STYLES[kind]) for body, kind in parts]
    colours = plt.get_cmap("tab10" if len(names) <= 10 else "tab20")
    return [(colours(k % colours.N), "-" if k < 20 else "--") for k in range(len(names))]


def draw_panel(axes, time, names, title, unit, values):
    """One panel: all its columns over time."""
    label, factor = plotted_unit(unit, values)
    # A column that stays (nearly) zero beside the others tells nothing and makes the legend long; ratios of any size count.
    largest = np.nanmax(np.abs(values), axis=0)
    floor = 0.0 if unit == "1" else 0.01 * np.nanmax(largest)
    shown = [k for k in range(len(names)) if largest[k] > floor] or list(range(len(names)))
    logarithmic = unit == "1" and np.any(values[:, shown] != 0)
    for k, (colour, style) in zip(shown, line_looks(title, [names[k] for k in shown])):
        curve = np.abs(values[:, k]) if logarithmic else values[:, k] / factor
        axes.plot(time, curve, style, lw=1.2, color=colour, label=names[k])
    axes.set_ylabel(f"{title} [{label}]" if label != "1" else f"{title}, magnitude" if logarithmic else title)
    axes.margins(x=0.01)
    if logarithmic:
        # Every curve shows, but neither its start from nothing nor what is only rounding.
        smallest = np.nanmin(largest[largest > 0])
        axes.set_yscale("log", nonpositive="mask")
        axes.set_ylim(bottom=max(axes.get_ylim()[0], np.clip(0.01 * smallest, 1e-12, 1e-6)))
    if len(shown) > 4:  # beside the panel: inside it would lie on the curves
        axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), fontsize=7)
    elif len(shown) > 1:
        axes.legend(loc="best", fontsize=7)
    else:
        axes.set_title(names[shown[0]], loc="left", fontsize=9)


def plot_histories(run, output):
    """history.png: one panel per quantity, those the user looks for first on top. Returns the files written."""
    names, units, rows = read_history(run / "history.csv")
    chosen = [k for k in range(1, len(names)) if names[k] not in BOOKKEEPING and not names[k].endswith(".angle")]
    members = {}
    for k in chosen:
        members.setdefault(panel_of(names[k], units[k]), []).append(k)
    order = sorted(members, key=panel_rank)
    lines = (len(order) + 1) // 2
    figure, panels = plt.subplots(lines, 2, figsize=(14, 3.0 * lines + 0.4), squeeze=False, sharex=True,
                                  constrained_layout=True)
    for axes, (title, unit) in zip(panels.flat, order):
        columns = members[title, unit]
        draw_panel(axes, rows[:, 0], [names[k] for k in columns], title, unit, rows[:, columns])
    for axes in panels.flat[len(order):]:
        axes.axis("off")
    for axes in panels.flat[max(len(order) - 2, 0):len(order)]:  # the lowest of either column
        axes.set_xlabel("time [s]")
        axes.tick_params(labelbottom=True)
    figure.suptitle(f"{run.name}: histories", x=0.01, ha="left", fontweight="bold")
    path = output / "history.png"
    figure.savefig(path)
    plt.close(figure)
    return [path]


def section_of(points, spacing, half_plane):
    """Which particles to draw, their coordinates in the picture, its axes and its place: the slab of one spacing on
    either side of y = place seen along y, or all of a plane or axisymmetric run (place None)."""
    if half_plane:
        return np.ones(len(points), bool), points[:, [0, 2]], ("r", "z"), None
    if np.ptp(points[:, 2]) == 0:
        return np.ones(len(points), bool), points[:, :2], ("x", "y"), None
    centre = 0.5 * (points[:, 1].min() + points[:, 1].max())
    middle = 0.0 if abs(centre) < 2 * spacing else centre
    return np.abs(points[:, 1] - middle) < spacing, points[:, [0, 2]], ("x", "z"), middle


def read_bodies(path, corners):
    """Nodes [m], temperatures [K] and cells with this many corners of the meshed rigid bodies."""
    try:
        with h5py.File(path, "r") as file:
            grid = file["VTKHDF"]
            offsets, connectivity = grid["Offsets"][:], grid["Connectivity"][:]
            first = offsets[:-1][np.diff(offsets) == corners]
            return (grid["Points"][:].astype(float), grid["PointData/temperature"][:].astype(float),
                    connectivity[first[:, None] + np.arange(corners)])
    except (OSError, KeyError) as failure:
        raise PlotError(f"cannot read the meshed rigid bodies {path}: {failure}") from failure


def cut(cells, above, edges_by_count):
    """Cuts simplices by a plane. Returns pairs of nodes (below, above) whose edge the plane crosses, a row of pairs per
    piece. `edges_by_count`: for so many corners above, the pieces as places in the cell sorted from below to above."""
    count = above[cells].sum(axis=1)
    ranked = np.take_along_axis(cells, np.argsort(above[cells], axis=1, kind="stable"), axis=1)
    return np.concatenate([ranked[count == k][:, pieces].reshape(-1, *np.shape(pieces)[1:])
                           for k, pieces in edges_by_count.items()])


# Pieces of the cut: triangles of a tetrahedron, of which two make a quadrilateral, and the line across a triangle.
TETRAHEDRON_CUT = {1: [[(0, 3), (1, 3), (2, 3)]],
                   2: [[(0, 2), (0, 3), (1, 3)], [(0, 2), (1, 3), (1, 2)]],
                   3: [[(0, 1), (0, 2), (0, 3)]]}
TRIANGLE_CUT = {1: [[(0, 2), (1, 2)]], 2: [[(0, 1), (0, 2)]]}


def outer_faces(cells):
    """Faces (edges of triangles) that belong to one cell only."""
    corners = cells.shape[1]
    faces = np.concatenate([np.delete(cells, k, axis=1) for k in range(corners)])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def section_of_bodies(path, place, half_plane=False):
    """The meshed rigid bodies in the plane of the picture: corners of triangles [m] (n, 3, 2), their temperatures
    (n, 3), and the lines around the bodies (m, 2, 2)."""
    points, temperature, cells = read_bodies(path, 3 if place is None else 4)
    if place is None:
        view = points[:, [0, 2] if half_plane else [0, 1]]
        lines = view[outer_faces(cells)]
        if half_plane:  # an edge on the axis is no surface
            lines = lines[np.any(np.abs(lines[:, :, 0]) > 1e-6 * np.ptp(view), axis=1)]
        return view[cells], temperature[cells], lines
    height = points[:, 1] - place
    above = height >= 0
    # Both neighbours of a face that the plane crosses are crossed too: the others are not needed to find the outside.
    cells = cells[np.ptp(above[cells].astype(int), axis=1) > 0]
    pieces, lines = cut(cells, above, TETRAHEDRON_CUT), cut(outer_faces(cells), above, TRIANGLE_CUT)

    def at_crossing(values, pairs):
        low, high = height[pairs[..., 0]], height[pairs[..., 1]]
        weight = (low / (low - high)).reshape(low.shape + (1,) * (values.ndim - 1))
        return (1 - weight) * values[pairs[..., 0]] + weight * values[pairs[..., 1]]

    view = points[:, [0, 2]]
    return at_crossing(view, pieces), at_crossing(temperature, pieces), at_crossing(view, lines)


def choose_snapshots(index, wanted):
    """First, middle and last, or the numbers asked for."""
    if wanted:
        chosen = [row for row in index if row[0] in wanted]
        if not chosen:
            raise PlotError(f"none of the snapshots {wanted} is in the run; it has {index[0][0]} to {index[-1][0]}")
        return chosen
    return [index[k] for k in sorted({0, len(index) // 2, len(index) - 1})]


def draw_bodies(axes, triangles, temperature, cmap, norm):
    """Temperature in the section of the meshed rigid bodies."""
    corners = 1e3 * triangles.reshape(-1, 2)
    axes.tripcolor(corners[:, 0], corners[:, 1], np.arange(len(corners)).reshape(-1, 3), temperature.ravel(), cmap=cmap,
                   norm=norm, shading="gouraud", zorder=0)


def plot_sections(run, output, wanted):
    """sections.png: a row per field, a column per snapshot. Returns the files written."""
    index = read_index(run)
    if not index:
        print(f"plot_run: {run} has no snapshots; only histories are drawn")
        return []
    fields = {"temperature": "temperature [K]", "equivalent_plastic_strain": "equivalent plastic strain",
              "material": "material"}
    half_plane = read_input(run).get("space") == "axisymmetric"
    spacing = 1e-3 * read_summary(run).get("spacing_mm", 0)
    pictures = [picture for row in choose_snapshots(index, wanted)
                if (picture := picture_of(*row, fields, half_plane, spacing))]
    present = [name for name in fields if pictures and all(name in picture["data"] for picture in pictures)]
    if len(present) > 1 and "material" in present and not any(np.ptp(p["data"]["material"]) for p in pictures):
        present.remove("material")  # one colour would tell nothing
    if not present:
        print("plot_run: the snapshots hold neither temperature nor strain nor material; only histories are drawn")
        return []
    path = output / "sections.png"
    draw_pictures(path, run, pictures, [(name, fields[name]) for name in present])
    return [path]


def with_mirror_image(corners):
    """Points of a half-plane (..., 2), followed by their images beyond the axis."""
    return np.concatenate([corners, corners * [-1, 1]])


def picture_of(number, time, path, rigid_path, fields, half_plane, spacing=0):
    """What is drawn of one snapshot; None if it has no particles. Without the scene's spacing [m] it is taken from the
    particles, whose disorder shortens it."""
    points, data = read_snapshot(path, fields)
    if len(points) == 0:
        return None
    spacing = spacing or particle_spacing(points)
    inside, view, axis_names, place = section_of(points, spacing, half_plane)
    view, data = view[inside], {name: values[inside] for name, values in data.items()}
    triangles, temperature, lines = np.empty((0, 3, 2)), np.empty((0, 3)), np.empty((0, 2, 2))
    if rigid_path and rigid_path.exists():
        triangles, temperature, lines = section_of_bodies(rigid_path, place, half_plane)
    if half_plane:
        view, triangles, lines = with_mirror_image(view), with_mirror_image(triangles), with_mirror_image(lines)
        temperature = np.concatenate([temperature, temperature])
        data = {name: np.concatenate([values, values]) for name, values in data.items()}
    return {"number": number, "time": time, "view": view, "spacing": spacing, "axes": axis_names, "place": place,
            "half_plane": half_plane, "data": data, "triangles": triangles, "body_temperature": temperature,
            "lines": lines}


def window_around(pictures, parts, margin):
    """Lower and upper corner [mm] of a window around these parts of all pictures; the margin is a share of its size, at
    least two particles."""
    corners = np.concatenate([picture[part].reshape(-1, 2) for picture in pictures for part in parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    rim = max(2 * max(picture["spacing"] for picture in pictures), margin * (high - low).max())
    return 1e3 * (low - rim), 1e3 * (high + rim)


def plan_rows(pictures, present):
    """(field, label, window) of every row. With meshed rigid bodies the temperature is shown twice, in all that was
    computed and in the metal, in the same colours."""
    meshed = "temperature" in dict(present) and any(len(picture["triangles"]) for picture in pictures)
    metal = window_around(pictures, ["view"], 0.1 if meshed else 0)
    rows = [(name, label, metal) for name, label in present]
    if meshed:
        machine = window_around(pictures, ["view", "triangles"], 0.05)
        rows.insert(0, ("temperature", dict(present)["temperature"], machine))
    return rows


def draw_picture(axes, picture, name, window, cmap, norm, outlines):
    """One field of one snapshot."""
    if name == "temperature" and len(picture["triangles"]):
        draw_bodies(axes, picture["triangles"], picture["body_temperature"], cmap, norm)
    discs = draw_section(axes, picture["view"], picture["data"][name], cmap, norm, picture["spacing"])
    axes.add_collection(LineCollection(1e3 * picture["lines"], colors="0.55", linewidths=0.8))
    for outline in outlines:
        if outline.get("snapshot") in (None, picture["number"]):
            axes.plot(*(1e3 * np.array(outline["points"]).T), color="0.25", lw=1.0)
    low, high = window
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    return discs


def draw_pictures(path, run, pictures, present):
    """A row per field, a column per snapshot, a colour bar per field."""
    rows = plan_rows(pictures, present)
    shapes = [(high[1] - low[1]) / (high[0] - low[0]) for _, _, (low, high) in rows]
    width = 3.3 if min(shapes) < 2 else 2.3
    heights = [min(max(width * shape, 1.0), 6.0) for shape in shapes]
    summary = read_summary(run)
    figure, panels = plt.subplots(len(rows), len(pictures), squeeze=False, sharex="row", sharey="row",
                                  figsize=(width * len(pictures) + 1.6, sum(heights) + 0.35 * len(rows) + 0.6),
                                  gridspec_kw={"height_ratios": heights}, constrained_layout=True)
    bars = {}
    for row, (name, label, window) in enumerate(rows):
        values = [picture["data"][name] for picture in pictures]
        if name == "temperature":
            values += [picture["body_temperature"].ravel() for picture in pictures]
        cmap, norm = field_scale(name, values)
        last_of_window = row == len(rows) - 1 or rows[row + 1][2] is not window
        for column, picture in enumerate(pictures):
            axes = panels[row, column]
            discs = draw_picture(axes, picture, name, window, cmap, norm, summary.get("outlines") or [])
            axes.tick_params(labelbottom=last_of_window)
            if row == 0:
                axes.set_title(f"t = {picture['time']:.4g} s", fontsize=10)
            if last_of_window:
                axes.set_xlabel(f"{picture['axes'][0]} [mm]")
            if column == 0:
                axes.set_ylabel(f"{picture['axes'][1]} [mm]")
        bars.setdefault(name, (label, discs, []))[2].extend(panels[row])
    for name, (label, discs, axes) in bars.items():
        whole = name in ("material", "body")
        extend = "neither" if whole else "max" if name == "equivalent_plastic_strain" else "both"
        bar = figure.colorbar(discs, ax=axes, label=label, extend=extend, pad=0.01,
                              aspect=25 * len(axes) / len(pictures))
        if whole:
            labels = summary.get("materials") or []
            count = discs.cmap.N
            bar.set_ticks(range(count), labels=[labels[k] if k < len(labels) else str(k) for k in range(count)])
            bar.ax.minorticks_off()
    figure.suptitle(f"{run.name}: section ({where_text(pictures)})", x=0.01, ha="left", fontweight="bold")
    figure.savefig(path)
    plt.close(figure)


def where_text(pictures):
    """The place of the section in words."""
    place = pictures[0]["place"]
    if place is None:
        return "axisymmetric, mirrored" if pictures[0]["half_plane"] else "plane strain"
    bodies = ", rigid bodies at y = {:.3g} mm".format(1e3 * place) if any(len(p["lines"]) for p in pictures) else ""
    return ("|y| < dx" if place == 0 else f"|y - {1e3 * place:.3g} mm| < dx") + bodies


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
