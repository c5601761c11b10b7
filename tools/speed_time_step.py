#!/usr/bin/python3
"""The largest stable time step, and what steps below it cost in accuracy. Used by tools/speed_study.py."""

import math
from dataclasses import dataclass, field
from typing import Callable, Optional

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from speed_cases import BAR_SPACINGS, taylor_bar
from scene_runs import fingerprint, table

SMALL = 0.1  # Courant number of the run that the others are compared with
SCAN = (0.2, 0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0)
# A run has failed when it blew up or lost a particle, or when its energy balance is off by so much more than that of the
# small steps: energy from nowhere is how an unstable mode shows before it blows up. In an undamped wave the leapfrog's
# balance swings by (omega dt)^2/4 of the energy without growing; there only more than that counts.
ENERGY_BOUND, WAVE_BOUND = 0.05, 0.5
RESOLUTION, QUICK_RESOLUTION = 0.02, 0.1  # of the bisection
MARGIN = 0.8  # default Courant number over the least limit

# Longitudinal wave speed of AL, 72.4 GPa, nu 0.33, 2785 kg/m3
WAVE_SPEED = math.sqrt(72.4e9 * (1 - 0.33) / ((1 + 0.33) * (1 - 2 * 0.33)) / 2785)


def phase_speed(run):
    """Phase speed over c of the wave of 16 mm: the kinetic energy swings with twice its frequency (least squares)."""
    time, energy = run.history["time"], run.history["energy.kinetic"]
    omega = 2 * np.pi / 16e-3 * WAVE_SPEED
    least, best = math.inf, math.nan
    for ratio in np.linspace(0.85, 1.25, 2001):
        angle = 2 * ratio * omega * time
        basis = np.stack([np.ones_like(time), np.cos(angle), np.sin(angle)], axis=1)
        solution = np.linalg.solve(basis.T @ basis, basis.T @ energy)
        misfit = float(np.sum((basis @ solution - energy) ** 2))
        if misfit < least:
            least, best = misfit, ratio
    return {"phase speed": best}


def shape_of_bar(run):
    return {name: 1 + error for name, error in taylor_bar(run).items()}  # over the reference


@dataclass
class StepCase:
    """`values(run)` are what the error is made of; `reference` their true values where there are any; `expected` is the
    limit by theory (verification B1)."""

    scene: str
    overrides: dict
    values: Optional[Callable] = None
    reference: dict = field(default_factory=dict)
    expected: Optional[float] = None
    group: str = "plastic"


def wave(kernel, h, alpha, expected=None, exact=None):
    """B1, with a disturbance of all wavelengths and directions a ten-thousandth as large."""
    noise = "1e-7*sin(1e7*x+3e7*y+7e7*z)"
    high = '["16 mm", "8 mm", "8 mm"]'
    return StepCase("b1_plane_wave.toml",
                    {"domain.high": high, "body.0.shape.high": high, "numerics.kernel": kernel, "numerics.h_over_dx": h,
                     "numerics.viscosity_alpha": alpha, "time.end": '"0.1 ms"', "output.history_steps": 1,
                     "body.0.velocity.x": f"1e-3*sin(2*pi*x/0.016)+{noise}", "body.0.velocity.y": noise,
                     "body.0.velocity.z": noise},
                    phase_speed if alpha == 0 else None, {"phase speed": exact} if exact else {}, expected, "elastic wave")


def block(alpha, group="plastic", **numerics):
    overrides = {f"numerics.{key}": value for key, value in numerics.items()}
    return StepCase("stretched_block.toml", {"numerics.viscosity_alpha": alpha, **overrides},
                    lambda run: {"plastic work": run.history["energy.plastic"][-1]}, group=group)


def heated(mode):
    case = block(0.5, "heat")
    case.overrides["heat.mode"] = mode
    case.values = lambda run: {"plastic work": run.history["energy.plastic"][-1], "T max": run.history["T_max"][-1] - 293.15}
    return case


def tube():
    """Everything on: pressed and stirred metal in a die, friction, heat, correction, diffusion, artificial stress."""
    return StepCase("mini_tube.toml", {"time.end": '"60 ms"'},
                    lambda run: {"tool travel": run.history["tool.displacement_z"][-1]}, group="contact")


def bar(correction="none", **contact):
    overrides = {f"contact.0.{key}": value for key, value in contact.items()}
    return StepCase("c4_taylor_bar.toml",
                    {"numerics.spacing": f'"{BAR_SPACINGS[0]:.10g} mm"', "body.0.fill_margin": 0.0,
                     "numerics.gradient_correction": correction, "output.fields": '["id"]', **overrides},
                    shape_of_bar, {"length": 1.0, "foot radius": 1.0} if "friction" not in contact else {}, group="contact")


C2 = {"kernel": "wendland_c2", "h_over_dx": 1.5}
C4 = {"kernel": "wendland_c4", "h_over_dx": 2.0}
QUINTIC = {"kernel": "quintic", "h_over_dx": 1.0}

CASES = {
    "wave, cubic 1.3": wave("cubic", 1.3, 0.0, 1.84, 0.95482),
    "wave, C2 1.5": wave("wendland_c2", 1.5, 0.0, 1.73, 0.95411),
    "wave, C4 2.0": wave("wendland_c4", 2.0, 0.0),
    "wave, quintic 1.0": wave("quintic", 1.0, 0.0, 2.27, 0.96555),
    "wave, cubic 1.3, alpha 0.5": wave("cubic", 1.3, 0.5),
    "wave, cubic 1.3, alpha 1": wave("cubic", 1.3, 1.0),
    "wave, C2 1.5, alpha 1": wave("wendland_c2", 1.5, 1.0),
    "wave, C4 2.0, alpha 1": wave("wendland_c4", 2.0, 1.0),
    "wave, quintic 1.0, alpha 1": wave("quintic", 1.0, 1.0),
    "block, alpha 0": block(0.0),
    "block, alpha 0.5": block(0.5),
    "block, alpha 1": block(1.0),
    "block, alpha 1, C2 1.5": block(1.0, **C2),
    "block, alpha 1, velocity": block(1.0, "correction", gradient_correction="velocity"),
    "block, alpha 1, full": block(1.0, "correction", gradient_correction="full"),
    "block, alpha 1, full, C2 1.5": block(1.0, "correction", gradient_correction="full", **C2),
    "block, alpha 1, full, C4 2.0": block(1.0, "correction", gradient_correction="full", **C4),
    "block, alpha 1, full, quintic 1.0": block(1.0, "correction", gradient_correction="full", **QUINTIC),
    "block, alpha 0.5, full": block(0.5, "correction", gradient_correction="full"),
    "block, alpha 0.5, diffusion 0.1": block(0.5, "correction", density_diffusion=0.1),
    "block, alpha 0.5, adiabatic": heated("adiabatic"),
    "block, alpha 0.5, conduction": heated("conduction"),
    "bar, alpha 0.5": bar(),
    "bar, alpha 0.5, mu 0.39": bar(friction=0.39),
    "bar, alpha 0.5, penalty 1": bar(penalty_scale=1.0),
    "bar, alpha 0.5, soft 1": bar(soft_scale=1.0),
    "bar, alpha 0.5, mu 0.39, velocity": bar("velocity", friction=0.39),
    "bar, alpha 0.5, mu 0.39, full": bar("full", friction=0.39),
    "mini tube, all modules on": tube(),
}
QUICK = ("wave, cubic 1.3", "block, alpha 0.5", "bar, alpha 0.5, mu 0.39")


def measure(runner, case, cfl):
    run = runner.run(case.scene, {"time.cfl": cfl, **case.overrides})
    residual = run.history["energy.residual"]
    residual = residual[len(residual) // 2 :]  # at the start all energies may be small, and their ratios large
    sound = run.code == 0 and run.leaked() == 0 and np.isfinite(residual).all()
    values = case.values(run) if sound and case.values else {}
    return {"sound": bool(sound), "steps": run.steps(), "cpu_s": run.cpu,
            "residual": float(np.max(np.abs(residual[np.isfinite(residual)]), initial=0.0)),
            "values": {name: float(value) for name, value in values.items()}}


def largest_difference(values, others):
    """Relative, over the values both have; None without any."""
    differences = [abs(value / others[name] - 1) for name, value in values.items() if others.get(name)]
    return max(differences) if differences else None


class Scan:
    """Runs of one case over the Courant number."""

    def __init__(self, name, runner, records):
        self.name, self.case, self.runner, self.records = name, CASES[name], runner, records
        self.small = self.get(SMALL)

    def get(self, cfl):
        key = {"study": "time_step", "case": self.name, "cfl": round(cfl, 4),
               "input": fingerprint(self.case.scene, self.case.overrides)}
        return self.records.get(key, lambda: measure(self.runner, self.case, key["cfl"]))

    def failed(self, record):
        bound = WAVE_BOUND if self.case.group == "elastic wave" else ENERGY_BOUND
        return not record["sound"] or record["residual"] > self.small["residual"] + bound

    def search(self, resolution):
        """Fills `stable`, a list of (Courant number, record), and `limit`, the largest that is known to be stable."""
        self.stable, bad = [], None
        for cfl in SCAN:
            record = self.get(cfl)
            if self.failed(record):
                bad = cfl
                break
            self.stable.append((cfl, record))
        good = self.stable[-1][0] if self.stable else SMALL
        while bad is not None and bad - good > resolution + 1e-9:
            middle = round(0.5 * (good + bad), 4)
            record = self.get(middle)
            if self.failed(record):
                bad = middle
            else:
                good = middle
                self.stable.append((middle, record))
        self.limit, self.failure = good, bad

    def error(self, record):
        return largest_difference(record["values"], self.small["values"])

    def error_to_reference(self, record):
        return largest_difference(record["values"], self.case.reference)

    def near(self, cfl):
        """The stable record of the largest Courant number up to `cfl`."""
        below = [item for item in self.stable if item[0] <= cfl + 1e-9]
        return max(below, key=lambda item: item[0])[1] if below else None


COLOURS = {"elastic wave": "#4477aa", "plastic": "#228833", "correction": "#ee9933", "heat": "#ee6677", "contact": "#aa3377"}


def draw(path, scans):
    figure, (top, middle, bottom) = plt.subplots(3, 1, figsize=(7, 11), gridspec_kw={"height_ratios": [3, 3, 4]})
    for scan in scans:
        colour = COLOURS[scan.case.group]
        shown = 1e-5
        stable = sorted(scan.stable, key=lambda item: item[0])
        errors = [(cfl, max(error, shown)) for cfl, record in stable if (error := scan.error(record)) is not None]
        residuals = [(cfl, max(record["residual"], shown)) for cfl, record in stable]
        for axes, points in ((top, errors), (middle, residuals)):
            axes.plot([p[0] for p in points], [p[1] for p in points], "-", color=colour, lw=0.8, marker=".", markersize=3)
            if points and scan.failure:
                axes.plot(*points[-1], "x", color=colour, markersize=8, mew=2)
    for axes, label in ((top, f"error against CFL {SMALL:g}"), (middle, "largest energy residual")):
        axes.set_yscale("log")
        axes.set_ylabel(label)
        axes.grid(True, which="both", alpha=0.2)
        axes.set_xlim(0, 2.5)
    top.set_title("Courant number dt (c + |v|)/h: a cross marks the last stable run", fontsize=10)
    for group in dict.fromkeys(scan.case.group for scan in scans):
        top.plot([], [], color=COLOURS[group], label=group)
    top.legend(fontsize=7)
    names = [scan.name for scan in scans][::-1]
    bottom.barh(names, [scan.limit for scan in scans][::-1], color=[COLOURS[scan.case.group] for scan in scans][::-1])
    for place, scan in enumerate(scans[::-1]):
        if scan.case.expected:
            bottom.plot([scan.case.expected] * 2, [place - 0.4, place + 0.4], "k-")
    bottom.set_xlim(0, 2.5)
    bottom.set_xlabel("Courant number; bars: largest stable, black: theory (B1)")
    bottom.tick_params(labelsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=150)
    plt.close(figure)


def percent(value):
    return "" if value is None else f"{100 * value:.2g}"


def time_step(runner, records, options):
    names = QUICK if options.quick else list(CASES)
    scans = []
    for name in names:
        scan = Scan(name, runner, records)
        scan.search(QUICK_RESOLUTION if options.quick else RESOLUTION)
        scans.append(scan)
    least = min(scans, key=lambda scan: scan.limit)
    default = math.floor(20 * MARGIN * least.limit + 1e-9) / 20
    draw(runner.folder / "time_step.png", scans)
    rows = []
    for scan in scans:
        # With the default, and with the largest step of this case that keeps the margin.
        at_default, at_own = scan.near(default), scan.near(MARGIN * scan.limit)
        row = [scan.name, f"{scan.limit:.2f}", f"{scan.case.expected:g}" if scan.case.expected else ""]
        for record in (at_default, at_own):
            row += [percent(scan.error(record)), percent(record["residual"])] if record else ["", ""]
        row += [percent(scan.error_to_reference(scan.small)), percent(scan.error_to_reference(at_own)) if at_own else ""]
        rows.append(row)
    table(f"Largest stable Courant number (bisected to {RESOLUTION}); error against CFL {SMALL:g} and largest energy "
          f"residual, %, near the default {default:g} and near {MARGIN:g} of the limit; error against the reference",
          ["case", "limit", "theory", "error at default", "residual", f"error at {MARGIN:g} limit", "residual",
           f"to reference, CFL {SMALL:g}", f"to reference, {MARGIN:g} limit"], rows)
    print(f"\nRecommended: time.cfl = {default:g}, {MARGIN:g} of the least limit, {least.limit:.2f} ({least.name})")
