#!/usr/bin/python3
"""D: contact and friction."""

import numpy as np
from verify_cases import Case, Program

CATALOGUE = "catalogue, set by reasoning [T]"
OF_HALF_SPACE = 0.980  # approach of the block of D2s over that of a half-space: hertz_block.py


def spacing_of(run):
    return float(run.settings()["numerics"]["spacing"].split()[0])


def patch(run):
    """D1: at rest after the stroke. Strain from the travel less the penetration at both tools, whose deepest is in the
    history and which goes with the traction; interior: farther than the reach of the kernel from every face."""
    dx, height, half, modulus = spacing_of(run), 10e-3, 10e-3, 72.4e9
    *_, (_, x, fields) = run.snapshots()
    travel = -run.history["top.displacement_z"][-1]
    top, bottom = x[:, 2] > height - dx, x[:, 2] < dx
    traction = np.abs(fields["contact_traction"][:, 2])
    depth = traction * run.history["penetration_over_dx"][-1] * dx / traction.max()
    at_top, at_bottom = depth[top], depth[bottom]
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
            "force for the whole travel": run.history["top.force_z"][-1] / (modulus * travel / height * 4 * half**2) - 1,
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


def stiffness(run):
    """D6 on the closed die of C5: deepest particle when the punch presses with the flow stress of the cold metal, 265 MPa, the
    most that tools of an extrusion in the hot press with; and the time step."""
    h = run.history
    pressure = h["punch.force_z"] / (np.pi * 12.5e-3**2)
    rising = slice(0, int(np.argmax(pressure)) + 1)
    return {"penetration over dx at 265 MPa": np.interp(265e6, pressure[rising], h["penetration_over_dx"][rising]),
            "penetration over dx at 886 MPa": np.interp(886e6, pressure[rising], h["penetration_over_dx"][rising]),
            "energy residual": h["energy.residual"][-1], "time step, us": 1e6 * h["dt"][-1]}


def springs(penalty, soft):
    return {f"contact.{k}.{name}": value for k in range(3)
            for name, value in (("penalty_scale", penalty), ("soft_scale", soft))}


def hertz(run):
    """D2: pressure on particles, which the run's force must be the sum of. Pressure in the
    middle (mean over a quarter of the contact), half width and shape are compared with Hertz's for the force of the run; the
    force of the sphere with that of its approach less the depth of its middle."""
    dx, history, radius, reduced = spacing_of(run), run.history, 10e-3, 81.248e9
    sphere = run.settings()["space"] == "axisymmetric"
    axis, height = ("z", 20e-3) if sphere else ("y", 8e-3)
    force = history[f"tool.force_{axis}"][-1] * (1 if sphere else 2)
    travel = -history[f"tool.displacement_{axis}"][-1]
    *_, (_, position, fields) = run.snapshots()
    x, y = position[:, 0], position[:, 2 if sphere else 1]
    pressure = np.sqrt((fields["contact_traction"]**2).sum(axis=1))
    touching = (pressure > 0) & (y > height / 2)
    x, pressure = x[touching], pressure[touching]
    if sphere:
        half = np.cbrt(0.75 * force * radius / reduced)
        highest = 1.5 * force / (np.pi * half**2)
        total = (pressure * 2 * np.pi * x * dx).sum()
    else:
        half = np.sqrt(4 * force * radius / (np.pi * reduced))
        highest = 2 * force / (np.pi * half)
        total = 2 * (pressure * dx).sum()
    exact = highest * np.sqrt(np.maximum(0, 1 - (x / half) ** 2))
    weight = x if sphere else np.ones_like(x)
    middle = x < half / 4
    found = {"pressure in the middle": (weight * pressure)[middle].sum() / (weight * exact)[middle].sum() - 1,
             "half width over dx": (x.max() + dx / 2 - half) / dx,
             "half width by the second moment, over dx":
             (np.sqrt((2.5 if sphere else 4) * (weight * pressure * x**2).sum() / (weight * pressure).sum()) - half) / dx,
             "shape of the pressure": np.sqrt((weight * (pressure - exact) ** 2).sum() / (weight * exact**2).sum()),
             "sum of the pressures": total / force - 1, "half width, spacings": half / dx,
             "highest pressure, MPa": highest / 1e6}
    if sphere:
        approach = travel - pressure[np.argmin(x)] * run.history["penetration_over_dx"][-1] * dx / pressure.max()
        found["force"] = force / (4 / 3 * reduced * np.sqrt(radius) * (approach / OF_HALF_SPACE) ** 1.5) - 1
    return found


CASES = [
    Case("D1", "patch test between flat tools", "T0", "d1_patch.toml", "E e, uniform [E]", patch,
         {"force": 0.01, "interior stress": 0.01, "scatter of the contact pressure": 0.05, "penetration over dx": 0.05},
         CATALOGUE + "; the penetration is that of D6. The scene turned by 17 degrees is left out: input cannot turn a lattice",
         spacings=(1.0, 0.5)),
    Case("D7", "block in a shaken box with sharp corners, plate sweeping past", "T1", "d7_shaken_box.toml",
         "no particle leaves [E]", shaken_box, {"swallowed": 0, "outside at the end": 0, "leaked": 0, "missing": 0}, CATALOGUE,
         spacings=(1.0, 0.5), must_fail={"soft walls": {f"contact.{k}.{name}": 0.001 for k in (0, 1)
                                                       for name in ("penalty_scale", "soft_scale")}}),
    Case("D3", "sliding block is stopped by friction and stays", "T1", "d3_sliding_block.toml",
         "stops at 0.25641 ms after 1.28205 mm, heat eta m v^2/2, no creep [E]", sliding_block,
         {"stop time": 0.005, "distance": 0.005, "friction work": 0.005, "heat": 0.005, "creep, m/s": 1e-6,
          "backward speed, m/s": 0.01},
         CATALOGUE + "; backward speed: elastic ringing only [T]", spacings=(5 / 3, 1.0),
         must_fail={"friction 0.40": {"contact.0.friction": 0.40}}),
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
    Case("D6", "penetration at the default stiffness of contact", "T0", "../plastic/c5_closed_die.toml",
         "0.05 spacings [T]", stiffness, {"penetration over dx at 265 MPa": 0.05, "energy residual": 1e-3},
         "catalogue [T], read as: at the flow stress of cold AL", spacings=(1.25, 0.625),
         variants={"penalty 1": springs(1, 0.1)},
         must_fail={"penalty 0.02, no soft constraint": springs(0.02, 0),
                    "penalty 10, beyond what the step can bear": springs(10, 0.1)}),
    Case("D2", "Hertz: cylinder on a block, plane strain", "T1", "d2_hertz_cylinder.toml",
         "p0 = 2 F/(pi a), a^2 = 4 F R/(pi E*) for the force of the run [E]", hertz,
         {"pressure in the middle": 0.06, "half width by the second moment, over dx": 1},
         CATALOGUE + ", at a/dx = 10; half width by the second moment: the outermost particle that touches moves in whole spacings",
         spacings=(0.16, 0.08)),
    Case("D2s", "Hertz: sphere on a block, rings", "T1", "d2_hertz_sphere.toml",
         "p0 = 3 F/(2 pi a^2), a^3 = 3 F R/(4 E*), F = 4/3 E* R^(1/2) d^(3/2) [E]; d of the block is 0.980 of that of a half-space [N]", hertz,
         {"force": 0.04, "pressure in the middle": 0.06, "half width by the second moment, over dx": 1},
         CATALOGUE + ", at a/dx = 10", spacings=(0.2, 0.1)),
]
