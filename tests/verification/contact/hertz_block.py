#!/usr/bin/python3
"""What the end of the block of D2s takes from its approach: axisymmetric finite elements (linear quadrilaterals) of the
block on its frictionless plate under Hertz's pressure, and of one fifty times as large.

Usage: tests/verification/contact/hertz_block.py
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

MODULUS, POISSON, FORCE, RADIUS = 72.4e9, 0.33, 10833.0, 1e-3  # Pa, 1, N, m (of the contact)


def graded(size):
    """Coordinates, fine under the contact."""
    x = list(np.linspace(0, 1.5 * RADIUS, 61))
    step = x[1]
    while x[-1] + 1.5 * step < size:
        step *= 1.08
        x.append(x[-1] + step)
    x[-1] = size
    return np.array(x)


def stiffness(r, z):
    lame, shear = MODULUS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), MODULUS / (2 * (1 + POISSON))
    law = np.diag([2 * shear, 2 * shear, 2 * shear, shear])
    law[:3, :3] += lame
    node = np.arange(len(r) * len(z)).reshape(len(r), len(z))
    corners = np.array([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]]).reshape(4, -1).T
    place = np.stack(np.meshgrid(r, z, indexing="ij"), axis=-1).reshape(-1, 2)[corners]
    of_elements = np.zeros((len(corners), 8, 8))
    for s in (-1 / np.sqrt(3), 1 / np.sqrt(3)):
        for t in (-1 / np.sqrt(3), 1 / np.sqrt(3)):
            shape = np.array([(1 - s) * (1 - t), (1 + s) * (1 - t), (1 + s) * (1 + t), (1 - s) * (1 + t)]) / 4
            slope = np.array([[t - 1, 1 - t, 1 + t, -1 - t], [s - 1, -1 - s, 1 + s, 1 - s]]) / 4
            jacobian = slope @ place
            gradient = np.linalg.solve(jacobian, np.broadcast_to(slope, (len(corners), 2, 4)))
            radius, strain = place[:, :, 0] @ shape, np.zeros((len(corners), 4, 8))
            strain[:, 0, 0::2], strain[:, 1, 0::2] = gradient[:, 0], shape / radius[:, None]
            strain[:, 2, 1::2] = strain[:, 3, 0::2] = gradient[:, 1]
            strain[:, 3, 1::2] = gradient[:, 0]
            weight = 2 * np.pi * radius * np.linalg.det(jacobian)
            of_elements += np.einsum("eki,kl,elj,e->eij", strain, law, strain, weight)
    freedoms = np.stack([2 * corners, 2 * corners + 1], axis=-1).reshape(-1, 8)
    rows, columns = np.repeat(freedoms, 8, axis=1).ravel(), np.tile(freedoms, (1, 8)).ravel()
    return node, scipy.sparse.csr_matrix((of_elements.ravel(), (rows, columns)))


def approach(size):
    """Displacement of the middle of a cylinder as wide and deep as `size` [m]."""
    r = z = graded(size)
    node, matrix = stiffness(r, z)
    load, (points, weights) = np.zeros(matrix.shape[0]), np.polynomial.legendre.leggauss(8)
    for i in range(len(r) - 1):
        at = (r[i] + r[i + 1] + points * (r[i + 1] - r[i])) / 2
        part = weights * np.sqrt(np.maximum(0, 1 - (at / RADIUS) ** 2)) * at * (r[i + 1] - r[i])
        share = (at - r[i]) / (r[i + 1] - r[i])
        load[2 * node[i, 0] + 1] += (part * (1 - share)).sum()
        load[2 * node[i + 1, 0] + 1] += (part * share).sum()
    load *= FORCE / load.sum()
    free = np.setdiff1d(np.arange(len(load)), np.concatenate([2 * node[0], 2 * node[:, -1] + 1]))
    return scipy.sparse.linalg.spsolve(matrix[free][:, free].tocsc(), load[free])[np.searchsorted(free, 2 * node[0, 0] + 1)]


if __name__ == "__main__":
    print(f"approach over that of a half-space: {approach(20e-3) / approach(1.0):.4f}")
