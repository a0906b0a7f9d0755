#!/usr/bin/env python3
"""What the choice of a key costs: times of small runs that differ in one key, over that of its first value.

    choices.py [--program FILE] [--repeat N] [--only KEY]

Runs with the values of a key take turns, on one core; a ratio is the median of those of N turns (3), and stands behind
the key in the order of its values. docs/user-guide.md has them as a table.
"""

import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import tempfile

DATA = pathlib.Path(__file__).resolve().parent.parent
PACK = ("studies/pack.json", {"fill.0.count": 100, "time.end": 0.6})
BLOCK = ("scenes/block-on-foundation.json", {})
CROSSES = {"fill.0.shapes": [{"cross": {}}]}
DASHPOT = {"model": "normal_viscous", "ratio": 0.5}


def regular(sides):
    return [[math.cos(2 * math.pi * k / sides), math.sin(2 * math.pi * k / sides)] for k in range(sides)]


def element(kind):
    return {"bodies.block.mesh.element": kind, "bodies.foundation.mesh.element": kind}


# Name of a row, scene, what all of its runs have, and what each of them has besides.
ROWS = [
    ("contact.normal_stiffness", PACK, {}, [{"contact.normal_stiffness": k} for k in (2e6, 2e7, 2e8)]),
    ("time.accuracy", PACK, {}, [{"time.accuracy": a} for a in (0.1, 0.03, 0.01)]),
    ("time.onsets", PACK, {}, [{"time.onsets": o} for o in ("plain", "corrected")]),
    ("contact.friction.coefficient", PACK, {}, [{"contact.friction.coefficient": m} for m in (0, 0.5)]),
    ("contact.friction.law", PACK, {"contact.damping": DASHPOT},
     [{"contact.friction.law": law} for law in ("resultant", "per_edge")]),
    ("contact.damping.model", PACK, {}, [{"contact.damping.model": m} for m in ("viscous", "normal_viscous")]),
    ("fill.0.shapes", PACK, {}, [{"fill.0.shapes": [shape]} for shape in (
        {"quadrilateral": {}}, {"polygon": regular(6)}, {"polygon": regular(12)}, {"cross": {}})]),
    ("contact.field", PACK, CROSSES, [{"contact.field": f} for f in ("roof", "distance")]),
    ("contact.surface", BLOCK, {}, [{}, {"contact.surface": "element", "contact.distribution": "resultant"}]),
    ("element", BLOCK, {}, [element(kind) for kind in ("Q4", "T3", "Q4-full")]),
    ("law", BLOCK, {}, [{"materials.rock.law": law} for law in ("st_venant_kirchhoff", "neo_hookean")]),
    ("contact.self_contact", BLOCK, {}, [{"contact.self_contact": c} for c in ("refuse", "compute")]),
]
OF_A_STEP = ["fill.0.shapes"]  # whose runs are of different physics: the time of a step counts


def seconds(program, scene, settings, of_a_step):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", str(DATA / scene), "-o", folder, "--overwrite", "--threads", "1"]
        for path, value in settings.items():
            command += ["--set", f"{path}={json.dumps(value)}"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"choices.py: '{' '.join(command)}' ended with exit code {done.returncode}:\n{done.stdout}")
        run = json.loads((pathlib.Path(folder) / "run.json").read_text(encoding="utf-8"))
    time = run["wall_time"]["total"] - run["wall_time"]["output"]
    return time / run["steps"] if of_a_step else time


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.environ.get("APOTHEM_PROGRAM", "apothem"))
    parser.add_argument("--repeat", type=int, default=3, metavar="N")
    parser.add_argument("--only", choices=[row[0] for row in ROWS], help="one row")
    args = parser.parse_args()
    for name, (scene, base), common, values in ROWS:
        if args.only not in (None, name):
            continue
        turns = [[seconds(args.program, scene, {**base, **common, **value}, name in OF_A_STEP) for value in values]
                 for _ in range(args.repeat)]
        ratios = [statistics.median(turn[k] / turn[0] for turn in turns) for k in range(len(values))]
        print(f"{name}: " + " ".join(f"{ratio:.3f}" for ratio in ratios), flush=True)


if __name__ == "__main__":
    main()
