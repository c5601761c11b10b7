#!/usr/bin/python3
"""Measures which settings of the mechanics are worth their time, and how large a time step may be.

Usage: tools/speed_study.py [pareto] [time_step] [--case B2|B3|C4|E1] [--quick] [--output FOLDER] [--program FILE]

pareto     error against CPU time over kernel, h/dx, gradient correction and spacing in cases with a reference:
           FOLDER/pareto_CASE.png, the cheapest setting for 5, 2 and 1 %, a recommended default
time_step  error, energy residual and failure of growing Courant numbers: FOLDER/time_step.png, a recommended default

Runs ordinary scenes (tests/verification/scenes) with overrides, one rank each, and prints Markdown tables. Every run adds
a line to FOLDER/records.jsonl; runs of the same commit that stand there are not repeated, so a study can be stopped and
gone on with. Both studies take about half an hour of one core, with --quick (fewer settings, no fine spacings) three minutes.
"""

import argparse
import sys
import time
from pathlib import Path

from speed_cases import CASES
from speed_pareto import pareto
from scene_runs import ROOT, Records, Runner, StudyError
from speed_time_step import time_step


def main():
    studies = {study.__name__: study for study in (pareto, time_step)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studies", nargs="*", metavar="study", help=", ".join(studies))
    parser.add_argument("--case", choices=list(CASES), help="only this case of the study pareto")
    parser.add_argument("--quick", action="store_true", help="fewer settings, no fine spacings")
    parser.add_argument("--output", type=Path, default=Path("runs/speed_study"))
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph")
    options = parser.parse_args()
    unknown = [name for name in options.studies if name not in studies]
    if unknown:
        parser.error(f"no such study: {', '.join(unknown)}. Known: {', '.join(studies)}")
    if not options.program.exists():
        parser.error(f"--program {options.program}: there is no such file; build it with tools/build.sh release stirsph")
    options.output.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.program, options.output)
    print(runner.version)
    records = Records(options.output / "records.jsonl", runner.commit)
    for name in options.studies or studies:
        start = time.monotonic()
        studies[name](runner, records, options)
        print(f"\n({name}: {time.monotonic() - start:.0f} s)", flush=True)


if __name__ == "__main__":
    try:
        main()
    except StudyError as failure:
        sys.exit(f"speed_study: {failure}")
