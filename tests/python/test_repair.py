"""Damaged rings are repaired to valid polygons with the area that the even-odd rule gives: that of the faces between their
lines, as GEOS finds them, around which the ring goes an odd number of times. Shapely's make_valid is asked beside. It counts
a line that the ring follows twice as one, so that it is compared only where there is none. Ends with 77 where shapely is
missing."""
import math
import random
import sys
import unittest

import apothem
import numpy

try:
    from shapely.geometry import LineString, Polygon
    from shapely.ops import polygonize, unary_union
    from shapely.validation import make_valid
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-shapely)")
    sys.exit(77)

CASES = 500


def ring_around(rng, n):
    """Vertices around the origin, in the order of their angles."""
    angles = sorted(rng.uniform(0, 2 * math.pi) for _ in range(n))
    return [[r * math.cos(a), r * math.sin(a)] for a in angles for r in [rng.uniform(0.3, 1)]]


def damaged(rng):
    ring = ring_around(rng, rng.randrange(4, 40))
    for kind in rng.choices(["spike", "duplicate", "crossing", "sliver", "touch"], k=rng.randrange(1, 6)):
        i = rng.randrange(len(ring))
        a, b = ring[i], ring[(i + 1) % len(ring)]
        if kind == "spike":
            ring[i + 1:i + 1] = [[a[0] * 2, a[1] * 2], a]
        elif kind == "duplicate":
            ring[i:i] = [a] * rng.randrange(1, 4)
        elif kind == "crossing":
            j = rng.randrange(len(ring))
            ring[i], ring[j] = ring[j], ring[i]
        elif kind == "sliver":
            ring[i + 1:i + 1] = [[(a[0] + b[0]) / 2 * 1.5, (a[1] + b[1]) / 2 * 1.5],
                                 [(a[0] + b[0]) / 2 * (1 + 1e-12), (a[1] + b[1]) / 2 * (1 + 1e-12)]]
        else:
            ring[i + 1:i + 1] = [ring[rng.randrange(len(ring))]]
    return ring


def shape(polygons):
    return [Polygon(p.outer, p.holes) for p in polygons]


def is_surrounded(ring, point):
    """Whether a ray to the right crosses the ring an odd number of times."""
    x, y = point
    odd = False
    for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1]):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            odd = not odd
    return odd


def even_odd_area(ring):
    faces = polygonize(unary_union(LineString(ring + ring[:1])))
    return sum(face.area for face in faces if is_surrounded(ring, face.representative_point().coords[0]))


class Repair(unittest.TestCase):
    def test_damaged_rings(self):
        rng = random.Random(43)
        worst, faults, compared = 0, 0, 0
        for case in range(CASES):
            ring = damaged(rng)
            repaired = apothem.repair([ring])
            parts = shape(repaired.polygons)
            faults += len(repaired.faults)
            with self.subTest(case=case):
                for part, polygon in zip(parts, repaired.polygons):
                    self.assertTrue(part.is_valid)
                    apothem.Polygon(polygon.outer)  # does not raise
                    for hole in polygon.holes:
                        apothem.Polygon(hole)
                area = sum(part.area for part in parts)
                expected = even_odd_area(ring)
                worst = max(worst, abs(area - expected))
                self.assertAlmostEqual(area, expected, 10)
                if not any("lie on each other" in fault or "spike" in fault for fault in repaired.faults):
                    compared += 1
                    self.assertAlmostEqual(area, make_valid(Polygon(ring)).area, 10)
                self.assertAlmostEqual(unary_union(parts).area, area, 10)  # parts do not overlap
                again = apothem.repair([part for p in repaired.polygons for part in [p.outer, *p.holes]])
                self.assertEqual(len(again.polygons), len(parts))
                self.assertAlmostEqual(sum(p.area for p in shape(again.polygons)), area, 14)
        print(f"{CASES} rings, {faults} faults; areas are wrong by {worst:.2g} m^2 at most; "
              f"{compared} compared with make_valid")
        self.assertGreater(compared, CASES // 4)

    def test_simplification_keeps_its_distance(self):
        rng = random.Random(44)
        for case in range(CASES // 5):
            ring = damaged(rng)
            exact = shape(apothem.repair([ring]).polygons)
            repaired = apothem.repair([ring], 0.02)
            simple = shape(repaired.polygons)
            with self.subTest(case=case):
                self.assertLessEqual(repaired.hausdorff_distance, 0.02)
                self.assertTrue(all(part.is_valid for part in simple))
                boundary = unary_union([part.boundary for part in exact])
                for part in simple:  # thin parts may have gone, so only in this direction
                    self.assertLessEqual(part.boundary.hausdorff_distance(boundary.intersection(
                        part.boundary.buffer(0.0201))), 0.0202)

    def test_valid_rings_stay(self):
        rng = random.Random(45)
        for n in range(3, 60):
            ring = ring_around(rng, n)
            repaired = apothem.repair([ring])
            if not Polygon(ring).is_valid:
                continue
            numpy.testing.assert_array_equal(repaired.polygons[0].outer, ring)
            self.assertEqual(repaired.faults, [])


if __name__ == "__main__":
    unittest.main()
