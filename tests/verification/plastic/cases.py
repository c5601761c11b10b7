#!/usr/bin/python3
"""C: plasticity."""

import numpy as np
import speed_cases
from verify_cases import Case, Program

CATALOGUE = "catalogue, set by reasoning [T]"
BULK, SHEAR, YIELD = 70.98e9, 27.218e9, 265e6  # AL


def spacing_of(run):
    return float(run.settings()["numerics"]["spacing"].split()[0])


def closed_die(run):
    """C5: force of the punch and pressure on the wall against those of a homogeneous strain, axial from the travel less the
    penetration at both ends, lateral from the penetration of the wall. The traction on a particle goes with its
    depth, the deepest is in the history. Strains are logarithmic: mean stress K ln(rho0/rho)."""
    dx, time, height = spacing_of(run), run.history["time"], 10e-3
    square = "bottom.force_z" not in run.history
    half = 5e-3 if square else 12.5e-3
    area, rows = (4 * half * half if square else np.pi * half * half), []
    for when, x, fields in run.snapshots():
        if when == 0:
            continue
        traction = np.abs(fields["contact_traction"])
        per_traction = np.interp(when, time, run.history["penetration_over_dx"]) * dx / traction.max()
        travel = -np.interp(when, time, run.history["punch.displacement_z"])
        side = np.abs(x[:, :2]).max(axis=1) if square else x[:, 0]
        weight = np.ones(len(x)) if square else x[:, 0]
        top, bottom, rim = x[:, 2] > x[:, 2].max() - dx / 2, x[:, 2] < x[:, 2].min() + dx / 2, side > side.max() - dx / 2
        at_punch = per_traction * np.average(traction[top, 2], weights=weight[top])
        at_bottom = per_traction * np.average(traction[bottom, 2], weights=weight[bottom])
        at_wall = per_traction * (traction[rim, :2].max(axis=1) if square else traction[rim, 0])
        strain, lateral = -np.log1p((at_punch + at_bottom - travel) / height), np.log1p(at_wall.mean() / half)
        volumetric, difference = strain - 2 * lateral, min(2 * SHEAR * (strain + lateral), YIELD)
        force = np.interp(when, time, run.history["punch.force_z"])
        wall = np.nan
        if not square:
            wall = (np.interp(when, time, run.history["die.contact_pressure"] * run.history["die.contact_area"])
                    / (2 * np.pi * half * (height - travel)))
        own = -np.log((x[top, 2].mean() - x[bottom, 2].mean()) / (height - dx))  # of the metal between outermost centres
        own_volumetric, own_difference = own - 2 * lateral, min(2 * SHEAR * (own + lateral), YIELD)
        rows.append((strain, force / area / (BULK * volumetric + 2 / 3 * difference) - 1,
                     wall / (BULK * volumetric - difference / 3) - 1, at_wall.std() / at_wall.mean(),
                     force / area / (BULK * own_volumetric + 2 / 3 * own_difference) - 1, force / area, at_punch / dx))
    strain, force, wall, spread, own, pressure, depth = np.array(rows).T

    def at(value, e=0.01):
        return np.interp(e, strain, value)

    found = {"force at 0.004": at(force, 0.004), "force at 0.01": at(force), "wall at 0.01": at(wall),
             "wall spread at 0.01": at(spread), "force at 0.018": at(force, 0.018), "wall at 0.018": at(wall, 0.018),
             "leaked": run.leaked(), "force at 0.01 for the strain of the centres": at(own),
             "penetration over dx at 265 MPa": np.interp(265e6, pressure, depth), "penetration over dx, largest": depth.max()}
    return {name: value for name, value in found.items() if not (square and name.startswith("wall at"))}


def full_travel(spacing):
    """The contact springs give way in proportion to the spacing."""
    return {"rigid.0.motion.z": f'"-{2 * (0.2 + 0.2 * spacing):.4g}*(1 - cos(2*pi*t/0.5e-3))"'}


DIE_TARGETS = {"force at 0.01": 0.01, "force at 0.018": 0.01, "wall at 0.01": 0.02, "wall at 0.018": 0.02,
               "wall spread at 0.01": 0.10, "leaked": 0}

def upsetting(run):
    """C7: mean pressure on the area of constant volume, over strains from 2 to 18 %; difference between the largest and the
    smallest radius of the rim along the height; volume lost over that of the mean stress sigma_y/3."""
    dx, history, radius, height = spacing_of(run), run.history, 10e-3, 10e-3
    gap = height + history["top.displacement_z"] + 2 * history["penetration_over_dx"] * dx
    late = history["top.displacement_z"] < -0.02 * height
    pressure = (history["top.force_z"] / (np.pi * radius**2 * height / gap))[late]
    (_, _, first), *_, (_, x, last) = run.snapshots()
    layers = np.round((x[:, 2] - x[:, 2].min()) / (np.ptp(x[:, 2]) / (round(height / dx) - 1)))
    rim = np.array([x[layers == layer, 0].max() for layer in np.unique(layers)])
    lost = 1 - last["volume"].sum() / first["volume"].sum()
    return {"pressure": pressure.mean() / YIELD - 1, "pressure, scatter in time": pressure.std() / YIELD,
            "barrelling over R": np.ptp(rim) / rim.mean(), "volume lost": lost / (YIELD / 3 / BULK) - 1,
            "volume": lost - YIELD / 3 / BULK}


def sticking_platens(run):
    """C7: mean pressure on the touching width, for reductions from 2 to 4 %, over that of Prandtl's field for the
    dimensions of the moment."""
    dx, time, ratios = spacing_of(run), run.history["time"], []
    for when, x, _ in run.snapshots():
        travel = -np.interp(when, time, run.history["top.displacement_y"])
        if 0.2e-3 <= travel <= 0.41e-3:
            gap = 10e-3 - travel
            touching = x[x[:, 1] > gap - dx / 2, 0]
            width = np.ptp(touching) + dx
            force = np.interp(when, time, run.history["top.force_y"])
            ratios.append(force / width / (2 * YIELD / np.sqrt(3) * (0.75 + width / (4 * gap))))
    return {"pressure": np.mean(ratios) - 1, "pressure, scatter in time": np.std(ratios)}


def taylor_rings(length, foot, hottest=None):
    """C4 in rings: faces lie half a spacing outside the outermost centres. A bar that has left the wall (aluminium) is as long as
    its end is high, less what its foot has risen since the last contact."""

    def measure(run):
        half = spacing_of(run) / 2
        *_, (_, x, fields) = run.snapshots()
        r, z = x[:, 0], x[:, 2]
        lowest = run.history["lowest"]
        rise = lowest[-1] - lowest[run.history["wall.force_z"] != 0][-1]
        found = {"length": (z[r < 2 * half].max() + half - rise) / length - 1, "rise of the foot [mm]": 1e3 * rise, "foot radius": (r.max() + half) / foot - 1,
                 "plastic strain on the axis, largest": fields["equivalent_plastic_strain"][r < 2 * half].max(),
                 "energy residual": run.history["energy.residual"][-1]}
        if hottest:
            found["temperature"] = (fields["temperature"].max() - 293.15) / (hottest - 293.15) - 1
        return found

    return measure


def rings(spacing):
    """Positions of rings have two components."""
    return {"space": "axisymmetric", "probe.0.component": 1, "probe.2.component": 1, "body.0.fill_margin": 0.45,
            "numerics.gradient_correction": '"full"', "numerics.viscosity_reconstruction": "true", "numerics.viscosity_alpha": 1,
            "output.fields": '["equivalent_plastic_strain", "temperature"]'}


def aluminium(spacing):
    return {**rings(spacing), "material.0.file": '"../materials/al.toml"', "body.0.shape.radius": '"4 mm"',
            "body.0.shape.height": '"30 mm"', "body.0.velocity.z": '"-250 m/s"', "time.end": '"90 us"',
            "heat.mode": "adiabatic"}


def extrusion(run):
    """C9: pressure of the punch over the last half of the stroke; speed of the wall, metal above the initial surface, over that
    of constant volume."""
    h = run.history
    plane = "punch.torque" in h and run.settings()["space"] == "plane_strain"
    axis = "y" if plane else "z"
    column, height = (1, 12e-3) if plane else (2, 10e-3)
    outer, inner = (10e-3, 5e-3) if plane else (12.5e-3, 11e-3)
    of_punch, of_die = (inner, outer) if plane else (np.pi * inner**2, np.pi * outer**2)
    end = h["time"][-1]
    late = h["time"] > end / 2
    pressure = h[f"punch.force_{axis}"][late] / of_punch
    reference = (2 + np.pi) * YIELD / np.sqrt(3) if plane else LIMIT_OF_C9 * YIELD
    # Mean speed over the last half of the stroke: the wall rings along its length.
    states = [(when, x[np.argsort(fields["id"])], np.sort(fields["id"])) for when, x, fields in run.snapshots()]
    middle = min(states, key=lambda state: abs(state[0] - end / 2))
    wall = (middle[1][:, column] > height) & (middle[1][:, 0] > inner)
    travel = (states[-1][1][wall, column] - middle[1][wall, column]).mean() if wall.any() else np.nan
    punch = -np.diff(np.interp([middle[0], states[-1][0]], h["time"], h[f"punch.displacement_{axis}"]))[0]
    return {"pressure": pressure.mean() / reference - 1, "pressure, scatter in time": pressure.std() / reference,
            "pressure, rise from the third to the last quarter":
            (pressure[len(pressure) // 2:].mean() - pressure[:len(pressure) // 2].mean()) / reference,
            "wall speed": travel / (punch * of_punch / (of_die - of_punch)) - 1, "leaked": run.leaked(),
            "energy residual": h["energy.residual"][-1], "penetration over dx, largest": h["penetration_over_dx"].max()}


LIMIT_OF_C9 = 3.135  # pressure over yield stress: finite elements, limit_analysis.py beside this file


def punch(run):
    """C6: mean pressure of the punch, depths from 0.6 to 1 mm."""
    depth, pressure = -run.history["punch.displacement_y"], run.history["punch.force_y"] / 5e-3
    limit = (2 + np.pi) * YIELD / np.sqrt(3)
    first, second = ((depth > a) & (depth <= b) for a, b in ((0.6e-3, 0.8e-3), (0.8e-3, 1.01e-3)))
    return {"pressure": pressure[first | second].mean() / limit - 1, "overshoot": pressure.max() / limit - 1,
            "rise over 0.2 mm": (pressure[second].mean() - pressure[first].mean()) / limit,
            "pressure at 0.3 mm": pressure[(depth > 0.25e-3) & (depth < 0.35e-3)].mean() / limit - 1,
            "largest viscous guard": run.history["guard.viscous"].max(), "energy residual": run.history["energy.residual"][-1]}


TAYLOR = {"length": 0.01, "foot radius": 0.04}

CASES = [
    Program("C1", "large simple shear of a stress point", "T0", "mechanics/stress_point_test", "SimpleShear*",
            "elastic Jaumann G sin g, G(1 - cos g); perfectly plastic k sqrt(1 - (k/G)^2), k^2/G [E]",
            "1e-6 at dg = 1e-4, second order in dg"),
    Program("C1b", "large simple shear of a block", "T0", "verification/plastic_test", "SimpleShearBlock*:TurnedBlock*",
            "as C1 [E]; heat is eta times the plastic work", "interior 1 %; a turned block has no stress"),
    Program("C2", "uniaxial compression with adiabatic heating", "T0", "mechanics/stress_point_test", "Compression*",
            "AL exact [E], copper by an ordinary differential equation [N]", "1e-4 at 1e4 steps a strain, first order"),
    Program("C3", "adiabatic simple shear at 1000/s", "T0", "mechanics/stress_point_test", "AdiabaticShear*",
            "exact without the elastic part [E]; without heating 167.59 MPa", "0.5 % beyond g = 1"),
    Case("C4", "Taylor bar, copper", "T1", "c4_taylor_bar.toml",
         "length 21.44, foot radius 7.4 mm: three meshes of an axisymmetric finite element program, extrapolated; taylor_bar.py [N]",
         taylor_rings(21.44e-3, 7.4e-3), TAYLOR, CATALOGUE, spacings=(0.8, 0.4, 0.2), target_spacing=0.4, overrides=rings),
    Case("C4b", "Taylor bar, aluminium with heating", "T1", "c4_taylor_bar.toml",
         "length 23.57, foot radius 8.24 mm, 563 K: the finest of three meshes of an axisymmetric finite element program; "
         "taylor_bar.py [N]",
         taylor_rings(23.57e-3, 8.24e-3, 563), TAYLOR, CATALOGUE, spacings=(1.0, 0.5, 0.25), target_spacing=0.5,
         overrides=aluminium),
    Case("C4c", "Taylor bar, copper, in three dimensions", "T1", "c4_taylor_bar.toml", "as C4 [N]", speed_cases.taylor_bar,
         TAYLOR, CATALOGUE, spacings=speed_cases.BAR_SPACINGS, overrides=speed_cases.CASES["C4"].overrides,
         diagnosis="The foot is too soft and its length right by luck: with alpha 0.1 length and radius are off by -4.4 "
         "and +31 % at 0.58 mm (+0.6 and +12 % with 0.5), without correction by +1.6 and -6.5 %. At 0.41 mm "
         "the rim beyond 7.8 mm is thinner than half a layer of particles: it is torn to pieces, and its "
         "radius grows on refinement (src/mechanics/README.md says the same)."),
    Case("C5", "closed-die compression", "T1", "c5_closed_die.toml",
         "uniaxial logarithmic strain e: K e + 2/3 sigma_y on the punch, K e - sigma_y/3 on the wall [E]",
         closed_die, DIE_TARGETS, CATALOGUE, spacings=(1.25, 0.625, 0.3125, 0.15625), overrides=full_travel),
    Case("C5s", "closed-die compression of a square billet in three dimensions", "T1", "c5_square_die.toml",
         "as C5 [E]", closed_die, {name: target for name, target in DIE_TARGETS.items() if not name.startswith("wall at")},
         CATALOGUE, spacings=(1.0, 0.5), overrides=full_travel),
    Case("C7", "upsetting without friction", "T1", "c7_upsetting.toml",
         "mean pressure sigma_y, no barrelling, volume change p/K [E]", upsetting,
         {"pressure": 0.01, "barrelling over R": 0.002, "volume": 0.001},
         "barrelling: catalogue [T]; pressure 1 % and volume 0.1 % of itself [T]", spacings=(1.0, 0.5, 0.25, 0.125),
         diagnosis="The rim: without friction the outermost rings at the plates spread a little further than the middle."
         " First order: 1.0, 0.5, 0.23 % at 1, 0.5, 0.25 mm; the pressure is met at all three (-0.1, -0.0, "
         "-0.1 %)."),
    Case("C7s", "compression between sticking platens, plane strain", "T1", "c7_sticking_platens.toml",
         "Prandtl's cycloid field 2k(3/4 + w/4h) [M]; slab estimate 14 % higher", sticking_platens, {"pressure": 0.05},
         "catalogue [T]", spacings=(1.0, 0.5)),
    Case("C9", "back extrusion of a tube, frictionless", "T1", "c9_back_extrusion.toml",
         "limit pressure 3.135 sigma_y by finite elements (limit_analysis.py beside the scene); the estimate of the catalogue, "
         "1.05 to 1.40 times the ideal work, is 2.0 to 2.7 sigma_y, below that limit", extrusion,
         {"pressure": 0.05, "wall speed": 0.01, "leaked": 0}, CATALOGUE + "; pressure as C6", spacings=(0.5, 0.25)),
    Case("C9p", "back extrusion in plane strain, frictionless, punch half as wide as the container", "T1",
         "c9_back_extrusion_plane.toml", "(2 + pi) k, slip-line field of Hill [M]", extrusion,
         {"pressure": 0.05, "wall speed": 0.01, "leaked": 0}, CATALOGUE + ", at 20 particles over the gap", spacings=(0.5, 0.25)),
    Case("C6", "flat punch in plane strain", "T1", "c6_punch.toml", "limit pressure (2 + pi) k, smooth or rough [E]", punch,
         {"pressure": 0.05}, CATALOGUE + ", at b/dx = 20", spacings=(0.5, 0.25),
         variants={"rough": {"contact.0.friction": 10}}),
]
