#!/usr/bin/env python3
"""Scenes of dry masonry: arches under a lateral acceleration, and walls on a tilting table.

    masonry.py arch N T/R [ANGLE] > arch.json        the angle of embrace in degrees, 180 unless given
    masonry.py wall ROWS BLOCKS MU [WIDTH HEIGHT] > wall.json
    masonry.py thickness N [APOTHEM]                  the least T/R of a semicircle of N voussoirs, by runs of the
                                                      program

See docs/how-to/masonry.md.
"""
import json
import math
import subprocess
import sys
import tempfile
import os

DENSITY = 2500
GRAVITY = 9.81


def arch_rings(n, thickness, angle=math.pi, radius=10.):
    """Rings of two springings and of n voussoirs, from right to left. Joints are radial and equally spaced. The
    corners lie on two circles, so that `thickness` (over the mean radius) is the length of the joints."""
    inner, outer = radius * (1 - thickness / 2), radius * (1 + thickness / 2)
    at = [math.pi / 2 - angle / 2 + angle * i / n for i in range(n + 1)]

    def point(r, a):
        return [r * math.cos(a), r * math.sin(a)]

    deep = radius * thickness
    rings = []
    for a, side in ((at[0], -1), (at[-1], 1)):
        # A block beyond the joint; it reaches past both ends of it.
        p, q = point(inner - deep, a), point(outer + deep, a)
        away = [-side * math.sin(a) * deep, side * math.cos(a) * deep]
        ring = [p, q, [q[0] + away[0], q[1] + away[1]], [p[0] + away[0], p[1] + away[1]]]
        rings.append(ring if side < 0 else ring[::-1])
        if side < 0:
            rings[-1] = rings[-1][::-1]
    for a, b in zip(at, at[1:]):
        rings.append([point(inner, a), point(outer, a), point(outer, b), point(inner, b)])
    return rings


def area(ring):
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(ring, ring[1:] + ring[:1])) / 2


def scene(name, bodies, friction, gravity, stiffness=1e9, end=1):
    return {
        "name": name,
        "gravity": gravity,
        "materials": {"rock": {"density": DENSITY}},
        "contact": {"normal_stiffness": stiffness, "rigid": True, "friction": {"coefficient": friction}},
        "bodies": bodies,
        "time": {"mode": "static", "end": end, "load_steps": "auto"},
    }


def arch(n, thickness, angle=math.pi, radius=10., friction=1.):
    """The load factor is the lateral acceleration over g."""
    rings = arch_rings(n, thickness, angle, radius)
    rings = [r if area(r) > 0 else r[::-1] for r in rings]
    bodies = [{"name": name, "material": "rock", "motion": "fixed", "polygon": ring}
              for name, ring in zip(("right", "left"), rings)]
    bodies += [{"name": f"voussoir {i}", "material": "rock", "polygon": ring} for i, ring in enumerate(rings[2:])]
    return scene(f"arch-{n}", bodies, friction,
                 [[0, -GRAVITY], {"value": [GRAVITY, 0], "history": [[0, 0], [1, 1]]}])


def wall_rings(rows, blocks, width=.4, height=.2):
    """A ground and a wall in running bond: every second row begins and ends with half a block."""
    length = blocks * width
    rings = [[[-length, -4 * height], [2 * length, -4 * height], [2 * length, 0], [-length, 0]]]
    for row in range(rows):
        cuts = [i * width for i in range(blocks + 1)]
        if row % 2:
            cuts = [0] + [(i + .5) * width for i in range(blocks)] + [length]
        for a, b in zip(cuts, cuts[1:]):
            rings.append([[a, row * height], [b, row * height], [b, (row + 1) * height], [a, (row + 1) * height]])
    return rings


def wall(rows, blocks, friction, width=.4, height=.2):
    """The load factor is the angle of the table in rad."""
    rings = wall_rings(rows, blocks, width, height)
    bodies = [{"name": "table", "material": "rock", "motion": "fixed", "polygon": rings[0]}]
    bodies += [{"name": f"block {i}", "material": "rock", "polygon": ring} for i, ring in enumerate(rings[1:])]
    return scene("wall", bodies, friction,
                 {"value": [0, -GRAVITY], "direction_history": [[0, 0], [1.5, 1.5]]}, end=1.5)


def stands(n, thickness, stiffness, program):
    """Whether a semicircle of this thickness carries its own weight, by a static run; None if the run finds neither an
    equilibrium nor a mechanism, as it may happen next to the limit."""
    scene_ = arch(n, thickness)
    scene_["gravity"] = [0, -GRAVITY]
    scene_["contact"] = {"normal_stiffness": stiffness, "friction": {"coefficient": 1}}
    scene_["output"] = {"history": {"track": []}}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "arch.json")
        with open(path, "w") as file:
            json.dump(scene_, file)
        done = subprocess.run([program, "run", path, "-o", os.path.join(folder, "out"), "--quiet"],
                              capture_output=True, text=True, check=False)
    if done.returncode == 3 and "collapses at load factor" in done.stderr:
        return False
    if done.returncode == 3 and "finds no equilibrium" in done.stderr:
        return None
    if done.returncode != 0:
        sys.exit(done.stderr)
    return True


def least_at(n, stiffness, program, tolerance=5e-6):
    """The least T/R at one stiffness, and how exactly it is known, by bisection. It ends early where a run does not tell."""
    low, high = .09, .14
    while high - low > tolerance:
        middle = (low + high) / 2
        verdict = stands(n, middle, stiffness, program)
        if verdict is None:
            break
        if verdict:
            high = middle
        else:
            low = middle
    return (low + high) / 2, (high - low) / 2


def extrapolate(values):
    """The parabola in k_n^(-1/3) through three values, each with ten times the stiffness of the one before."""
    x = [10**(-i / 3) for i in range(3)]
    weights = [math.prod(b / (b - a) for b in x if b != a) for a in x]
    return (sum(w * value for w, (value, _) in zip(weights, values)),
            sum(abs(w) * error for w, (_, error) in zip(weights, values)))


def least_thickness(n, program):
    """The least T/R for rigid voussoirs, its error, and the values at the stiffnesses that it is from."""
    values = [least_at(n, k, program) for k in (1e9, 1e10, 1e11, 1e12)]
    value, error = extrapolate(values[1:])
    return value, error + abs(value - extrapolate(values[:3])[0]), [v for v, _ in values]


def main():
    words = sys.argv[1:]
    if len(words) >= 3 and words[0] == "arch":
        angle = math.radians(float(words[3])) if len(words) > 3 else math.pi
        print(json.dumps(arch(int(words[1]), float(words[2]), angle), indent=1))
    elif len(words) >= 4 and words[0] == "wall":
        print(json.dumps(wall(int(words[1]), int(words[2]), *map(float, words[3:])), indent=1))
    elif len(words) >= 2 and words[0] == "thickness":
        value, error, each = least_thickness(int(words[1]), words[2] if len(words) > 2 else "apothem")
        print(f"least T/R {value:.6f} +- {error:.6f}; with k_n 1e9 to 1e12: " + ", ".join(f"{t:.5f}" for t in each))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
