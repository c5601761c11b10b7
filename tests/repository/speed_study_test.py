#!/usr/bin/python3
"""Gives the speed study made-up runs with known errors and costs. Usage: speed_study_test.py ROOT"""

import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(sys.argv[1]) / "tools"))
import speed_cases  # noqa: E402  (the path comes from the command line)
import speed_pareto  # noqa: E402
import scene_runs  # noqa: E402
import speed_time_step  # noqa: E402


def runs_of(*pairs):
    """Runs of one setting from coarse to fine with these (error, CPU seconds)."""
    return [{"error": error, "cpu_s": cpu, "key": {"spacing_mm": 2.0**-k}} for k, (error, cpu) in enumerate(pairs)]


class Measures(unittest.TestCase):
    def test_bar_that_follows_the_theory_has_no_error(self):
        time = np.linspace(0, 12e-6, 1201)
        force = -141.998e6 * 2.4e-3**2 * (time < 7.845e-6)
        force[0] = 0
        errors = speed_cases.bar_on_wall(
            SimpleNamespace(history={"time": time, "wall.force_x": force, "v_mean": np.full(1201, 10.0)}))
        self.assertEqual(set(errors), {"stress", "contact time", "rebound"})
        for error in errors.values():
            self.assertLess(abs(error), 2e-3)

    def test_plate_with_a_longer_period_and_damping(self):
        time, period, loss = np.linspace(0, 0.32, 321), 1.03 * 0.2553, 0.04
        tip = np.sin(2 * np.pi * time / period) * (1 - loss) ** (time / period)
        errors = speed_cases.oscillating_plate(SimpleNamespace(history={"time": time, "tip": 0.5 + tip}))
        self.assertAlmostEqual(errors["period"], 0.03, places=3)
        self.assertAlmostEqual(errors["amplitude loss"], loss, places=3)

    def test_bar_of_the_right_shape(self):
        angle = np.linspace(0, 2 * np.pi, 240, endpoint=False)
        foot = np.stack([7.2e-3 * np.cos(angle), 7.2e-3 * np.sin(angle), 0.2e-3 + 0 * angle], axis=1)
        loose = np.array([[9e-3, 0, 0.2e-3]])
        top = np.array([[0, 0, 21.24e-3]])
        shape = np.concatenate([foot, loose, top])
        run = SimpleNamespace(snapshots=lambda: iter([(0.0, shape, {}), (8e-5, shape, {})]))
        for error in speed_cases.taylor_bar(run).values():
            self.assertLess(abs(error), 1e-9)

    def test_slab_of_the_catalogue(self):
        self.assertAlmostEqual(float(speed_cases.heated_slab(np.array([0.0]), 0.2)[0]), 0.143675, places=6)
        self.assertAlmostEqual(float(speed_cases.heated_slab(np.array([0.005]), 0.5)[0]), 0.652371, places=6)

    def test_phase_speed_of_a_sampled_wave(self):
        omega = 0.97 * 2 * np.pi / 16e-3 * speed_time_step.WAVE_SPEED
        time = np.linspace(0, 1e-4, 300)
        run = SimpleNamespace(history={"time": time, "energy.kinetic": np.cos(omega * time) ** 2})
        self.assertAlmostEqual(speed_time_step.phase_speed(run)["phase speed"], 0.97, places=3)


class Costs(unittest.TestCase):
    def test_interpolates_in_the_logarithms(self):
        cost, spacing = speed_pareto.cost_to_reach(0.02, runs_of((0.08, 1), (0.02**2 / 0.08, 100)))
        self.assertAlmostEqual(cost, 10)
        self.assertAlmostEqual(spacing, 2**-0.5)

    def test_an_error_passing_through_zero_does_not_count(self):
        self.assertIsNone(speed_pareto.cost_to_reach(0.02, runs_of((0.001, 1), (0.05, 8))))
        self.assertEqual(speed_pareto.cost_to_reach(0.02, runs_of((0.03, 1), (None, 4), (0.01, 9)))[0], 9)

    def test_what_is_dominated(self):
        better = runs_of((0.04, 0.5), (0.02, 1))
        self.assertFalse(speed_pareto.dominated(better, [better]))
        examples = ((0.05, 2, True), (0.05, 1.2, False), (0.1, 0.9, True), (0.1, 0.7, False), (None, 1, True))
        for error, cpu, expected in examples:
            own = runs_of((0.04, 0.1), (error, cpu))
            self.assertEqual(speed_pareto.dominated(own, [better, own]), expected, (error, cpu))

    def test_an_error_that_is_small_once_does_not_dominate(self):
        lucky, steady = runs_of((0.1, 0.5), (0.0001, 1)), runs_of((0.1, 0.5), (0.05, 1.2))
        self.assertFalse(speed_pareto.dominated(steady, [lucky, steady]))

    def test_front(self):
        runs = runs_of((0.1, 1), (0.2, 2), (0.05, 3), (None, 0.1))
        self.assertEqual([run["cpu_s"] for run in speed_pareto.front(runs)], [1, 3])


class Memory(unittest.TestCase):
    def test_runs_of_this_commit_are_not_repeated(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "records.jsonl"
            made = []

            def measure():
                made.append(1)
                return {"error": 0.1}

            for commit in ("a", "a", "b"):
                records = scene_runs.Records(path, commit)
                self.assertEqual(records.get({"case": "B2"}, measure)["error"], 0.1)
            self.assertEqual(len(made), 2)
            self.assertEqual(len(path.read_text(encoding="utf-8").splitlines()), 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
