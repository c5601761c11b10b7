#!/usr/bin/python3
"""Error against time over kernel, smoothing length, gradient correction and spacing. Used by tools/speed_study.py."""

import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from speed_cases import CASES
from scene_runs import fingerprint, table

SMOOTHING = {"cubic": (1.2, 1.3, 1.5), "wendland_c2": (1.5, 1.75, 2.0), "wendland_c4": (1.75, 2.0), "quintic": (1.0, 1.15)}
QUICK = {"cubic": (1.3,), "wendland_c2": (1.5,)}
TARGETS = (0.05, 0.02, 0.01)
# A setting is not refined further when another one with the same spacing was so much cheaper and no less accurate, or so
# much more accurate and not that much dearer. Errors change more between spacings than costs do: they get more benefit of
# the doubt.
CHEAPER, MORE_ACCURATE = 1.25, 2.0


def settings_of(case, quick):
    smoothing = QUICK if quick else SMOOTHING
    return [(kernel, h, correction) for kernel, ratios in smoothing.items() for h in ratios
            for correction in case.corrections]


def overrides_of(case, setting, spacing):
    kernel, h, correction = setting
    return {"numerics.spacing": f'"{spacing:.10g} mm"', "numerics.kernel": kernel, "numerics.h_over_dx": h,
            "numerics.gradient_correction": correction, **case.overrides(spacing)}


def measure(runner, case, setting, spacing):
    run = runner.run(case.scene, overrides_of(case, setting, spacing))
    errors = {name: float(value) for name, value in case.errors(run).items()} if run.code == 0 else {}
    worst = max(map(abs, errors.values())) if errors else math.inf
    if not math.isfinite(worst):
        worst = None  # blown up, or nothing that could be measured: JSON has no infinity
    residual = float(run.history["energy.residual"][-1]) if "energy.residual" in run.history else None
    return {"particles": run.particles(), "steps": run.steps(), "wall_s": run.wall, "cpu_s": run.cpu, "errors": errors,
            "error": worst, "energy_residual": residual}


def dominated(own, others):
    """By another setting, clearly (see CHEAPER). All are runs of a setting from coarse to fine, the last with the same
    spacing. The larger error of the last two counts, as one alone may be passing through zero."""
    def error(runs):
        return max(math.inf if run["error"] is None else run["error"] for run in runs[-2:])

    def cost(runs):
        return runs[-1]["cpu_s"]

    if error(own) == math.inf:
        return True
    return any(error(other) <= error(own) and CHEAPER * cost(other) <= cost(own) or
               MORE_ACCURATE * error(other) <= error(own) and cost(other) <= CHEAPER * cost(own) for other in others)


def measure_case(name, runner, records, quick):
    """Records by setting, from coarse to fine. Every setting runs at the two coarsest spacings; what is dominated at
    the last spacing it ran at goes no further."""
    case = CASES[name]
    found = {setting: [] for setting in settings_of(case, quick)}
    alive = list(found)
    for level, spacing in enumerate(case.spacings[:2] if quick else case.spacings):
        if level >= 2:
            last = [found[setting] for setting in alive]
            alive = [setting for setting in alive if not dominated(found[setting], last)]
        for setting in alive:
            key = {"study": "pareto", "case": name, "kernel": setting[0], "h_over_dx": setting[1],
                   "gradient_correction": setting[2], "spacing_mm": round(spacing, 6),
                   "input": fingerprint(case.scene, overrides_of(case, setting, spacing))}
            found[setting].append(records.get(key, lambda s=setting: measure(runner, case, s, spacing)))
    return found


def cost_to_reach(target, runs):
    """(CPU seconds, spacing) at which this setting reaches the target for good: at that spacing and all finer ones that
    ran, so that an error passing through zero does not count. Between two spacings the cost is interpolated in the
    logarithms; None when the finest run misses the target."""
    good = len(runs)
    while good > 0 and runs[good - 1]["error"] is not None and runs[good - 1]["error"] <= target:
        good -= 1
    if good == len(runs):
        return None
    fine = runs[good]
    if good == 0 or runs[good - 1]["error"] is None:
        return fine["cpu_s"], fine["key"]["spacing_mm"]
    coarse = runs[good - 1]
    share = math.log(coarse["error"] / target) / math.log(coarse["error"] / fine["error"])
    between = lambda a, b: math.exp((1 - share) * math.log(a) + share * math.log(b))
    return between(coarse["cpu_s"], fine["cpu_s"]), between(coarse["key"]["spacing_mm"], fine["key"]["spacing_mm"])


def front(runs):
    """Those that no other run beats in both time and error, by time."""
    best, result = math.inf, []
    for run in sorted((r for r in runs if r["error"] is not None), key=lambda r: (r["cpu_s"], r["error"])):
        if run["error"] < best:
            best = run["error"]
            result.append(run)
    return result


COLOURS = {"cubic": "#4477aa", "wendland_c2": "#228833", "wendland_c4": "#ee9933", "quintic": "#aa3377"}
MARKERS = {"none": "o", "velocity": "s", "full": "^"}


def label_of(key):
    return f"{key['kernel']} {key['h_over_dx']:g} {key['gradient_correction']}"


def draw(path, name, found):
    figure, axes = plt.subplots(figsize=(7, 5))
    for (kernel, h, correction), runs in found.items():
        points = [(r["cpu_s"], r["error"]) for r in runs if r["error"] is not None]
        size = 3 + 3 * SMOOTHING[kernel].index(h)
        axes.plot([p[0] for p in points], [p[1] for p in points], color=COLOURS[kernel], marker=MARKERS[correction],
                  markersize=size, lw=0.5, alpha=0.7, markerfacecolor="none")
    best = front([run for runs in found.values() for run in runs])
    axes.plot([r["cpu_s"] for r in best], [r["error"] for r in best], "k-", lw=1.5, alpha=0.6)
    for run in best:
        axes.annotate(f"{label_of(run['key'])}, {run['key']['spacing_mm']:.3g} mm", (run["cpu_s"], run["error"]), fontsize=6,
                      xytext=(3, 3), textcoords="offset points")
    for kernel in dict.fromkeys(setting[0] for setting in found):
        axes.plot([], [], color=COLOURS[kernel], label=f"{kernel} {', '.join(f'{h:g}' for h in SMOOTHING[kernel])}")
    for correction in dict.fromkeys(setting[2] for setting in found):
        axes.plot([], [], "k", ls="", marker=MARKERS[correction], markerfacecolor="none", label=f"correction: {correction}")
    for target in TARGETS:
        axes.axhline(target, color="0.6", lw=0.7, ls=":")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("CPU time of the run, s (larger marker: larger h/dx)")
    axes.set_ylabel("largest relative error")
    axes.set_title(f"{name}, {CASES[name].title}", fontsize=10)
    axes.grid(True, which="both", alpha=0.2)
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=150)
    plt.close(figure)


def cheapest(target, found):
    """(setting, CPU seconds, spacing) that reaches the target first; None when none does."""
    costs = [(cost, setting) for setting, runs in found.items() if (cost := cost_to_reach(target, runs))]
    if not costs:
        return None
    (cpu, spacing), setting = min(costs)
    return setting, cpu, spacing


def part_of(found, part):
    """The same runs, judged by one of their errors only."""
    return {setting: [{**run, "error": abs(run["errors"][part]) if part in run["errors"] else None} for run in runs]
            for setting, runs in found.items()}


def print_cheapest(measured):
    rows = []
    for name, found in measured.items():
        parts = dict.fromkeys(part for runs in found.values() for run in runs for part in run["errors"])
        for label, judged in [("all", found)] + [(part, part_of(found, part)) for part in parts]:
            row = [name, label]
            for target in TARGETS:
                best = cheapest(target, judged)
                row.append(f"{' '.join(map(str, best[0]))}, {best[2]:.3g} mm, {best[1]:.2g} s" if best else "none")
            rows.append(row)
    table("Cheapest setting (kernel, h/dx, gradient correction), dx and CPU time that reach an error for good",
          ["case", "errors"] + [f"{100 * target:g} %" for target in TARGETS], rows)


def print_settings(measured, target):
    """The rule for a default: of all settings that reach the target in the most cases, the one with the least geometric
    mean of cost over the cheapest cost of the case."""
    costs = {name: {s: cost[0] for s, runs in found.items() if (cost := cost_to_reach(target, runs))}
             for name, found in measured.items()}
    scored = []
    for kernel, ratios in SMOOTHING.items():
        for h in ratios:
            for correction in MARKERS:
                ratio = {}
                for name, by_setting in costs.items():
                    own = (kernel, h, correction if correction in CASES[name].corrections else "none")
                    if own in by_setting:
                        ratio[name] = by_setting[own] / min(by_setting.values())
                if ratio:
                    mean = math.exp(sum(map(math.log, ratio.values())) / len(ratio))
                    scored.append((-len(ratio), mean, (kernel, h, correction), ratio))
    scored.sort(key=lambda entry: entry[:3])
    rows = [[f"{kernel} {h:g} {correction}", str(-count), f"{mean:.2f}"] +
            [f"{ratio[name]:.2f}" if name in ratio else "no" for name in costs]
            for count, mean, (kernel, h, correction), ratio in scored[:12]]
    table(f"Settings by the number of cases in which they reach {100 * target:g} %, then by their cost there over the "
          "cheapest (geometric mean)", ["setting", "cases", "mean"] + list(costs), rows)
    if scored:
        print(f"\nBy this rule: {' '.join(map(str, scored[0][2]))}")


def print_runs(name, found):
    def row(run):
        errors = ", ".join(f"{part} {100 * value:+.2f}" for part, value in run["errors"].items())
        return [label_of(run["key"]), f"{run['key']['spacing_mm']:.3g}", str(run["particles"]), str(run["steps"]),
                f"{run['cpu_s']:.2f}", errors or "none could be measured"]

    rows = [row(run) for runs in found.values() for run in runs]
    table(f"{name}, {CASES[name].title}", ["setting", "dx, mm", "particles", "steps", "CPU, s", "errors, %"], rows)


def pareto(runner, records, options):
    names = [options.case] if options.case else list(CASES)
    measured = {name: measure_case(name, runner, records, options.quick) for name in names}
    for name, found in measured.items():
        draw(runner.folder / f"pareto_{name}.png", name, found)
        print_runs(name, found)
    print_cheapest(measured)
    for target in (0.05, 0.02):
        print_settings(measured, target)
