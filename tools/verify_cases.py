#!/usr/bin/python3
"""What a case of the verification catalogue is, and where cases are found. Used by tools/verify.py and by the
tests/verification/*/cases.py; not a program of its own.

A case is an ordinary scene file with a reference: it is run at several spacings (and in variants), `measure` compares each
run with the reference, and the targets hold at one spacing. A `Program` is a case that needs no scene, or looks into a run
more closely than its output files allow: a GoogleTest program of the build.
"""

import importlib.util
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

from scene_runs import ROOT

FOLDER = ROOT / "tests/verification"
TIERS = ("T0", "T1", "T2")


@dataclass
class Case:
    """`measure(run)` returns {quantity: error}, signed and relative unless the name says otherwise; a quantity without a
    target is reported only. Spacings in mm, from coarse to fine; none: the scene as it stands."""

    id: str
    title: str
    tier: str
    scene: str  # a file in the folder of the family, or in tests/verification/scenes
    reference: str  # what the truth is, and its source
    measure: Callable
    targets: dict  # {quantity: largest |error|}
    origin: str  # of the targets
    spacings: tuple = ()
    target_spacing: float | None = None  # mm; the finest when missing
    overrides: Callable = lambda spacing: {}
    variants: dict = field(default_factory=dict)  # {name: overrides}, to the same targets
    must_fail: dict = field(default_factory=dict)  # {name: overrides} that miss a target, or the case tests nothing
    refused: dict = field(default_factory=dict)  # {name: (overrides, part of the message)}: wrong input, exit code 2
    diagnosis: str = ""  # why a target is missed, by which experiment
    family: str = ""  # filled in when loaded
    folder: Path | None = None

    def path(self):
        own = self.folder / self.scene
        return own if own.exists() else FOLDER / "scenes" / self.scene

    def goal(self):
        return self.target_spacing or (self.spacings[-1] if self.spacings else None)


@dataclass
class Program:
    """A GoogleTest program run with a filter; it passes if all chosen tests do. Its printed lines are the figures."""

    id: str
    title: str
    tier: str
    program: str  # below build/release/tests
    tests: str  # a filter of GoogleTest
    reference: str
    target: str  # in words, as the test has it
    ranks: int = 1
    diagnosis: str = ""
    family: str = ""
    folder: Path | None = None


def load(folder=FOLDER):
    """All cases of tests/verification/*/cases.py, in the order of the folders and files."""
    cases = []
    for path in sorted(folder.glob("*/cases.py")):
        spec = importlib.util.spec_from_file_location(f"cases_{path.parent.name}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        for case in module.CASES:
            case.family, case.folder = path.parent.name, path.parent
            if case.tier not in TIERS:
                raise ValueError(f"{path}: case {case.id} has tier {case.tier}, allowed are {', '.join(TIERS)}")
            cases.append(case)
    ids = [case.id for case in cases]
    if len(set(ids)) < len(ids):
        raise ValueError(f"two cases are named {next(i for i in ids if ids.count(i) > 1)}")
    return cases


def mean_between(run, column, begin, end):
    """Mean over time of a column of the history."""
    time, value = run.history["time"], run.history[column]
    inside = (time >= begin) & (time <= end)
    if inside.sum() < 2:
        return float("nan")
    return float(((value[inside][1:] + value[inside][:-1]) / 2 * (time[inside][1:] - time[inside][:-1])).sum()
                 / (time[inside][-1] - time[inside][0]))
