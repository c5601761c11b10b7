#!/usr/bin/python3
"""Studies behind the figures of the verification catalogue. Used by tools/catalogue_figures.py; not a program of its own.

Each study runs ordinary scenes with overrides, keeps a record of every run, draws one picture and returns its numbers.
"""

import json
import math
import os
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from scene_runs import ROOT, StudyError, fingerprint
from verify_cases import FOLDER, Case, load, mean_between
from verify_report import machine

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
                     "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 130})


def finish(figure, path):
    figure.text(0.995, 0.005, machine(), ha="right", va="bottom", fontsize=6, color="0.5")
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def measured(runner, records, study, scene, overrides, measure):
    """Record of one run: exit code, times and what `measure(run)` finds (nothing when it failed)."""
    key = {"study": study, "input": fingerprint(scene, overrides)}

    def once():
        run = runner.run(scene, overrides, runner.folder / "runs" / study)
        found = {}
        if run.code == 0:
            found = {name: float(value) for name, value in measure(run).items()}
        steps = run.steps() if run.history and len(run.history["step"]) else 0
        return {"exit_code": run.code, "wall_s": run.wall, "cpu_s": run.cpu, "steps": steps,
                "particles": run.particles(), "phases_s": run.phases(), "found": found}

    return records.get(key, once)


def error_against_spacing(records_path, path):
    """Figure 1: |error| over target against spacing over that of the target, one line per quantity of every case."""
    if not records_path.exists():
        raise StudyError(f"there is no {records_path}: run tools/verify.py --tier T1 first")
    records = [json.loads(line) for line in records_path.read_text(encoding="utf-8").splitlines()]
    cases = [case for case in load() if isinstance(case, Case) and len(case.spacings) > 1]
    families = list(dict.fromkeys(case.family for case in cases))
    no_error = ("residual", "drift", "gap", "scatter", "spread", "guard", "noise", "penetration", "lost", "leaked", "spacings")
    figure, panels = plt.subplots((len(families) + 1) // 2, 2, figsize=(11, 3.4 * ((len(families) + 1) // 2)), squeeze=False)
    for axes, family in zip(panels.flat, families):
        for case in (case for case in cases if case.family == family):
            for quantity, target in case.targets.items():
                points = sorted({r["key"]["spacing_mm"]: abs(r["errors"][quantity]) for r in records
                                 if r["key"]["case"] == case.id and r["key"]["kind"] == "plain"
                                 and r["errors"].get(quantity)}.items())
                if len(points) < 2 or target == 0 or any(word in quantity for word in no_error):
                    continue
                spacing, error = np.array(points).T
                order = math.log(error[1] / error[0]) / math.log(spacing[1] / spacing[0])
                axes.loglog(spacing / case.goal(), error / target, "o-", markersize=3, lw=1,
                            label=f"{case.id} {quantity} ({order:.1f})")
        axes.axhline(1, color="k", lw=0.8, ls=":")
        reach = np.array([0.5, 2.0])
        for order in (1, 2):
            axes.loglog(reach, 0.1 * reach**order, "k--", lw=0.6)
        axes.set(xlabel="spacing over that of the target", ylabel="|error| over its target", title=family)
        axes.legend(fontsize=5.5, loc="center left", bbox_to_anchor=(1.0, 0.5))
    for axes in panels.flat[len(families):]:
        axes.axis("off")
    figure.suptitle("1: error against spacing; in brackets the observed order; dashed: orders 1 and 2", fontsize=10)
    finish(figure, path)


def upset(run):
    """F1: mean pressure on the plate over strains from 10 to 40 %, and the mean of (3/16) rho v^2 R^2/H^2 (for s = 1)."""
    size, speed, density = 10e-3, 1.0, 2785.0
    time = run.history["time"]
    inside = time >= 1e-3
    height = size - speed * time[inside]
    radius2 = size**3 / height
    pressure = run.history["top.force_z"][inside] / (np.pi * radius2)
    return {"pressure": pressure.mean(), "per_scale": (3 / 16 * density * speed**2 * radius2 / height**2).mean()}


def wall_pressure(run):
    """F2: mean contact pressure of the die in the second half of the run."""
    end = run.history["time"][-1]
    return {"pressure": mean_between(run, "die.contact_pressure", 0.5 * end, end)}


def couette_torque(run):
    return {"torque": mean_between(run, "tool.torque_z", 0.9e-3, 1e-3)}


def mass_scaling(runner, records, options, path):
    """Figure 3: what a density scale s costs in accuracy and saves in time: F1, F2, C8."""
    spacing = "0.5 mm" if options.quick else "0.25 mm"
    numbers = {}
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4))

    scales = (300, 3e3, 3e4) if options.quick else (300, 1e3, 3e3, 1e4, 3e4, 1e5)
    runs = [measured(runner, records, "mass_scaling", "f1_upsetting.toml",
                     {"numerics.spacing": f'"{spacing}"', "numerics.density_scale": s}, upset) for s in scales]
    # The flow stress is what is left at s = 0 of the straight line through the two smallest scales.
    p = [run["found"]["pressure"] for run in runs]
    still = p[0] - (p[1] - p[0]) / (scales[1] - scales[0]) * scales[0]
    error = [value / still - 1 for value in p]
    numbers["F1"] = {"s": scales, "error": error, "cpu_s": [run["cpu_s"] for run in runs]}
    line = left.loglog(scales, np.abs(error), "o", label=f"F1 upsetting at 1 m/s, {spacing}")[0]
    exact = np.array(scales) * runs[0]["found"]["per_scale"] / still
    left.loglog(scales, exact, "-", color=line.get_color(), lw=1)
    numbers["F1"]["formula"] = list(exact)
    numbers["F1"]["s of 1 %"] = 0.01 / (runs[0]["found"]["per_scale"] / still)
    right.loglog(scales, numbers["F1"]["cpu_s"], "o-", color=line.get_color())

    scales = (3, 30, 300) if options.quick else (3, 10, 30, 100, 300)
    rate, radius, density, strength = 1570.796, 11e-3, 2785.0, 265e6
    runs = [measured(runner, records, "mass_scaling", "f2_spinning_plug.toml", {"numerics.density_scale": s}, wall_pressure)
            for s in scales]
    error = [run["found"]["pressure"] / strength for run in runs]
    exact = np.array(scales) * density * rate**2 * radius**2 / 4 / strength
    numbers["F2"] = {"s": scales, "error": error, "formula": list(exact), "cpu_s": [run["cpu_s"] for run in runs],
                     "s of 1 %": 0.01 / (exact[0] / scales[0])}
    line = left.loglog(scales, error, "s", label="F2 plug at 15,000 rpm (pressure over 265 MPa)")[0]
    left.loglog(scales, exact, "-", color=line.get_color(), lw=1)
    right.loglog(scales, numbers["F2"]["cpu_s"], "s-", color=line.get_color())

    scales = (1, 100, 1e4) if options.quick else (1, 10, 100, 1e3, 1e4)
    runs = [measured(runner, records, "mass_scaling", "c8_couette_rings.toml",
                     {"numerics.density_scale": s, "material.0.file": "../materials/al.toml"}, couette_torque) for s in scales]
    torque = [run["found"].get("torque", math.nan) for run in runs]
    error = [abs(value / torque[0] - 1) for value in torque]
    numbers["C8"] = {"s": scales, "error": error, "cpu_s": [run["cpu_s"] for run in runs]}
    line = left.loglog(scales[1:], error[1:], "^", label="C8 torque of Couette flow, change from s = 1")[0]
    right.loglog(scales, numbers["C8"]["cpu_s"], "^-", color=line.get_color())

    left.axhline(0.01, color="0.5", ls=":")
    left.set(xlabel="density scale s", ylabel="relative error of the force", title="3: error of scaled mass, formulas as lines",
             ylim=(1e-5, None))  # room for the legend
    left.legend(fontsize=7, loc="lower right")
    right.set(xlabel="density scale s", ylabel="CPU time [s]", title="time saved")
    finish(figure, path)
    return numbers


def contact_stiffness(runner, records, options, path):
    """Figure 7: stiffness of the contact against penetration, force error, and time (C5, closed-die compression)."""
    case = next(case for case in load() if case.id == "C5")
    factors = (0.01, 0.1, 1.0) if options.quick else (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
    spacing = case.spacings[0] if options.quick else case.goal()
    base = {"numerics.spacing": f'"{spacing:.9g} mm"', **case.overrides(spacing)} if spacing else {}
    contacts = case.path().read_text(encoding="utf-8").count("[[contact]]")
    numbers = {"penalty_scale": factors, "penetration_over_dx": [], "errors": [], "cpu_s": [], "exit_code": []}
    for factor in factors:
        overrides = {**base, **{f"contact.{k}.penalty_scale": factor for k in range(contacts)},
                     **{f"contact.{k}.soft_scale": 0.0 for k in range(contacts)}}
        record = measured(runner, records, "contact_stiffness", case.path(), overrides, lambda run: {
            "penetration": run.history["penetration_over_dx"].max(), **case.measure(run)})
        found = record["found"]
        numbers["penetration_over_dx"].append(found.get("penetration", math.nan))
        numbers["errors"].append({name: found.get(name, math.nan) for name in case.targets})
        numbers["cpu_s"].append(record["cpu_s"])
        numbers["exit_code"].append(record["exit_code"])
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
    left.loglog(factors, numbers["penetration_over_dx"], "o-")
    left.axhline(0.05, color="0.5", ls=":")
    left.set(xlabel="penalty stiffness over E dx", ylabel="deepest penetration over dx", title="7: contact stiffness, C5")
    for name in case.targets:
        values = [abs(errors[name]) for errors in numbers["errors"]]
        if any(value > 0 for value in values):
            right.loglog(factors, values, "o-", label=name)
    for factor, code in zip(factors, numbers["exit_code"]):
        if code != 0:
            right.axvline(factor, color="r", lw=0.8, ls="--")
    right.set(xlabel="penalty stiffness over E dx", ylabel="|error|", title="error (dashed red: the run failed)")
    right.legend(fontsize=7)
    finish(figure, path)
    return numbers


def bench(runner, arguments, ranks):
    """The JSON record of a run of stirsph_bench."""
    out = runner.folder / "bench.json"
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    if os.geteuid() == 0:
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks),
               str(runner.program.with_name("stirsph_bench")), *arguments, "--json", str(out)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise StudyError(f"{' '.join(command)} failed:\n{done.stderr[-1000:]}")
    return json.loads(out.read_text(encoding="utf-8"))


def scaling(runner, records, options, path):
    """Figure 8: rates on one rank and on all cores for a fixed and for a growing problem; shares of the phases."""
    cores = os.cpu_count() or 1
    ranks = [n for n in (1, 2, 4, 8, 16, 32) if n <= cores]
    size = 20000 if options.quick else 97336
    repeat = ["--repeat", "1" if options.quick else "3", "--steps", "10" if options.quick else "30"]
    strong = [bench(runner, ["block", "--particles", str(size), *repeat], n) for n in ranks]
    weak = [bench(runner, ["block", "--particles", str(size * n), *repeat], n) for n in ranks]
    process = bench(runner, ["extrusion", *repeat], ranks[-1])
    rate = "particle_steps_per_s_per_core"
    numbers = {"ranks": ranks, "strong": [r[rate] for r in strong], "weak": [r[rate] for r in weak],
               "particles": size, "phases": {name: phase["mean"] for name, phase in process["phases"].items()}}
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
    left.plot(ranks, [value / numbers["strong"][0] for value in numbers["strong"]], "o-", label=f"strong, {size} particles")
    left.plot(ranks, [value / numbers["weak"][0] for value in numbers["weak"]], "s-", label=f"weak, {size} particles a rank")
    left.set(xlabel="ranks", ylabel="rate per core over that of one rank", ylim=(0, 1.1), xticks=ranks,
             title=f"8: scaling ({numbers['strong'][0] / 1e6:.2f} M particle-steps/s on one)")
    left.legend()
    phases = sorted(numbers["phases"].items(), key=lambda item: -item[1])
    total = sum(numbers["phases"].values())
    right.barh([name for name, _ in phases][::-1], [100 * value / total for _, value in phases][::-1])
    right.set(xlabel="share of the step [%]", title=f"phases of an extrusion on {ranks[-1]} ranks")
    finish(figure, path)
    return numbers


OFF = {"numerics.hourglass_control": 0.0}
SETTINGS = {
    "as in the case": {},
    "no viscosity": {"numerics.viscosity_alpha": 0.0, "numerics.viscosity_beta": 0.0},
    "viscosity 0.5": {"numerics.viscosity_alpha": 0.5},
    "viscosity 2": {"numerics.viscosity_alpha": 2.0},
    "full, hourglass control": {"numerics.gradient_correction": "full", "numerics.hourglass_control": 1.0},
    "full": {"numerics.gradient_correction": "full", **OFF},
    "full, artificial stress 0.3": {"numerics.gradient_correction": "full", "numerics.artificial_stress": 0.3, **OFF},
    "velocity": {"numerics.gradient_correction": "velocity", **OFF},
    "no correction": {"numerics.gradient_correction": "none", **OFF},
    "no correction, art. stress 0.3": {"numerics.gradient_correction": "none", "numerics.artificial_stress": 0.3, **OFF},
    "density diffusion 0.1": {"numerics.density_diffusion": 0.1},
    "Wendland C2, 1.5": {"numerics.kernel": "wendland_c2", "numerics.h_over_dx": 1.5},
    "quintic, 1.0": {"numerics.kernel": "quintic", "numerics.h_over_dx": 1.0},
}
MAP_CASES = ("B3", "B6", "B7", "C8h", "G2")


def stability_map(runner, records, options, path):
    """Figure 9: which settings a case survives, with the largest error over its target and the time over that of the case."""
    cases = [case for case in load() if case.id in MAP_CASES]
    settings = dict(list(SETTINGS.items())[:3]) if options.quick else SETTINGS
    numbers, colours = {}, {"meets": "#cfe8cf", "survives": "#f6e7b4", "dies": "#efb9b4"}
    figure, axes = plt.subplots(figsize=(2.2 + 1.7 * len(cases), 1.2 + 0.36 * len(settings)))
    for column, case in enumerate(cases):
        spacing = case.spacings[0] if case.spacings else None  # the coarsest: the map is about survival
        own = {"numerics.spacing": f'"{spacing:.9g} mm"', **case.overrides(spacing)} if spacing else {}
        base = None
        for row, (name, more) in enumerate(settings.items()):
            record = measured(runner, records, "stability_map", case.path(), {**own, **more}, case.measure)
            base = base or record["cpu_s"]
            found = {q: record["found"].get(q, math.nan) for q in case.targets}
            ratios = [abs(value) / case.targets[q] for q, value in found.items() if case.targets[q]]
            whole = all(value == 0 for q, value in found.items() if not case.targets[q])
            worst = max(ratios) if record["exit_code"] == 0 and all(map(math.isfinite, found.values())) else math.inf
            verdict = "dies" if record["exit_code"] != 0 else "meets" if worst <= 1 and whole else "survives"
            label = ("dies" if verdict == "dies" else "no answer" if not math.isfinite(worst) else f"{worst:.2g} of target")
            numbers.setdefault(case.id, {})[name] = {"verdict": verdict, "errors": found, "cpu_s": record["cpu_s"],
                                                     "exit_code": record["exit_code"]}
            axes.add_patch(plt.Rectangle((column, row), 1, 1, color=colours[verdict], ec="w"))
            axes.text(column + 0.5, row + 0.5, f"{label}, time x{record['cpu_s'] / base:.1f}", ha="center", va="center",
                      fontsize=6.5)
            print(f"  {case.id} {name}: {label}, {record['cpu_s']:.1f} s", flush=True)
    axes.set(xlim=(0, len(cases)), ylim=(len(settings), 0), xticks=np.arange(len(cases)) + 0.5,
             yticks=np.arange(len(settings)) + 0.5, title="9: stability map (largest error over its target, coarsest spacing)")
    axes.set_xticklabels([case.id for case in cases])
    axes.set_yticklabels(list(settings))
    axes.tick_params(length=0)
    axes.grid(False)
    finish(figure, path)
    return numbers


def module_cost(runner, records, options, path):
    """Figure 10 (G6): one billet under a turning tool; modules switched on in turn; microseconds per particle and step.
    Every round runs all scenes in turn, the least of the rounds counts."""
    scene = FOLDER / "coupled/g6_modules.toml"
    heat = {"heat.mode": "conduction"}
    stages = {
        "elastic": {"material.0.file": "../materials/al_elastic.toml"},
        "plastic": {},
        "contact": {"contact": '[{rigid="tool"},{rigid="die"},{rigid="plate"}]'},
        "friction": {"contact": '[{rigid="tool",friction=0.39},{rigid="die",friction=0.39},{rigid="plate",friction=0.39}]'},
    }
    stages["heat in the billet"] = {**stages["friction"], **heat}
    stages["heat in the tools"] = {**stages["heat in the billet"],
                                   **{f"rigid.{k}.heat": '{role="mesh",conductance="5000 W/m2/K",mesh={near="2 mm"}}'
                                      for k in range(3)}}
    stages["microstructure"] = {**stages["heat in the tools"], "microstructure.window": '"1 ms"'}
    rounds = 1 if options.quick else 3
    best = {name: math.inf for name in stages}
    bytes_each = {}
    for turn in range(rounds):
        for name, overrides in stages.items():
            run = runner.run(scene, overrides, runner.folder / "runs" / "module_cost")
            if run.code != 0:
                raise StudyError(f"{name}: exit code {run.code}: {run.message}")
            each = 1e6 * sum(run.phases().values()) / (run.particles() * run.steps())
            best[name] = min(best[name], each)
            bytes_each[name] = int(run.log.split(" B per particle")[0].split()[-1])
            print(f"  {name} (round {turn + 1}): {each:.3f} us", flush=True)
    figure, axes = plt.subplots(figsize=(7.5, 3.4))
    names, values = list(best), list(best.values())
    axes.barh(names[::-1], values[::-1])
    for at, name in enumerate(names[::-1]):
        axes.text(best[name], at, f" {best[name]:.2f} us, {bytes_each[name]} B", va="center", fontsize=8)
    axes.set(xlabel="time per particle and step [us], one core", title="10: modules switched on in turn", xlim=(0, 1.3 * max(values)))
    finish(figure, path)
    return {"us_per_particle_step": best, "bytes_per_particle": bytes_each}
