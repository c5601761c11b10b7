#!/usr/bin/python3
"""Compares the speed of two builds: runs stirsph_bench of both in turn, so that a busy machine disturbs both alike.

Usage: tools/bench_compare.py BASE CHANGE [--rounds N] [--ranks N] [-- SCENE and other arguments of stirsph_bench]

BASE and CHANGE are stirsph_bench programs or git revisions; a revision is built in a temporary worktree. Prints the
ratio CHANGE / BASE of the rate and of each phase's seconds: median, least and greatest over the rounds.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOTICED = 1e-3  # phases below this share of the step are all noise


class BenchError(Exception):
    """A message for the user."""


def record_of(program, arguments, ranks=1):
    """The JSON record of one run of stirsph_bench."""
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    if os.geteuid() == 0:  # containers; Open MPI asks twice
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    launcher = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] if ranks > 1 else []
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "record.json"
        command = [*launcher, str(program), *arguments, "--json", str(path)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
        except OSError as error:
            raise BenchError(f"{command[0]}: {error.strerror}; give a stirsph_bench program") from error
        if done.returncode != 0 or not path.exists():
            raise BenchError(f"'{' '.join(command)}' ended with {done.returncode}:\n{done.stdout}{done.stderr}")
        return json.loads(path.read_text(encoding="utf-8"))


def build_revision(revision, stack):
    """stirsph_bench of a git revision, built in a worktree that is removed when `stack` closes."""
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "source"
    git = ["git", "-C", str(ROOT), "worktree"]
    done = subprocess.run([*git, "add", "--detach", str(folder), revision], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BenchError(f"{revision} is neither a program nor a git revision: {done.stderr.strip()}")
    stack.callback(subprocess.run, [*git, "remove", "--force", str(folder)], check=False)
    print(f"building {revision} ...", flush=True)
    if subprocess.run([folder / "tools/build.sh", "release", "stirsph_bench"], check=False).returncode != 0:
        raise BenchError(f"{revision} does not build")
    return folder / "build/release/stirsph_bench"


def program_of(name, stack):
    path = Path(name)
    return path.resolve() if path.is_file() else build_revision(name, stack)


def ratios(base, change):
    """Ratios change / base of one round by name."""
    result = {"rate": change["particle_steps_per_s_per_core"] / base["particle_steps_per_s_per_core"],
              "bytes per particle": change["bytes_per_particle"] / base["bytes_per_particle"]}
    for phase in base["phases"].keys() & change["phases"].keys():
        seconds = base["phases"][phase]["mean"]
        if seconds > NOTICED * base["seconds"]:
            result["seconds of " + phase] = change["phases"][phase]["mean"] / seconds
    return result


def summary(rounds):
    """One line per ratio that every round has; the rate first."""
    names = [name for name in rounds[0] if all(name in entry for entry in rounds)]
    lines = [f"{'change / base':<28} {'median':>8} {'min':>8} {'max':>8}"]
    for name in sorted(names, key=lambda name: (name != "rate", name)):
        values = [entry[name] for entry in rounds]
        lines.append(f"{name:<28} {statistics.median(values):8.3f} {min(values):8.3f} {max(values):8.3f}")
    return lines


def positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text}: at least 1")
    return value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", metavar="BASE")
    parser.add_argument("change", metavar="CHANGE")
    parser.add_argument("--rounds", type=positive, default=5)
    parser.add_argument("--ranks", type=positive, default=1)
    own, bench = sys.argv[1:], []
    if "--" in own:
        cut = own.index("--")
        own, bench = own[:cut], own[cut + 1:]
    arguments = parser.parse_args(own)
    with ExitStack() as stack:
        base, change = program_of(arguments.base, stack), program_of(arguments.change, stack)
        rounds = []
        for k in range(arguments.rounds):
            # Whoever runs second may find the machine warmer: take turns in that too.
            order = [base, change] if k % 2 == 0 else [change, base]
            records = {program: record_of(program, bench, arguments.ranks) for program in order}
            first, second = records[base], records[change]
            if base != change and first["options"] != second["options"]:
                raise BenchError(f"the two do not run the same: {first['options']} and {second['options']}")
            rounds.append(ratios(first, second))
            print(f"round {k + 1}: base {first['particle_steps_per_s_per_core']:.4g} ({first['commit']}), "
                  f"change {second['particle_steps_per_s_per_core']:.4g} ({second['commit']}) particle-steps/s per core",
                  flush=True)
    print("\n".join(summary(rounds)))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BenchError as problem:
        print(f"bench_compare: {problem}", file=sys.stderr)
        sys.exit(2)
