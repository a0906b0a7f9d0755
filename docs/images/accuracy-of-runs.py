"""Energy error against the number of steps of three scenes, as programs choose the step by `time.accuracy`:

    python3 docs/images/accuracy-of-runs.py [--picture FILE] NAME=PROGRAM [NAME=PROGRAM ...]

runs a gas of polygons, a pack that comes to rest and a cradle with each of the programs, at accuracies of 1e-2 to
1e-6, prints a table and draws it where a picture is asked for. Of the gas and the cradle the error is the largest
total error in energy.csv of rows in which no bodies touch, over the kinetic energy at the start; of the pack it is the
largest of all rows, over the energy that friction and damping have taken. Every number is the median of five runs
that begin differently.
"""

import argparse
import csv
import json
import math
import random
import statistics
import subprocess
import tempfile
from pathlib import Path

ACCURACIES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]


def regular(corners, radius, angle=0.0):
    turns = [angle + 2 * math.pi * i / corners for i in range(corners)]
    return [[radius * math.cos(t), radius * math.sin(t)] for t in turns]


def body(name, polygon, **more):
    return {"name": name, "material": "rock", "polygon": polygon, **more}


def scene(contact, bodies, end, gravity=(0, 0)):
    return {
        "gravity": list(gravity),
        "materials": {"rock": {"density": 2000}},
        "contact": {"normal_stiffness": 2e8, **contact},
        "bodies": bodies,
        "time": {"end": end},
        "output": {"frames": 1, "history": {"interval": end / 200, "track": [{"body": bodies[-1]["name"]}]}},
    }


def walls(size):
    half, thick = size / 2, 1
    sides = {"left": (-half - thick, -half - thick, -half, half + thick), "right": (half, -half - thick, half + thick, half + thick),
             "low": (-half, -half - thick, half, -half), "high": (-half, half, half, half + thick)}
    return [body(name, [[a, b], [c, b], [c, d], [a, d]], motion="fixed") for name, (a, b, c, d) in sides.items()]


def gas(seed):
    draw = random.Random(seed)
    bodies = walls(6)
    for i in range(16):
        place = [-2.25 + 1.5 * (i % 4), -2.25 + 1.5 * (i // 4)]
        bodies.append(body(f"p{i}", regular(draw.randint(3, 8), 0.5), position=place, angle=draw.uniform(0, 6),
                           velocity=[draw.uniform(-3, 3), draw.uniform(-3, 3)], spin=draw.uniform(-3, 3)))
    return scene({}, bodies, 3)


def pack(seed):
    draw = random.Random(seed)
    bodies = walls(6)
    for i in range(64):
        place = [-2.6 + 0.74 * (i % 8), -2.6 + 0.74 * (i // 8)]
        bodies.append(body(f"q{i}", regular(4, 0.34), position=place, angle=draw.uniform(0, 6)))
    damping = {"model": "viscous", "ratio": 0.1}
    return scene({"friction": {"coefficient": 0.4}, "damping": damping}, bodies, 1.5, (0, -10))


def cradle(seed):
    draw = random.Random(seed)
    bodies = walls(8)
    for i in range(5):
        velocity = [draw.uniform(1, 3), 0] if i == 0 else [0, 0]
        bodies.append(body(f"c{i}", regular(50, 0.5), position=[-2.5 + 1.2 * i, 0], velocity=velocity))
    return scene({}, bodies, 5)


def run(program, setup, accuracy):
    setup["time"]["accuracy"] = accuracy
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "scene.json")
        file.write_text(json.dumps(setup))
        out = Path(folder, "out")
        subprocess.run([program, "run", file, "-o", out, "--quiet"], capture_output=True, check=True)
        summary = json.loads((out / "run.json").read_text())
        with open(out / "energy.csv") as text:
            rows = list(csv.reader(text))
    names = [name.split(" [")[0] for name in rows[0]]
    rows = [dict(zip(names, map(float, row))) for row in rows[1:]]
    lost = rows[-1]["friction_loss"] + rows[-1]["damping_loss"]
    error = max(abs(row["total_error"]) for row in rows if lost > 0 or row["contact"] == 0)
    return summary["steps"], error / (lost if lost > 0 else rows[0]["kinetic"])


def middle(program, make, accuracy):
    runs = [run(program, make(seed), accuracy) for seed in range(5)]
    return tuple(statistics.median(values) for values in zip(*runs))


def draw(found, file):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(found), figsize=(4 * len(found), 4), layout="constrained")
    for axis, (title, curves) in zip(axes, found.items()):
        for (name, points), colour, mark in zip(curves.items(), ["#ee6677", "#4477aa", "#228833"], "sov"):
            axis.loglog(*zip(*points), marker=mark, color=colour, label=name)
            for point, accuracy in zip(points, ACCURACIES):
                axis.annotate(f"{accuracy:.0e}", point, textcoords="offset points", xytext=(4, 4), fontsize=7)
        axis.xaxis.set_minor_formatter("")
        axis.set(title=title, xlabel="steps", ylabel="largest energy error")
        axis.grid(color="#dddddd")
        axis.legend(loc="lower left", fontsize=8)
    figure.savefig(file, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", metavar="FILE")
    parser.add_argument("programs", metavar="NAME=PROGRAM", nargs="+")
    options = parser.parse_args()
    programs = dict(argument.split("=", 1) for argument in options.programs)
    scenes = {"gas of 16 polygons": gas, "64 blocks come to rest": pack, "cradle of five 50-gons": cradle}
    found = {title: {} for title in scenes}
    print("| program | run | " + " | ".join(f"{a:.0e}" for a in ACCURACIES) + " |")
    for title, make in scenes.items():
        for name, program in programs.items():
            points = found[title][name] = [middle(program, make, accuracy) for accuracy in ACCURACIES]
            print(f"| {name} | {title}: steps | " + " | ".join(f"{steps}" for steps, _ in points) + " |")
            print(f"| {name} | {title}: error | " + " | ".join(f"{error:.1e}" for _, error in points) + " |", flush=True)
    if options.picture:
        draw(found, options.picture)


main()
