#!/usr/bin/python3
"""Runs stirsph as a user does and checks how it ends: exit code, one clear message, saved state, no rank left hanging.

Usage: failures.py --program STIRSPH --launcher "mpirun -n 2" --folder SCRATCH [--only NAME]
"""

import argparse
import csv
import os
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

SCENES = Path(__file__).resolve().parent / "scenes"
LIMIT_S = 60  # a run that takes longer than this hangs
FINISHED, INPUT, BLOW_UP, SOLVER, IO, STOPPED = 0, 2, 3, 4, 5, 10


class Program:
    """stirsph under mpirun, with a scratch folder per case."""

    def __init__(self, arguments):
        self.program = str(Path(arguments.program).resolve())
        self.launcher = shlex.split(arguments.launcher)
        self.scratch = Path(arguments.folder).resolve()

    def folder(self, name):
        """An empty folder path (not created) for the results of a case."""
        path = self.scratch / name
        shutil.rmtree(path, ignore_errors=True)
        self.scratch.mkdir(parents=True, exist_ok=True)
        return path

    def start(self, *arguments, wrapper=(), environment=()):
        command = [*self.launcher, *wrapper, self.program, *map(str, arguments)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                env={**os.environ, **dict(environment)})

    def run(self, *arguments, **options):
        return finish(self.start(*arguments, **options))


class Result:
    """Exit code and output; `errors` are the lines in which the program complains."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err
        self.errors = [line for line in err.splitlines() if line.startswith("error: ")]

    def expect(self, code, *parts):
        """This exit code; for failures exactly one message, which holds all parts."""
        text = f"\n--- output\n{self.out}\n--- errors\n{self.err}"
        check(self.code == code, f"exit code {self.code}, expected {code}{text}")
        wanted = 0 if code in (FINISHED, STOPPED) else 1
        check(len(self.errors) == wanted, f"{len(self.errors)} messages, expected {wanted}{text}")
        for part in parts:
            check(part in (self.errors[0] if wanted else self.out), f"'{part}' is not in the message{text}")
        return self


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def finish(process):
    try:
        out, err = process.communicate(timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        raise AssertionError(f"hangs: no end after {LIMIT_S} s\n{out}\n{err}") from None
    return Result(process.returncode, out, err)


def rows(folder):
    path = folder / "history.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8") as file:
        return [float(row[0]) for row in list(csv.reader(file))[1:]]


def wait_for_rows(folder, count, process):
    deadline = time.monotonic() + LIMIT_S
    while len(rows(folder)) < count:
        check(process.poll() is None, f"ended too early:\n{process.stderr.read() if process.poll() is not None else ''}")
        check(time.monotonic() < deadline, "no history is written")
        time.sleep(0.02)


BAR, HOT_SPOT = SCENES / "bar.toml", SCENES / "hot_spot.toml"
INTERVAL = 4e-6  # s, history of the bar


def case_finishes(stirsph):
    folder = stirsph.folder("finishes")
    stirsph.run(BAR, "-o", folder).expect(FINISHED)
    check((folder / "summary.json").exists(), "no summary")
    # The effective input runs by itself, from its own folder, and gives the same history.
    again = stirsph.folder("again")
    stirsph.run(folder / "input_as_used.toml", "-o", again).expect(FINISHED)
    check((folder / "history.csv").read_bytes() == (again / "history.csv").read_bytes(), "the effective input differs")


def case_help(stirsph):
    stirsph.run("--help").expect(FINISHED, "Exit codes", "--restart")
    stirsph.run("--version").expect(FINISHED, "StirSPH")
    stirsph.run("manual").expect(FINISHED, "| `spacing` |", "[[rigid]]", "Material files")


def case_check(stirsph):
    stirsph.run("check", BAR).expect(FINISHED, "300 particles", "time step", "predicted wall time")
    stirsph.run("check", HOT_SPOT).expect(FINISHED, "360 particles", "heat only")
    shares = stirsph.scratch / "shares.csv"
    stirsph.run("check", BAR, "--partition", "1,4", "--partition-file", shares).expect(FINISHED, "300 particles", "halo copies")
    check(shares.read_text(encoding="utf-8").count("\n4,") == 4, "not every part is in the file")
    for value in ("0", "2,many", "-1", "1.5"):
        check("--partition" in stirsph.run("check", BAR, "--partition=" + value).err, f"--partition {value} is taken")
    stirsph.run("check", BAR, "--partition", "2", "--partition-file", stirsph.scratch / "no/where.csv").expect(IO, "no/where.csv")
    stirsph.run("check", BAR, "-P", "numerics.spacing=1 kg").expect(INPUT, "numerics.spacing", "kg")


def case_wrong_input(stirsph):
    folder = stirsph.folder("wrong")
    stirsph.run("no_such_scene.toml", "-o", folder).expect(INPUT, "no_such_scene.toml")
    stirsph.run(BAR, "-o", folder, "-P", "numerics.spacin=1 mm").expect(INPUT, "numerics.spacin", 'Did you mean "spacing"?')
    stirsph.run(BAR, "-o", folder, "-P", "probe.0.field=speed").expect(INPUT, 'no field "speed"')
    stirsph.run(BAR, "-o", folder, "-P", "body.0.velocity.x=log(x-6e-3)").expect(INPUT, 'body "bar"', "log(x-6e-3)", "must have a value")
    stirsph.run(BAR, "-o", folder, "--wall-limit", "soon").expect(INPUT, "HH:MM:SS")
    stirsph.run(BAR, "-o", folder, "--restart", "nowhere.h5").expect(INPUT, "nowhere.h5")
    stirsph.run("-o", folder).expect(INPUT, "no scene given")
    check(stirsph.run(BAR, "--outptu", folder).code == INPUT, "an unknown option is an input error")


def case_blow_up(stirsph):
    folder = stirsph.folder("blow_up")
    stirsph.run(BAR, "-o", folder, "-P", "time.step=0.6 us", "-P", "time.end=2 ms", "-P",
                "limits.penetration=1e9").expect(BLOW_UP, "step ", "unstable", "time.step")
    check((folder / "failed_state.h5").exists(), "the state was not saved")
    check("error: " in (folder / "run.log").read_text(encoding="utf-8"), "the message is not in the log")


def case_formula_without_a_value(stirsph):
    folder = stirsph.folder("formula")
    # Formulas that lose their value during the run: the load of all particles, the motion of the wall, and a grip that
    # only one rank may hold.
    stirsph.run(BAR, "-o", folder, "-P", "body_force.y=sqrt(1e-5-t)").expect(INPUT, "step ", "sqrt(1e-5-t)", "at t = ")
    check((folder / "failed_state.h5").exists(), "the state was not saved")
    stirsph.run(BAR, "-o", folder, "-P", "rigid.0.motion.type=velocity", "-P", "rigid.0.motion.x=sqrt(1e-5-t)").expect(
        INPUT, "step ", 'rigid "wall"', "sqrt(1e-5-t)")
    gripped = stirsph.scratch / "gripped.toml"
    gripped.write_text(BAR.read_text(encoding="utf-8").replace("../../../inputs", str(SCENES.parents[2] / "inputs")) + """
[[set]]
name = "tip"
region = { type = "box", low = ["11 mm", "0 mm", "0 mm"], high = ["12 mm", "9 mm", "9 mm"] }
[[grip]]
name = "tip"
set = "tip"
velocity = { y = "sqrt(1e-5-t)" }
""", encoding="utf-8")
    stirsph.run(gripped, "-o", folder).expect(INPUT, "step ", "sqrt(1e-5-t)", "at t = ")
    stirsph.run(gripped, "-o", folder, "-P", "grip.0.velocity.y=log(x-1)").expect(INPUT, "log(x-1)")
    stirsph.run(gripped, "-o", folder, "-P", 'set.0.region.low=["50 mm", "0 mm", "0 mm"]', "-P",
                'set.0.region.high=["60 mm", "1 mm", "1 mm"]').expect(INPUT, 'set "tip"', "no particle")


def plate_mesh(path, nodes_shift=(0, 0, 0), swap=False):
    """A plate under the block of the hot spot in mm: six tetrahedra around the diagonal of a box, text of version 2."""
    corners = [(10 * x, 6 * y, 4 * z - 4) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    nodes = [" ".join([str(n + 1), *(str(c + s) for c, s in zip(corner, nodes_shift))]) for n, corner in enumerate(corners)]
    elements = []
    for step in ((1, 2, 4), (2, 4, 1), (4, 1, 2), (2, 1, 4), (1, 4, 2), (4, 2, 1)):  # a way along x, y and z each
        a, b = 1 + step[0], 1 + step[0] + step[1]
        even = step in ((1, 2, 4), (2, 4, 1), (4, 1, 2))
        elements.append((1, a, b, 8) if even else (1, b, a, 8))
    if swap:
        elements[2] = (elements[2][1], elements[2][0], *elements[2][2:])
    lines = [f"{10 + e} 4 2 1 1 {' '.join(map(str, nodes))}" for e, nodes in enumerate(elements)]
    path.write_text("\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", "8", *nodes, "$EndNodes", "$Elements",
                              "6", *lines, "$EndElements", ""]), encoding="utf-8")


def case_bad_mesh(stirsph):
    folder = stirsph.folder("bad_mesh")
    plate_mesh(stirsph.scratch / "plate.msh")
    plate_mesh(stirsph.scratch / "inverted.msh", swap=True)
    plate_mesh(stirsph.scratch / "overlapping.msh", nodes_shift=(0, 0, 1))
    text = (stirsph.scratch / "plate.msh").read_text(encoding="utf-8")
    (stirsph.scratch / "torn.msh").write_text(text[:text.index("13 4 2")], encoding="utf-8")
    scene = stirsph.scratch / "on_plate.toml"
    scene.write_text(HOT_SPOT.read_text(encoding="utf-8").replace("../../../inputs", str(SCENES.parents[2] / "inputs")) + """
[[rigid]]
name = "plate"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "-4 mm"], high = ["10 mm", "6 mm", "0 mm"] }
[rigid.heat]
role = "mesh"
interface = "perfect"
mesh = { file = "plate.msh", scale = 1e-3 }
[[rigid.heat.surface]]
region = { type = "box", low = ["-1 mm", "-1 mm", "-5 mm"], high = ["11 mm", "7 mm", "-2.9 mm"] }
flux = "1e5 W/m2"
[[heat_source]]
on = ["plate"]
density = "1e6 W/m3"
""", encoding="utf-8")
    mesh = "rigid.0.heat.mesh.file="
    stirsph.run(scene, "-o", folder).expect(FINISHED)
    stirsph.run("check", scene).expect(FINISHED, "mesh of 6 elements, 8 nodes")
    stirsph.run(scene, "-o", folder, "-P", mesh + "nowhere.msh").expect(INPUT, "rigid[0].heat.mesh.file", "no such file")
    stirsph.run(scene, "-o", folder, "-P", mesh + "inverted.msh").expect(
        INPUT, 'rigid "plate" heat', "inverted.msh: element 12 (nodes 5, 1, ", "inverted or flat")
    stirsph.run(scene, "-o", folder, "-P", mesh + "overlapping.msh").expect(INPUT, 'rigid "plate"', "overlaps", "inside element")
    stirsph.run(scene, "-o", folder, "-P", mesh + "torn.msh").expect(INPUT, "torn.msh", "Gmsh says")
    stirsph.run(scene, "-o", folder, "-P", "rigid.0.heat.mesh.scale=1").expect(INPUT, "plate.msh", "10 m long", "scale = 1e-3")
    stirsph.run(scene, "-o", folder, "-P", 'rigid.0.heat.surface.0.region.high=["11 mm", "7 mm", "-4.5 mm"]').expect(
        INPUT, 'rigid "plate" heat: surface[0]', "no facet")
    # Formulas that lose their value during the run.
    for key in ("heat_source.0.density", "rigid.0.heat.surface.0.flux"):
        stirsph.run(scene, "-o", folder, "-P", f"{key}=sqrt(0.1-t)").expect(INPUT, "step ", "sqrt(0.1-t)", "at t = ")
        check((folder / "failed_state.h5").exists(), "the state was not saved")


def case_penetration(stirsph):
    folder = stirsph.folder("penetration")
    stirsph.run(BAR, "-o", folder, "-P", "limits.penetration=1e-3").expect(BLOW_UP, "penetrated", "limits.penetration")


def case_linear_solve(stirsph):
    stirsph.run(HOT_SPOT, "-o", stirsph.folder("heat")).expect(FINISHED)
    folder = stirsph.folder("linear_solve")
    stirsph.run(HOT_SPOT, "-o", folder, "--petsc", "-heat_ksp_max_it 1").expect(SOLVER, "heat equation", "What to do")
    check((folder / "failed_state.h5").exists(), "the state was not saved")
    stirsph.run(HOT_SPOT, "-o", folder, "--petsc", "-heat_pc_type nonsense").expect(INPUT, "--petsc", "nonsense")
    stirsph.run(HOT_SPOT, "-o", folder, "--petsc", "-heat_ksp_maxit 1").expect(FINISHED, "-heat_ksp_maxit was not used")


def case_folder(stirsph):
    blocker = stirsph.folder("blocker")
    blocker.write_text("a file, not a folder")
    stirsph.run(BAR, "-o", blocker / "results").expect(IO, "create the folder", "blocker/results")
    blocker.unlink()


def case_disk_full(stirsph):
    # The limit on file sizes stands in for the full disk. Nothing of MPI may use shared
    # memory then: that is a file, too.
    def run(name, limit, *overrides):
        return stirsph.run(BAR, "-o", stirsph.folder(name), *overrides, wrapper=[__file__, "--limited", str(limit)],
                           environment={"OMPI_MCA_btl": "self,tcp", "PMIX_MCA_gds": "hash"})
    run("full_at_start", 20_000).expect(IO, "snapshot_", "File too large")
    run("full_later", 200_000, "-P", "output.history_steps=1", "-P", "time.end=2 ms").expect(IO, "history.csv", "File too large")


def check_history(folder, end):
    """One row at each interval, none missing, none twice."""
    times = rows(folder)
    found = [round(t / INTERVAL) for t in times]
    check(found == list(range(len(found))), f"rows at {found}")
    check(abs(times[-1] - end) < 0.5 * INTERVAL, f"the history ends at {times[-1]} s instead of {end} s")


def stop_and_continue(stirsph, name, stop, *arguments):
    """Stops a long run by `stop(process, folder)`, then runs it to an end that is near."""
    folder = stirsph.folder(name)
    process = stirsph.start(BAR, "-o", folder, "-P", "time.end=1 s", *arguments)
    wait_for_rows(folder, 5, process)
    stop(process, folder)
    finish(process).expect(STOPPED, "stopped at", "--restart auto")
    check(list(folder.glob("checkpoint*.h5")), "no checkpoint")
    end = (len(rows(folder)) + 6) * INTERVAL
    stirsph.run(BAR, "-o", folder, "--restart", "auto", "-P", f"time.end={end} s").expect(FINISHED, "continuing from")
    check_history(folder, end)


def case_stop_file(stirsph):
    stop_and_continue(stirsph, "stop_file", lambda process, folder: (folder / "stop").touch())
    check(not (stirsph.scratch / "stop_file/stop").exists(), "the stop file is still there")


def case_signal(stirsph):
    stop_and_continue(stirsph, "signal", lambda process, folder: process.send_signal(signal.SIGUSR1))


def case_wall_limit(stirsph):
    stop_and_continue(stirsph, "wall_limit", lambda process, folder: None, "--wall-limit", "00:04")
    stirsph.run(BAR, "-o", stirsph.folder("short_limit"), "--wall-limit", "1").expect(STOPPED, "stopped at")


def limited():
    """failures.py --limited BYTES COMMAND...: runs a command that cannot write files larger than that."""
    size = int(sys.argv[2])
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    os.execv(sys.argv[3], sys.argv[3:])


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "launcher", "folder"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--only", default="", help="name of one case")
    arguments = parser.parse_args()
    stirsph = Program(arguments)
    failed = 0
    for name, case in list(globals().items()):
        if not name.startswith("case_") or arguments.only not in ("", name.removeprefix("case_")):
            continue
        began = time.monotonic()
        try:
            case(stirsph)
            print(f"ok     {name} ({time.monotonic() - began:.1f} s)", flush=True)
        except AssertionError as wrong:
            failed += 1
            print(f"FAILED {name}: {wrong}", flush=True)
    print(f"{failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--limited"]:
        limited()
    sys.exit(main())
