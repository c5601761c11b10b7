#!/usr/bin/python3
"""F: what scaled inertia adds to forces, against its formulas; swirl."""

from verify_cases import Program

CASES = [
    Program("F1", "upsetting with scaled mass, rings and three dimensions", "T1", "verification/mass_scaling_test", "*",
            "(3/16) s rho v^2 R^2/H^2 [E]", "10 % of itself at 0.125 mm (rings); 1.23 at 0.5 mm (three dimensions)"),
    Program("F2", "spinning plug with scaled mass, with and without inertia of the swirl", "T0", "verification/swirl_test",
            "SpinningPlug*", "s rho w^2 R^2/4 [E]", "10 %; nothing without inertia of the swirl"),
    Program("F3", "Couette flow with scaled mass", "T0", "verification/couette_test", "*F3*",
            "torque of the unscaled flow [E]", "1 %"),
]
