"""D: contact and friction."""

import numpy as np
from verify_cases import Case, Program

CATALOGUE = "catalogue, set by reasoning [T]"


def spacing_of(run):
    return float(run.settings()["numerics"]["spacing"].split()[0])


def patch(run):
    """D1: at rest after the stroke. Strain from the travel less the penetration at both tools, depths as contact counts them;
    interior: farther than the reach of the kernel from every face. The pressure on a particle goes with its depth."""
    dx, height, half, modulus = spacing_of(run), 10e-3, 10e-3, 72.4e9
    *_, (_, x, fields) = run.snapshots()
    travel = -run.history["top.displacement_z"][-1]
    top, bottom = x[:, 2] > height - dx, x[:, 2] < dx
    at_top, at_bottom = dx / 2 - (height - travel - x[top, 2]), dx / 2 - x[bottom, 2]
    strain = (travel - at_top.mean() - at_bottom.mean()) / height
    stress = modulus * strain
    reach = 2 * float(run.settings()["numerics"]["h_over_dx"]) * dx
    inside = (np.abs(x[:, :2]).max(axis=1) < half - reach) & (np.abs(x[:, 2] - height / 2) < height / 2 - reach)
    wrong = fields["stress"].copy()
    wrong[:, 2] += stress
    layers = x[top, 2].mean() - x[bottom, 2].mean()
    return {"force": run.history["top.force_z"][-1] / (stress * 4 * half**2) - 1,
            "interior stress": np.sqrt((wrong[inside] ** 2).sum() / inside.sum()) / stress,
            "interior stress over force per area": -fields["stress"][inside, 2].mean() * 4 * half**2
            / run.history["top.force_z"][-1] - 1,
            "scatter of the contact pressure": at_top.std() / at_top.mean(),
            "force for the strain of the centres": run.history["top.force_z"][-1]
            / (modulus * (1 - layers / (height - dx)) * 4 * half**2) - 1,
            "upper against lower force": run.history["top.force_z"][-1] / -run.history["bottom.force_z"][-1] - 1,
            "penetration over dx": run.history["penetration_over_dx"][-1]}


def shaken_box(run):
    """D7: a particle is lost when it is ever wholly inside the wall (its centre farther than half a spacing beyond it), or when
    its centre lies beyond it at the end; in the hardest blows corners dip in and come back."""
    dx, half, time = spacing_of(run), 5.5e-3, run.history["time"]
    swallowed, deepest = 0, -half
    for when, x, _ in run.snapshots():
        place = np.array([np.interp(when, time, run.history[f"box.displacement_{axis}"]) for axis in "xyz"])
        beyond = np.abs(x - place).max(axis=1) - half
        swallowed, deepest = max(swallowed, int((beyond > dx / 2).sum())), max(deepest, beyond.max())
    return {"swallowed": swallowed, "outside at the end": (beyond > 0).sum(), "leaked": run.leaked(),
            "missing": run.particles() - len(x), "deepest centre beyond the wall, over dx": deepest / dx,
            "penetration over dx, largest": run.history["penetration_over_dx"].max(),
            "energy residual": run.history["energy.residual"][-1]}


def sliding_block(run):
    """D3: the block rings, so the stop is where the straight line through mean speeds of 9 and 0.5 m/s is zero; the sole tells
    whether it creeps afterwards."""
    h = run.history
    early, late = np.flatnonzero(h["v"] < 9)[0], np.flatnonzero(h["v"] > 0.5)[-1]
    slope = (h["v"][late] - h["v"][early]) / (h["time"][late] - h["time"][early])
    stop = h["time"][late] - h["v"][late] / slope
    mass = 2785 * 20e-3 * 20e-3 * 5e-3
    return {"stop time": stop / 0.25641e-3 - 1, "distance": (h["x"][-1] - h["x"][0]) / 1.28205e-3 - 1,
            "friction work": h["energy.friction"][-1] / (0.5 * mass * 100) - 1,
            "heat": (h["T_mean"][-1] - h["T_mean"][0]) / (0.9 * 50 / 875) - 1, "creep, m/s": creep(run, 0.3e-3),
            "backward speed, m/s": max(0.0, -h["v"][h["time"] > 0.27e-3].min()),
            "energy residual": h["energy.residual"][-1]}


def creep(run, after):
    """Mean speed of the sole from a time on, m/s."""
    time, sole = run.history["time"], run.history["x_sole"]
    k = np.searchsorted(time, after)
    return (sole[-1] - sole[k]) / (time[-1] - time[k])


CASES = [
    Case("D1", "patch test between flat tools", "T0", "d1_patch.toml", "E e, uniform [E]", patch,
         {"force": 0.01, "interior stress": 0.01, "scatter of the contact pressure": 0.05, "penetration over dx": 0.05},
         CATALOGUE + "; the penetration is that of D6. The scene turned by 17 degrees is left out: input cannot turn a lattice",
         spacings=(1.0, 0.5),
         diagnosis="The force is right to 0.7 %, but inside the block stress is 2 % above force per area (1 and 0.5 mm), because the "
         "outermost layer of the free sides carries less than its stress with the plain momentum sum. Other corrections at 1 and "
         "0.5 mm: full has stress and force alike (0.7, 0.3 %) but is too stiff, force +21 and +9.6 %, because contact keeps half a "
         "spacing around a centre (the metal between the outermost centres takes the whole strain: dx/H = 10 and 5 %) and "
         "edges are too stiff; none: force -18 and -9.4 %. All first order."),
    Case("D7", "block in a shaken box with sharp corners, plate sweeping past", "T1", "d7_shaken_box.toml",
         "no particle leaves [E]", shaken_box, {"swallowed": 0, "outside at the end": 0, "leaked": 0, "missing": 0}, CATALOGUE,
         spacings=(1.0, 0.5)),
    Case("D3", "sliding block is stopped by friction and stays", "T1", "d3_sliding_block.toml",
         "stops at 0.25641 ms after 1.28205 mm, heat eta m v^2/2, no creep [E]", sliding_block,
         {"stop time": 0.005, "distance": 0.005, "friction work": 0.005, "heat": 0.005, "creep, m/s": 1e-6,
          "backward speed, m/s": 0.01},
         CATALOGUE + "; backward speed: elastic ringing only [T]", spacings=(5 / 3, 1.0)),
    Case("D3s", "block pushed with 0.9 mu N", "T1", "d3_sliding_block.toml", "sticks [E]",
         lambda run: {"creep, m/s": creep(run, 0.25e-3), "friction work over mu N dx": run.history["energy.friction"][-1]
                      / (0.39 * 2785 * 2e-6 * 1e5 * spacing_of(run))},
         {"creep, m/s": 1e-6}, CATALOGUE, spacings=(5 / 3, 1.0),
         overrides=lambda spacing: {"body.0.velocity.x": '"0 m/s"', "body_force.z": '"-1e5*min(1,t/1e-4)"',
                                    "body_force.x": '"0.351e5*max(0,min(1,(t-1e-4)/1e-4))"', "time.end": '"0.35 ms"'}),
    Program("D4r", "Coulomb torque of a flat tool on an elastic plug in its die", "T0", "verification/friction_test",
            "*TurningTool*", "2/3 mu F R [E]", "1 % at 22 rings over the radius"),
    Program("D4d", "layer dragged along by a plate that slips", "T0", "verification/friction_test", "*DraggedLayer*",
            "its inertia and the shear strength [E]", "0.8 of the acceleration, +-0.15"),
]
