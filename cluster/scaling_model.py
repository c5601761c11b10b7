#!/usr/bin/python3
"""Strong scaling of the extrusion on paper: measured rates, real METIS partitions, a stated network.

Usage: cluster/scaling_model.py --measure [--output FOLDER]    measure this machine, cut both sizes, predict (15 minutes)
       cluster/scaling_model.py [--latency 1e-6 ...]           predict again from the files of the last --measure
       cluster/scaling_model.py --check-itself

The scene is inputs/paper_scale (263,088 particles) and the same with half the spacing (2.1 million). `stirsph check
--partition` cuts them as a run would and counts particles, pair-list entries and halo copies of every part. --measure
takes rates from `stirsph_bench extrusion` at up to 120,000 particles on one rank, predicts its full size (246,472) on
one and two ranks from its partition and the message times measured here, measures these and fails if a prediction is
more than 10 % off: let nothing else run meanwhile. Time of a step on P ranks:

  largest over the ranks of
    sweeps   pair-list entries x time per entry
    others   particles x time per particle + a constant (integration, contact, vote's scan, loads)
    halo     two exchanges: latency per message, received bytes/bandwidth, packed and unpacked bytes/copy rate
  + vote     log2(P) latencies
  + lists    order, halo plan and pair list of a part, moving the fields; shared by the steps a list lives
  + cell table   made whole on every rank, with its collectives, at every renewal of the lists
  + METIS    on one rank while the others wait, every 100 lists
  + heat     conjugate gradients: work by share, 2 allreduces and a halo exchange per iteration

All times are in seconds and all sizes in bytes unless a name says otherwise.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SCENE = ROOT / "inputs/paper_scale/scene.toml"
SPACINGS = {"full": "0.4 mm", "half": "0.2 mm"}  # of the two sizes
HEAT_PARTICLES = 263088  # the size that --heat-work and --heat-iterations stand for
CALIBRATION = {1000: 1000, 2000: 1000, 8000: 300, 32000: 100, 120000: 25}  # particles asked for: steps
VALIDATION_STEPS = 20
TERMS = ("sweeps", "others", "halo", "wait for slowest", "vote", "lists", "cell table", "METIS", "heat")
ALLOWED_ERROR = 0.10


@dataclass
class Network:
    latency: float
    bandwidth: float
    copy_rate: float
    message_overhead: float = 0.3e-6  # posting one message of an all-to-all that holds nothing

    def allreduce(self, ranks):
        return math.ceil(math.log2(ranks)) * self.latency

    def allgather(self, ranks, size):
        return self.allreduce(ranks) + (size / self.bandwidth if ranks > 1 else 0.0)

    def counts_to_all(self, ranks):
        """MPI_Alltoall of one 4-byte count per pair: log2(P) messages of half the counts each."""
        return self.allreduce(ranks) * (1 + 2 * ranks / self.bandwidth / self.latency) if ranks > 1 else 0.0


@dataclass
class Process:
    """What the partition does not know: how often lists are renewed, cells cut again and heat conducted."""

    steps_per_list: float
    lists_per_partition: float
    steps_per_heat: float
    heat_work: float  # core-seconds per solve and million particles
    heat_iterations: float
    overlap: float = 0.0  # part of the halo time that hides behind interior clusters


class Rates:
    """Time of the sweeps and of the rest of a step against particles per rank. Between the measured sizes times per list
    entry and per particle vary with the logarithm of the size; outside, the nearest holds, and below the smallest size
    the rest keeps the constant part that a line through the two smallest shows."""

    def __init__(self, rows):
        rows = sorted(rows, key=lambda row: row["particles"])
        self.size = np.array([row["particles"] for row in rows])
        self.entry = np.array([row["sweeps"] / row["candidates"] for row in rows])
        self.particle = np.array([row["others"] / row["particles"] for row in rows])
        least = rows[0]["others"]
        slope = (rows[1]["others"] - least) / (self.size[1] - self.size[0])
        self.constant = min(max(least - slope * self.size[0], 0.0), least)

    def sweeps(self, candidates, particles):
        return candidates * np.interp(np.log(np.maximum(particles, 1)), np.log(self.size), self.entry)

    def others(self, particles):
        inside = particles * np.interp(np.log(np.maximum(particles, 1)), np.log(self.size), self.particle)
        least = self.size[0] * self.particle[0]
        below = self.constant + (least - self.constant) * particles / self.size[0]
        return np.where(particles < self.size[0], below, inside)


class Study:
    """The file of `stirsph check --partition-file`: sizes, times and every part's share, for each number of parts."""

    def __init__(self, text):
        lines = text.splitlines()
        pairs = [line[2:].split("=") for line in lines if line.startswith("# ")]
        self.numbers = {key: float(value) for key, value in pairs}
        rows = [line for line in lines if line and not line.startswith("#")]
        names = rows[0].split(",")
        table = np.array([[float(value) for value in row.split(",")] for row in rows[1:]])
        self.columns = dict(zip(names, table.T))
        self.parts = sorted({int(p) for p in self.columns["parts"]})

    def share(self, parts, column):
        return self.columns[column][self.columns["parts"] == parts]

def halo_times(study, parts, network, sizes):
    """Of every rank, for exchanges of copies of these sizes one after the other."""
    received, sent = study.share(parts, "received"), study.share(parts, "sent")
    sources = study.share(parts, "sources")
    total = np.zeros(parts)
    for size in sizes:
        copied = size * (received + sent) / network.copy_rate
        total += sources * network.latency + copied + (size * received / network.bandwidth if parts > 1 else 0.0)
    return total


def rebuild_terms(study, parts, network, lists_per_partition):
    """Seconds of one renewal of the lists, as Neighbourhood::rebuild does it, by what they are spent on."""
    numbers = study.numbers
    candidates, particles = study.share(parts, "candidates"), study.share(parts, "particles")
    imbalance = candidates.max() / max(candidates.mean(), 1)
    # The measured mean of a part holds its halo copies; what the rebuild of all does beyond is moving the fields.
    fields = max(numbers["rebuild_s"] - numbers["table_s"] - numbers["list_s[1]"], 0.0)
    terms = {"lists": imbalance * numbers[f"list_s[{parts}]"] + fields * particles.max() / numbers["particles"]}
    terms["cell table"], terms["METIS"] = numbers["table_s"], 0.0
    if parts == 1:
        return terms
    terms["lists"] += 2 * network.counts_to_all(parts) + parts * network.message_overhead
    terms["lists"] += halo_times(study, parts, network, [numbers["kinematic_bytes"] + numbers["stress_bytes"] + 32]).max()
    # Imbalance (2 numbers), largest support, weights or not, all positions countable: five small allreduces.
    terms["cell table"] += 5 * network.allreduce(parts) + network.allgather(parts, 16 * numbers["cells"])
    terms["METIS"] = numbers[f"metis_s[{parts}]"] + network.allgather(parts, 8 * numbers["cells"])
    terms["METIS"] /= lists_per_partition
    return terms


def step_terms(study, parts, rates, network, process):
    """Seconds per step by term; their sum is the time of a step."""
    candidates, particles = study.share(parts, "candidates"), study.share(parts, "particles")
    numbers = study.numbers
    sweeps, others = rates.sweeps(candidates, particles), rates.others(particles)
    halo = (1 - process.overlap) * halo_times(study, parts, network,
                                              [numbers["kinematic_bytes"], numbers["stress_bytes"]])
    slowest = (sweeps + others + halo).max()
    terms = {"sweeps": sweeps.mean(), "others": others.mean(), "halo": halo.mean()}
    terms["wait for slowest"] = slowest - sum(terms.values())
    terms["vote"] = network.allreduce(parts)
    for name, seconds in rebuild_terms(study, parts, network, process.lists_per_partition).items():
        terms[name] = seconds / process.steps_per_list
    terms["heat"] = 0.0
    if process.steps_per_heat > 0:
        growth = (numbers["particles"] / HEAT_PARTICLES) ** (1 / 3)  # of the iterations with finer spacing
        work = process.heat_work * 1e-6 * particles.max()
        talk = 2 * network.allreduce(parts) + halo_times(study, parts, network, [8]).max()
        terms["heat"] = growth * (work + process.heat_iterations * talk) / process.steps_per_heat
    return terms


# ---------------------------------------------------------------------------------------------------- measurements


def command(arguments, ranks=1):
    launcher = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] if ranks > 1 else []
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    if os.geteuid() == 0:  # containers
        environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    done = subprocess.run(launcher + [str(a) for a in arguments], capture_output=True, text=True, check=False,
                          env=environment)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, arguments))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def cut(program, scene, part_counts, file):
    """Study of a scene; `scene`: the arguments that name it."""
    command([program, *scene, "--partition", ",".join(map(str, part_counts)), "--partition-file", file])
    return Study(file.read_text(encoding="utf-8"))


def bench(program, particles, steps, ranks, repeats, folder):
    """Median of the extrusion in mid-process: seconds per step by kind, pair-list entries, lists per step."""
    file = folder / "bench.json"
    size = ["--particles", particles] if particles else []
    command([program, "extrusion", *size, "--steps", steps, "--repeat", repeats, "--json", file], ranks)
    record = json.loads(file.read_text(encoding="utf-8"))
    mean = {name: phase["mean"] / steps for name, phase in record["phases"].items()}
    total, sweeps = record["seconds"] / steps, mean["stress"] + mean["forces"]
    return {"particles": record["particles"], "candidates": record["candidates_per_cluster"] * record["particles"] / 8,
            "ranks": ranks, "steps": steps, "total": total, "sweeps": sweeps, "halo": mean.get("halo", 0.0),
            "others": total - sweeps - mean.get("halo", 0.0) - mean.get("neighbours", 0.0),
            "neighbours": mean.get("neighbours", 0.0), "lists": record["rebuilds"] / steps,
            "cpu_share": record.get("cpu_share", 1.0), "machine": record["machine"], "commit": record["commit"]}


def measure_messages(folder):
    program = folder / "message_cost"
    command(["mpicc", "-O2", ROOT / "cluster/message_cost.c", "-o", program])
    return {key: float(value) for key, value in re.findall(r"(\w+)=([0-9.e+-]+)", command([program], 2))}


def measure(programs, folder, repeats):
    """Everything the model takes from this machine, as written to measured.json."""
    program = programs / "stirsph_bench"
    rows = []
    for particles, steps in CALIBRATION.items():
        row = bench(program, particles, steps, 1, repeats, folder)
        rows.append(row)
        print(f"one rank, {row['particles']:7d} particles: {1e9 * row['sweeps'] / row['candidates']:6.2f} ns per list entry, "
              f"{1e9 * row['others'] / row['particles']:6.1f} ns per particle besides, "
              f"{row['particles'] / row['total'] / 1e6:.3f} M particle-steps/s", flush=True)
    validation = [bench(program, None, VALIDATION_STEPS, ranks, repeats, folder) for ranks in (1, 2)]
    return {"rows": rows, "validation": validation, "messages": measure_messages(folder)}


def compare(measured, study):
    """Prints prediction and measurement on one and two ranks; true when all agree."""
    messages = measured["messages"]
    network = Network(messages["latency_s"], messages["bandwidth_B_per_s"], messages["copy_B_per_s"])
    print(f"messages between two ranks here: {1e6 * network.latency:.2f} us, {network.bandwidth / 1e9:.2f} GB/s, packing "
          f"{network.copy_rate / 1e9:.2f} GB/s")
    served = min(row.get("cpu_share", 1.0) for row in measured["rows"] + measured["validation"])
    if served < 0.97:
        print(f"a rank had a processor for only {100 * served:.0f} % of the time: other work disturbed the measurement")
    rates, good = Rates(measured["rows"]), True
    table = []
    for row in measured["validation"]:
        assert study.numbers["particles"] == row["particles"], "partition and measurement are of different scenes"
        process = Process(1 / row["lists"] if row["lists"] else math.inf, math.inf, 0, 0, 0)
        predicted = sum(step_terms(study, row["ranks"], rates, network, process).values())
        error = predicted / row["total"] - 1
        good &= abs(error) <= ALLOWED_ERROR
        table.append([str(row["ranks"]), f"{1e3 * predicted:.1f}", f"{1e3 * row['total']:.1f}", f"{100 * error:+.1f} %",
                      f"{row['particles'] / row['total'] / row['ranks'] / 1e6:.3f} M"])
    markdown(f"Prediction and measurement here, extrusion in mid-process, {study.numbers['particles']:.0f} particles",
             ["ranks", "predicted ms per step", "measured", "error", "particle-steps/s per core"], table)
    return good


# ---------------------------------------------------------------------------------------------------------- report


def markdown(title, columns, rows):
    print(f"\n{title}\n\n| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def predict(study, rates, network, process):
    """Terms of a step for each number of ranks."""
    return {parts: step_terms(study, parts, rates, network, process) for parts in study.parts}


def report(study, prediction):
    one = sum(prediction[1].values())
    rows, best = [], min(prediction, key=lambda parts: sum(prediction[parts].values()))
    for parts, terms in prediction.items():
        step = sum(terms.values())
        candidates = study.share(parts, "candidates")
        rows.append([str(parts), f"{study.share(parts, 'particles').mean():.0f}", f"{candidates.max() / candidates.mean():.2f}",
                     f"{study.share(parts, 'received').max():.0f}", f"{1e3 * step:.3g}", f"{one / step:.1f}",
                     f"{100 * one / step / parts:.0f} %"] + [f"{100 * terms[name] / step:.0f}" for name in TERMS])
    markdown(f"{study.numbers['particles']:.0f} particles",
             ["ranks", "particles each", "work most/mean", "halo most", "ms per step", "speed-up", "efficiency"]
             + [f"{name} %" for name in TERMS], rows)
    half = max(parts for parts, terms in prediction.items() if one / sum(terms.values()) / parts >= 0.5)
    fastest = sum(prediction[best].values())
    print(f"\nfastest on {best} ranks ({1e3 * fastest:.3g} ms per step, speed-up {one / fastest:.0f}); "
          f"most ranks with an efficiency of at least 50 %: {half}")


def picture(path, studies, predictions):
    figure, axes = plt.subplots(2, 2, figsize=(10, 8))
    colours = ["#4477aa", "#88bbdd", "#228833", "#bbbbbb", "#ddcc77", "#ee6677", "#882255", "#332288", "#ee9944"]
    for study, prediction, marker in zip(studies, predictions, "os"):
        parts = np.array(list(prediction))
        steps = np.array([sum(terms.values()) for terms in prediction.values()])
        label = f"{study.numbers['particles']:,.0f} particles"
        axes[0, 0].loglog(parts, steps[0] / steps, marker + "-", label=label, markersize=4)
        axes[0, 1].semilogx(parts, 100 * steps[0] / steps / parts, marker + "-", label=label, markersize=4)
    axes[0, 0].loglog(parts, parts, "k--", label="ideal", linewidth=1)
    axes[0, 0].set_ylabel("speed-up")
    axes[0, 1].set_ylabel("parallel efficiency, %")
    axes[0, 1].set_ylim(0, 105)
    for axis, study, prediction in zip(axes[1], studies, predictions):
        parts, base = list(prediction), np.zeros(len(prediction))
        for name, colour in zip(TERMS, colours):
            share = np.array([100 * terms[name] / sum(terms.values()) for terms in prediction.values()])
            axis.bar(range(len(parts)), share, bottom=base, color=colour, label=name, width=0.85)
            base += share
        axis.set_xticks(range(len(parts)), [str(p) for p in parts], fontsize=8)
        axis.set_ylabel("share of the step, %")
        axis.set_title(f"{study.numbers['particles']:,.0f} particles", fontsize=10)
    figure.legend(*axes[1, 1].get_legend_handles_labels(), fontsize=8, loc="lower center", ncol=5)
    for axis in axes[0]:
        axis.grid(True, which="both", alpha=0.25)
        axis.legend(fontsize=8)
    for axis in axes.flat:
        axis.set_xlabel("ranks")
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(path, dpi=150)
    plt.close(figure)


def check_itself():
    """The arithmetic on partitions whose answer is known by hand."""

    def study(parts, candidates, received, sources):
        lines = ["# particles=8000", "# cells=100", "# repartition_imbalance=1.15", "# kinematic_bytes=48",
                 "# stress_bytes=72", "# rebuild_s=0.9", "# table_s=0.1", "# metis_s[1]=0", "# list_s[1]=0.6",
                 f"# metis_s[{parts}]=0.5", f"# list_s[{parts}]=0.16",
                 "parts,part,particles,candidates,sent,received,destinations,sources", "1,0,8000,80000,0,0,0,0"]
        lines += [f"{parts},{p},{8000 // parts},{c},{received},{received},{sources},{sources}"
                  for p, c in enumerate(candidates)]
        return Study("\n".join(lines))

    rates = Rates([{"particles": n, "candidates": 10 * n, "sweeps": 1e-8 * 10 * n, "others": 2e-8 * n}
                   for n in (1000, 8000)])
    free, never = Network(1e-12, 1e21, 1e21, 0.0), Process(math.inf, math.inf, 0, 0, 0)
    slow = Network(1e-6, 1e9, 2e9)

    def near(value, expected, what):
        assert abs(value - expected) <= 1e-6 * abs(expected) + 1e-15, f"{what}: {value}, expected {expected}"

    even = study(4, [20000] * 4, 100, 2)
    one, four = (step_terms(even, p, rates, free, never) for p in (1, 4))
    near(sum(one.values()), 80000e-8 + 8000 * 2e-8, "one rank")
    near(sum(one.values()) / sum(four.values()), 4.0, "free messages and even shares: ideal speed-up")
    near(step_terms(even, 4, rates, slow, never)["halo"],
         2 * 2 * 1e-6 + 120 * 100 / 1e9 + 120 * 200 / 2e9, "halo: messages, transfer, packing")
    near(step_terms(even, 4, rates, slow, Process(math.inf, math.inf, 0, 0, 0, 0.75))["halo"],
         0.25 * (4e-6 + 12e-6 + 12e-6), "overlapped halo")
    near(step_terms(even, 4, rates, slow, never)["vote"], 2e-6, "vote: two latencies for four ranks")
    uneven = step_terms(study(4, [26000, 18000, 18000, 18000], 100, 2), 4, rates, free, never)
    near(uneven["wait for slowest"], 6000e-8, "wait for the most loaded")
    near(sum(rebuild_terms(even, 1, slow, math.inf).values()), 0.9, "rebuild on one rank")
    rebuild = rebuild_terms(even, 4, free, math.inf)
    near(rebuild["cell table"], 0.1, "rebuild: the table stays whole")
    near(rebuild["lists"], 0.16 + 0.2 / 4, "rebuild: list of a part and its share of the fields")
    near(rebuild_terms(even, 4, free, 10)["METIS"], 0.05, "METIS every ten lists")
    near(rebuild_terms(even, 4, slow, 10)["cell table"], 0.1 + 5 * 2e-6 + 2e-6 + 1600 / 1e9, "collectives of the table")
    rebuild = rebuild_terms(study(4, [26000, 18000, 18000, 18000], 100, 2), 4, free, 10)
    near(rebuild["lists"], 1.3 * 0.16 + 0.2 / 4, "rebuild of the most loaded")
    near(step_terms(even, 1, rates, slow, Process(5, math.inf, 0, 0, 0))["lists"], 0.16, "lists shared by five steps")
    fixed = Rates([{"particles": n, "candidates": n, "sweeps": 0.0, "others": 1e-5 + 1e-8 * n} for n in (1000, 4000)])
    near(fixed.others(np.array([100.0]))[0], 1.1e-5, "constant part below the smallest size")
    near(fixed.others(np.array([4000.0]))[0], 5e-5, "a measured size")
    heat = step_terms(even, 4, rates, slow, Process(math.inf, math.inf, 100, 10.0, 30))["heat"]
    near(heat, (8000 / HEAT_PARTICLES) ** (1 / 3) * (10e-6 * 2000 + 30 * (2 * 2e-6 + 2 * 1e-6 + 800 / 1e9 + 1600 / 2e9)) / 100, "heat")
    print("scaling_model: arithmetic in order")


def positive(text):
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f"{text}: must be > 0")
    return value


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", action="store_true", help="run the program and METIS; keeps the results in the output folder")
    parser.add_argument("--check-itself", action="store_true", help="test the arithmetic and leave")
    parser.add_argument("--output", type=Path, default=ROOT / "runs/scaling", help="folder of results (default runs/scaling)")
    parser.add_argument("--programs", type=Path, default=ROOT / "build/release", help="folder of stirsph and stirsph_bench")
    parser.add_argument("--repeats", type=int, default=3, help="runs of which the median counts (default 3)")
    parser.add_argument("--most-ranks", type=int, default=4096, help="powers of 2 up to this are cut (default 4096)")
    # Assumed, not measured: an MPI message between nodes over HDR InfiniBand; its 200 Gb/s (25 GB/s) serve all ranks of a
    # node. message_cost.c measures both on the cluster at hand.
    parser.add_argument("--latency", type=positive, default=1.5e-6, help="s per message (default 1.5e-6, assumed for HDR InfiniBand)")
    parser.add_argument("--bandwidth", type=positive, default=1e9,
                        help="B/s of one rank (default 1e9: a port's 25 GB/s among 25 busy ranks)")
    parser.add_argument("--overlap", type=float, default=0.0, help="part of the halo time hidden behind work, 0..1 (default 0)")
    parser.add_argument("--steps-per-list", type=positive, default=5, help="life of a pair list (default 5)")
    parser.add_argument("--lists-per-partition", type=positive, default=100,
                        help="lists between two METIS calls (default 100)")
    parser.add_argument("--steps-per-heat", type=float, default=100, help="mechanical steps per heat solve, 0: no heat (default 100)")
    parser.add_argument("--heat-work", type=positive, default=8.6,
                        help="core-seconds per heat solve and million particles at 263,088 (default 8.6, src/thermal/README.md)")
    parser.add_argument("--heat-iterations", type=positive, default=36,
                        help="of the conjugate gradients at 263,088 particles; both grow as 1/spacing (default 36)")
    arguments = parser.parse_args()
    if not 0 <= arguments.overlap <= 1:
        parser.error(f"--overlap {arguments.overlap}: must lie in 0..1")
    if arguments.repeats < 1 or arguments.most_ranks < 2:
        parser.error("--repeats must be >= 1 and --most-ranks >= 2")
    return arguments


def main():
    arguments = read_arguments()
    if arguments.check_itself:
        check_itself()
        return 0
    folder = arguments.output
    files = {name: folder / f"partition_{name}.csv" for name in ("bench", *SPACINGS)}
    if arguments.measure:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as scratch:
            measured = measure(arguments.programs, Path(scratch), arguments.repeats)
        (folder / "measured.json").write_text(json.dumps(measured, indent=1), encoding="utf-8")
        counts = [2 ** k for k in range(int(math.log2(arguments.most_ranks)) + 1)]
        cut(arguments.programs / "stirsph_bench", ["extrusion"], [1, 2], files["bench"])
        for name, spacing in SPACINGS.items():
            cut(arguments.programs / "stirsph", ["check", SCENE, "-P", f'numerics.spacing="{spacing}"'], counts, files[name])
    if not all(path.exists() for path in [folder / "measured.json", *files.values()]):
        print(f"scaling_model: {folder} holds no complete measurement; run with --measure first", file=sys.stderr)
        return 2
    measured = json.loads((folder / "measured.json").read_text(encoding="utf-8"))
    bench_study, *studies = [Study(file.read_text(encoding="utf-8")) for file in files.values()]
    origin = measured["rows"][0]
    machine = origin["machine"]
    print(f"commit {origin['commit']}, {machine['cpu']}, family {machine['family']}, model {machine['model']}, "
          f"{machine['lanes']} lanes, {machine['compiler']}")
    good = compare(measured, bench_study)
    network = Network(arguments.latency, arguments.bandwidth, measured["messages"]["copy_B_per_s"])
    process = Process(arguments.steps_per_list, arguments.lists_per_partition, arguments.steps_per_heat,
                      arguments.heat_work, arguments.heat_iterations, arguments.overlap)
    predictions = [predict(study, Rates(measured["rows"]), network, process) for study in studies]
    for study, prediction in zip(studies, predictions):
        report(study, prediction)
    picture(folder / "scaling.png", studies, predictions)
    print(f"\nnetwork: {1e6 * network.latency:g} us, {network.bandwidth / 1e9:g} GB/s per rank, packing "
          f"{network.copy_rate / 1e9:.2f} GB/s, {100 * process.overlap:g} % of the halo hidden; a list lives "
          f"{process.steps_per_list:g} steps, a partition {process.lists_per_partition:g} lists; heat every "
          f"{process.steps_per_heat:g} steps\n{folder}/scaling.png")
    if not good:
        print(f"scaling_model: a prediction for this machine is more than {100 * ALLOWED_ERROR:.0f} % off", file=sys.stderr)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
