#!/usr/bin/python3
"""E: heat conduction, interfaces and sources. Most cases compare whole fields with exact solutions and measure orders in
space and time within one test, in two and three dimensions; they are programs."""

import speed_cases
from verify_cases import Case, Program

CATALOGUE = "catalogue, set by reasoning [T]"
EXACT = "closed form or series [E]"


def heat(case, title, program, tests, reference, target, tier="T0", diagnosis=""):
    return Program(case, title, tier, f"{program}", tests, reference, target, diagnosis=diagnosis)


CASES = [
    heat("A4", "conduction operator on a cosine", "thermal/heat_test", "ConductionOperator*:LatticeSums*",
         "lattice sums of the catalogue [N]", "1e-3 of the table"),
    Case("E1", "slab heated through its faces", "T0", "e1_slab.toml", "series solution [E]", speed_cases.slab,
         {"T at 0.2 s": 0.01, "T at 0.5 s": 0.01, "T at 1.0 s": 0.01}, CATALOGUE, spacings=(10 / 3, 2.0, 1.0),
         overrides=speed_cases.slab_box),
    heat("E1b", "the same in two dimensions, with jitter, in the mesh; order", "verification/heat_conduction_cases_test",
         "*E1*:HeatedSlab*", EXACT, "1 % (L2) at 20 spacings"),
    heat("E2", "two half-spaces with a film, h = 147 to 1e6; sliding at 1.7 m/s", "verification/heat_interface_cases_test",
         "*HalfSpaces*", EXACT, "1 %"),
    heat("E3", "billet in its die, paper's geometry", "verification/heat_interface_cases_test", "BilletInDie*",
         "finite volumes, 900 cells [N]", "1 % of 380 K"),
    heat("E4", "composite slab, steady", "verification/heat_conduction_cases_test", "*E4*", EXACT,
         "1e-3, both sides alike to 1e-10"),
    heat("E5", "conductivity that depends on temperature", "verification/heat_conduction_cases_test", "*E5*",
         "Kirchhoff transform [E]", "1e-3"),
    heat("E6", "manufactured solution with k(T), c_p(T): order in space and time",
         "verification/heat_conduction_cases_test", "Manufactured*:*E6*", EXACT, "orders of the schemes"),
    heat("E7", "moving plane, line and surface sources", "verification/heat_source_cases_test", "*",
         "closed form; integral of Eagar and Tsai [N]", "2 % of the peak"),
    heat("E8", "time schemes: decay factors, huge steps", "thermal/heat_test", "TimeScheme*", "discrete factors [E]",
         "1e-8; no overshoot at lambda dt = 1e3"),
    heat("E9", "heat of a closed system with sliding contact", "verification/heat_interface_cases_test", "Conservation*",
         "conserved [E]", "10 times the solver tolerance"),
    heat("E10", "thermal step against mechanical step", "verification/heat_staggering_test", "*", "first order [E]",
         "observed order 1"),
    heat("E11", "rings: quenched rod, steady tube, E3", "verification/axisymmetric_heat_cases_test",
         "QuenchedRod*:SteadyTube*:BilletInDie*", EXACT, "1 %"),
    heat("D5", "partition of friction heat", "verification/heat_interface_cases_test", "*FrictionPartition*:*D5*", EXACT,
         "3 %"),
    heat("H", "grain size and hardness, and where the law has no value", "microstructure/grain_test", "*",
         "table of the catalogue [E]", "1e-5"),
]
