#!/usr/bin/python3
"""report.html with its pictures, and RESULTS.md. Used by tools/verify.py; not a program of its own."""

import base64
import html
import platform
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from scene_runs import ROOT
from verify_cases import Case

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
                     "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 130})


def machine():
    """Processor, cores and memory of this machine."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*: (.*)", text)
    memory = Path("/proc/meminfo")
    size = re.search(r"MemTotal:\s+(\d+)", memory.read_text(encoding="utf-8")) if memory.exists() else None
    return (f"{model.group(1).strip() if model else platform.machine()}, {text.count('processor' + chr(9))} cores"
            + (f", {int(size.group(1)) / 2**20:.0f} GiB" if size else ""))


def series(case, records):
    """{(variant, quantity): [(spacing, |error|, wall)]} of the runs that ended well."""
    found = {}
    for record in records:
        key = record["key"]
        if key["kind"] in ("plain", "variant") and key["spacing_mm"] and record["exit_code"] == 0:
            for quantity in case.targets:
                error = record["errors"].get(quantity, np.nan)
                if np.isfinite(error) and error:
                    found.setdefault((key["variant"], quantity), []).append(
                        (key["spacing_mm"], abs(error), record["wall_s"]))
    return {name: sorted(points) for name, points in found.items() if len(points) > 1}


def picture(folder, case, records):
    """Error against spacing and against wall time; returns the file, or None where there is nothing to draw."""
    lines = series(case, records)
    if not lines:
        return None
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3))
    for (variant, quantity), points in lines.items():
        spacing, error, wall = np.array(points).T
        label = f"{variant}: {quantity}" if variant else quantity
        colour = left.loglog(spacing, error, "o-", label=label)[0].get_color()
        right.loglog(wall, error, "o-", color=colour)
        left.axhline(case.targets[quantity], color=colour, linestyle=":", linewidth=1)
    left.set(xlabel="spacing [mm]", ylabel="|error|", title=f"{case.id}: error and target (dotted)")
    right.set(xlabel="wall time [s]", ylabel="|error|", title="error against time")
    left.legend()
    figure.tight_layout()
    path = folder / f"{re.sub(r'[^A-Za-z0-9]+', '_', case.id)}.png"
    figure.savefig(path)
    plt.close(figure)
    return path


def number(value):
    return f"{value:+.3g}" if np.isfinite(value) else "none"


def table_of(case, records):
    """Rows (variant, quantity, target, errors at each spacing, wall times) of a case that runs scenes."""
    rows = []
    runs = {}
    for record in records:
        key = record["key"]
        if key["kind"] in ("plain", "variant"):
            name = key["variant"] + (f" ({key['ranks']} ranks)" if key["ranks"] > 1 else "")
            runs.setdefault(name, []).append(record)
    for name, group in runs.items():
        group.sort(key=lambda record: -(record["key"]["spacing_mm"] or 0))
        seen = dict.fromkeys(list(case.targets) + [q for record in group for q in record["errors"]])
        for quantity in seen:
            values = [(f"{record['key']['spacing_mm']:g} mm: " if record["key"]["spacing_mm"] else "")
                      + (number(record["errors"].get(quantity, np.nan)) if record["exit_code"] == 0
                         else f"exit {record['exit_code']}") for record in group]
            target = f"{case.targets[quantity]:g}" if quantity in case.targets else ""
            rows.append((name, quantity, target, "; ".join(values),
                         "; ".join(f"{record['wall_s']:.0f} s" for record in group)))
    return rows


def outcome_of_others(case, records):
    """Sentences about the runs that must fail or be refused."""
    for record in records:
        key = record["key"]
        if key["kind"] == "must_fail":
            errors = ", ".join(f"{q} {number(e)}" for q, e in record["errors"].items() if q in case.targets)
            yield f"must fail, {key['variant']}: {errors or 'exit code ' + str(record['exit_code'])}"
        if key["kind"] == "refused":
            yield f"refused, {key['variant']}: {' '.join(record['message'].split())[-260:]}"


def write_report(folder, rows, version):
    """folder/report.html: everything in one file; the pictures also stand beside it."""
    parts = [f"<h1>StirSPH verification</h1><p>{html.escape(version)}<br>{html.escape(machine())}</p>",
             "<table><tr><th>case</th><th>tier</th><th>verdict</th><th>title</th></tr>"]
    for case, _, passed, wrong, _ in rows:
        verdict = "passed" if passed else "FAILED: " + "; ".join(wrong)
        parts.append(f"<tr class='{'good' if passed else 'bad'}'><td><a href='#{case.id}'>{case.id}</a></td>"
                     f"<td>{case.tier}</td><td>{html.escape(verdict)}</td><td>{html.escape(case.title)}</td></tr>")
    parts.append("</table>")
    for case, records, passed, _, order in rows:
        parts.append(f"<h2 id='{case.id}'>{case.id}: {html.escape(case.title)}</h2><p>Reference: {html.escape(case.reference)}")
        if not isinstance(case, Case):
            parts.append(f"<br>Target: {html.escape(case.target)}</p><pre>{html.escape(chr(10).join(records[0]['lines']))}</pre>")
        else:
            parts.append(f"<br>Targets: {html.escape(case.origin)}</p><table><tr><th>variant</th><th>quantity</th><th>target</th>"
                         "<th>error</th><th>order</th><th>wall time</th></tr>")
            for name, quantity, target, values, walls in table_of(case, records):
                observed = f"{order[quantity]:.2f}" if not name and quantity in order else ""
                cells = (name, quantity, target, values, observed, walls)
                parts.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>")
            parts.append("</table>" + "".join(f"<p>{html.escape(line)}</p>" for line in outcome_of_others(case, records)))
            image = picture(folder, case, records)
            if image:
                data = base64.b64encode(image.read_bytes()).decode()
                parts.append(f"<img alt='{case.id}' src='data:image/png;base64,{data}'>")
        if not passed and case.diagnosis:
            parts.append(f"<p><b>Diagnosis.</b> {html.escape(case.diagnosis)}</p>")
    style = ("body{font:14px sans-serif;max-width:1100px;margin:2em auto}table{border-collapse:collapse}"
             "td,th{border:1px solid #ccc;padding:2px 8px;text-align:left}.good td{background:#f2faf2}.bad td{background:#fbeeee}"
             "pre{background:#f6f6f6;padding:6px;overflow:auto}")
    (folder / "report.html").write_text(f"<!doctype html><meta charset='utf-8'><title>StirSPH verification</title>"
                                        f"<style>{style}</style>" + "\n".join(parts), encoding="utf-8")


def write_results(path, rows, version, arguments):
    """RESULTS.md: the tables of the report, to be committed."""
    passed = sum(row[2] for row in rows)
    lines = ["# Results of the verification catalogue", "",
             f"Written by `tools/verify.py {arguments}`; {version}; {machine()}.", "",
             f"**{passed} of {len(rows)} cases meet their targets.** Errors are relative unless the name of the quantity says",
             "otherwise; `order` is the observed one between the two finest spacings. Targets and references: `cases.py` of each folder.", ""]
    family = None
    for case, records, ok, wrong, order in rows:
        if case.family != family:
            family = case.family
            lines += [f"## {family}", "", "| case | quantity | target | error at each spacing | order | wall | verdict |",
                      "|---|---|---|---|---|---|---|"]
        verdict = "passed" if ok else "**missed**"
        name = f"{case.id} {case.title} ({case.tier})"
        if not isinstance(case, Case):
            text = "; ".join(records[0]["lines"][:6]).replace("|", "/")
            lines.append(f"| {name} | {case.target} | | {text} | | {records[0]['wall_s']:.0f} s | {verdict} |")
            continue
        for variant, quantity, target, values, walls in table_of(case, records):
            observed = f"{order[quantity]:.1f}" if not variant and quantity in order else ""
            label = f"{variant}: {quantity}" if variant else quantity
            lines.append(f"| {name} | {label} | {target} | {values} | {observed} | {walls} | {verdict} |")
            name = verdict = ""
        for line in outcome_of_others(case, records):
            lines.append(f"| {name} | {line.replace('|', '/')} | | | | | {verdict} |")
            name = verdict = ""
    missed = [(case, wrong) for case, _, ok, wrong, _ in rows if not ok]
    if missed:
        lines += ["", "## Misses and why", ""]
        lines += [f"- **{case.id}** ({'; '.join(wrong)}): {case.diagnosis or 'not diagnosed yet'}" for case, wrong in missed]
    # Messages name scenes by their place on the machine; in the repository they are relative to it.
    path.write_text("\n".join(lines).replace(f"{ROOT}/", "") + "\n", encoding="utf-8")
