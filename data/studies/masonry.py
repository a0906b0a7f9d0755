#!/usr/bin/env python3
"""Scenes of dry masonry: arches under a lateral acceleration, and walls on a tilting table.

    masonry.py arch N T/R [ANGLE] > arch.json        the angle of embrace in degrees, 180 unless given
    masonry.py wall ROWS BLOCKS MU [WIDTH HEIGHT] > wall.json
    masonry.py thickness N [APOTHEM]                  the least T/R of a semicircle, by runs of the program

See docs/how-to/masonry.md.
"""
import json
import math
import subprocess
import sys
import tempfile

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
