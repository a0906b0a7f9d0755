"""Work against error beside other programs, on the same scenes and this machine.

    compare.py --apothem PROGRAM [--box2d PROGRAM] [--ccx PROGRAM] [SCENE ...]

Prints a table per scene: what each program takes (processor time) and how far it is off. References are
closed forms and laws of conservation. Box2D (tests/peers/box2d.cpp) and CalculiX (ccx) are left out where they are not
installed. Lengths are in m, masses in kg. Ends with 1 if our own program is farther off than it should be.
"""

import argparse
import csv
import json
import math
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile

GRAVITY = 9.81
BOX2D_STEPS = [1 / 60, 1 / 240, 1 / 960]


def box(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def turned(points, angle, at):
    c, s = math.cos(angle), math.sin(angle)
    return [[at[0] + c * x - s * y, at[1] + s * x + c * y] for x, y in points]


def scene_of(bodies, end, stiffness, friction=0.0, gravity=(0, 0), **time):
    """`bodies`: dicts with a name and a polygon, and maybe a velocity, a spin and a motion."""
    contact = {"normal_stiffness": stiffness}
    if friction:
        contact["friction"] = {"coefficient": friction, "tangential_stiffness": 0.6 * stiffness}
    return {"materials": {"stone": {"density": 2000}}, "gravity": list(gravity), "contact": contact,
            "bodies": [dict(b, material="stone") for b in bodies], "time": {"end": end, **time},
            "output": {"frames": 0}}


def demand(condition, what):
    if not condition:
        raise SystemExit(f"apothem: {what}")


class Programs:
    def __init__(self, arguments):
        self.apothem, self.box2d, self.ccx = arguments.apothem, arguments.box2d, arguments.ccx
        self.folder = tempfile.mkdtemp(prefix="apothem-peers-")

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, scene):
        with open(self.path("scene.json"), "w", encoding="utf-8") as file:
            json.dump(scene, file)
        return self.path("scene.json")

    def run(self, scene, track=(), interval=None):
        """The scene by Apothem: run.json, and the rows of history.csv and energy.csv as dicts of numbers."""
        scene = json.loads(json.dumps(scene))
        history = {"interval": interval or scene["time"]["end"]}
        if track:
            history["track"] = [{"body": name} for name in track]
        scene["output"]["history"] = history
        out = self.path("run")
        shutil.rmtree(out, ignore_errors=True)
        done = subprocess.run([self.apothem, "run", self.write(scene), "-o", out], capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError("apothem: " + done.stderr)
        tables = {}
        for name in ("history", "energy"):
            file = os.path.join(out, name + ".csv")
            if os.path.exists(file):
                with open(file, newline="", encoding="utf-8") as lines:
                    rows = csv.DictReader(lines)
                    tables[name] = [{re.sub(r" \[.*", "", k): float(v) for k, v in row.items() if v} for row in rows]
        with open(os.path.join(out, "run.json"), encoding="utf-8") as file:
            return json.load(file), tables

    def run_box2d(self, scene, step, end, restitution=0.0, rest=None):
        command = [self.box2d, self.write(scene), repr(step), repr(end), repr(restitution)]
        command += [repr(rest)] if rest is not None else []
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)


def power_of_ten(number):
    return f"1e{round(math.log10(number))}"


def milliseconds(seconds):
    return f"{1e3 * seconds:.3g}"


def table(title, columns, rows):
    print(f"\n## {title}\n")
    print("| " + " | ".join(columns) + " |")
    print("| " + " | ".join("---" for _ in columns) + " |")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    sys.stdout.flush()


def gas(programs):
    """Boxes without friction that collide elastically in a closed room: the energy after 2 s."""
    rng = random.Random(1)
    side, cells, end = 0.5, 20, 2.0
    room = cells * 1.0
    bodies = [{"name": f"wall {k}", "motion": "fixed", "polygon": polygon} for k, polygon in enumerate(
        [box(-2, -2, room + 2, 0), box(-2, room, room + 2, room + 2), box(-2, 0, 0, room), box(room, 0, room + 2, room)])]
    for i in range(cells * cells):
        at = (i % cells + 0.5, i // cells + 0.5)
        square = [[x - side / 2, y - side / 2] for x, y in box(0, 0, side, side)]
        bodies.append({"name": f"box {i}", "polygon": turned(square, rng.uniform(0, math.pi), at),
                       "velocity": [rng.uniform(-4, 4), rng.uniform(-4, 4)], "spin": rng.uniform(-2, 2)})
    moments = [b for b in bodies if "velocity" in b]
    mass = 2000 * side * side
    inertia = mass * side * side / 6
    first = sum(mass * (b["velocity"][0] ** 2 + b["velocity"][1] ** 2) / 2 + inertia * b["spin"] ** 2 / 2
                for b in moments)
    rows = []
    for accuracy in (1e-2, 1e-3, 1e-4):
        run, _ = programs.run(scene_of(bodies, end, 1e8, accuracy=accuracy))
        demand(run["largest_energy_error"] < 1e-3 * first, f"the energy of the gas is off at the accuracy {accuracy:g}")
        rows.append([f"Apothem, accuracy {accuracy:g}", milliseconds(run["processor_time"] / end),
                     f"{run['largest_energy_error'] / first:.2g}"])
    for step in BOX2D_STEPS if programs.box2d else []:
        result = programs.run_box2d(scene_of(bodies, end, 1e8), step, end, 1.0)
        last = sum(b["mass"] * (b["v"][0] ** 2 + b["v"][1] ** 2) / 2 + b["inertia"] * b["v"][2] ** 2 / 2
                   for name, b in result["bodies"].items() if name.startswith("box"))
        rows.append([f"Box2D, step 1/{round(1 / step)} s", milliseconds(result["processor_time"] / end),
                     f"{abs(last / first - 1):.2g}"])
    table("400 boxes that collide elastically, without friction",
          ["program", "ms per simulated s", "error of the energy after 2 s, parts of it"], rows)


def impacts(programs):
    """A corner of a box meets the face of another one, without friction: the velocities after the elastic
    impact, against the closed form for rigid bodies."""
    rng = random.Random(2)
    count, end = 100, 0.4
    square = box(-0.5, -0.5, 0.5, 0.5)
    bodies, exact = [], {}
    mass, inertia = 2000.0, 2000.0 / 6
    for i in range(count):
        x = 6.0 * i
        angle, dy = rng.uniform(0.3, 1.2), rng.uniform(-0.3, 0.3)
        corners = turned(square, angle, (0, 0))
        corner = min(corners)
        at = (x + 0.6 - corner[0], dy - corner[1])  # so that the corner is .1 m from the face, at the height dy
        bodies.append({"name": f"a{i}", "polygon": [[x + p[0], p[1]] for p in square], "velocity": [1, 0]})
        bodies.append({"name": f"b{i}", "polygon": turned(square, angle, at), "velocity": [0, 0]})
        lever_a, lever_b = -dy, -corner[1]  # of a force along x, about the mass centres
        impulse = 2 / (2 / mass + lever_a ** 2 / inertia + lever_b ** 2 / inertia)
        exact[f"a{i}"] = (1 - impulse / mass, 0, -impulse * lever_a / inertia)
        exact[f"b{i}"] = (impulse / mass, 0, impulse * lever_b / inertia)

    def error(velocity_of):
        worst = 0.0
        for name, expected in exact.items():
            found = velocity_of(name)
            worst = max([worst] + [abs(f - e) for f, e in zip(found, expected)])
        return worst

    rows, before = [], 0.2
    for stiffness in (1e7, 1e8, 1e9, 1e10):
        run, tables = programs.run(scene_of(bodies, end, stiffness, accuracy=1e-4), track=exact)
        last = tables["history"][-1]
        off = error(lambda name: [last[f"{name}.{k}"] for k in ("vx", "vy", "spin")])
        demand(off < 0.6 * before, f"impacts do not come nearer to those of rigid bodies at {stiffness:g} Pa")
        before = off
        rows.append([f"Apothem, k_n = {power_of_ten(stiffness)} Pa", milliseconds(run["processor_time"] / end), f"{off:.2g}"])
    for step in BOX2D_STEPS if programs.box2d else []:
        result = programs.run_box2d(scene_of(bodies, end, 1e8), step, end, 1.0)
        off = error(lambda name: result["bodies"][name]["v"])
        rows.append([f"Box2D, step 1/{round(1 / step)} s", milliseconds(result["processor_time"] / end), f"{off:.2g}"])
    table("100 elastic impacts of a corner on a face",
          ["program", "ms per simulated s", "largest error of a velocity, m/s and rad/s"], rows)


def slope(programs):
    """A block slides up a slope and stops: its way, against the closed form."""
    angle, friction, speed, end = math.radians(25), 0.6, 6.0, 3.0
    gravity = (-GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle))
    way = speed ** 2 / (2 * GRAVITY * (math.sin(angle) + friction * math.cos(angle)))
    bodies = [{"name": "slope", "motion": "fixed", "polygon": box(-5, -1, 10, 0)},
              {"name": "block", "polygon": box(0, 0, 1, 0.5), "velocity": [speed, 0]}]
    rows = []
    for name, settings in (("", {}), (", scheme auto", {"scheme": "auto"})):
        scene = scene_of(bodies, end, 1e9, friction, gravity, start="settled", **settings)
        scene["contact"]["damping"] = {"model": "viscous", "ratio": 0.3}
        run, tables = programs.run(scene, track=["block"])
        off = abs(tables["history"][-1]["block.x"] - tables["history"][0]["block.x"] - way) / way
        demand(off < 1e-4, f"the way on the slope{name} is off by {off:.2g} of it")
        rows.append(["Apothem" + name, milliseconds(run["processor_time"] / end), f"{off:.2g}"])
    for step in BOX2D_STEPS if programs.box2d else []:
        result = programs.run_box2d(scene_of(bodies, end, 1e9, friction, gravity), step, end)
        off = abs(result["bodies"]["block"]["x"][0] - 0.5 - way) / way
        rows.append([f"Box2D, step 1/{round(1 / step)} s", milliseconds(result["processor_time"] / end), f"{off:.2g}"])
    table("A block slides up a slope until it stops", ["program", "ms per simulated s", "error of its way, parts of it"],
          rows)


def pile(programs):
    """A pyramid of boxes at rest: how deep they are in each other, and how far they creep in a second."""
    side, rows_of_boxes, friction = 0.5, 30, 0.5
    bodies = [{"name": "floor", "motion": "fixed", "polygon": box(-20, -1, 20, 0)}]
    for row in range(rows_of_boxes):
        for i in range(rows_of_boxes - row):
            x = (i - (rows_of_boxes - row - 1) / 2) * 1.05 * side
            bodies.append({"name": f"{row}.{i}", "polygon": box(x - side / 2, row * side, x + side / 2, (row + 1) * side)})
    free = [b["name"] for b in bodies[1:]]
    rows = []
    for scheme, stiffness in (("verlet", 1e8), ("auto", 1e8), ("auto", 1e10)):
        seconds = 5 if scheme == "verlet" else 50

        def run(end, scheme=scheme, stiffness=stiffness):
            scene = scene_of(bodies, end, stiffness, friction, (0, -GRAVITY), scheme=scheme, start="settled")
            return programs.run(scene, track=free, interval=1)

        (short, _), (whole, tables) = run(1), run(1 + seconds)
        a, b = tables["history"][-2:]
        way = max(math.hypot(a[f"{n}.x"] - b[f"{n}.x"], a[f"{n}.y"] - b[f"{n}.y"]) for n in free)
        demand(way < 1e-9, f"the pile creeps with the scheme {scheme}")
        rows.append([f"Apothem, {scheme}, k_n = {power_of_ten(stiffness)} Pa",
                     milliseconds((whole["processor_time"] - short["processor_time"]) / seconds), f"{whole['largest_penetration']:.2g}", f"{way:.2g}"])
    for step in BOX2D_STEPS if programs.box2d else []:
        scene = scene_of(bodies, 3, 1e8, friction, (0, -GRAVITY))
        result = programs.run_box2d(scene, step, 3.0, 0.0, 2.0)
        rows.append([f"Box2D, step 1/{round(1 / step)} s", milliseconds(result["processor_time_at_rest"]), f"{result['depth']:.2g}",
                     f"{result['way']:.2g}"])
    table("A pyramid of 465 boxes at rest",
          ["program", "ms per simulated s", "deepest overlap, m", "largest way of a box in a second, m"], rows)


def cantilever(programs):
    """A cantilever of 10 m x 1 m in plane strain with large deflections, on the same mesh."""
    young, poisson, traction, load_steps = 20e9, 0.2, -1.5e7, 5
    rows = []
    for nx, ny in ((100, 10), (200, 20), (400, 40)):
        scene = {"materials": {"m": {"density": 2000, "young": young, "poisson": poisson, "plane": "strain"}},
                 "bodies": [{"name": "beam", "material": "m",
                             "mesh": {"rectangle": {"size": [10, 1], "cells": [nx, ny]}, "element": "Q4-full"},
                             "supports": [{"where": {"x": 0}, "fix": ["x", "y"]}],
                             "loads": [{"where": {"group": "right"}, "traction": [0, traction],
                                        "history": [[0, 0], [1, 1]]}]}],
                 "time": {"mode": "static", "end": 1, "load_steps": load_steps},
                 "output": {"history": {"track": [{"body": "beam", "point": [10, 0.5], "name": "tip"}]}}}
        out = programs.path("run")
        shutil.rmtree(out, ignore_errors=True)
        subprocess.run([programs.apothem, "run", programs.write(scene), "-o", out], check=True, capture_output=True)
        with open(os.path.join(out, "history.csv"), newline="", encoding="utf-8") as lines:
            last = list(csv.DictReader(lines))[-1]
        with open(os.path.join(out, "run.json"), encoding="utf-8") as file:
            seconds = json.load(file)["processor_time"]
        deflection = next(float(v) for k, v in last.items() if k.startswith("tip.uy"))
        rows.append([f"Apothem, {nx * ny} elements", f"{seconds:.2f}", f"{deflection:.6f}"])
        if not programs.ccx:
            continue
        node = lambda i, j: j * (nx + 1) + i + 1
        lines = ["*NODE,NSET=ALL"]
        lines += [f"{node(i, j)},{10 * i / nx},{j / ny},0." for j in range(ny + 1) for i in range(nx + 1)]
        lines += ["*ELEMENT,TYPE=CPE4,ELSET=E"]
        lines += [f"{j * nx + i + 1},{node(i, j)},{node(i + 1, j)},{node(i + 1, j + 1)},{node(i, j + 1)}"
                  for j in range(ny) for i in range(nx)]
        lines += ["*NSET,NSET=FIX"] + [f"{node(0, j)}," for j in range(ny + 1)]
        lines += ["*NSET,NSET=TIP", f"{node(nx, ny // 2)},", "*MATERIAL,NAME=M", "*ELASTIC", f"{young},{poisson}",
                  "*SOLID SECTION,ELSET=E,MATERIAL=M", "1.", "*BOUNDARY", "FIX,1,2", "*STEP,NLGEOM,INC=100",
                  "*STATIC,DIRECT", f"{1 / load_steps},1.", "*CLOAD"]
        lines += [f"{node(nx, j)},2,{traction * (0.5 if j in (0, ny) else 1) / ny}" for j in range(ny + 1)]
        lines += ["*NODE PRINT,NSET=TIP", "U", "*END STEP"]
        with open(programs.path("beam.inp"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([programs.ccx, "beam"], cwd=programs.folder, check=True, capture_output=True,
                       env=dict(os.environ, OMP_NUM_THREADS="1"))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        with open(programs.path("beam.dat"), encoding="utf-8") as file:
            numbers = [line.split() for line in file if line.strip() and line.split()[0].isdigit()]
        rows.append([f"CalculiX, {nx * ny} elements", f"{seconds:.2f}", f"{float(numbers[-1][2]):.6f}"])
    table("A cantilever with a large deflection, five load steps", ["program", "processor s", "deflection, m"], rows)


SCENES = {"gas": gas, "impacts": impacts, "slope": slope, "pile": pile, "cantilever": cantilever}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--apothem", required=True, help="the program apothem")
    parser.add_argument("--box2d", default="", help="the program apothem_box2d")
    parser.add_argument("--ccx", default=shutil.which("ccx") or "", help="CalculiX (default: ccx, if it is installed)")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(SCENES)}; all if none is given")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.scenes if name not in SCENES]
    if unknown:
        parser.error(f"unknown scene {unknown[0]}; there are {', '.join(SCENES)}")
    programs = Programs(arguments)
    try:
        missing = [name for name, found in (("Box2D", programs.box2d), ("CalculiX", programs.ccx)) if not found]
        if missing:
            print(f"not installed, and left out: {', '.join(missing)} (Debian: libbox2d-dev, calculix-ccx)")
        for name in arguments.scenes or SCENES:
            SCENES[name](programs)
    finally:
        shutil.rmtree(programs.folder, ignore_errors=True)


if __name__ == "__main__":
    main()
