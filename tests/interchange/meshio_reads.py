#!/usr/bin/env python3
"""meshio reads every kind of file in frames/, with and without cells, and names.csv names what they number. Called with
the program; ends with 77 where meshio is missing."""

import collections
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import meshio
    import numpy
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-meshio)")
    sys.exit(77)

# A stone falls beside an L onto a mesh, and leaves the world at the end; there is no contact at the start.
SCENE = {
    "gravity": [0, -10],
    "materials": {"rock, \"hard\"": {"density": 2000}, "Ton": {"density": 2000, "young": 1e8, "poisson": 0.3}},
    "contact": {"normal_stiffness": 1e7, "friction": {"coefficient": 0.3}},
    "bodies": [
        {"name": "floor", "material": "rock, \"hard\"", "motion": "fixed", "polygon": [[-3, -1], [9, -1], [9, 0], [-3, 0]]},
        {"name": "L-förmig", "material": "rock, \"hard\"",
         "polygon": [[4, 0.05], [6, 0.05], [6, 0.5], [4.5, 0.5], [4.5, 2], [4, 2]]},
        {"name": "stone", "material": "rock, \"hard\"", "polygon": [[0.3, 1.02], [1.3, 1.02], [1.3, 1.5], [0.8, 1.8]]},
        {"name": "sheet", "material": "Ton", "mesh": {"rectangle": {"size": [2, 1], "cells": [4, 2]}},
         "supports": [{"where": {"y": 0}, "fix": ["x", "y"]}]}],
    "regions": {"bin": {"polygon": [[-1, -1], [8, -1], [8, 3], [-1, 3]]}, "right": {"polygon": [[3, -1], [8, -1], [8, 3]]}},
    "time": {"end": 0.2},
    "output": {"frames": 8},
}
# One body alone that flies out of the world, which leaves frames without anything.
EMPTY = {
    "materials": {"rock": {"density": 2000}},
    "bodies": [{"name": "stone", "material": "rock", "velocity": [10, 0], "polygon": [[0, 0], [1, 0], [0, 1]]}],
    "world": {"box": [[-2, -2], [3, 3]], "outside": "remove"},
    "time": {"end": 1}, "output": {"frames": 4},
}
LINES = {"line"}
CELLS = {"bodies": {"polygon"}, "outlines": LINES, "chains": LINES, "roses": LINES, "surfaces": LINES,
         "contacts": {"vertex"}}


def main():
    program = sys.argv[1]
    faults = []
    seen = collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        for scene_name, scene in (("scene", SCENE), ("empty", EMPTY)):
            path = pathlib.Path(name) / f"{scene_name}.json"
            path.write_text(json.dumps(scene))
            out = pathlib.Path(name) / scene_name
            result = subprocess.run([program, "run", path, "-o", out, "--quiet"], capture_output=True, text=True, check=False)
            if result.returncode != 0:
                print(result.stderr)
                return 1
            for file in sorted((out / "frames").glob("*.vtu")):
                kind = file.name.rsplit("_", 1)[0]
                try:
                    mesh = meshio.read(file)
                except (SystemExit, Exception) as error:
                    faults.append(f"{scene_name}/{file.name}: {error!r}")
                    continue
                empty = len(mesh.points) == 0
                seen[kind, "empty" if empty else "full"] += 1
                types = {block.type for block in mesh.cells}
                if types != ({"polygon"} if empty else CELLS[kind]):
                    faults.append(f"{scene_name}/{file.name}: cells {types}")
                if "TimeValue" not in mesh.field_data:
                    faults.append(f"{scene_name}/{file.name}: no TimeValue in {list(mesh.field_data)}")
                values = [*mesh.point_data.values()]
                if any(len(array) != len(mesh.points) for array in values):
                    faults.append(f"{scene_name}/{file.name}: arrays of other lengths than the points")
                if not empty and kind == "bodies":
                    numbers = numpy.concatenate([b.ravel() for b in mesh.cell_data["body"]])
                    present = set(numbers.tolist())
                    if not present <= set(range(len(scene["bodies"]))):
                        faults.append(f"{scene_name}/{file.name}: bodies {present}")
            with open(out / "names.csv", newline="", encoding="utf-8") as table:
                rows = list(csv.DictReader(table))
            bodies = {int(r["number"]): r["name"] for r in rows if r["kind"] != "material"}
            materials = {int(r["number"]): r["name"] for r in rows if r["kind"] == "material"}
            meshed = [r["name"] for r in rows if r["kind"] == "deformable_body"]
            if bodies != dict(enumerate(b["name"] for b in scene["bodies"])):
                faults.append(f"{scene_name}: names {bodies}")
            if sorted(materials.values()) != sorted(scene["materials"]):
                faults.append(f"{scene_name}: materials {materials}")
            if meshed != [b["name"] for b in scene["bodies"] if "mesh" in b]:
                faults.append(f"{scene_name}: meshes {meshed}")
    print(dict(seen))
    # Every kind with cells, and those without that a run can have.
    for kind in CELLS:
        if seen[kind, "full"] == 0:
            faults.append(f"no file of {kind} with cells")
    for kind in ("bodies", "outlines", "chains", "contacts"):
        if seen[kind, "empty"] == 0:
            faults.append(f"no file of {kind} without cells")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
