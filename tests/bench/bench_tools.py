#!/usr/bin/python3
"""Runs tools/bench_table.py and tools/bench_compare.py on tiny scenes. Usage: bench_tools.py PROGRAM"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

TOOLS = Path(os.environ["STIRSPH_TOOLS"])
sys.path.insert(0, str(TOOLS))
import bench_compare  # noqa: E402


def run(tool, *arguments):
    return subprocess.run([sys.executable, TOOLS / tool, *arguments], capture_output=True, text=True, check=False)


def check_ratios():
    base = {"particle_steps_per_s_per_core": 2e6, "bytes_per_particle": 500, "seconds": 10,
            "phases": {"stress": {"mean": 5}, "forces": {"mean": 4}, "vote": {"mean": 1e-3}}}
    change = {"particle_steps_per_s_per_core": 3e6, "bytes_per_particle": 400, "seconds": 8,
              "phases": {"stress": {"mean": 4}, "forces": {"mean": 4}, "vote": {"mean": 1}}}
    ratios = bench_compare.ratios(base, change)
    assert ratios == {"rate": 1.5, "bytes per particle": 0.8, "seconds of stress": 0.8, "seconds of forces": 1.0}
    lines = bench_compare.summary([ratios, dict(ratios, rate=1.1), dict(ratios, rate=1.2)])
    assert lines[1].split() == ["rate", "1.200", "1.100", "1.500"], lines


def check_compare(program):
    done = run("bench_compare.py", program, program, "--rounds", "2", "--", "small", "--particles", "200", "--steps", "2")
    assert done.returncode == 0 and "seconds of stress" in done.stdout, done.stderr
    done = run("bench_compare.py", "no-such-revision", program)
    assert done.returncode == 2 and "no-such-revision" in done.stderr and "Traceback" not in done.stderr, done.stderr


def check_table(program):
    with tempfile.TemporaryDirectory() as scratch:
        done = run("bench_table.py", "--program", program, "--portable-program", program, "--particles", "600",
                   "--steps", "3", "--repeat", "2", "--markdown", "--output", scratch)
        assert done.returncode == 0, done.stderr
        rows = [line for line in done.stdout.splitlines() if line.startswith("| ")]
        for figure in ("2 ranks against 1", "bytes per particle", "a list rebuild in steps", "steps per list",
                       "contact, integration, ledger, output", "overhead per step", "(portable build)",
                       "gradient correction", "stress, correction velocity"):
            assert any(figure in row for row in rows), figure
        assert "the targets do not apply" in done.stdout
        records = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in Path(scratch).iterdir()}
        assert records["release_block_none_2_ranks.json"]["ranks"] == 2 and "portable_machine_1_ranks.json" in records
        peer = next(row for row in rows if "0.458 M" in row).split(" | ")
        ours = records["release_taylor_velocity_1_ranks.json"]["particle_steps_per_s_per_core"]
        assert abs(float(peer[-1].split()[0]) - ours / 0.458e6) < 0.006, (peer, ours)


def main():
    check_ratios()
    check_compare(sys.argv[1])
    check_table(sys.argv[1])
    return 0


if __name__ == "__main__":
    sys.exit(main())
