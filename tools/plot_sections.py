#!/usr/bin/python3
"""Draws sections of the metal at chosen times: across the axis below the tool, or along it.

Usage: tools/plot_sections.py RUN [--times 5 7 10] [--plane longitudinal top] [--colour material temperature ...]
                              [--below MM | --height MM] [--thickness MM] [--output FOLDER]

Writes RUN/pictures/section_PLANE_COLOUR.png, a picture per time: that of the nearest snapshot (see snapshot_times in
inputs/PARAMETERS.md). A colour is any one-component field of the snapshots. The top section is a slab below the tool's
face, seen from above; the longitudinal one the slab around y = 0, seen along y. A run in the axisymmetric space knows
the half-plane only: its mirror image is drawn beside it. Grain size and hardness are grey where nothing has
recrystallised.
"""

import argparse
import sys
from pathlib import Path

import h5py
import numpy as np

from run_files import (PlotError, draw_section, field_scale, particle_spacing, plt, read_history, read_index,
                       read_input, read_snapshot)

# Fields that would need powers of ten in their SI unit: the unit to plot in and how many SI units it is.
PLOT_UNITS = {"grain_size": ("µm", 1e-6), "von_mises": ("MPa", 1e6), "pressure": ("MPa", 1e6)}
NEEDS_RECRYSTALLISATION = ("grain_size", "hardness")


def si(text):
    """The number of a quantity of input_as_used.toml."""
    return float(str(text).split()[0])


def nearest_snapshots(index, times):
    """Rows of the index nearest to the times, the last one without times."""
    if not index:
        raise PlotError("the run has no snapshots: set output.snapshot_interval or output.snapshot_times")
    if not times:
        return [index[-1]]
    chosen = [min(index, key=lambda row: abs(row[1] - time)) for time in times]
    gaps = np.diff([row[1] for row in index])
    for time, row in zip(times, chosen):
        if abs(row[1] - time) > 0.5 * max(gaps, default=0.0) + 1e-9:
            raise PlotError(f"no snapshot is near {time:g} s: they reach from {index[0][1]:.4g} to {index[-1][1]:.4g} s; "
                            "output.snapshot_times asks for more")
    return list(dict.fromkeys(chosen))


def tool_face(run, scene, time):
    """Height [m] of the tool's reference point at a time: of the first rigid body that moves or turns."""
    for rigid in scene.get("rigid", []):
        if "rotation" not in rigid and rigid.get("motion", {}).get("type", "fixed") == "fixed":
            continue
        names, _, rows = read_history(run / "history.csv")
        column = rigid["name"] + ".displacement_z"
        moved = np.interp(time, rows[:, 0], rows[:, names.index(column)]) if column in names else 0.0
        return si(rigid["reference_point"][2]) + float(moved)
    raise PlotError("the run has no tool (a rigid body that moves or turns): give the height of the section, "
                    "--height MM")


def top_section(points, spacing, centre, thickness):
    """The slab around the height `centre` [m], seen from above."""
    inside = np.abs(points[:, 2] - centre) <= 0.5 * max(thickness, spacing)
    return inside, points[:, :2], ("x", "y"), f"z = {1e3 * centre:.3g} mm"


def longitudinal_section(points, spacing, thickness, space):
    """The slab around y = 0 seen along y; of a plane or axisymmetric run everything."""
    if space == "plane_strain":
        return np.ones(len(points), bool), points[:, :2], ("x", "y"), "plane strain"
    if space == "axisymmetric":
        return np.ones(len(points), bool), points[:, [0, 2]], ("r", "z"), "axisymmetric, mirrored"
    inside = np.abs(points[:, 1]) <= 0.5 * max(thickness, spacing)
    return inside, points[:, [0, 2]], ("x", "z"), "y = 0"


def picture_of(run, row, plane, colour, arguments, scene):
    """What is drawn of one snapshot: places in the picture, values, axes and the place in words."""
    _, time, path, _ = row
    space = scene.get("space", "cartesian3")
    points, data = read_snapshot(path, [colour, "recrystallised"])
    if colour not in data:
        with h5py.File(path, "r") as file:
            known = [name for name, values in file["VTKHDF/PointData"].items() if values.ndim == 1]
        raise PlotError(f"the snapshots hold no \"{colour}\" to colour by; they have {', '.join(known)}")
    if data[colour].ndim > 1:
        raise PlotError(f"\"{colour}\" has several components: choose a field of one component")
    # Disorder shortens the distance to the nearest neighbour: the scene's own spacing is the size of a particle.
    spacing = si(scene["numerics"]["spacing"]) if "numerics" in scene else particle_spacing(points)
    thickness = 1e-3 * arguments.thickness if arguments.thickness else 2 * spacing
    if plane == "top":
        if space != "cartesian3":
            raise PlotError(f"a run in the space {space} has no section across the axis: use --plane longitudinal")
        centre = (1e-3 * arguments.height if arguments.height is not None
                  else tool_face(run, scene, time) - 1e-3 * arguments.below - 0.5 * thickness)
        inside, view, axes, where = top_section(points, spacing, centre, thickness)
    else:
        inside, view, axes, where = longitudinal_section(points, spacing, thickness, space)
    if not inside.any():
        raise PlotError(f"there is no metal in the section {where} at t = {time:.4g} s: choose --height, --below or "
                        "--thickness")
    values = data[colour].astype(float) / PLOT_UNITS.get(colour, ("", 1.0))[1]
    if colour in NEEDS_RECRYSTALLISATION and "recrystallised" in data:
        values[data["recrystallised"] == 0] = np.nan
    view, values = view[inside], values[inside]
    if space == "axisymmetric":
        view, values = np.concatenate([view, view * [-1, 1]]), np.concatenate([values, values])
    return {"time": time, "view": view, "values": values, "spacing": spacing, "axes": axes, "where": where}


def label_of(path, colour):
    """Name and unit of a field for the colour bar."""
    with h5py.File(path, "r") as file:
        unit = file[f"VTKHDF/PointData/{colour}"].attrs.get("unit", b"")
    unit = PLOT_UNITS[colour][0] if colour in PLOT_UNITS else unit.decode() if isinstance(unit, bytes) else str(unit)
    return colour.replace("_", " ") + (f" [{unit}]" if unit not in ("", "1") else "")


def draw(path, run, pictures, colour, label, names):
    """One row of pictures with a common scale."""
    everything = [picture["values"] for picture in pictures]
    if not any(np.isfinite(values).any() for values in everything):
        raise PlotError(f"nothing to draw in \"{colour}\": nothing has recrystallised at these times")
    cmap, norm = field_scale(colour, everything)
    cmap = cmap.copy()
    cmap.set_bad("0.8")
    low = np.min([picture["view"].min(axis=0) for picture in pictures], axis=0)
    high = np.max([picture["view"].max(axis=0) for picture in pictures], axis=0)
    rim = 2 * pictures[0]["spacing"]
    width = 3.3
    height = min(max(width * (high - low + 2 * rim)[1] / (high - low + 2 * rim)[0], 1.2), 7.0)
    figure, panels = plt.subplots(1, len(pictures), squeeze=False, sharey=True, constrained_layout=True,
                                  figsize=(width * len(pictures) + 1.4, height + 0.9))
    for axes, picture in zip(panels[0], pictures):
        discs = draw_section(axes, picture["view"], np.ma.masked_invalid(picture["values"]), cmap, norm,
                             picture["spacing"])
        axes.set_xlim(*(1e3 * np.array([low[0] - rim, high[0] + rim])))
        axes.set_ylim(*(1e3 * np.array([low[1] - rim, high[1] + rim])))
        axes.set_title(f"t = {picture['time']:.4g} s, {picture['where']}", fontsize=9)
        axes.set_xlabel(f"{picture['axes'][0]} [mm]")
    panels[0][0].set_ylabel(f"{pictures[0]['axes'][1]} [mm]")
    bar = figure.colorbar(discs, ax=panels[0].tolist(), label=label, pad=0.01)
    if colour in ("material", "body"):
        count = cmap.N
        bar.set_ticks(range(count), labels=[names[k] if k < len(names) else str(k) for k in range(count)])
        bar.ax.minorticks_off()
    figure.suptitle(run.name, x=0.01, ha="left", fontweight="bold")
    figure.savefig(path)
    plt.close(figure)


def parser():
    """The command line."""
    line = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    line.add_argument("run", type=Path, help="output folder of a run")
    line.add_argument("--times", type=float, nargs="+", default=[], help="process times [s] (default: the last)")
    line.add_argument("--plane", nargs="+", choices=("longitudinal", "top"), default=["longitudinal"])
    line.add_argument("--colour", nargs="+", default=["material"], help="fields of the snapshots (default material)")
    line.add_argument("--below", type=float, default=0.0, help="of a top section: mm below the tool (default 0)")
    line.add_argument("--height", type=float, help="of a top section: mm above z = 0, instead of --below")
    line.add_argument("--thickness", type=float, help="of the slab in mm (default two spacings)")
    line.add_argument("--output", type=Path, help="folder for the pictures (default RUN/pictures)")
    return line


def main():
    arguments = parser().parse_args()
    output = arguments.output or arguments.run / "pictures"
    try:
        rows = nearest_snapshots(read_index(arguments.run), arguments.times)
        scene = read_input(arguments.run)
        for plane in arguments.plane:
            for colour in arguments.colour:
                pictures = [picture_of(arguments.run, row, plane, colour, arguments, scene) for row in rows]
                names = [entry["name"] for entry in scene.get(colour, [])] if colour in ("material", "body") else []
                output.mkdir(parents=True, exist_ok=True)
                path = output / f"section_{plane}_{colour}.png"
                draw(path, arguments.run, pictures, colour, label_of(rows[0][2], colour), names)
                print(path)
    except (PlotError, OSError, ValueError) as failure:
        print(f"plot_sections: {failure}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
