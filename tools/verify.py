#!/usr/bin/python3
"""Runs cases of the verification catalogue and reports error, observed order, time and verdict of each.

Usage: tools/verify.py [--tier T0|T1|T2] [--case ID ...] [--family NAME ...] [--ranks N ...] [-P KEY=VALUE ...]
                       [--jobs N] [--output FOLDER] [--results] [--list]

Tiers: T0 seconds, T1 up to ten minutes a case, T2 longer; T1 includes T0, T2 only what is named or all of it. Every run adds
a line to FOLDER/records.jsonl; runs of the same commit and input that stand there are not repeated (a changed source that
is not committed counts as another commit only by the name "dirty": use a fresh folder). FOLDER/report.html shows all, with
figures as PNG beside it; --results writes tests/verification/RESULTS.md. The last line is "N passed, N failed".

Cases live in tests/verification/*/cases.py; how to write one: tests/verification/README.md.
"""

import argparse
import os
import re
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scene_runs import ROOT, Records, Runner, StudyError, fingerprint
from verify_cases import TIERS, Case, Program, load
from verify_report import write_report, write_results


class Slots:
    """Cores; a run of several ranks takes several at once."""

    def __init__(self, count):
        self.count, self.free, self.changed = count, count, threading.Condition()

    def take(self, wanted):
        wanted = min(wanted, self.count)
        with self.changed:
            self.changed.wait_for(lambda: self.free >= wanted)
            self.free -= wanted
        return wanted

    def give(self, taken):
        with self.changed:
            self.free += taken
            self.changed.notify_all()


def plain(value):
    """Numbers of numpy as those of JSON."""
    return float(value) if value is not None else None


def complaint(run):
    """What the program complained of, without the banner that mpirun puts after it."""
    errors = [line for line in run.message.splitlines() if line.startswith("error: ")]
    return "\n".join(errors)[:600] or run.message[-600:]


def describe(run):
    """What rule 0 of the catalogue wants to know of a run beside its errors."""
    if not run.history:
        return {"message": complaint(run)}
    settings = run.settings()
    numerics, steps = settings["numerics"], run.history["step"]
    found = {"dx_m": float(numerics["spacing"].split()[0]), "h_over_dx": numerics["h_over_dx"], "kernel": numerics["kernel"],
             "gradient_correction": numerics["gradient_correction"], "density_scale": numerics["density_scale"],
             "dt_s": plain(run.history["dt"][-1]), "cfl": settings["time"].get("cfl"),
             "heat_every": settings["heat"]["every"], "ksp_rtol": settings["heat"]["relative_tolerance"],
             "particles": run.particles(), "steps": int(steps[-1]), "leaked": run.leaked(), "phases_s": run.phases()}
    if "energy.residual" in run.history:
        found["energy_residual"] = plain(run.history["energy.residual"][-1])
    return found


class Verification:
    def __init__(self, options):
        self.options = options
        self.runner = Runner(options.program, options.output)
        self.records = Records(options.output / "records.jsonl", self.runner.commit)
        self.slots, self.lock = Slots(options.jobs), threading.Lock()

    def jobs_of(self, case):
        """(label, kind, spacing, overrides) of the runs of a case; kind: plain, variant, must_fail or refused."""
        spacings = case.spacings or (None,)
        for spacing in spacings:
            own = {"numerics.spacing": f'"{spacing:.9g} mm"', **case.overrides(spacing)} if spacing else {}
            yield "", "plain", spacing, own
            for name, more in case.variants.items():
                yield name, "variant", spacing, {**own, **more}
        goal = case.goal()
        own = {"numerics.spacing": f'"{goal:.9g} mm"', **case.overrides(goal)} if goal else {}
        for name, more in case.must_fail.items():
            yield name, "must_fail", goal, {**own, **more}
        for name, (more, _) in case.refused.items():
            yield name, "refused", goal, {**own, **more}

    def run_scene(self, case, name, kind, spacing, overrides, ranks):
        overrides = {**overrides, **self.options.override}
        path = case.path()
        key = {"case": case.id, "variant": name, "kind": kind, "spacing_mm": spacing, "ranks": ranks,
               "input": fingerprint(path, overrides)}

        def measure():
            label = "_".join(str(part) for part in (case.id, name, spacing, ranks) if part not in ("", None))
            folder = self.options.output / "runs" / re.sub(r"[^\w.]+", "_", label)
            run = self.runner.run(path, overrides, folder, ranks, accepted=None)
            errors = {}
            if run.code == 0 and kind != "refused":
                try:
                    errors = {quantity: float(value) for quantity, value in case.measure(run).items()}
                except (KeyError, ValueError, IndexError, ZeroDivisionError) as failure:
                    errors = {f"measure failed: {type(failure).__name__}: {failure}": float("nan")}
            return {"exit_code": run.code, "wall_s": round(run.wall, 2), "cpu_s": round(run.cpu, 2), "errors": errors,
                    "message": complaint(run), **describe(run)}

        with self.lock:
            known = self.records.known.get(Records.name_of(key, self.runner.commit))
        if known is None:
            taken = self.slots.take(ranks)
            try:
                result = measure()
            finally:
                self.slots.give(taken)
            with self.lock:
                known = self.records.get(key, lambda: result)
            shown = ", ".join(f"{q} {e:+.4g}" for q, e in known["errors"].items()) or f"exit code {known['exit_code']}"
            at = f" {spacing:g} mm" if spacing else ""
            print(f"  {case.id} {name}{at} on {ranks}: {shown} ({known['wall_s']:.1f} s)", flush=True)
        return known

    def run_program(self, case):
        program = self.options.program.parent / "tests" / case.program
        key = {"case": case.id, "variant": "", "kind": "program", "spacing_mm": None, "ranks": case.ranks,
               "input": case.tests}
        with self.lock:
            known = self.records.known.get(Records.name_of(key, self.runner.commit))
        if known:
            return known
        command = [str(program), f"--gtest_filter={case.tests}", "--gtest_color=no"]
        if case.ranks > 1:
            command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(case.ranks), *command]
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        if os.geteuid() == 0:
            environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        if not program.exists():
            raise StudyError(f"there is no {program}: build the tests with tools/build.sh release")
        taken = self.slots.take(case.ranks)
        try:
            start = time.monotonic()
            done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
            wall = time.monotonic() - start
        finally:
            self.slots.give(taken)
        lines = [line for line in done.stdout.splitlines()
                 if line and not re.match(r"\[[-=\s\w]*\]|Note: Google|Running main|.* tests? from |$", line)]
        ran = re.search(r"\[  PASSED  \] (\d+) test", done.stdout)
        ok = done.returncode == 0 and ran is not None and int(ran.group(1)) > 0
        with self.lock:
            known = self.records.get(key, lambda: {"exit_code": done.returncode, "wall_s": round(wall, 2), "errors": {},
                                                   "passed": ok, "lines": lines[:60]})
        print(f"  {case.id}: {'passed' if ok else 'FAILED'} ({wall:.1f} s)", flush=True)
        return known

    def run(self, cases):
        """{case id: its records}; runs of all cases side by side on the cores."""
        tasks = []
        for case in cases:
            if isinstance(case, Program):
                tasks.append((case, self.run_program, (case,)))
                continue
            for name, kind, spacing, overrides in self.jobs_of(case):
                for ranks in self.options.ranks:
                    tasks.append((case, self.run_scene, (case, name, kind, spacing, overrides, ranks)))
        results = {case.id: [] for case in cases}
        with ThreadPoolExecutor(max_workers=max(1, self.options.jobs)) as pool:
            for case, future in [(case, pool.submit(work, *arguments)) for case, work, arguments in tasks]:
                results[case.id].append(future.result())
        return results


def misses(case, record):
    """Quantities beyond their targets, or what else is wrong with a run at the target spacing."""
    if record["exit_code"] != 0:
        return [f"exit code {record['exit_code']}"]
    wrong = [name for name, target in case.targets.items()
             if not (name in record["errors"] and abs(record["errors"][name]) <= target)]
    return wrong


def judge(case, records):
    """(passed, what is wrong). A case passes when its plain runs and variants meet all targets at the target spacing
    and at every finer one (an error that grows again was met by luck), what must fail does, and wrong input is refused
    with its message."""
    if isinstance(case, Program):
        return records[0]["passed"], [] if records[0]["passed"] else ["the test failed"]
    wrong = []
    for record in records:
        key = record["key"]
        label = key["variant"] + (f" on {key['ranks']} ranks" if key["ranks"] > 1 else "")
        if key["kind"] in ("plain", "variant"):
            if key["spacing_mm"] is None or key["spacing_mm"] <= case.goal():
                at = f" at {key['spacing_mm']:g} mm" if key["spacing_mm"] != case.goal() else ""
                wrong += [f"{label + ': ' if label else ''}{name}{at}" for name in misses(case, record)]
        elif key["kind"] == "must_fail":
            if not misses(case, record):
                wrong.append(f"{label}: passes though it must not")
        elif record["exit_code"] != 2 or case.refused[key["variant"]][1] not in record["message"]:
            wrong.append(f"{label}: not refused as it should be (exit code {record['exit_code']}: {record['message'][-200:]})")
    return not wrong, wrong


def orders(case, records):
    """{quantity: observed order} of the plain runs between the two finest spacings."""
    plain_runs = sorted((r for r in records if r["key"]["kind"] == "plain" and r["key"]["spacing_mm"]
                         and r["key"]["ranks"] == records[0]["key"]["ranks"]), key=lambda r: r["key"]["spacing_mm"])
    found = {}
    if len(plain_runs) < 2:
        return found
    fine, coarse = plain_runs[:2]
    for name, error in fine["errors"].items():
        before = coarse["errors"].get(name)
        if before and error and np.isfinite(before) and np.isfinite(error):
            found[name] = float(np.log(abs(before / error)) / np.log(coarse["key"]["spacing_mm"] / fine["key"]["spacing_mm"]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tier", choices=TIERS, help="T0 (the default without --case), or T1: T0 and T1, or T2: T2 alone")
    parser.add_argument("--case", nargs="+", default=[], metavar="ID")
    parser.add_argument("--family", nargs="+", default=[], metavar="NAME", help="a folder of tests/verification")
    parser.add_argument("--scenes-only", action="store_true", help="leave out the cases that are GoogleTest programs")
    parser.add_argument("--ranks", nargs="+", type=int, default=[1], metavar="N")
    parser.add_argument("-P", dest="override", action="append", default=[], metavar="KEY=VALUE",
                        help="another value of a scene key in all runs, for example numerics.kernel=\\\"wendland_c2\\\"")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="cores to use")
    parser.add_argument("--output", type=Path, default=Path("runs/verify"))
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph")
    parser.add_argument("--results", action="store_true", help="write tests/verification/RESULTS.md")
    parser.add_argument("--list", action="store_true", help="name the chosen cases and leave")
    options = parser.parse_args()
    for pair in options.override:
        if "=" not in pair:
            parser.error(f"-P {pair}: KEY=VALUE is wanted")
    options.override = dict(pair.split("=", 1) for pair in options.override)
    options.program = options.program.resolve()
    cases = load()
    unknown = ([f"--case {name}" for name in options.case if name not in [case.id for case in cases]]
               + [f"--family {name}" for name in options.family if name not in [case.family for case in cases]])
    if unknown:
        parser.error(f"{', '.join(unknown)}: unknown. Cases: {', '.join(case.id for case in cases)}")
    tiers = {"T0": ("T0",), "T1": ("T0", "T1"), "T2": ("T2",)}[options.tier or "T0"]
    chosen = [case for case in cases
              if (case.id in options.case if options.case else case.tier in tiers)
              and (not options.family or case.family in options.family)
              and not (options.scenes_only and isinstance(case, Program))]
    if not chosen:
        parser.error("no case is chosen")
    if options.list:
        for case in chosen:
            print(f"{case.id:6} {case.tier} {case.family:12} {case.title}")
        return 0
    if not options.program.exists():
        parser.error(f"--program {options.program}: there is no such file; build it with tools/build.sh release")
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    verification = Verification(options)
    print(verification.runner.version, flush=True)
    results = verification.run(chosen)
    rows = [(case, results[case.id], *judge(case, results[case.id]), orders(case, results[case.id])
             if isinstance(case, Case) else {}) for case in chosen]
    write_report(options.output, rows, verification.runner.version)
    if options.results:
        write_results(ROOT / "tests/verification/RESULTS.md", rows, verification.runner.version,
                      f"--tier {options.tier or 'T0'} --results")
    print(f"report: {options.output / 'report.html'} ({time.monotonic() - start:.0f} s)")
    failed = 0
    for case, _, passed, wrong, _ in rows:
        if not passed:
            failed += 1
            print(f"FAILED {case.id} {case.title}: {'; '.join(wrong)}")
    print(f"{len(rows) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except StudyError as failure:
        sys.exit(f"verify: {failure}")
