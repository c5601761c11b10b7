#!/usr/bin/python3
"""Runs every scene of stirsph_bench on a few hundred particles and checks its record. Usage: bench_records.py PROGRAM RANKS"""

import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, os.environ["STIRSPH_TOOLS"])
from bench_compare import BenchError, record_of  # noqa: E402

LAST_LINE = ("particle_steps_per_s_per_core", "neighbours", "bytes_per_particle", "ranks", "rebuild_cost_steps",
             "steps_per_list", "step_overhead_us")
STEPS, REPEATS = 3, 2
PHASES = {"block": set(), "small": set(), "stirred": {"loads"}, "extrusion": {"contact", "heat"}, "taylor": {"loads"}}


def close(a, b, tolerance=1e-6):
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=1e-9)


def check_record(record, scene, correction, ranks):
    assert record["scene"] == scene and record["ranks"] == ranks and record["steps"] == STEPS
    assert record["options"] == {"particles": 600, "gradient_correction": correction, "repeats": REPEATS}
    assert 200 < record["particles"] < 900, record["particles"]
    assert {"cpu", "family", "model", "lanes", "compiler"} == record["machine"].keys() and record["commit"]
    for key in LAST_LINE:
        assert isinstance(record[key], (int, float)) and record[key] > 0, key
    # Nearest neighbours within 2.6 spacings: 80 inside a lattice, fewer at the many surfaces of so small a body.
    assert 15 < record["neighbours"] < 80
    assert record["candidates_per_cluster"] >= record["visited_per_register"] > 8
    assert close(sum(record["bytes"].values()), record["bytes_per_particle"])

    seconds, rates = record["seconds"], record["rates"]
    assert len(rates) == REPEATS and close(max(rates), record["particle_steps_per_s_per_core"])  # faster of two
    assert close(record["particles"] * STEPS / seconds / ranks, record["particle_steps_per_s_per_core"])
    phases = record["phases"]
    assert {"stress", "forces", "integration", "vote", "halo", "output", "other"} | PHASES[scene] <= phases.keys()
    for name, phase in phases.items():
        assert phase["min"] <= phase["mean"] * (1 + 1e-6) + 1e-9 and phase["mean"] <= phase["max"] * (1 + 1e-6) + 1e-9, name
    # A rank's phases fill its own window; the slowest rank's is reported.
    filled = sum(phase["mean"] for phase in phases.values())
    assert filled <= seconds * (1 + 1e-6) and (ranks > 1 or close(filled, seconds)), (filled, seconds)
    sweeps = phases["stress"]["mean"] + phases["forces"]["mean"]
    rebuilding = phases.get("neighbours", {"mean": 0})["mean"]
    assert close(record["step_overhead_us"], 1e6 * (seconds - sweeps - rebuilding) / STEPS, 1e-4)
    assert (record["rebuilds"] > 0) == ("neighbours" in phases)
    assert 0 < record["cpu_share"] < 1.05  # two clocks
    assert 0 < record["service_share"] < 1 and (phases["output"]["mean"] > 0) == (scene == "extrusion")


def check_last_line(program):
    done = subprocess.run([program, "small", "--particles", "200", "--steps", "2"], capture_output=True, text=True,
                          check=True)
    words = dict(word.split("=") for word in done.stdout.strip().splitlines()[-1].split())
    assert tuple(words) == LAST_LINE and all(float(value) > 0 for value in words.values()), words


def check_sizes(program):
    """The scenes at their own size: created by nobody, only counted."""
    for scene, expected, spacing in (("block", 262144, 0.4e-3), ("small", 3000, 0.4e-3), ("stirred", 263088, 0.4e-3),
                                     ("extrusion", 246472, 0.4e-3), ("taylor", 66170, 0.25e-3)):
        record = record_of(program, [scene, "--dry-run"])
        assert record["particles"] == expected and close(record["spacing"], spacing), (scene, record)


def check_refusals(program):
    for arguments in (["blok"], ["block", "--gradient-correction", "momentum"], ["block", "--steps", "0"],
                      ["block", "--stepz", "3"]):
        try:
            record_of(program, arguments)
        except BenchError as problem:
            assert any(word in str(problem) for word in ("blok", "momentum", "--steps", "--stepz")), problem
        else:
            raise AssertionError(f"accepted: {arguments}")


def check_unwritable(program):
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch) / "missing" / "record.json"
        done = subprocess.run([program, "block", "--dry-run", "--json", target], capture_output=True, text=True,
                              check=False)
        assert done.returncode != 0 and str(target.parent) in done.stderr, done.stderr


def main():
    program, ranks = sys.argv[1], int(sys.argv[2])
    for scene in PHASES:
        for correction in ("none", "velocity", "full"):
            record = record_of(program, [scene, "--particles", "600", "--steps", str(STEPS), "--repeat", str(REPEATS),
                                         "--gradient-correction", correction], ranks)
            check_record(record, scene, correction, ranks)
    machine = record_of(program, ["machine"], ranks)
    for key in ("multiply_add", "add", "divide", "square_root", "triad"):
        assert machine[key] > 1e7, key  # slower than any processor of this century
    assert machine["ranks"] == ranks
    if ranks == 1:
        check_last_line(program)
        check_sizes(program)
        check_refusals(program)
        check_unwritable(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
