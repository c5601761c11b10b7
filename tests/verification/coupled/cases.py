#!/usr/bin/python3
"""G: coupled cases, restart, rank count; C8 and D4, the core of the process."""

from verify_cases import Case, Program, mean_between

SLICE = 2e-3  # m along the axis


def torque_of_held_layers(run):
    """C8, RS at 100 rad/s: torque per length on the inner grip in the last tenth of a millisecond."""
    return {"torque": mean_between(run, "tool.torque_z", 0.9e-3, 1e-3) / SLICE / 39251 - 1,
            "torque on the die": mean_between(run, "die.torque_z", 0.9e-3, 1e-3) / SLICE / -39251 - 1}


def hot_held_layers(run):
    """G1, k = 2000 W/m/K: torque per length and rise of the face's temperature in the steady state."""
    end = run.history["time"][-1]
    return {"torque": mean_between(run, "tool.torque_z", 0.9 * end, end) / SLICE / 33536 - 1,
            "rise of the face": (run.history["face"][-1] - 293.15) / (451.45 - 293.15) - 1}


CASES = [
    Program("C8", "Couette annulus, no slip by held layers, perfectly plastic and AL", "T0", "verification/couette_test",
            "*PerfectlyPlasticTorqueC8:*JohnsonCookTorqueC8", "closed form [E]", "1 %; 6 %"),
    Program("C8p", "plane shear between grips, RS", "T0", "verification/couette_test", "*PlaneShear*",
            "k (1 + C ln(V/(sqrt(3) H))) [E]", "0.2 %"),
    Program("C8r", "Couette annulus, no slip by friction: perfectly plastic, AL, RS at 100 rad/s", "T0",
            "verification/couette_test", "*RubbingToolC8:*RubbingToolRateSensitiveC8", "closed form [E]", "3 % of no slip"),
    Case("C8h", "Couette annulus, no slip by held layers, RS at 100 rad/s", "T1", "c8_couette_rings.toml",
         "39251 N, closed form [E]", torque_of_held_layers, {"torque": 0.05}, "catalogue [T]", spacings=(0.25, 0.125),
         target_spacing=0.25),
    Case("G1h", "hot Couette flow, no slip by held layers", "T1", "g1_hot_couette.toml",
         "boundary value problem [N]: 33536 N, 451.45 K at k = 2000 W/m/K", hot_held_layers,
         {"torque": 0.05, "rise of the face": 0.05}, "catalogue [T]", spacings=(0.25,)),
    Program("G1r", "hot Couette flow, tool that rubs", "T0", "verification/couette_test", "*HotRubbingToolG1",
            "boundary value problem [N]", "torque and rise of temperature 5 %, heat out 1 %"),
    Program("D4", "sliding tool: two thirds of mu F R; flat punch", "T0", "verification/sliding_torque_test", "*",
            "closed form [E], finite elements [N]", "3 %"),
    Program("G3", "restart", "T0", "verification/restart_test", "*", "identity", "bitwise on the same ranks", ranks=2),
    Program("G4", "rank count", "T0", "verification/rank_count_test", "*", "identity",
            "1e-13 after a step, 1e-10 after 1000, Taylor bar 1e-6", ranks=4),
    Program("S1", "planes of symmetry: part of the whole", "T0", "verification/symmetry_test", "*", "identity", "1e-9"),
]
