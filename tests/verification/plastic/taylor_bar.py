#!/usr/bin/python3
"""The reference of the Taylor bars C4 and C4b: axisymmetric finite elements, bilinear quadrilaterals with 2 x 2 points and
one mean stress K ln(V/V0) each, central differences, frictionless rigid wall, adiabatic heating, linear and quadratic bulk
viscosity (0.06, 1.2 times `--viscosity`).

Usage: tests/verification/plastic/taylor_bar.py copper|aluminium ELEMENTS_OVER_THE_RADIUS ... [--viscosity FACTOR]
"""

import argparse

import numpy as np

COPPER = dict(radius=3.2e-3, length=32.4e-3, speed=227.0, end=80e-6, density=8930.0, youngs_modulus=117e9, poisson_ratio=0.35,
              strength=400e6, hardening=100e6, rate_factor=0.0, heat=0.0, aspect=5)
ALUMINIUM = dict(radius=4e-3, length=30e-3, speed=250.0, end=90e-6, density=2785.0, youngs_modulus=72.4e9, poisson_ratio=0.33,
                 strength=265e6, hardening=0.0, rate_factor=0.015, heat=0.9 / 875.0, aspect=4)
REFERENCE_TEMPERATURE, MELTING_TEMPERATURE = 293.15, 823.15
POINT = np.array([(s, t) for s in (-1, 1) for t in (-1, 1)]) / np.sqrt(3)


def flow_stress(bar, strain, rate, temperature):
    """And its slope with the rate."""
    softening = 1 - np.clip((temperature - REFERENCE_TEMPERATURE) / (MELTING_TEMPERATURE - REFERENCE_TEMPERATURE), 0, 1)
    cold = (bar["strength"] + bar["hardening"] * strain) * (softening if bar["heat"] else 1.0)
    fast = rate > 1
    factor = np.where(fast, 1 + bar["rate_factor"] * np.log(np.where(fast, rate, 1.0)), 1.0)
    return cold * factor, np.where(fast, cold * bar["rate_factor"] / np.where(fast, rate, 1.0), 0.0)


def shapes(s, t):
    return (np.array([(1 - s) * (1 - t), (1 + s) * (1 - t), (1 + s) * (1 + t), (1 - s) * (1 + t)]) / 4,
            np.array([[t - 1, 1 - t, 1 + t, -1 - t], [s - 1, -1 - s, 1 + s, 1 - s]]) / 4)


def geometry(x, corners):
    """Gradients of the shape functions (point, direction, corner, element), radius and weight (2 pi r dA) at the points."""
    place = x[corners]  # (element, corner, 2)
    gradient, radius, weight = [], [], []
    for s, t in POINT:
        shape, slope = shapes(s, t)
        j = np.einsum("dc,eck->dke", slope, place)  # dx_k/dxi_d
        determinant = j[0, 0] * j[1, 1] - j[0, 1] * j[1, 0]
        inverse = np.array([[j[1, 1], -j[0, 1]], [-j[1, 0], j[0, 0]]]) / determinant
        gradient.append(np.einsum("kde,dc->kce", inverse, slope))
        radius.append(place[:, :, 0] @ shape)
        weight.append(2 * np.pi * radius[-1] * determinant)
    return np.array(gradient), np.array(radius), np.array(weight)


def run(bar, across, viscosity):
    """Length on the axis, gap between axis and wall, radius of the foot [m], largest plastic strain and temperature at the end."""
    along = bar["aspect"] * across
    node = np.arange((across + 1) * (along + 1)).reshape(across + 1, along + 1)
    corners = np.array([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]]).reshape(4, -1).T
    x = np.stack(np.meshgrid(np.linspace(0, bar["radius"], across + 1), np.linspace(0, bar["length"], along + 1),
                             indexing="ij"), axis=-1).reshape(-1, 2)
    v = np.zeros_like(x)
    v[:, 1] = -bar["speed"]
    shear = bar["youngs_modulus"] / (2 * (1 + bar["poisson_ratio"]))
    bulk = bar["youngs_modulus"] / (3 * (1 - 2 * bar["poisson_ratio"]))
    wave = np.sqrt((bulk + 4 / 3 * shear) / bar["density"])
    shape = np.array([shapes(s, t)[0] for s, t in POINT])  # (point, corner)

    def gathered(values):  # (corner, element) to nodes
        return np.bincount(corners.T.ravel(), values.ravel(), len(x))

    gradient, radius, weight = geometry(x, corners)
    volume0 = weight.sum(axis=0)
    mass = gathered(bar["density"] * np.einsum("pc,pe->ce", shape, weight))
    elements = len(corners)
    deviator = np.zeros((4, 4, elements))  # component rr, zz, tt, rz; point; element
    strain, rate, temperature = np.zeros((4, elements)), np.zeros((4, elements)), np.full((4, elements), REFERENCE_TEMPERATURE)
    force, time = np.zeros_like(x), 0.0
    axis = node[0]
    while time < bar["end"]:
        place = x[corners]
        area = 0.5 * np.abs((place[:, 2, 0] - place[:, 0, 0]) * (place[:, 3, 1] - place[:, 1, 1])
                            - (place[:, 3, 0] - place[:, 1, 0]) * (place[:, 2, 1] - place[:, 0, 1]))
        sides = np.sqrt(((place - np.roll(place, 1, axis=1)) ** 2).sum(axis=2)).max(axis=1)
        size = area / sides
        dt = min(0.4 * size.min() / wave, bar["end"] - time)
        v += dt * force / mass[:, None]
        v[axis, 0] = 0
        reached = x[:, 1] + dt * v[:, 1] < 0
        v[reached, 1] = -x[reached, 1] / dt
        middle, x = x + 0.5 * dt * v, x + dt * v
        # Rates at the middle of the step.
        gradient, radius, _ = geometry(middle, corners)
        moving = v[corners]  # (element, corner, 2)
        l = np.einsum("pkce,eci->pike", gradient, moving)  # dv_i/dx_k
        d = np.array([l[:, 0, 0], l[:, 1, 1], np.einsum("pc,ec->pe", shape, moving[:, :, 0]) / radius,
                      0.5 * (l[:, 0, 1] + l[:, 1, 0])])
        spin = 0.5 * (l[:, 0, 1] - l[:, 1, 0])
        d[:3] -= d[:3].mean(axis=0)
        # Rotation by the angle of the step, then Hooke and the return to the flow stress.
        cosine, sine = np.cos(spin * dt), np.sin(spin * dt)
        rr, zz, rz = deviator[0], deviator[1], deviator[3]
        trial = np.array([cosine**2 * rr + sine**2 * zz + 2 * sine * cosine * rz,
                          sine**2 * rr + cosine**2 * zz - 2 * sine * cosine * rz, deviator[2],
                          (cosine**2 - sine**2) * rz - sine * cosine * (rr - zz)]) + 2 * shear * dt * d
        q = np.sqrt(1.5 * (trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2))
        step = np.full_like(q, dt)  # Newton from the left: a rate of 1/s
        for _ in range(12):
            stress, slope = flow_stress(bar, strain + step, step / dt, temperature)
            step += (q - 3 * shear * step - stress) / (3 * shear + bar["hardening"] + slope / dt)
        step = np.where(q > flow_stress(bar, strain, 0 * strain, temperature)[0], np.maximum(step, 0), 0.0)
        deviator = trial * np.where(q > 0, 1 - 3 * shear * step / np.where(q > 0, q, 1), 1.0)
        strain = strain + step
        stress = q - 3 * shear * step
        temperature = temperature + bar["heat"] / bar["density"] * stress * step
        # Forces at the end of the step: one mean stress an element.
        gradient, radius, weight = geometry(x, corners)
        volume = weight.sum(axis=0)
        opening = np.einsum("pkce,eck,pe->e", gradient, moving, weight) / volume + (
            np.einsum("pc,ec,pe->e", shape, moving[:, :, 0], weight / radius) / volume)
        damping = bar["density"] * size * viscosity * (0.06 * wave * opening
                                                       - np.where(opening < 0, 1.2**2 * size * opening**2, 0.0))
        mean = bulk * np.log(volume / volume0) + damping
        total = deviator.copy()
        total[:3] += mean
        # as (corner, element)
        fr = np.einsum("pe,pce->ce", weight * total[0], gradient[:, 0]) + np.einsum("pe,pce->ce", weight * total[3], gradient[:, 1])
        fr += np.einsum("pe,pc->ce", weight * total[2] / radius, shape)
        fz = np.einsum("pe,pce->ce", weight * total[3], gradient[:, 0]) + np.einsum("pe,pce->ce", weight * total[1], gradient[:, 1])
        force = -np.stack([gathered(fr), gathered(fz)], axis=1)
        time += dt
    return np.ptp(x[axis, 1]), x[axis, 1].min(), x[:, 0].max(), strain.max(), temperature.max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bar", choices=("copper", "aluminium"))
    parser.add_argument("elements", type=int, nargs="+")
    parser.add_argument("--viscosity", type=float, default=1.0)
    options = parser.parse_args()
    for across in options.elements:
        length, gap, foot, strain, hottest = run(COPPER if options.bar == "copper" else ALUMINIUM, across, options.viscosity)
        print(f"{options.bar}, {across} elements over the radius: length {1e3 * length:.3f} mm, {1e3 * gap:.3f} mm off the wall, foot radius {1e3 * foot:.3f} mm, "
              f"largest plastic strain {strain:.2f}, temperature {hottest:.0f} K", flush=True)


if __name__ == "__main__":
    main()
