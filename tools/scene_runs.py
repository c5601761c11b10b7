#!/usr/bin/python3
"""Runs of ordinary scenes: one scene with overrides becomes one record, and records are kept between calls.

Used by tools/speed_study.py and tools/verify.py; not a program of its own.
"""

import csv
import hashlib
import json
import os
import re
import shutil
import subprocess
import time
import tomllib
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "tests/verification/scenes"


class StudyError(Exception):
    """Something the user can mend; printed without a traceback."""


class Run:
    """What one run of the program left behind. `history` maps column names to arrays; it may be short after a failure,
    and is empty when the run did not start. `message` is what the program complained of."""

    def __init__(self, folder, code, wall, cpu, message=""):
        self.folder, self.code, self.wall, self.cpu, self.message = folder, code, wall, cpu, message
        self.log, self.history = "", {}
        if not (folder / "history.csv").exists():
            return
        self.log = (folder / "run.log").read_text(encoding="utf-8")
        with open(folder / "history.csv", newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
        names = [name.rsplit(" [", 1)[0] for name in lines[0]]
        rows = np.array([[float(value) for value in line] for line in lines[1:] if len(line) == len(names)])
        self.history = dict(zip(names, rows.T))

    def steps(self):
        return int(self.history["step"][-1])

    def particles(self):
        return sum(int(number) for number in re.findall(r": (\d+) particles", self.log))

    def leaked(self):
        found = re.search(r"leaked particles (\d+)", self.log)
        return int(found.group(1)) if found else 0

    def phases(self):
        """Seconds of each phase of the step, mean over the ranks."""
        return {name: float(value) for name, value in re.findall(r"^  (\w+) +([\d.]+) s mean", self.log, re.M)}

    def settings(self):
        """The input with all its defaults, as nested tables; quantities are texts in SI units."""
        with open(self.folder / "input_as_used.toml", "rb") as file:
            return tomllib.load(file)

    def snapshots(self):
        """(time [s], position [m], fields) of every snapshot."""
        with open(self.folder / "snapshots.csv", newline="", encoding="utf-8") as file:
            rows = [(float(row["time [s]"]), self.folder / row["file"]) for row in csv.DictReader(file)]
        for when, path in rows:
            with h5py.File(path, "r") as file:
                data = file["VTKHDF/PointData"]
                yield when, file["VTKHDF/Points"][:].astype(float), {name: data[name][:].astype(float) for name in data}


class Runner:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        version = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=True).stdout.strip()
        self.version = version
        self.commit = re.search(r"commit ([^)]*)\)", version).group(1)

    def run(self, scene, overrides, folder=None, ranks=1, accepted=(0, 3)):
        """One run, on one core unless `ranks` says more; `scene` is a path or a file of tests/verification/scenes. An
        exit code that is not `accepted` (None: all are) is an error of the caller; a blow-up, 3, is a result."""
        folder = folder or self.folder / "run"
        folder.parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        command = [str(self.program), str(SCENES / scene), "--output", str(folder), "--quiet"]
        if ranks > 1:
            command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *command]
        for key, value in overrides.items():
            command += ["-P", f"{key}={value}"]
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        if os.geteuid() == 0:
            environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        complaints = folder.with_name(folder.name + ".errors.txt")
        start = time.monotonic()
        with open(complaints, "w", encoding="utf-8") as errors:
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, env=environment)
            # Time of this child alone, whatever else the machine does.
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - start
        message = complaints.read_text(encoding="utf-8")
        if accepted is not None and process.returncode not in accepted:
            raise StudyError(f"{' '.join(command)}\nended with exit code {process.returncode}\n{message[-2000:]}")
        return Run(folder, process.returncode, wall, usage.ru_utime + usage.ru_stime, message)


def fingerprint(scene, overrides):
    """Of the input of a run, so that a record is not taken for one of a scene that has changed since."""
    text = (SCENES / scene).read_text(encoding="utf-8") + json.dumps(overrides, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


class Records:
    """Lines of JSON, one per run. A run whose `key` (with the fingerprint of its input) and commit are present is not
    repeated."""

    def __init__(self, path, commit):
        self.path, self.commit, self.known = path, commit, {}
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                record = json.loads(line)
                self.known[self.name_of(record["key"], record["commit"])] = record

    @staticmethod
    def name_of(key, commit):
        return json.dumps([key, commit], sort_keys=True)

    def get(self, key, measure):
        """The record of `key` (a dict), from the file or made by `measure()`, a dict of results."""
        name = self.name_of(key, self.commit)
        if name not in self.known:
            record = {"key": key, "commit": self.commit, **measure()}
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
            self.known[name] = record
        return self.known[name]


def table(title, columns, rows):
    print(f"\n{title}\n\n| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for row in rows:
        print("| " + " | ".join(row) + " |")
