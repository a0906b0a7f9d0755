"""Collapse of dry masonry against limit analysis: usage: collapse.py [all] PROGRAM.

The program's load factors, in the limit of rigid bodies, are compared with the linear program of limit_analysis.py for the
same polygons, and its mechanisms with the hinges of that program. With `all`, all rows of the table in
docs/verification.md are computed and printed. Ends with 77 where NumPy or SciPy is not installed.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np

    import limit_analysis
except ImportError as error:
    print(error)
    sys.exit(77)

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "data", "studies"))
import masonry  # noqa: E402

LATERAL = (masonry.GRAVITY, 0)
DEAD = (0, -masonry.GRAVITY)
TABLE = ["| case | ours | limit analysis | difference |", "| --- | --- | --- | --- |"]


def add_row(case, ours, exact, error, kind=""):
    TABLE.append(f"| {case} | {ours} | {exact:.6f}{kind} | {100 * error:.3f} % |")


def with_bounds(collapse):
    return f"{collapse['factor']:.6f} ({collapse['lower']:.6f} to {collapse['upper']:.6f})"


def run(program, scene):
    """run.json of a scene."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.json")
        with open(path, "w") as file:
            json.dump(scene, file)
        done = subprocess.run([program, "run", path, "-o", os.path.join(folder, "out"), "--quiet"],
                              capture_output=True, text=True, check=False)
        # The scene does not promise its collapse.
        assert done.returncode in (0, 3), done.stderr
        with open(os.path.join(folder, "out", "run.json")) as file:
            return json.load(file)


def blocks_of(scene):
    rings = [body["polygon"] for body in scene["bodies"]]
    fixed = [i for i, body in enumerate(scene["bodies"]) if body.get("motion") == "fixed"]
    return limit_analysis.Blocks(rings, fixed, scene["contact"]["friction"]["coefficient"])


def with_meshes(scene, every, size):
    """The scene with every n-th free block of stiff finite elements; all of them if every is 1."""
    for material in scene["materials"].values():
        material.update({"young": 1e11, "poisson": 0.2})
    for i, body in enumerate(scene["bodies"]):
        if body.get("motion") != "fixed" and i % every == 0:
            body["mesh"] = {"fill": {"polygon": body.pop("polygon"), "size": size}}
    return scene


def of_meshes(every):
    return ["", " of finite elements", ", every second one of finite elements"][every]


def sector_masses(n, thickness, angle=math.pi, radius=10.):
    """Mass and centroid of voussoirs with curved faces, after those of the springings."""
    inner, outer, half = radius * (1 - thickness / 2), radius * (1 + thickness / 2), angle / n / 2
    mass = masonry.DENSITY * half * (outer**2 - inner**2)
    r = 2 / 3 * math.sin(half) / half * (outer**3 - inner**3) / (outer**2 - inner**2)
    at = [math.pi / 2 - angle / 2 + (2 * i + 1) * half for i in range(n)]
    return [(0, (0, 0))] * 2 + [(mass, (r * math.cos(a), r * math.sin(a))) for a in at]


def hinges(rotations):
    """Numbers of the joints of an arch, from its right springing on, where a mechanism turns, and the sense."""
    jumps = np.diff(np.concatenate([[0], rotations, [0]]))
    return [(i, int(np.sign(j))) for i, j in enumerate(jumps) if abs(j) > 0.05 * np.abs(jumps).max()]


def check_arch(program, n, thickness, degrees, meshed=0):
    scene = masonry.arch(n, thickness, math.radians(degrees))
    exact, mechanism = blocks_of(scene).largest_factor(DEAD, LATERAL)
    found = run(program, with_meshes(scene, meshed, .8) if meshed else scene)
    collapse = found["collapse"]
    moved = {body["body"]: body["angle"] for body in collapse["bodies"]}
    angles = np.array([moved.get(f"voussoir {i}", 0.) for i in range(n)])
    wanted, got = hinges(-mechanism[:, 2]), hinges(angles)
    if [s for _, s in wanted] != [s for _, s in got]:
        wanted = hinges(mechanism[:, 2])  # multipliers are known but for their sign
    error = collapse["factor"] / exact - 1
    print(f"arch of {n}, t/R {thickness:g}, {degrees:g} degrees{of_meshes(meshed)}: {collapse['factor']:.6f} "
          f"({collapse['lower']:.6f} to {collapse['upper']:.6f}), limit analysis {exact:.6f}, {100 * error:+.3f} %; "
          f"hinges at joints {[i for i, _ in got]}, limit analysis {[i for i, _ in wanted]}; "
          f"{found['processor_time']:.1f} s", flush=True)
    add_row(f"arch of {degrees:g} degrees, {n} voussoirs{of_meshes(meshed)}, joints {thickness:g} of the mean radius: lateral "
            "acceleration over g",
            with_bounds(collapse), exact, error)
    assert abs(error) < 0.005
    assert got == wanted
    assert len(got) == 4


def check_wall(program, rows, blocks, friction, width=.4, height=.2, closed_form=None, meshed=0):
    scene = masonry.wall(rows, blocks, friction, width, height)
    exact = math.atan(blocks_of(scene).largest_factor(DEAD, (-masonry.GRAVITY, 0))[0])
    found = run(program, with_meshes(scene, meshed, .1) if meshed else scene)
    collapse = found["collapse"]
    error = collapse["factor"] / exact - 1
    print(f"wall of {rows} rows, {blocks} blocks of {width:g} m x {height:g} m each{of_meshes(meshed)}, mu {friction:g}: "
          f"{collapse['factor']:.6f} rad ({collapse['lower']:.6f} to {collapse['upper']:.6f}), limit analysis {exact:.6f}"
          f"{'' if closed_form is None else f', closed form {closed_form:.6f}'}, {100 * error:+.3f} %; "
          f"{found['processor_time']:.1f} s", flush=True)
    add_row(f"wall of {rows} rows of {blocks} blocks of {width:g} m x {height:g} m{of_meshes(meshed)}, friction {friction:g}, "
            "on a tilting table, rad",
            with_bounds(collapse), exact, error, ", an upper bound" if closed_form is None else ", closed form")
    if closed_form is not None:
        assert abs(exact / closed_form - 1) < 1e-6
    assert abs(error) < 0.01
    return collapse["factor"], exact


def check_masses():
    """The two values of this arch in circulation, 0.3736 and 0.3700, are those of voussoirs with straight and with
    curved faces."""
    scene = masonry.arch(7, .15, math.radians(157.5))
    straight = blocks_of(scene).largest_factor(DEAD, LATERAL)[0]
    blocks = blocks_of(scene)
    blocks.masses = sector_masses(7, .15, math.radians(157.5))
    curved = blocks.largest_factor(DEAD, LATERAL)[0]
    print(f"arch of 7: {straight:.6f} with straight faces, {curved:.6f} with curved ones")
    assert abs(straight - .373612) < 1e-6 and abs(curved - .370010) < 1e-6


def check_thickness(program, n):
    def make(thickness):
        return blocks_of(masonry.arch(n, thickness))

    def make_curved(thickness):
        blocks = make(thickness)
        blocks.masses = sector_masses(n, thickness)
        return blocks

    exact = limit_analysis.least_thickness(make, .05, .2)
    curved = limit_analysis.least_thickness(make_curved, .05, .2)
    value, error, each = masonry.least_thickness(n, program)
    print(f"least t/R of a semicircle of {n}: {value:.6f} +- {error:.6f} "
          f"(k_n 1e9 to 1e12: {', '.join(f'{t:.5f}' for t in each)}), limit analysis {exact:.6f}, "
          f"{100 * (value / exact - 1):+.3f} %; with curved faces {curved:.6f}", flush=True)
    add_row(f"semicircle of {n} voussoirs: least length of joints over the mean radius", f"{value:.6f} ± {error:.6f}", exact,
            value / exact - 1)
    assert abs(value / exact - 1) < 0.005


def main():
    program = sys.argv[-1]
    check_masses()
    # A column that topples as a whole; a wall that slides as a whole.
    check_wall(program, 1, 1, .8, .4, 1, closed_form=math.atan(.4))
    check_wall(program, 3, 2, .3, closed_form=math.atan(.3))
    check_wall(program, 3, 2, .3, closed_form=math.atan(.3), meshed=2)
    check_arch(program, 7, .15, 157.5)
    check_arch(program, 7, .15, 157.5, meshed=1)
    if sys.argv[1:-1] != ["all"]:
        return
    check_wall(program, 2, 1, .8, .4, .5, closed_form=math.atan(.4))
    check_wall(program, 6, 5, .6)
    for n in (9, 15, 27):
        check_arch(program, n, .15, 157.5)
    check_arch(program, 27, .15, 180)
    check_arch(program, 27, .2, 180)
    for n in (8, 16, 32):
        check_thickness(program, n)
    print("\n".join(TABLE))


if __name__ == "__main__":
    main()
