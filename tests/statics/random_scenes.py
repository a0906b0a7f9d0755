"""Random static scenes against limit analysis: usage: random_scenes.py PROGRAM [COUNT].

Piles, walls, arches, wedges and cut rectangles of rigid blocks, and meshed blocks, each under its weight and a horizontal
acceleration, in a static run or a settled start; k_n from 1e5 to 1e13 Pa, friction from 0 to 1.5, ratios of density up to
1e6. The program must find an equilibrium, in which the forces on each body balance, or refuse the scene with a reason.
Whether rigid blocks can be in equilibrium is known from the linear program of masonry/limit_analysis.py: none may be found
where it has none, unless a body has moved to where it has one, and nothing that stands by 5 % of the weight may be refused,
unless its contacts are soft. COUNT is 24, or 200 with APOTHEM_LONG=1. Ends with 77 where NumPy or SciPy is not installed.
"""
import collections
import csv
import json
import math
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "masonry"))
sys.path.insert(0, os.path.join(HERE, "..", "..", "data", "studies"))
try:
    import limit_analysis
except ImportError as error:
    print(error)
    sys.exit(77)
import masonry  # noqa: E402

GRAVITY = 9.81
LONGEST = 60  # s of processor time


def box(x, y, w, h):
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


def pile(rng):
    """Blocks of random sizes and densities on each other, some of them too far out."""
    rings, y, x = [box(-20, -1, 40, 1)], 0, 0
    for _ in range(rng.randint(2, 14)):
        w, h = rng.uniform(.4, 1.2), rng.uniform(.2, .8)
        x += rng.uniform(-.25, .25) * w
        rings.append(box(x - w / 2, y, w, h))
        y += h
    return rings, 1


def wall(rng):
    rings = masonry.wall_rings(rng.randint(2, 7), rng.randint(2, 4), rng.uniform(.3, .6), rng.uniform(.15, .3))
    return rings, 1


def arch(rng):
    rings = masonry.arch_rings(rng.randint(4, 18), rng.uniform(.08, .35), math.radians(rng.uniform(110, 180)), 5.)
    return [r if masonry.area(r) > 0 else r[::-1] for r in rings], 2


def wedge(rng):
    """A block between two slopes."""
    a, b = math.radians(rng.uniform(15, 75)), math.radians(rng.uniform(15, 75))
    h = rng.uniform(.4, 1)
    left, right = [-h / math.tan(a), h], [h / math.tan(b), h]
    rings = [[[0, 0], left, [left[0], -1], [0, -1]][::1], [[0, 0], [0, -1], [right[0], -1], right]]
    top = box(left[0], h, right[0] - left[0], rng.uniform(.1, 1))
    rings = [r if masonry.area(r) > 0 else r[::-1] for r in rings]
    return rings + [[[0, 0], right, left], top], 2


def cut(ring, point, direction):
    """The two parts of a convex ring at a line."""
    n = (-direction[1], direction[0])
    side = [(p[0] - point[0]) * n[0] + (p[1] - point[1]) * n[1] for p in ring]
    parts = ([], [])
    for i, p in enumerate(ring):
        q, s, t = ring[(i + 1) % len(ring)], side[i], side[(i + 1) % len(ring)]
        parts[0 if s >= 0 else 1].append(p)
        if s * t < 0:
            f = s / (s - t)
            x = [p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1])]
            parts[0].append(x)
            parts[1].append(x)
    return parts


def cuts(rng):
    """A rectangle in a box, cut into convex blocks."""
    w, h = rng.uniform(1, 3), rng.uniform(1, 2)
    pieces = [box(0, 0, w, h)]
    for _ in range(rng.randint(3, 16)):
        pieces.sort(key=masonry.area)
        big = pieces.pop()
        c = limit_analysis.centroid(big)[1]
        angle = rng.uniform(0, math.pi)
        pieces += cut(big, [float(c[0]), float(c[1])], (math.cos(angle), math.sin(angle)))
    holders = [box(-1, -1, w + 2, 1), box(-1, 0, 1, h * rng.uniform(.2, 1.2)), box(w, 0, 1, h * rng.uniform(.2, 1.2))]
    return holders + pieces, 3


def soft(rng):
    """Meshed blocks on each other."""
    rings, y = [box(-5, -1, 10, 1)], 0
    w = rng.uniform(.6, 1.2)
    for _ in range(rng.randint(1, 4)):
        h = rng.uniform(.3, .6)
        rings.append(box(-w / 2, y, w, h))
        y += h
    return rings, 1


def stands(blocks, factor):
    """Whether blocks can be in equilibrium under their weight and `factor` of it to the right."""
    try:
        return blocks.largest_factor((factor * GRAVITY, -GRAVITY), (0, 0)) is not None
    except AssertionError:  # It is feasible: nothing limits a factor on no load.
        return True


KINDS = [pile, wall, arch, wedge, cuts, soft]


Case = collections.namedtuple("Case", "kind scene expected masses weight depth size")


def make(seed):
    rng = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    rings, fixed = kind(rng)
    mu = rng.choice([0, rng.uniform(.05, .5), rng.uniform(.3, 1.5)])
    k = 10 ** rng.uniform(5, 13)
    heavy = rng.random() < .3
    density = [2500 * (10 ** rng.uniform(-3, 3) if heavy else 1) for _ in rings]
    masses = [(d * a, c) for d, (a, c) in zip(density, map(limit_analysis.centroid, rings))]
    blocks = limit_analysis.Blocks(rings, list(range(fixed)), mu, masses=masses)
    limit = .3
    if stands(blocks, 0):
        try:
            limit = min(blocks.largest_factor((0, -GRAVITY), (GRAVITY, 0))[0], 3)
        except AssertionError:  # There is no limit.
            limit = 3
    factor = rng.choice([0, limit * rng.uniform(0, .8), limit * rng.uniform(.8, 1.5)])
    verdicts = [stands(blocks, factor + d) for d in (-.05, 0, .05)]
    expected = "stands" if all(verdicts) else "falls" if not any(verdicts) else "limit"
    bodies, materials = [], {}
    young = 10 ** rng.uniform(6, 11)
    for i, ring in enumerate(rings):
        materials[f"m{i}"] = {"density": density[i]}
        body = {"name": f"b{i}", "material": f"m{i}", "polygon": ring}
        if i < fixed:
            body["motion"] = "fixed"
        elif kind is soft and rng.random() < .8:
            materials[f"m{i}"].update({"young": young, "poisson": rng.uniform(0, .45)})
            body["mesh"] = {"fill": {"polygon": body.pop("polygon"), "size": rng.uniform(.12, .4)},
                            "element": rng.choice(["Q4", "T3"])}
        bodies.append(body)
    if kind is soft:
        expected = "unknown"
    step = 1e-6 * min(1, math.sqrt(1e7 / k))
    when = {"end": step, "start": "settled", "step": step} if rng.random() < .4 else \
        {"mode": "static", "end": 1, "load_steps": rng.choice([1, 1, 5])}
    scene = {"name": f"random-{seed}", "gravity": [factor * GRAVITY, -GRAVITY], "materials": materials,
             "contact": {"normal_stiffness": k, "friction": {"coefficient": mu}}, "bodies": bodies, "time": when,
             "output": {"history": {"track": [{"body": body["name"]} for body in bodies[fixed:]]}}}
    weight = sum(m for m, _ in masses[fixed:]) * GRAVITY
    corners = [c for ring in rings[fixed:] for p in ring for c in p]
    return Case(kind.__name__, scene, expected, {i: m for i, (m, _) in enumerate(masses) if i >= fixed}, weight,
                weight / k, max(corners) - min(corners))


def run(program, scene, folder):
    """Exit status and message; the first and the last row of the history of a run that is complete."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as file:
        json.dump(scene, file)
    out = os.path.join(folder, "out")
    done = subprocess.run([program, "run", path, "-o", out, "--quiet"], capture_output=True, text=True, check=False,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST)))
    lines = [line for line in done.stderr.splitlines() if "warning" not in line]
    text = re.sub(r".*scene.json(:\d+)?: ", "", lines[-1] if lines else "")
    if done.returncode != 0:
        return done.returncode, text, None
    with open(os.path.join(out, "history.csv")) as file:
        rows = list(csv.DictReader(file))
    return 0, text, [{key.split(" ")[0]: float(value) for key, value in row.items()} for row in (rows[0], rows[-1])]


REASONS = ("slides on", "tips over", "rolls on", "falls, or flies off", "moves away", "has collapsed", "overlap",
           "out of balance", "has moved")


def faults(case, code, text, rows):
    """What is wrong with the verdict of the program."""
    if code not in (0, 2, 3):
        return [f"it ends with {code}, after more than {LONGEST} s or by a fault"]
    if code:
        found = []
        if '"b' not in text or not any(reason in text for reason in REASONS):
            found.append("it names no body or no reason")
        if case.expected == "stands" and case.depth < 1e-3:
            found.append("it is refused, although it stands")
        return found
    found, first, last = [], *rows
    moved = 0
    for i, mass in case.masses.items():
        name = f"b{i}"
        k = case.scene["contact"]["normal_stiffness"]
        allowed = 1e-5 * mass * GRAVITY + 1e-5 * case.weight + 1e-14 * k * case.size  # the last: rounding of places
        off = math.hypot(last[f"{name}.fx"] + mass * case.scene["gravity"][0], last[f"{name}.fy"] - mass * GRAVITY)
        if off > allowed:
            found.append(f"{name} is out of balance by {off:.3g} N, {allowed:.3g} N are allowed")
        moved = max(moved, *(abs(last[f"{name}.{x}"] - first[f"{name}.{x}"]) for x in "xy"))
    # One that slides until it meets something else has found its equilibrium there.
    if case.expected == "falls" and moved < 1e-2 * case.size and case.depth < 1e-3:
        found.append("it has an equilibrium where limit analysis has none")
    return found


def main():
    program = sys.argv[1]
    long = os.environ.get("APOTHEM_LONG", "0") not in ("", "0")
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 200 if long else 24
    first = 1000 * int(os.environ.get("APOTHEM_SEED", "0") or 0)
    print(f"{count} scenes from seed {first} on")
    wrong, table = 0, collections.Counter()
    for seed in range(first, first + count):
        case = make(seed)
        with tempfile.TemporaryDirectory() as folder:
            code, text, rows = run(program, case.scene, folder)
        table[case.kind, case.expected, "found" if code == 0 else "refused"] += 1
        for fault in faults(case, code, text, rows):
            wrong += 1
            print(f"seed {seed} ({case.kind}, {case.expected}, "
                  f"k_n = {case.scene['contact']['normal_stiffness']:.1e} Pa): {fault}: {text}")
    for row, number in sorted(table.items()):
        print(*row, number)
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main())
