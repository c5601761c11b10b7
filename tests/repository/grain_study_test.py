#!/usr/bin/python3
"""Gives the grain study made-up maps with known changes. Usage: grain_study_test.py ROOT"""

import io
import sys
import unittest
from contextlib import redirect_stdout
from pathlib import Path
from types import SimpleNamespace

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(sys.argv[1]) / "tools"))
import grain_study  # noqa: E402  (the path comes from the command line)


def run_of(rows):
    """A run whose last snapshot has rows of (r [mm], z [mm], grain size [um], recrystallised)."""
    r, z, grain, known = np.array(rows, float).T
    points = 1e-3 * np.stack([0.6 * r, 0.8 * r, z], -1)
    last = (1.0, points, {"grain_size": 1e-6 * grain, "recrystallised": known})
    return SimpleNamespace(folder=Path("made_up"), snapshots=lambda: iter([(0.0, points, {}), last]))


class GrainStudy(unittest.TestCase):
    def test_squares_hold_three_recrystallised_particles(self):
        mean, squares = grain_study.grain_map(run_of(
            [(0.2, 5.1, 3, 1), (0.5, 5.5, 4, 1), (0.9, 5.9, 5, 1), (0.5, 5.5, 30, 0)] +  # a square with its mean of 4
            [(1.5, 5.5, 8, 1), (1.5, 5.6, 8, 1), (1.5, 5.7, 30, 0)]))                    # two are too few
        self.assertAlmostEqual(mean, 28 / 5)
        self.assertEqual(list(squares), [(0, 5)])
        self.assertAlmostEqual(squares[0, 5], 4)

    def test_nothing_recrystallised_is_an_error(self):
        with self.assertRaisesRegex(grain_study.StudyError, "nothing has recrystallised"):
            grain_study.grain_map(run_of([(1, 1, 30, 0)]))

    def test_change_has_the_standard_error_of_both_groups(self):
        moved, error = grain_study.change(np.array([3.9, 4.1]), np.array([4.0, 4.4]))
        self.assertAlmostEqual(moved, 0.05)
        # Variances 0.02 and 0.08, each over two runs.
        self.assertAlmostEqual(error, np.sqrt(0.01 + 0.04) / 4)

    def test_report_tells_the_change_of_mean_and_squares(self):
        squares = {0.5: [3.9, 4.1], 0.25: [4.0, 4.4]}
        maps = {courant: [(mean, {(0, 5): mean, (1, 5): 2 * mean}) for mean in means]
                for courant, means in squares.items()}
        maps[0.5][0][1][7, 7] = 1.0  # a square that one run alone has
        told = io.StringIO()
        with redirect_stdout(told):
            grain_study.report([0.5, 0.25], maps)
        self.assertIn("0.25 against 0.5: mean +5.00 % (standard error 5.59)", told.getvalue())
        self.assertIn("2 squares: mean change +5.00 %, standard deviation 0.00 %, of which chance makes 5.59 %",
                      told.getvalue())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
