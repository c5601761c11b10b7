#!/usr/bin/python3
"""Cases of the speed study: which scene, at which spacings, and how far a run is from the reference.

Used by tools/speed_study.py; not a program of its own. References: the verification catalogue's B2, B3, C4 and E1, whose
values stand below.
"""

from dataclasses import dataclass
from typing import Callable

import numpy as np


def rise_through(level, time, value):
    """Times at which `value` crosses `level`, by linear interpolation."""
    above = value > level
    k = np.flatnonzero(above[1:] != above[:-1])
    return time[k] + (level - value[k]) / (value[k + 1] - value[k]) * (time[k + 1] - time[k])


def bar_on_wall(run):
    """B2, exact: stress rho c v while in contact, for 2 L/c; then the bar leaves as fast as it came."""
    stress, duration, speed, area = 141.998e6, 7.845e-6, 10.0, 2.4e-3**2
    time, pressure = run.history["time"], -run.history["wall.force_x"] / area
    inside = (time > 0.1 * duration) & (time < 0.9 * duration)
    crossings = rise_through(0.5 * stress, time, pressure)
    if len(crossings) < 2:
        return {}
    return {"stress": np.trapz(pressure[inside], time[inside]) / np.ptp(time[inside]) / stress - 1,
            "contact time": (crossings[-1] - crossings[0]) / duration - 1,
            "rebound": run.history["v_mean"][-1] / speed - 1}


def extreme_near(time, value, centre, width):
    """Height of the parabola through the largest sample and its neighbours within centre +- width."""
    inside = np.flatnonzero(np.abs(time - centre) < width)
    k = inside[np.argmax(value[inside])]
    if k in (0, len(time) - 1):
        return np.nan
    a, b, c = np.polyfit(time[k - 1 : k + 2] - time[k], value[k - 1 : k + 2], 2)
    return c - b * b / (4 * a)


def oscillating_plate(run):
    """B3: period of the two-dimensional eigenvalue (finite elements); an elastic plate keeps its amplitude. Nothing when
    the period is so long (by a quarter) that the run ends before it."""
    exact = 0.2553
    time, tip = run.history["time"], run.history["tip"] - run.history["tip"][0]
    crossings = rise_through(0.0, time[1:], tip[1:])
    if len(crossings) < 2:
        return {}
    period = 2 * (crossings[1] - crossings[0])
    first = extreme_near(time, tip, crossings[0] - period / 4, period / 8)
    second = extreme_near(time, -tip, crossings[1] - period / 4, period / 8)
    return {"period": period / exact - 1, "amplitude loss": 1 - (second / first) ** 2}


def taylor_bar(run):
    """C4: length and foot radius of a converged finite element solution.

    Faces of the bar lie half a spacing outside the outermost particles. The radius is the median over twelve sectors of
    the largest distance from the axis, so that no single particle that got loose decides.
    """
    length, radius, sectors = 21.44e-3, 7.4e-3, 12
    (_, initial, _), *_, (_, position, _) = run.snapshots()
    half_spacing = initial[:, 2].min()
    r, angle = np.hypot(position[:, 0], position[:, 1]), np.arctan2(position[:, 1], position[:, 0])
    sector = np.floor((angle + np.pi) / (2 * np.pi) * sectors * (1 - 1e-12)).astype(int)
    foot = np.median([r[sector == k].max() for k in range(sectors)])
    return {"length": (position[:, 2].max() + half_spacing) / length - 1, "foot radius": (foot + half_spacing) / radius - 1}


def heated_slab(x, time):
    """E1, series solution: rise in a slab |x| < 10 mm of AL, initially 0, its faces at 1 from t = 0."""
    diffusivity, half = 188.0 / (2785 * 875), 0.01
    n = np.arange(60)
    b = ((n + 0.5) * np.pi / half)[:, None]
    terms = (-1.0) ** n[:, None] * 2 / (b * half) * np.exp(-b * b * diffusivity * time) * np.cos(b * x)
    return 1 - terms.sum(axis=0)


def slab(run):
    """Worst of the root mean square errors at 0.2, 0.5 and 1 s, relative to the step of the face temperature."""
    errors = {}
    for time, position, fields in run.snapshots():
        if min(abs(time - t) for t in (0.2, 0.5, 1.0)) < 1e-6:
            exact = 300 + 100 * heated_slab(position[:, 0], time)
            errors[f"T at {time:.1f} s"] = float(np.sqrt(np.mean((fields["temperature"] - exact) ** 2)) / 100)
    return errors


def slab_box(spacing):
    """Ten spacings thick, which is what the widest kernel needs in a periodic direction; steps in proportion."""
    half = 5 * spacing
    low, high = f'["-10 mm", "{-half} mm", "{-half} mm"]', f'["10 mm", "{half} mm", "{half} mm"]'
    return {"domain.low": low, "domain.high": high, "body.0.shape.low": low, "body.0.shape.high": high,
            "time.step": f'"{2.5 * spacing} ms"', "rigid.0.heat.mesh.near": '"2 mm"', "rigid.0.heat.mesh.far": '"2 mm"',
            "output.snapshot_interval": '"0.1 s"', "output.fields": '["temperature"]'}


@dataclass
class Case:
    """`spacings` [mm] from coarse to fine; `overrides(spacing)` are more scene keys; `errors(run)` are relative."""

    title: str
    scene: str
    spacings: tuple
    errors: Callable
    overrides: Callable = lambda spacing: {}
    corrections: tuple = ("none", "velocity", "full")


# Spacings of C4 at which the layers fit the length and the lattice has the mass of the round bar within 0.6 %.
BAR_SPACINGS = (32.4 / 38, 32.4 / 56, 32.4 / 79)

CASES = {
    "B2": Case("elastic bar on a wall: stress, contact time, rebound", "b2_bar_on_wall.toml", (0.8, 0.4, 0.2), bar_on_wall),
    "B3": Case("oscillating plate: period, amplitude loss", "b3_oscillating_plate.toml", (20 / 6, 2.0, 1.25),
               oscillating_plate,
               lambda spacing: {"body.0.shape.low": f'["{-6 * spacing} mm", "-10 mm"]', "time.end": '"0.32 s"'}),
    "C4": Case("Taylor bar: length, foot radius", "c4_taylor_bar.toml", BAR_SPACINGS, taylor_bar,
               lambda spacing: {"output.fields": '["id"]', "body.0.fill_margin": 0.0}),
    "E1": Case("heated slab: temperature", "e1_slab.toml", (10 / 3, 2.0, 1.0), slab, slab_box, ("none",)),
}
