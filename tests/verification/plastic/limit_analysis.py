#!/usr/bin/env python3
"""Limit pressure of back extrusion (C9, C9p) by finite elements, independent of the particles.

Rigid-plastic flow of a perfectly plastic metal (von Mises) without friction: of all velocities that the walls allow, those
that dissipate least. Elements of four nodes, volume kept at their centres by a penalty, strains of the dissipation at four
points; the viscosity sigma_y/rate is found by repetition. The result is an upper bound that falls with the first order of
the element's size, as the flow has a jump at the punch's corner: two sizes extrapolated give the limit. Plane strain has
the exact limit (2 + pi) k (Hill) for a punch half as wide as its container: it comes out to 0.1 %.

Usage: tests/verification/plastic/limit_analysis.py          (a minute; python3-numpy, python3-scipy)
"""
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as solvers

GAUSS = [(a / np.sqrt(3), b / np.sqrt(3)) for b in (-1, 1) for a in (-1, 1)]
# Strains are (e_x, e_y, gamma_xy, e_out): rates of the plane, and around the axis or zero.
TRACE = np.array([1, 1, 0, 1])
DEVIATOR = np.diag([1, 1, 0.5, 1]) - np.outer(TRACE, TRACE) / 3  # e.DEVIATOR e = dev e : dev e


def strain_matrices(corners, xi, eta, axisymmetric):
    """Strain over nodal velocities (elements, 4, 8) at a point of the unit square, and its weight in volume."""
    slopes = 0.25 * np.array([[eta - 1, 1 - eta, 1 + eta, -1 - eta], [xi - 1, -1 - xi, 1 + xi, 1 - xi]])
    shapes = 0.25 * np.array([(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)])
    jacobian = np.einsum("dn,enk->edk", slopes, corners)
    gradient = np.einsum("edk,kn->edn", np.linalg.inv(jacobian), slopes)
    radius = corners[:, :, 0] @ shapes
    strain = np.zeros((len(corners), 4, 8))
    strain[:, 0, 0::2] = gradient[:, 0]
    strain[:, 1, 1::2] = gradient[:, 1]
    strain[:, 2, 0::2] = gradient[:, 1]
    strain[:, 2, 1::2] = gradient[:, 0]
    if axisymmetric:
        strain[:, 3, 0::2] = shapes[None, :] / radius[:, None]
    return strain, np.linalg.det(jacobian) * (2 * np.pi * radius if axisymmetric else 1)


def punch_force(axisymmetric, container, punch, height, over_gap):
    """Force over yield stress of a flat punch in a frictionless container, with `over_gap` elements across the gap."""
    size = (container - punch) / over_gap
    across, along = round(container / size), round(height / size)
    x = np.linspace(0, container, across + 1)
    x[np.argmin(abs(x - punch))] = punch
    nodes = np.array([[a, b] for b in np.linspace(0, height, along + 1) for a in x])
    first = np.array([j * (across + 1) + i for j in range(along) for i in range(across)])
    elements = np.stack([first, first + 1, first + across + 2, first + across + 1], axis=1)
    unknowns = np.stack([2 * elements, 2 * elements + 1], 2).reshape(len(elements), 8)
    rows, columns = np.repeat(unknowns, 8, 1).ravel(), np.tile(unknowns, (1, 8)).ravel()

    prescribed = {2 * n: 0.0 for n, (a, b) in enumerate(nodes) if a == 0 or np.isclose(a, container)}
    prescribed |= {2 * n + 1: 0.0 for n, (a, b) in enumerate(nodes) if b == 0}
    prescribed |= {2 * n + 1: -1.0 for n, (a, b) in enumerate(nodes) if np.isclose(b, height) and a <= punch + 1e-9}
    held = np.array(sorted(prescribed))
    free = np.setdiff1d(np.arange(2 * len(nodes)), held)
    velocity = np.zeros(2 * len(nodes))
    velocity[held] = [prescribed[n] for n in held]

    points = [strain_matrices(nodes[elements], xi, eta, axisymmetric) for xi, eta in GAUSS]
    centre, volume = strain_matrices(nodes[elements], 0, 0, axisymmetric)
    dilatation = np.einsum("a,eai->ei", TRACE, centre)
    viscosity = [np.ones(len(elements)) for _ in points]
    least_rate, power = 1e-4 / height, 0.0
    for _ in range(100):
        penalty = 1e5 * np.median(viscosity)
        stiffness = penalty * np.einsum("e,ei,ej->eij", 4 * volume, dilatation, dilatation)
        for (strain, weight), nu in zip(points, viscosity):
            stiffness += np.einsum("e,eai,ab,ebj->eij", weight * nu, strain, DEVIATOR, strain)
        matrix = sparse.csr_matrix((stiffness.ravel(), (rows, columns)), shape=(2 * len(nodes),) * 2)
        velocity[free] = solvers.spsolve(matrix[free][:, free].tocsc(), -(matrix[free][:, held] @ velocity[held]))
        before, power = power, 0.0
        for k, (strain, weight) in enumerate(points):
            rate = np.einsum("eai,ei->ea", strain, velocity[unknowns])
            equivalent = np.sqrt(np.maximum(2 / 3 * np.einsum("ea,ab,eb->e", rate, DEVIATOR, rate), 0))
            power += (weight * equivalent).sum()
            viscosity[k] = 2 / 3 / np.maximum(equivalent, least_rate)
        if abs(power - before) < 1e-5 * power:
            return power
    raise RuntimeError("the viscosity did not settle in 100 repetitions")


def report(name, unit, coarse, *geometry):
    """Prints pressures over `unit` with `coarse` and 1.5 times as many elements over the gap, and their limit."""
    area = np.pi * geometry[2]**2 if geometry[0] else geometry[2]
    first, second = (punch_force(*geometry, n) / area / unit for n in (coarse, coarse * 3 // 2))
    print(f"{name}: {first:.4f}, {second:.4f}, extrapolated {second - 2 * (first - second):.4f}")


if __name__ == "__main__":
    for height in (10, 9.1):
        report(f"C9, pressure over yield stress, billet of {height} mm", 1, 4, True, 12.5, 11, height)
    report("C9p, pressure over (2 + pi) k", (2 + np.pi) / np.sqrt(3), 10, False, 10, 5, 12)
