#!/usr/bin/python3
"""Whether the grain map at the end of a run depends on the time step, beyond what chance makes of single runs.

Usage: tools/grain_study.py [SCENE] [--courant C C ...] [--runs N] [--program P] [--output FOLDER]

Once metal flows, runs that differ by rounding come to differ by some percent in every square millimetre of the map, so
one run against another says little. Each Courant number (first the one the others are compared with) has N runs whose
first body starts hotter by 1e-5 K times the number of the run. Printed: the mean grain size of all recrystallised
metal, its change with its standard error; and the same of the squares of 1 mm in r and z that hold three particles or
more in every run.
"""

import argparse
import math
import sys
from pathlib import Path

import numpy as np

from scene_runs import ROOT, Runner, StudyError


def grain_map(run):
    """Grain size [um] of all recrystallised metal, its mean and the means of its squares (column, row)."""
    *_, (_, points, fields) = run.snapshots()
    if "recrystallised" not in fields:
        raise StudyError(f"{run.folder}: no grain sizes in its snapshots; the scene needs [microstructure]")
    known = fields["recrystallised"] > 0
    if not known.any():
        raise StudyError(f"{run.folder}: nothing has recrystallised by the end of the run")
    grain = 1e6 * fields["grain_size"][known]
    squares = {}
    places = np.floor(1e3 * np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], -1)[known]).astype(int)
    for place, size in zip(map(tuple, places), grain):
        squares.setdefault(place, []).append(size)
    return grain.mean(), {place: np.mean(sizes) for place, sizes in squares.items() if len(sizes) >= 3}


def change(base, other):
    """Relative change of the mean over runs (first axis), and its standard error."""
    error = np.sqrt(base.var(axis=0, ddof=1) / len(base) + other.var(axis=0, ddof=1) / len(other))
    return other.mean(axis=0) / base.mean(axis=0) - 1, error / base.mean(axis=0)


def maps_of(runner, scene, courant, runs):
    def run(number, overrides):
        return runner.run(scene, {"time.cfl": courant, **overrides}, runner.folder / f"courant_{courant}_{number}",
                          accepted=(0,))
    first = run(0, {})
    start = float(first.settings()["body"][0]["temperature"].split()[0])
    hotter = [{"body.0.temperature": f'"{start + 1e-5 * number!r} K"'} for number in range(1, runs)]
    return [grain_map(first)] + [grain_map(run(1 + k, overrides)) for k, overrides in enumerate(hotter)]


def report(courants, maps):
    for courant in courants:
        means = np.array([mean for mean, _ in maps[courant]])
        print(f"Courant number {courant}: mean {means.mean():.3f} um, one run scatters by "
              f"{100 * means.std(ddof=1) / means.mean():.2f} %")
    for courant in courants[1:]:
        pair = [maps[courants[0]], maps[courant]]
        places = sorted(set.intersection(*(set(squares) for runs in pair for _, squares in runs)))
        moved, error = change(*(np.array([mean for mean, _ in runs]) for runs in pair))
        print(f"{courant} against {courants[0]}: mean {100 * moved:+.2f} % (standard error {100 * error:.2f})")
        if places:
            moved, error = change(*(np.array([[squares[place] for place in places] for _, squares in runs])
                                    for runs in pair))
            print(f"  {len(places)} squares: mean change {100 * moved.mean():+.2f} %, standard deviation "
                  f"{100 * moved.std():.2f} %, of which chance makes {100 * math.sqrt((error**2).mean()):.2f} %")


def main():
    line = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    line.add_argument("scene", type=Path, nargs="?", default=ROOT / "inputs/tube_id2/hot_start.toml")
    line.add_argument("--courant", type=float, nargs="+", default=[0.5, 0.25])
    line.add_argument("--runs", type=int, default=7, help="of each Courant number, two at least (default 7)")
    line.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph")
    line.add_argument("--output", type=Path, default=ROOT / "runs/grain_study")
    arguments = line.parse_args()
    if arguments.runs < 2 or len(set(arguments.courant)) < 2:
        line.error("needs two runs and two different Courant numbers at least")
    try:
        runner = Runner(arguments.program.resolve(), arguments.output.resolve())
        maps = {courant: maps_of(runner, arguments.scene.resolve(), courant, arguments.runs)
                for courant in arguments.courant}
        report(arguments.courant, maps)
    except (StudyError, OSError, ValueError, KeyError) as failure:
        print(f"grain_study: {failure}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
