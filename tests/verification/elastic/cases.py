"""B: elastic dynamics and objectivity."""

import numpy as np
import speed_cases
from verify_cases import Case, Program

CATALOGUE = "catalogue, set by reasoning [T]"


CASES = [
    Program("B1", "phase speed of plane waves", "T0", "verification/elastic_test", "*PlaneWave*",
            "semi-discrete formula [N]", "1e-3"),
    Case("B2", "elastic bar on a rigid wall", "T0", "b2_bar_on_wall.toml",
         "stress rho c v = 141.998 MPa, contact time 2 L/c = 7.845 us, rebound 10 m/s [E]",
         speed_cases.bar_on_wall, {"stress": 0.02, "contact time": 0.03, "rebound": 0.03}, CATALOGUE,
         spacings=(0.8, 0.4, 0.2), target_spacing=0.4),
    Program("B5", "stressed point turned 1000 times", "T0", "mechanics/stress_point_test", "*", "sigma = R sigma0 R^T [E]",
            "invariants 1e-10, phase second order in dt"),
]
