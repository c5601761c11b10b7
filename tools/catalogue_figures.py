#!/usr/bin/python3
"""Makes the ten figures of the verification catalogue, each by its number.

Usage: tools/catalogue_figures.py NUMBER ... [--output FOLDER] [--program FILE] [--work FOLDER] [--quick]

 1  error against spacing, all cases with an exact reference     from the records of tools/verify.py (run that first)
 2  error against CPU time over kernel, h/dx and correction      tools/speed_study.py pareto, half an hour
 3  mass scaling: error and time against s, with the formulas    ten minutes
 4  Courant number: error, energy residual, failure              tools/speed_study.py time_step, half an hour
 5  thermal step against error and time                          tools/heat_study.py staggering time_step
 6  tolerance of the heat solve and preconditioner               tools/heat_study.py solver
 7  contact stiffness: penetration, error, time                  three minutes
 8  strong and weak scaling, share of each phase                 three minutes, an idle machine
 9  stability map: settings against cases                        twenty minutes
10  cost of each module of the physics                           three minutes, an idle machine

FOLDER (tests/verification/figures) gets figure_NN.png and, with the numbers and the commit, figure_NN.json.
"""

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path

import figure_studies
import matplotlib

matplotlib.use("Agg")
import matplotlib.image
import matplotlib.pyplot as plt
from scene_runs import ROOT, Records, Runner, StudyError

STUDIES = {3: figure_studies.mass_scaling, 7: figure_studies.contact_stiffness, 8: figure_studies.scaling,
           9: figure_studies.stability_map, 10: figure_studies.module_cost}
# Programs that draw their own pictures: what to call, and which of them to put side by side.
OTHERS = {2: (["tools/speed_study.py", "pareto"], ["pareto_B2.png", "pareto_B3.png", "pareto_C4.png", "pareto_E1.png"]),
          4: (["tools/speed_study.py", "time_step"], ["time_step.png"]),
          5: (["tools/heat_study.py", "staggering", "time_step"], ["staggering.png", "time_step.png", "time_step_cost.png"]),
          6: (["tools/heat_study.py", "solver"], ["solver.png"])}


def side_by_side(pictures, path):
    """Pictures in a grid of two columns; one alone is copied."""
    if len(pictures) == 1:
        shutil.copy(pictures[0], path)
        return
    rows = (len(pictures) + 1) // 2
    figure, axes = plt.subplots(rows, 2, figsize=(12, 4.3 * rows))
    for axis in axes.flat:
        axis.axis("off")
    for axis, picture in zip(axes.flat, pictures):
        axis.imshow(matplotlib.image.imread(picture))
    figure.tight_layout(pad=0.2)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def by_another_program(number, options, path):
    command, pictures = OTHERS[number]
    folder = options.work / command[0].split("/")[1].removesuffix(".py")
    extra = ["--quick"] if options.quick and "speed_study" in command[0] else []
    done = subprocess.run([sys.executable, str(ROOT / command[0]), *command[1:], "--output", str(folder), "--program",
                           str(options.program), *extra], check=False, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise StudyError(f"{' '.join(command)} failed")
    path.with_suffix(".txt").write_text(done.stdout, encoding="utf-8")
    side_by_side([folder / name for name in pictures], path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("numbers", nargs="+", type=int, choices=range(1, 11), metavar="NUMBER")
    parser.add_argument("--output", type=Path, default=ROOT / "tests/verification/figures")
    parser.add_argument("--work", type=Path, default=Path("runs/figures"), help="runs and records go here")
    parser.add_argument("--verify", type=Path, default=Path("runs/verify"), help="records of tools/verify.py for figure 1")
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph")
    parser.add_argument("--quick", action="store_true", help="fewer settings and spacings, to try it")
    options = parser.parse_args()
    if not options.program.exists():
        parser.error(f"--program {options.program}: there is no such file; build it with tools/build.sh release")
    options.program, options.work = options.program.resolve(), options.work.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    options.work.mkdir(parents=True, exist_ok=True)
    for number in options.numbers:
        path = options.output / f"figure_{number:02}.png"
        print(f"figure {number}", flush=True)
        if number in OTHERS:
            by_another_program(number, options, path)
        elif number == 1:
            figure_studies.error_against_spacing(options.verify / "records.jsonl", path)
        else:
            runner = Runner(options.program, options.work)
            records = Records(options.work / "records.jsonl", runner.commit)
            numbers = STUDIES[number](runner, records, options, path)
            path.with_suffix(".json").write_text(json.dumps({"version": runner.version, "numbers": numbers}, indent=1) + "\n",
                                                 encoding="utf-8")
        print(f"  {path}", flush=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except StudyError as failure:
        sys.exit(f"catalogue_figures: {failure}")
