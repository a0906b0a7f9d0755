"""Scenes from files and dicts, and the errors of bad ones."""
import json
import os
import unittest

import apothem
import numpy
from support import SOURCE, FolderCase, falling_block, flying_block, square


class Scenes(FolderCase):
    def test_a_dict_is_the_file_with_the_same_keys(self):
        document = falling_block()
        (self.folder / "scene.json").write_text(json.dumps(document))
        of_dict = apothem.Simulation(apothem.Scene(document))
        of_file = apothem.Simulation(apothem.load(self.folder / "scene.json"))
        self.assertTrue(of_dict.run() and of_file.run())
        self.assertEqual(of_dict.state_hash(), of_file.state_hash())

    def test_every_shipped_scene_is_the_same_as_a_dict(self):
        for file in sorted((SOURCE / "data/scenes").glob("*.json"))[::6]:
            with self.subTest(file=file.name):
                scene = apothem.load(file)
                again = apothem.Scene(scene.to_dict(), folder=file.parent)
                self.assertEqual(repr(again), repr(scene))
                self.assertEqual(again.end, scene.end)

    def test_arrays_tuples_and_numbers_of_numpy(self):
        document = flying_block()
        document["bodies"][0]["polygon"] = numpy.array(square(0, 0, 1), dtype=numpy.float32)
        document["bodies"][0]["velocity"] = (numpy.float64(1), numpy.int32(2))
        sim = apothem.Simulation(apothem.Scene(document))
        numpy.testing.assert_array_equal(sim.bodies.velocity, [[1, 2, 0]])

    def test_values_that_are_set(self):
        file = self.folder / "scene.json"
        file.write_text(json.dumps(flying_block()))
        scene = apothem.load(file, set={"bodies.block.velocity": [3, 4], "time.end": 0.5})
        self.assertEqual(scene.end, 0.5)
        self.assertEqual(apothem.Simulation(scene).bodies.velocity[0, 1], 4)
        self.assertEqual(scene.to_dict()["time"]["end"], 1)

    def test_files_are_relative_to_the_folder(self):
        document = flying_block()
        document["bodies"][0]["polygon"] = "shape.json"
        (self.folder / "shape.json").write_text(json.dumps(square(0, 0, 2)))
        sim = apothem.Simulation(apothem.Scene(document, folder=self.folder))
        self.assertEqual(sim.bodies.mass[0], 8000)
        with self.assertRaises(apothem.SceneError):
            apothem.Scene(document)

    def test_one_scene_serves_many_simulations(self):
        scene = apothem.Scene(falling_block())
        hashes = set()
        for _ in range(2):
            sim = apothem.Simulation(scene)
            sim.step(100)
            hashes.add(sim.state_hash())
        self.assertEqual(len(hashes), 1)


class Errors(FolderCase):
    def test_the_place_in_a_dict(self):
        document = falling_block()
        document["bodies"][1]["polygon"][2] = "corner"
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Scene(document)
        error = caught.exception
        self.assertIsInstance(error, ValueError)
        self.assertEqual(error.pointer, "/bodies/1/polygon/2")
        self.assertEqual(error.file, "<dict>")
        self.assertIsNone(error.line)
        self.assertTrue(str(error).startswith("<dict>: /bodies/1/polygon/2: "), str(error))
        self.assertIn(error.reason, str(error))

    def test_the_place_in_a_file(self):
        file = self.folder / "bad.json"
        file.write_text('{\n  "materials": {},\n  "bodys": []\n}')
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.load(file)
        self.assertEqual(caught.exception.file, str(file))
        self.assertEqual((caught.exception.line, caught.exception.pointer), (2, "/materials"))

    def test_values_that_json_does_not_know(self):
        for value, words in [(float("nan"), "finite"), ({1}, '"set"'), (10**30, "too large")]:
            with self.subTest(value=value), self.assertRaises(apothem.SceneError) as caught:
                apothem.Scene(flying_block(thickness=value))
            self.assertEqual(caught.exception.pointer, "/thickness")
            self.assertIn(words, str(caught.exception))
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Scene({1: 2})
        self.assertIn("has the key 1", str(caught.exception))

    def test_a_dict_in_itself_and_text_that_is_none(self):
        document = {}
        document["again"] = document
        with self.assertRaisesRegex(apothem.SceneError, "contains itself"):
            apothem.Scene(document)
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Scene({"name": "\ud800"})
        self.assertEqual(caught.exception.pointer, "/name")

    def test_what_is_no_path(self):
        for path, error in [(5, TypeError), ("scene.json\0x", ValueError)]:
            with self.assertRaises(error):
                apothem.load(path)

    def test_the_path_of_a_value_that_is_wrong(self):
        file = self.folder / "scene.json"
        file.write_text(json.dumps(flying_block()))
        with os.scandir(self.folder) as entries:
            self.assertEqual(apothem.load(next(entries)).end, flying_block()["time"]["end"])
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.load(file, set={"time.end": float("inf")})
        self.assertEqual(caught.exception.pointer, "/time/end")

    def test_bodies_that_overlap_are_refused_at_their_place(self):
        document = falling_block()
        document["bodies"][1]["polygon"] = square(0, -0.3, 1)
        scene = apothem.Scene(document)
        with self.assertRaises(apothem.SceneError) as caught:
            apothem.Simulation(scene)
        self.assertEqual(caught.exception.pointer, "/bodies/1")
        self.assertIsNone(caught.exception.line)

    def test_a_file_that_is_not_there(self):
        with self.assertRaises(apothem.SceneError):
            apothem.load(self.folder / "none.json")


if __name__ == "__main__":
    unittest.main()
