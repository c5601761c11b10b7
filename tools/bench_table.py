#!/usr/bin/python3
"""Measures the speed figures of the README with stirsph_bench and prints them beside their targets, with the machine.

Usage: tools/bench_table.py [--program FILE] [--portable-program FILE] [--repeat N] [--steps N] [--particles N]
                            [--markdown] [--output FOLDER]

Wants an idle machine with two cores; about 5 minutes with the defaults, twice the time with --portable-program (the
preset `portable`: AVX2). --particles is for a quick trial: the targets hold for the scenes' own sizes. --output keeps
the JSON record of every run.
"""

import argparse
import json
import sys
from pathlib import Path

from bench_compare import ROOT, BenchError, positive, record_of

# A run that had a processor for less of its time than this was disturbed by others.
IDLE = 0.98

# Best open peer on one core of a Zen 5 machine: LAMMPS MACHDYN (updated Lagrangian, develop of 2024-09-20), the same
# Taylor bar, 66,170 particles, 73.1 neighbours; median particle-steps/s without and with gradient correction.
PEER = {"none": 0.604e6, "velocity": 0.458e6}

# Operations per neighbour and lane of the two sweeps in src/mechanics/pair_sweep.hpp: cubic kernel, three dimensions,
# one h, linear viscosity, no artificial stress, no density diffusion. Additions and multiplications, a fused pair
# counts two; divisions and square roots apart, because the machine does them in a unit of its own. max, comparisons,
# loads and what is done once per neighbour for all lanes are not counted.
#   first sweep:  d 3, r^2 6, q 1, slope 7, weight 1, g 3, v_j - v_i 3, L 18; first moment 12
#   second sweep: d 3, r^2 6, q 1, slope 7, weight 1, sigma_i + sigma_j 6, approach 9, mu 2, q_ij 8, its part of the
#                 stress 3, dissipation 3, traction 15, force 6, times V_i 3, its sum over lanes 3
FLOPS = {"none": {"stress": 42, "forces": 76}, "velocity": {"stress": 54, "forces": 76}}
DIVISIONS = {"stress": 1, "forces": 2}
SQUARE_ROOTS = {"stress": 1, "forces": 1}
# Pairs per particle that a sweep works through: the whole list, or what the first sweep found in reach of a register, a
# pair of two clusters once. USEFUL: how often a sweep needs a pair in reach.
VISITED = {"stress": "candidates_per_cluster", "forces": "visited_per_register"}
USEFUL = {"stress": 1, "forces": 0.5}


class Bench:
    """Runs of one program; equal ones are made once."""

    def __init__(self, program, options):
        self.program, self.options, self.records = program, options, {}

    def __call__(self, scene, correction="", ranks=1, steps=None):
        key = (scene, correction, ranks)
        if key not in self.records:
            arguments = [scene]
            if scene != "machine":
                arguments += ["--steps", str(steps or self.options.steps), "--repeat", str(self.options.repeat)]
                if correction:
                    arguments += ["--gradient-correction", correction]
                if self.options.particles:
                    arguments += ["--particles", str(self.options.particles)]
            print("measuring", *[word for word in (scene, correction) if word], f"on {ranks} rank(s) ...",
                  file=sys.stderr, flush=True)
            self.records[key] = record_of(self.program, arguments, ranks)
        return self.records[key]

    def keep(self, folder, name):
        folder.mkdir(parents=True, exist_ok=True)
        for (scene, correction, ranks), record in self.records.items():
            words = [name, scene] + ([correction] if correction else []) + [f"{ranks}_ranks"]
            (folder / ("_".join(words) + ".json")).write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def rate(record):
    """Median with the spread of the repeats, in millions."""
    rates = [value * 1e-6 for value in record["rates"]]
    spread = f" ({min(rates):.2f} .. {max(rates):.2f})" if len(rates) > 1 else ""
    return f"{record['particle_steps_per_s_per_core'] * 1e-6:.2f} M{spread}"


def row(figure, target, measured, reached):
    return [figure, target, measured, "yes" if reached else "no"]


def rate_row(figure, record, least):
    return row(figure, f">= {least * 1e-6:.1f} M", rate(record), record["particle_steps_per_s_per_core"] >= least)


def speed_rows(bench, portable):
    plain, corrected, two = bench("block", "none"), bench("block", "velocity"), bench("block", "none", ranks=2)
    stirred, extrusion, small = bench("stirred"), bench("extrusion"), bench("small", steps=500)
    speedup = 2 * two["particle_steps_per_s_per_core"] / plain["particle_steps_per_s_per_core"]
    lanes = plain["machine"]["lanes"]
    rows = [rate_row(f"block, {lanes} lanes: particle-steps/s per core", plain, 3.0e6),
            rate_row(f"block, {lanes} lanes, gradient correction", corrected, 2.4e6)]
    if portable:
        wide = portable("block", "none")["machine"]["lanes"]
        rows += [rate_row(f"block, {wide} lanes (portable build)", portable("block", "none"), 1.6e6),
                 [f"block, {wide} lanes, gradient correction", "", rate(portable("block", "velocity")), ""]]
    split = plain["bytes"]
    rows += [row("block, 2 ranks against 1", ">= 1.9", f"{speedup:.2f}", speedup >= 1.9),
             row("block, bytes per particle", "<= 600",
                 f"{plain['bytes_per_particle']:.0f} (particles {split['particles']:.0f}, list {split['list']:.0f}, "
                 f"mechanics {split['mechanics']:.0f})", plain["bytes_per_particle"] <= 600)]
    for name, record in (("block", plain), ("block, 2 ranks", two), ("stirred", stirred)):
        rows.append(row(f"{name}: a list rebuild in steps", "<= 1.5", f"{record['rebuild_cost_steps']:.2f}",
                        record["rebuild_cost_steps"] <= 1.5))
    rows += [row("stirred: steps per list", ">= 5",
                 ("" if stirred["rebuilds"] else "at least ") + f"{stirred['steps_per_list']:.1f}",
                 stirred["steps_per_list"] >= 5),
             ["stirred: particle-steps/s per core", "", rate(stirred), ""],
             row("extrusion: contact, integration, ledger, output", "<= 12 %",
                 f"{100 * extrusion['service_share']:.1f} %", extrusion["service_share"] <= 0.12),
             ["extrusion: particle-steps/s per core", "", rate(extrusion), ""],
             row("small: overhead per step beyond the sweeps", "<= 20 us", f"{small['step_overhead_us']:.1f} us",
                 small["step_overhead_us"] <= 20)]
    return rows


def taylor_rows(bench):
    rows = []
    for correction, peer in PEER.items():
        record = bench("taylor", correction)
        ratio = record["particle_steps_per_s_per_core"] / peer
        name = "no correction" if correction == "none" else "gradient correction"
        rows.append([f"{name}, {record['particles']} particles, {record['neighbours']:.1f} neighbours",
                     f"{peer * 1e-6:.3f} M", rate(record), f"{ratio:.2f}"])
    return rows


def roofline_rows(bench):
    """Where the time of the two sweeps goes, against what the core could do at most."""
    machine = bench("machine")
    rows = []
    for correction, flops in FLOPS.items():
        record = bench("block", correction)
        work = record["particles"] * record["steps"]
        for sweep, visited in VISITED.items():
            visits, inside = work * record[visited], work * record["neighbours"] * USEFUL[sweep]
            seconds = record["phases"][sweep]["mean"]
            peak = machine["multiply_add"] * seconds
            unit = DIVISIONS[sweep] / machine["divide"] + SQUARE_ROOTS[sweep] / machine["square_root"]
            rows.append([f"{sweep}, correction {correction}", f"{1e9 * seconds / visits:.2f}",
                         f"{flops[sweep]}", f"{100 * visits * flops[sweep] / peak:.0f} %",
                         f"{100 * inside * flops[sweep] / peak:.0f} %", f"{100 * visits * unit / seconds:.0f} %"])
    return rows


def print_table(title, columns, rows, markdown):
    print(f"\n{title}\n")
    if markdown:
        print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
        for cells in rows:
            print("| " + " | ".join(cells) + " |")
        return
    widths = [max(len(cells[k]) for cells in [columns, *rows]) for k in range(len(columns))]
    for cells in [columns, *rows]:
        print("  ".join(cell.ljust(width) for cell, width in zip(cells, widths)).rstrip())


def machine_text(record):
    rates = {name: 1e-9 * record[name] for name in ("multiply_add", "add", "divide", "square_root", "triad")}
    machine = record["machine"]
    return (f"{machine['cpu']}, family {machine['family']}, model {machine['model']}, {machine['lanes']} lanes, "
            f"{machine['compiler']}, commit {record['commit']}\none core: {rates['multiply_add']:.1f} Gflop/s fused, "
            f"{rates['add']:.1f} G additions/s, {rates['divide']:.2f} G divisions/s, "
            f"{rates['square_root']:.2f} G square roots/s, triad {rates['triad']:.1f} GB/s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/stirsph_bench")
    parser.add_argument("--portable-program", "--portable-binary", type=Path)
    parser.add_argument("--repeat", type=positive, default=3)
    parser.add_argument("--steps", type=positive, default=50)
    parser.add_argument("--particles", type=positive)
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--output", type=Path)
    options = parser.parse_args()
    bench = Bench(options.program, options)
    portable = Bench(options.portable_program, options) if options.portable_program else None
    speed, taylor, roofline = speed_rows(bench, portable), taylor_rows(bench), roofline_rows(bench)
    print(machine_text(bench("machine")))
    if portable:
        print(machine_text(portable("machine")))
    for record in [*bench.records.values(), *(portable.records.values() if portable else [])]:
        if record.get("cpu_share", 1) < IDLE:
            print(f"disturbed: {record['scene']} on {record['ranks']} rank(s) had a processor for only "
                  f"{100 * record['cpu_share']:.0f} % of the time")
    if options.particles:
        print(f"a trial with about {options.particles} particles: the targets do not apply")
    print_table("Speed", ["figure", "target", "measured", "reached"], speed, options.markdown)
    print_table("Taylor bar against the best open peer (particle-steps/s on one core)",
                ["case", "peer", "measured", "ratio"], taylor, options.markdown)
    print_table("Sweeps against the machine: share of the fused multiply-add peak; share of the time that divisions "
                "and square roots take at least",
                ["sweep", "ns per visited pair", "flop per pair", "peak, pairs visited", "peak, pairs in reach",
                 "divide unit"], roofline, options.markdown)
    if options.output:
        bench.keep(options.output, "release")
        if portable:
            portable.keep(options.output, "portable")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BenchError as problem:
        print(f"bench_table: {problem}", file=sys.stderr)
        sys.exit(2)
