#!/usr/bin/python3
"""Grain size, hardness and plastic strain of an extruded tube: below the tool, and at the inner side, in the middle and
at the outer side of the wall.

Usage: tools/wall_table.py RUN [RUN ...] [--time T] [--tool-radius MM]

Means over the particles (rings) of one snapshot, the last without --time, that have recrystallised, and how many of all
these are. Below the tool: the first millimetre of metal below its face. The wall: what is more than a millimetre above
the face and farther out than the tool, a third of the thickness each (at least three particles thick, or thirds say
little). The scene needs [microstructure].
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from plot_sections import nearest_snapshots, si, tool_face
from run_files import PlotError, read_index, read_input, read_snapshot

FIELDS = ("grain_size", "hardness", "recrystallised", "equivalent_plastic_strain")


def tool_radius(scene):
    """Radius [m] of the first rigid body that turns."""
    for rigid in scene.get("rigid", []):
        if "rotation" in rigid and "radius" in rigid.get("shape", {}):
            return si(rigid["shape"]["radius"])
    raise PlotError("the run has no turning tool with a radius: give --tool-radius MM")


def table_of(run, time, radius):
    """A line per region: name, particles, recrystallised ones, mean grain size [um], hardness [HV], plastic strain."""
    scene = read_input(run)
    _, when, path, _ = nearest_snapshots(read_index(run), [] if time is None else [time])[0]
    points, fields = read_snapshot(path, FIELDS)
    missing = [name for name in FIELDS if name not in fields]
    if missing:
        raise PlotError(f"{path} has no {', '.join(missing)}: the scene needs [microstructure], and output.fields, if "
                        "given, must name them")
    distance = np.hypot(points[:, 0], points[:, 1])
    face = tool_face(run, scene, when)
    wall = (distance > radius) & (points[:, 2] > face + 1e-3)
    edges = np.linspace(radius, distance[wall].max() if wall.any() else radius, 4)
    regions = {"below the tool": (distance < radius) & (points[:, 2] > face - 1e-3) & (points[:, 2] <= face)}
    for name, low, high in zip(("wall, inner third", "wall, middle", "wall, outer third"), edges, edges[1:]):
        regions[name] = wall & (distance > low) & (distance <= high)
    lines = []
    for name, inside in regions.items():
        known = inside & (fields["recrystallised"] > 0)
        means = [fields[field][known].mean() if known.any() else np.nan
                 for field in ("grain_size", "hardness", "equivalent_plastic_strain")]
        lines.append((name, inside.sum(), known.sum(), 1e6 * means[0], means[1], means[2]))
    return when, lines


def main():
    line = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    line.add_argument("run", type=Path, nargs="+", help="folders of runs")
    line.add_argument("--time", type=float, help="s; the nearest snapshot is taken (default the last)")
    line.add_argument("--tool-radius", type=float, help="mm (default that of the first turning rigid body)")
    arguments = line.parse_args()
    try:
        for run in arguments.run:
            radius = tool_radius(read_input(run)) if arguments.tool_radius is None else 1e-3 * arguments.tool_radius
            when, lines = table_of(run, arguments.time, radius)
            print(f"{run}, t = {when:.4g} s")
            for name, particles, known, grain, hardness, strain in lines:
                print(f"  {name:18} {known:6} of {particles:6} recrystallised, {grain:6.2f} um {hardness:6.1f} HV, "
                      f"plastic strain {strain:.3g}")
    except (PlotError, OSError, ValueError, KeyError) as failure:
        print(f"wall_table: {failure}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
