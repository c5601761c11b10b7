"""Hard cases: input that must be refused, sharp edges, extremes of material and of numerical settings, long runs."""

import numpy as np
from verify_cases import Case, Program, mean_between

REASONED = "set by reasoning [T]"
CATALOGUE = "catalogue, set by reasoning [T]"


def sound(run):
    """What every run must have: all particles, only numbers, closed balance of energy. The residual is relative to the
    largest energy involved, see src/driver/diagnostics.hpp."""
    wrong = sum(int((~np.isfinite(column)).sum()) for column in run.history.values())
    for _, position, fields in run.snapshots():
        wrong += int((~np.isfinite(position)).sum()) + sum(int((~np.isfinite(field)).sum()) for field in fields.values())
    return {"lost particles": run.leaked(), "values that are no numbers": wrong,
            "energy residual": run.history["energy.residual"][-1]}


SOUND = {"lost particles": 0, "values that are no numbers": 0, "energy residual": 0.02}


def spacing_of(run):
    return float(run.settings()["numerics"]["spacing"].split()[0])


def last_snapshot(run):
    *_, (_, position, fields) = run.snapshots()
    return position, fields


def cut(run):
    """Slip-line field of Lee and Shaffer with rake 0 and no friction: shear plane at 45 degrees, force 2 k t."""
    exact = 2 * 265e6 / np.sqrt(3) * 1e-3
    force = -mean_between(run, "tool.force_x", 0.15e-3, 0.3e-3)
    return {"cutting force": force / exact - 1, **sound(run)}


def wedge_die(run):
    """Hill's slip-line field of the wedge die; the exit is as thick as the die is wide there."""
    k, angle, half_height, exit_height = 265e6 / np.sqrt(3), np.pi / 3, 5e-3, 1.8301270189e-3
    reduction = 2 * np.sin(angle) / (1 + 2 * np.sin(angle))
    exact = 2 * k * reduction * (1 + angle) * half_height
    force = -mean_between(run, "ram.force_x", 0.3e-3, 0.6e-3)
    position, fields = last_snapshot(run)
    spacing = spacing_of(run)
    # The front end is what was pushed in first; steady metal has passed the die and is clear of it.
    out = (position[:, 0] > 1e-3) & (position[:, 0] < 3e-3)
    thickness = np.median([position[out & (np.abs(position[:, 0] - x) < spacing), 1].max() + spacing / 2
                           for x in np.arange(1.2e-3, 2.8e-3, spacing)])
    speed = np.average(fields["velocity"][out, 0])
    return {"ram force": force / exact - 1, "exit thickness": thickness / exit_height - 1,
            "exit speed": speed / (5 * half_height / exit_height) - 1, **sound(run)}


def sheared_through_melting(run):
    """All plastic work is heat (share 0.9): strength falls with the temperature until the residual strength is left, then
    the temperature rises in proportion to the strain. Exact for the plastic strain that the run reports."""
    strength, share, heat, reference, melting, residual = 265e6, 0.9, 2785 * 875, 293.15, 823.15, 0.01
    strain, start = run.history["plastic_strain"], 815.15
    slope = share * strength / heat
    range_ = melting - reference
    bend = np.log((melting - start) / (residual * range_)) * range_ / slope
    exact = np.where(strain < bend, melting - (melting - start) * np.exp(-slope * strain / range_),
                     melting - residual * range_ + slope * residual * (strain - bend))
    rise = exact[-1] - start
    stress = residual * strength / np.sqrt(3)
    return {"temperature": np.abs(run.history["T_core"] - exact).max() / rise,
            "strength left": run.history["shear_stress"][-1] / stress - 1,
            "plastic strain": strain[-1] / (20 / np.sqrt(3)) - 1,
            "kelvin above melting": run.history["T_core"][-1] - melting, **sound(run)}


def nothing_to_measure(run):
    return sound(run)


CASES = [
    Program("G5", "nasty input: refused with place, value and remedy", "T0", "scene/bad_input_test", "*",
            "an answer before the first step", "exit code 2 and one message for each of some forty mistakes"),
    Case("G5.1", "nasty input through the program", "T0", "g5_press.toml", "refused before the first step, exit code 2",
         nothing_to_measure, SOUND, CATALOGUE,
         refused={
             "step of zero": ({"time.step": '"0 s"'}, "time.step"),
             "step below zero": ({"time.step": '"-1e-8 s"'}, "time.step"),
             "Courant number below zero": ({"time.cfl": "-0.5"}, "time.cfl"),
             "temperature that is no number": ({"body.0.temperature": '"nan K"'}, "not a number"),
             "formula that is infinite at a particle": ({"body.0.temperature": '"600/(x - 0.5e-3)"'}, "must have a value"),
             "motion that has no value later": ({"rigid.0.motion.z": '"sqrt(1e-6 - t)"'}, "rigid \"tool\""),
             "friction that is no number": ({"contact.0.friction": '"nan"'}, "contact[0].friction"),
             "tool inside the billet": ({"rigid.0.shape.base": '["3 mm", "3 mm", "4 mm"]'}, "overlaps a deformable body"),
             "billet inside the tool": ({"rigid.0.shape.base": '["3 mm", "3 mm", "-1 mm"]', "rigid.0.shape.radius": '"20 mm"'},
                                        "overlaps a deformable body"),
             "particles on each other": ({"body.1.shape.low": '["5 mm", "0 mm", "0 mm"]'}, "sit on each other"),
             "periodic box smaller than the body": (
                 {"domain.periodic": '["y"]', "domain.low": '["0 mm", "0 mm", "0 mm"]',
                  "domain.high": '["9 mm", "3 mm", "6 mm"]'}, "periodic box is smaller"),
             "periodic box without length": (
                 {"domain.periodic": '["x"]', "domain.low": '["0 mm", "0 mm", "0 mm"]',
                  "domain.high": '["0 mm", "3 mm", "6 mm"]'}, "positive length"),
             "body inside out": ({"body.0.shape.high": '["-6 mm", "6 mm", "6 mm"]'}, "larger than that of low"),
             "body thinner than half a spacing": ({"body.0.shape.high": '["0.3 mm", "6 mm", "6 mm"]'}, "no lattice point"),
             "spacing larger than the body": ({"numerics.spacing": '"20 mm"'}, "no lattice point"),
         }),
    Case("G5.2", "nasty input that a user would want refused", "T0", "g5_press.toml",
         "refused before the first step, exit code 2, with the value and its limit",
         nothing_to_measure, SOUND, CATALOGUE,
         refused={
             "hotter than the melting temperature": ({"body.0.temperature": '"900 K"'}, "melting"),
             "step beyond any stable one": ({"time.step": '"1e-4 s"', "time.end": '"1 ms"'}, "time.step"),
             "bodies that overlap between lattice points": (
                 {"body.1.shape.low": '["5.2 mm", "0 mm", "0 mm"]', "body.1.lattice_origin": '["0.4 mm", "0 mm", "0 mm"]'},
                 "overlap"),
             "periodic box that cuts a spacing in two": (
                 {"domain.periodic": '["y"]', "domain.low": '["0 mm", "0 mm", "0 mm"]',
                  "domain.high": '["9 mm", "5.5 mm", "6 mm"]'}, "periodic"),
             "infinite velocity": ({"body.0.velocity.x": '"inf m/s"'}, "velocity"),
             "contact with no body": ({"contact.0.bodies": "[]"}, "bodies"),
         },
         diagnosis="All six are accepted. 900 K (melting 823.15 K) runs with the residual strength, no warning. A step 1200 times the "
                   "stable one ends with exit code 0: the particles fly apart at 17 km/s, below limits.speed (ten wave speeds), "
                   "and -13.8 kJ of contact energy balance 13.8 kJ of motion (time.cfl refuses values above 3, time.step has "
                   "no such limit). Particles nearer than 0.1 dx are refused, a second body 0.8 dx deep in the first is not. A "
                   "seam of half a spacing passes. Infinite velocity ends the first step with exit code 3 instead of 2. "
                   "An empty list of bodies passes."),
    Case("K1", "tool edge cutting a layer off", "T1", "tool_edge.toml",
         "force 2 k t = 306.0 kN/m, slip-line field of rake 0 without friction [E for rigid-plastic metal]",
         cut, {"cutting force": 0.15, **SOUND}, REASONED, spacings=(0.25, 0.2, 0.125, 0.1), target_spacing=0.1),
    Case("K1.1", "sharp edge pressed in and drawn sideways", "T1", "pressed_edge.toml",
         "balances; nothing is lost [E]", nothing_to_measure, SOUND, REASONED, spacings=(0.2, 0.1)),
    Case("K2", "extrusion past a sharp die corner of 60 degrees", "T1", "wedge_die.toml",
         "Hill's slip-line field of a frictionless wedge die: ram pressure 2 k r (1 + a) = 397.2 MPa [M]; exit by volume [E]",
         wedge_die, {"ram force": 0.05, "exit thickness": 0.05, "exit speed": 0.05, **SOUND}, REASONED,
         spacings=(0.4, 0.2), target_spacing=0.2),
    Case("K4", "plastic heating through the melting temperature", "T0", "melting_shear.toml",
         "adiabatic shear with linear softening and residual strength, closed form [E]", sheared_through_melting,
         {"temperature": 0.01, "strength left": 0.01, "plastic strain": 0.01, **SOUND}, REASONED),
]
