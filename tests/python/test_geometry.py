"""Geometry from Python: the same numbers as the program's, and the errors of bad polygons."""
import json
import math
import subprocess
import unittest

import apothem
import numpy
from support import PROGRAM, SOURCE, FolderCase, square

BOULDER = json.loads((SOURCE / "data/polygons/boulder.json").read_text())
BOULDER = BOULDER["polygon"] if isinstance(BOULDER, dict) else BOULDER


def program(*words):
    words = [PROGRAM, *map(str, words), "--json"]
    return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


class Polygons(FolderCase):
    def test_a_square(self):
        polygon = apothem.Polygon(square(1, 2, 2)[::-1])
        self.assertEqual((len(polygon), polygon.area, polygon.centroid), (4, 4, (2, 3)))
        self.assertTrue(polygon.is_convex)
        self.assertAlmostEqual(polygon.polar_moment, 16 / 6, 14)
        circle = polygon.inscribed_circle()
        self.assertEqual((circle.radius, circle.centres.tolist()), (1, [[2, 3]]))
        roof = polygon.roof()
        self.assertEqual(roof.height, 1)
        self.assertEqual(roof.nodes[-1].tolist(), [2, 3, 1])
        self.assertEqual([face[0] for face in roof.faces], [0, 1, 2, 3])
        self.assertEqual(polygon.singular_area().kind, "point")
        area = polygon.singular_area(0.5)
        self.assertEqual((area.kind, area.area), ("polygons", 1))
        self.assertEqual(apothem.Polygon([[0, 0], [4, 0], [4, 1], [0, 1]]).singular_area().kind,
                         "segment")

    def test_holes(self):
        holes = [square(1, 1, 1), square(3, 2, 1)[::-1]]
        plate = apothem.Polygon([[0, 0], [5, 0], [5, 4], [0, 4]], holes)
        self.assertEqual(plate.area, 18)
        self.assertEqual(plate.points.tolist(), [[0, 0], [5, 0], [5, 4], [0, 4]])
        clockwise = [[[1, 1], [1, 2], [2, 2], [2, 1]], [[3, 3], [4, 3], [4, 2], [3, 2]]]
        self.assertEqual([{tuple(v) for v in hole.tolist()} for hole in plate.holes],
                         [{tuple(v) for v in hole} for hole in clockwise])
        for hole in plate.holes:
            x, y = hole.T
            self.assertLess(sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)), 0)
        numpy.testing.assert_allclose(plate.centroid, [2.5, 2], rtol=1e-15)
        self.assertFalse(plate.is_convex)
        self.assertEqual(apothem.Polygon(square(0, 0, 1)).holes, [])
        points = [[0.5, 0.5], [1.5, 1.5], [1, 1.5], [3.5, 2.5], [2.5, 2], [9, 9]]
        self.assertEqual(plate.contains(points).tolist(), [True, False, False, False, True, False])
        # What lies in the hole does not touch the plate; what is larger overlaps it all around.
        self.assertEqual(apothem.overlap(plate, apothem.Polygon(square(1.25, 1.25, 0.5))), [])
        [ring, hole] = apothem.overlap(plate, apothem.Polygon(square(0.75, 0.75, 1.5)))
        self.assertEqual({tuple(v) for v in hole.tolist()}, {tuple(v) for v in clockwise[0]})
        [frame] = apothem.boolean(plate, apothem.Polygon(square(3, 2, 1)), "union")
        self.assertEqual(len(frame.holes), 1)
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Polygon(square(0, 0, 4), [square(1, 1, 1), square(2.5, 2.5, 2)])
        self.assertEqual(caught.exception.hole, 1)
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Polygon(square(0, 0, 4), [[[1, 1], [2, 2], [2, 1], [1, 2]]])
        self.assertEqual((caught.exception.hole, caught.exception.vertex), (0, 2))

    def test_contact_in_a_hole(self):
        ring = apothem.Polygon(square(0, 0, 4), [square(1, 1, 2)])
        inside = apothem.Polygon(square(0.75, 1.5, 1))  # 0.25 deep in the left wall of the hole
        found = apothem.contact(ring, inside)
        self.assertAlmostEqual(found.overlap_area, 0.25, 14)
        self.assertLess(found.force[0], 0)
        self.assertAlmostEqual(found.force[1], 0, 14)
        self.assertAlmostEqual(found.penetration, 0.25, 14)
        self.assertEqual(apothem.contact(ring, apothem.Polygon(square(1.5, 1.5, 1))).force, (0, 0))
        [part] = ring.offset(0.25)
        self.assertAlmostEqual(part.area, 3.5 ** 2 - 2.5 ** 2, 14)
        self.assertEqual(len(part.holes), 1)
        self.assertEqual(ring.inscribed_circle().radius > 0.5, True)  # in a corner

    def test_numbers_are_those_of_the_program(self):
        file = SOURCE / "data/polygons/boulder.json"
        expected = program("polygon", file, "--reference", 0.62)
        polygon = apothem.Polygon(BOULDER)
        self.assertEqual(polygon.area, expected["area"])
        self.assertEqual(list(polygon.centroid), expected["centroid"])
        self.assertEqual(polygon.inscribed_circle().radius, expected["inradius"])
        roof = polygon.roof()
        self.assertEqual(roof.height, expected["roof_height"])
        self.assertEqual(polygon.singular_area(0.62).area, expected["singular_area"]["area"])
        edges = {face["edge"]: face["polygon"] for face in expected["faces"]}
        faces = [roof.nodes[face].tolist() for face in roof.faces]
        self.assertEqual(sorted(faces), sorted(edges.values()))

    def test_skeleton_and_offset(self):
        polygon = apothem.Polygon([[0, 0], [4, 0], [4, 2], [0, 2]])
        skeleton = polygon.skeleton()
        ends = {tuple(map(tuple, line)) for line in skeleton.lines}
        self.assertIn(((1, 1), (3, 1)), ends | {line[::-1] for line in ends})
        self.assertEqual((len(skeleton.lines), len(skeleton.edges)), (5, 5))
        [inner] = polygon.offset(0.5)
        self.assertEqual((inner.area, inner.centroid), (3, (2, 1)))
        self.assertEqual(polygon.offset(2), [])
        with self.assertRaises(ValueError):
            polygon.offset(-1)

    def test_points(self):
        square_ = apothem.Polygon(square(0, 0, 2))
        points = [[1, 0.5], [1, 0], [3, 1], [0, 0], [1.75, 1]]
        self.assertEqual(square_.contains(points).tolist(), [True, False, False, False, True])
        self.assertEqual(square_.potential(points).tolist(), [0.5, 0, 0, 0, 0.25])
        self.assertEqual(square_.gradient(points)[[0, 1, 2, 4]].tolist(), [[0, 1], [0, 1], [0, 0], [-1, 0]])
        # By differences, in a polygon that is not convex, of both fields.
        boulder = apothem.Polygon(BOULDER)
        random = numpy.random.default_rng(5)
        low, high = boulder.points.min(axis=0), boulder.points.max(axis=0)
        places = random.uniform(low, high, (200, 2))
        places = places[boulder.contains(places)]
        step = 1e-7
        for field in ["roof", "distance"]:
            gradient = boulder.gradient(places, field=field)
            difference = numpy.stack([(boulder.potential(places + step * axis, field=field) -
                                       boulder.potential(places - step * axis, field=field)) / (2 * step)
                                      for axis in numpy.eye(2)], axis=1)
            near = numpy.abs(gradient - difference).max(axis=1) < 1e-5
            self.assertGreater(near.mean(), 0.98)  # not at the few points within a step of a ridge

    def test_a_closed_ring_is_the_same_polygon(self):
        ring = square(0, 0, 1)
        self.assertEqual(len(apothem.Polygon(ring + ring[:1])), 4)

    def test_bad_polygons(self):
        bow_tie = [[0, 0], [1, 1], [1, 0], [0, 1]]
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Polygon(bow_tie)
        self.assertIn(caught.exception.vertex, range(4))
        for points in [[[0, 0], [1, 1]], [[0, 0], [1, 0], [math.nan, 1]]]:
            with self.assertRaises(apothem.SceneError):
                apothem.Polygon(points)
        with self.assertRaises(ValueError):
            apothem.Polygon([0, 1, 2])
        with self.assertRaises(ValueError):
            apothem.Polygon(square(0, 0, 1)).singular_area(0)


class Contact(FolderCase):
    def test_methods_are_those_of_the_program(self):
        a, b = square(0, 0, 1), [[0.9, 0.3], [2, 0.1], [1.8, 1.2]]
        for name, ring in [("a", a), ("b", b)]:
            (self.folder / name).write_text(json.dumps(ring))
        results = program("contact", self.folder / "a", self.folder / "b", "--method", "all",
                          "--stiffness", 3)["results"]
        self.assertEqual([r["method"] for r in results], ["edge", "overlap", "exact"])
        for expected in results:
            found = apothem.contact(apothem.Polygon(a), apothem.Polygon(b), expected["method"],
                                    stiffness=3)
            with self.subTest(method=found.method):
                for key, value in found._asdict().items():
                    value = list(value) if isinstance(value, tuple) else value
                    self.assertEqual(value, expected[key], key)

    def test_choices(self):
        a = apothem.Polygon([[0, 0], [1, 0], [0.5, 1]])
        b = apothem.Polygon([[0.5, 0.9], [1.5, 0.8], [1, 2]])
        forces = {apothem.contact(a, b, **choice).force for choice in
                  [{}, {"reference": "inscribed_circle"}, {"reference": 0.1}, {"potential": "area"}]}
        self.assertEqual(len(forces), 3)  # roof and circle agree where polygons are convex
        for choice in [{"method": "magic"}, {"reference": "size"}, {"reference": -1}, {"field": "far"}]:
            with self.assertRaises(ValueError):
                apothem.contact(a, b, **choice)
        with self.assertRaises(apothem.SceneError):
            apothem.contact(apothem.Polygon(BOULDER), b, potential="area")

    def test_overlap(self):
        a = apothem.Polygon(square(0, 0, 1))
        parts = apothem.overlap(a, apothem.Polygon(square(0.75, 0.5, 1)))
        self.assertEqual(len(parts), 1)
        self.assertEqual(apothem.Polygon(parts[0]).area, 0.125)
        self.assertEqual(apothem.overlap(a, apothem.Polygon(square(2, 0, 1))), [])


class Regions(unittest.TestCase):
    def test_boolean(self):
        a, b = apothem.Polygon(square(0, 0, 4)), apothem.Polygon(square(1, 1, 2))
        [ring] = apothem.boolean(a, b, "difference")
        self.assertEqual(ring.outer.tolist(), a.points.tolist())
        self.assertEqual(ring.holes[0].tolist(), [[1, 1], [1, 3], [3, 3], [3, 1]])
        self.assertEqual(apothem.boolean(b, a, "difference"), [])
        self.assertEqual(len(apothem.boolean(a, b, "union")), 1)
        with self.assertRaises(ValueError):
            apothem.boolean(a, b, "sum")

    def test_repair(self):
        bow_tie = [[0, 0], [2, 2], [2, 0], [0, 2], [0, 2]]
        repaired = apothem.repair([bow_tie])
        self.assertEqual(len(repaired.polygons), 2)
        self.assertEqual(repaired.faults, ["vertex 4 repeats the one before at (0, 2) m",
                                           "edge 0 and edge 2 cross at (1, 1) m"])
        self.assertEqual(repaired.hausdorff_distance, 0)
        simple = apothem.repair([[[0, 0], [1, 1e-4], [2, 0], [2, 2], [0, 2]]], 1e-3)
        self.assertEqual(len(simple.polygons[0].outer), 4)
        self.assertAlmostEqual(simple.hausdorff_distance, 1e-4)
        self.assertEqual(apothem.repair([[[0, 0], [1, 0], [2, 0]]]).polygons, [])
        with self.assertRaises(ValueError):
            apothem.repair([bow_tie], -1)


class Voronoi(unittest.TestCase):
    def test_cells_tile_the_region(self):
        region = apothem.Polygon(BOULDER)
        mesh = apothem.voronoi(region, 50, seed=3)
        self.assertEqual((len(mesh.cells), mesh.sites.shape), (50, (50, 2)))
        areas = [apothem.Polygon(mesh.points[cell]).area for cell in mesh.cells]
        self.assertAlmostEqual(sum(areas) / region.area, 1, 12)
        again = apothem.voronoi(region, 50, seed=3)
        numpy.testing.assert_array_equal(again.points, mesh.points)
        with self.assertRaises(ValueError):
            apothem.voronoi(region, 0)

    def test_cells_around_a_hole(self):
        hole = [(1, 1), (2, 1), (2, 2), (1, 2)]
        region = apothem.Polygon([(0, 0), (3, 0), (3, 3), (0, 3)], [hole])
        mesh = apothem.voronoi(region, 1)
        cells = [apothem.Polygon(mesh.points[cell]) for cell in mesh.cells]
        self.assertEqual((len(cells), mesh.sites.shape), (2, (1, 2)))
        self.assertAlmostEqual(sum(cell.area for cell in cells), 8, 12)
        mesh = apothem.voronoi(region, 20, convex=True, smallest_angle=0.6)
        cells = [apothem.Polygon(mesh.points[cell]) for cell in mesh.cells]
        self.assertAlmostEqual(sum(cell.area for cell in cells), 8, 12)
        self.assertGreaterEqual(len(cells), 20)


if __name__ == "__main__":
    unittest.main()
