"""Limit analysis of rigid blocks that touch along straight joints.

Joints carry no tension and Coulomb friction (M. Livesley, Limit analysis of structures formed from rigid blocks,
Int. J. Numer. Meth. Eng. 12 (1978) 1853). The largest load factor with any forces in the joints that are in
equilibrium and admissible is a linear program; its multipliers are the mechanism. Slip is taken to open the joint
(associated flow), so that the factor is an upper bound where the mechanism slides, and exact where it rocks.

No line of this file is shared with the program: it is a reference for its tests.
"""
import math

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix


def centroid(polygon):
    """Area (m^2) and centroid (m) of a simple polygon."""
    p = np.asarray(polygon, float)
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    area = cross.sum() / 2
    return area, ((p + q) * cross[:, None]).sum(axis=0) / (6 * area)


def joints(polygons, tolerance=1e-9):
    """Segments that edges of two polygons have in common: (block, block, end, end, normal out of the first)."""
    found = []
    edges = [[(np.asarray(p[i], float), np.asarray(p[(i + 1) % len(p)], float)) for i in range(len(p))]
             for p in polygons]
    boxes = [(np.min(p, axis=0) - 1e-6, np.max(p, axis=0) + 1e-6) for p in polygons]
    for i in range(len(polygons)):
        for j in range(i + 1, len(polygons)):
            if (boxes[i][0] > boxes[j][1]).any() or (boxes[j][0] > boxes[i][1]).any():
                continue
            for a, b in edges[i]:
                length = np.linalg.norm(b - a)
                t = (b - a) / length
                n = np.array([t[1], -t[0]])
                for c, d in edges[j]:
                    if max(abs((c - a) @ n), abs((d - a) @ n)) > tolerance * length or (d - c) @ t >= 0:
                        continue
                    low, high = max(0, (d - a) @ t), min(length, (c - a) @ t)
                    if high - low > 1e-6 * length:
                        found.append((i, j, a + low * t, a + high * t, n))
    return found


class Blocks:
    """`polygons`: rings; `fixed`: numbers of those that stand still; `masses`: kg and centroid of each, else the
    polygons' own with the density."""

    def __init__(self, polygons, fixed, friction, density=2500., masses=None):
        self.polygons = polygons
        self.free = [i for i in range(len(polygons)) if i not in set(fixed)]
        self.friction = friction
        self.joints = joints(polygons)
        if masses is None:
            masses = [(density * a, c) for a, c in map(centroid, polygons)]
        self.masses = masses

    def equations(self):
        """Rows: x, y and moment about the origin of each free block; columns: normal and shear at both ends of each
        joint."""
        place = {b: 3 * k for k, b in enumerate(self.free)}
        rows, columns, values = [], [], []
        column = 0
        for i, j, a, b, n in self.joints:
            t = np.array([-n[1], n[0]])
            for point in (a, b):
                for direction in (-n, t):  # on the first block: pressure, and shear
                    for block, sign in ((i, 1), (j, -1)):
                        if block not in place:
                            continue
                        f = sign * direction
                        for k, v in enumerate((f[0], f[1], point[0] * f[1] - point[1] * f[0])):
                            rows.append(place[block] + k)
                            columns.append(column)
                            values.append(v)
                    column += 1
        return coo_matrix((values, (rows, columns)), shape=(3 * len(self.free), column)).tocsr()

    def load(self, acceleration):
        """Forces of an acceleration of all blocks, like the rows of equations()."""
        result = np.zeros(3 * len(self.free))
        for k, b in enumerate(self.free):
            mass, c = self.masses[b]
            f = mass * np.asarray(acceleration, float)
            result[3 * k:3 * k + 3] = f[0], f[1], c[0] * f[1] - c[1] * f[0]
        return result

    def largest_factor(self, dead, live):
        """The largest factor on the acceleration `live` beside `dead`, and the mechanism: (x, y, angle) of each
        free block about the origin. None if the blocks do not stand at factor 0."""
        a = self.equations()
        count = a.shape[1]
        d, l = self.load(dead), self.load(live)
        scale = np.abs(d).max()
        live_column = coo_matrix((l / scale, (np.arange(len(l)), np.zeros(len(l), int))), shape=(len(l), 1))
        from scipy.sparse import hstack
        equality = hstack([a, live_column]).tocsc()
        half = count // 2
        friction = coo_matrix(
            (np.concatenate([np.ones(half), -np.ones(half), -self.friction * np.ones(2 * half)]),
             (np.concatenate([np.arange(half), half + np.arange(half), np.arange(half), half + np.arange(half)]),
              np.concatenate([2 * np.arange(half) + 1, 2 * np.arange(half) + 1, 2 * np.arange(half),
                              2 * np.arange(half)]))), shape=(2 * half, count + 1))
        cost = np.zeros(count + 1)
        cost[-1] = -1
        bounds = [(0, None), (None, None)] * half + [(0, None)]
        answer = linprog(cost, A_ub=friction, b_ub=np.zeros(2 * half), A_eq=equality, b_eq=-d / scale, bounds=bounds,
                         method="highs", options={"primal_feasibility_tolerance": 1e-10,
                                                  "dual_feasibility_tolerance": 1e-10})
        if answer.status == 2:
            return None
        assert answer.status == 0, answer.message
        return answer.x[-1], answer.eqlin.marginals.reshape(-1, 3)


def least_thickness(make, low, high, tolerance=1e-7):
    """The smallest t for which make(t) stands under its weight alone, by bisection."""
    while high - low > tolerance:
        middle = (low + high) / 2
        if make(middle).largest_factor((0, -9.81), (1e-3, 0)) is None:
            low = middle
        else:
            high = middle
    return (low + high) / 2
