#!/usr/bin/python3
"""Measures what the choices of the heat solve cost and what they are worth: error against wall time.

Usage: tools/heat_study.py [staggering] [time_step] [solver] [interface] [share] [--output FOLDER] [--program FILE]

Runs ordinary scenes (tests/verification/scenes, inputs/paper_scale) with overrides and prints Markdown tables; draws
FOLDER/STUDY.png. Without a study named all are run: about 15 minutes on two idle cores, of which `share` takes most.
"""

import argparse
import csv
import re
import subprocess
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "tests/verification/scenes"


class Runner:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def run(self, scene, overrides, petsc="", ranks=1):
        """Last row of the history as numbers by column name, seconds of the run's loop, and the log."""
        out = self.folder / "run"
        command = [str(self.program), str(scene), "--output", str(out)]
        if ranks > 1:
            command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] + command
        for override in overrides:
            command += ["-P", override]
        if petsc:
            command += ["--petsc", petsc]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        log = done.stdout
        with open(out / "history.csv", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        names = [name.rsplit(" [", 1)[0] for name in rows[0]]
        last = dict(zip(names, map(float, rows[-1])))
        wall = float(re.search(r"steps, ([0-9.]+) s wall", log).group(1))
        heat = re.search(r"^.*\bheat +([0-9.]+) s mean", log, re.M)
        return last, wall, float(heat.group(1)) if heat else 0.0, log


def table(title, columns, rows):
    print(f"\n{title}\n\n| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def picture(path, title, xlabel, ylabel, curves, xlog=True):
    figure, axes = plt.subplots(figsize=(5.5, 4))
    shown = 1e-8  # the history prints ten digits: smaller differences are none
    for label, points in curves.items():
        style = "k--" if label == "first order" else "o-"
        axes.plot([p[0] for p in points], [max(p[1], shown) for p in points], style, label=label, markersize=4)
    axes.set_yscale("log")
    if xlog:
        axes.set_xscale("log")
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.set_title(title, fontsize=10)
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=150)
    plt.close(figure)


def staggering(runner):
    """E10: plastic work warms a sheared block; the flow stress sees the temperature of the last heat solve."""
    scene = SCENES / "e10_staggering.toml"
    base = runner.run(scene, ["heat.every=1"])[0]
    rows, error = [], {"temperature": [], "shear stress": []}
    for every in (1, 10, 100, 1000):
        last, wall, heat, _ = runner.run(scene, [f"heat.every={every}"])
        # Solving every step is itself late by one step: the error of n steps is in proportion to n.
        factor = every / (every - 1) if every > 1 else 0.0
        rise = factor * (last["T_mean"] - base["T_mean"]) / (base["T_mean"] - 293.15)
        stress = factor * (last["shear_stress"] / base["shear_stress"] - 1)
        rows.append([str(every), f"{rise:+.2e}", f"{stress:+.2e}", f"{heat:.2f}", f"{wall:.2f}"])
        if every > 1:
            error["temperature"].append((every, abs(rise)))
            error["shear stress"].append((every, abs(stress)))
    table("Thermal step (E10, adiabatic shear to 1 in 4000 steps, relative errors)",
          ["mechanical steps per heat solve", "temperature rise", "shear stress", "heat solve, s", "run, s"], rows)
    error["first order"] = [(10, 1e-5), (1000, 1e-3)]
    picture(runner.folder / "staggering.png", "E10: error against the thermal step",
            "mechanical steps per heat solve", "relative error", error)


def quench(overrides):
    """E3 with a well-conducting interface, the first second: the billet loses a fifth of its heat."""
    return ['rigid.0.heat.conductance="1e4 W/m2/K"', 'time.end="1 s"'] + overrides


def probes(last):
    return [last[name] for name in ("axis", "thermocouple", "face_1", "face_2")]


def largest(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def time_step(runner):
    scene = SCENES / "e3_billet_in_die.toml"
    reference = probes(runner.run(scene, quench(['time.step="0.5 ms"', "heat.scheme=crank_nicolson"]))[0])
    rows, curves, against_time = [], {}, {}
    for scheme in ("backward_euler", "crank_nicolson"):
        for step in (5, 10, 20, 50, 100, 200):
            last, _, heat, _ = runner.run(scene, quench([f'time.step="{step} ms"', f"heat.scheme={scheme}"]))
            error = largest(probes(last), reference)
            curves.setdefault(scheme.replace("_", " "), []).append((step, error))
            against_time.setdefault(scheme.replace("_", " "), []).append((heat, error))
            rows.append([scheme, str(step), f"{error:.3g}", f"{heat:.2f}"])
    table("Time step and scheme (E3, h = 1e4, largest error of four probes after 1 s against steps of 0.5 ms)",
          ["scheme", "step, ms", "error, K", "heat solve, s"], rows)
    picture(runner.folder / "time_step.png", "E3: error against the thermal step", "thermal step, ms", "error, K", curves)
    picture(runner.folder / "time_step_cost.png", "E3: error against time", "heat solve, s", "error, K", against_time)


PRECONDITIONERS = {
    "jacobi": "-heat_pc_type jacobi",
    "block ICC(0)": "-heat_pc_type bjacobi -heat_sub_pc_type icc",
    "SOR": "-heat_pc_type sor",
    "GAMG": "-heat_pc_type gamg",
    "hypre BoomerAMG": "-heat_pc_type hypre",
}


def solver(runner):
    """Tolerance and preconditioner: billet of 0.5 mm particles in its die, steps of the paper's 0.05 s."""
    scene = SCENES / "e3_billet_in_die.toml"
    base = quench(['numerics.spacing="0.5 mm"', "body.0.fill_margin=0.25", 'time.step="50 ms"', "heat.scheme=backward_euler"])
    reference = probes(runner.run(scene, base + ["heat.relative_tolerance=1e-13"])[0])
    rows, curves = [], {}
    for name, options in PRECONDITIONERS.items():
        for exponent in (2, 4, 6, 8, 10, 12):
            last, _, heat, log = runner.run(scene, base + [f"heat.relative_tolerance=1e-{exponent}"],
                                            options + " -heat_ksp_converged_reason")
            iterations = [int(n) for n in re.findall(r"iterations (\d+)", log)]
            error = largest(probes(last), reference)
            curves.setdefault(name, []).append((heat, error))
            rows.append([name, f"1e-{exponent}", f"{sum(iterations) / max(1, len(iterations)):.0f}", f"{error:.2g}",
                         f"{abs(last['heat.residual']):.0e}", f"{heat / max(1, len(iterations)):.3f}"])
    table("Preconditioner and tolerance (E3 at 0.5 mm, 20 steps of 50 ms, largest error of four probes)",
          ["preconditioner", "rtol", "iterations", "error, K", "heat residual", "s per solve"], rows)
    picture(runner.folder / "solver.png", "E3: error of the linear solve against time", "20 heat solves, s", "error, K",
            curves)


def interface(runner):
    """E4 at steady state: the flux through slab, interface and mesh is known exactly."""
    scene = SCENES / "e4_composite_slab.toml"
    rows, curves = [], {}
    slabs = 0.01 / 188 + 0.01 / 24.4
    for name, film, overrides in (
            ("film 1e4 W/m2/K", 1e-4, []),
            ("perfect", 0.0, ["rigid.0.heat.interface=perfect"]),
            ("hybrid", 0.0, ["rigid.0.heat.interface=hybrid"])):
        exact = 400 / (slabs + film)
        for spacing in (1, 0.5, 0.25):
            last, _, heat, _ = runner.run(scene, overrides + [f'numerics.spacing="{spacing} mm"'])
            # All heat that enters the steel leaves at its cold face, 6 mm x 6 mm.
            steel = 300 + exact * 0.01 / 24.4
            error = (last["T_steel_face"] - 300) / (steel - 300) - 1
            curves.setdefault(name, []).append((heat, abs(error)))
            rows.append([name, f"{spacing}", f"{100 * error:+.3f} %", f"{heat:.2f}"])
    table("Interface (E4, error of the steel's temperature rise near the interface, that is of the flux)",
          ["interface", "spacing, mm", "error", "heat solve, s"], rows)
    picture(runner.folder / "interface.png", "E4: error of the flux against time", "heat solve, s", "relative error",
            curves)


def share(runner):
    """The paper's counts: share of the heat solve at 100 mechanical steps per heat step."""
    scene = ROOT / "inputs/paper_scale/scene.toml"
    rows = []
    for petsc in ("", PRECONDITIONERS["block ICC(0)"]):
        last, wall, heat, log = runner.run(
            scene, ['body.0.temperature="700 K"', "time.most_steps=300", 'output.checkpoint_wall_interval="0 s"',
                    "output.history_steps=100"], petsc + " -heat_ksp_converged_reason", ranks=2)
        iterations = [int(n) for n in re.findall(r"iterations (\d+)", log)]
        elements = sum(int(n) for n in re.findall(r"mesh of (\d+) elements", log))
        rows.append([petsc or "default", str(elements), f"{heat / 3:.2f}", f"{(wall - heat) / 3:.2f}",
                     f"{100 * heat / wall:.1f} %", f"{sum(iterations) / max(1, len(iterations)):.0f}",
                     f"{last['heat.residual']:.1e}"])
    table("Share of the heat solve (263,088 particles, 2 ranks, a heat solve every 100 steps)",
          ["solver", "elements", "s per heat solve", "s per 100 mechanical steps", "share", "iterations", "residual"],
          rows)


def main():
    studies = {study.__name__: study for study in (staggering, time_step, solver, interface, share)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studies", nargs="*", metavar="study", help=", ".join(studies))
    parser.add_argument("--output", type=Path, default=Path("runs/heat_study"))
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph")
    options = parser.parse_args()
    unknown = [name for name in options.studies if name not in studies]
    if unknown:
        parser.error(f"no such study: {', '.join(unknown)}. Known: {', '.join(studies)}")
    options.output.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.program, options.output)
    print(subprocess.run([str(options.program), "--version"], capture_output=True, text=True, check=True).stdout.strip())
    for name in options.studies or studies:
        start = time.time()
        studies[name](runner)
        print(f"\n({name}: {time.time() - start:.0f} s)", flush=True)


if __name__ == "__main__":
    try:
        main()
    except RuntimeError as failure:
        sys.exit(f"heat_study: {failure}")
