#!/usr/bin/env python3
"""GDAL, with which QGIS reads, reads the shapes that the commands write, and Apothem itself does, all with the same bits.
Called with the program; ends with 77 where GDAL's Python is missing."""

import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

try:
    from osgeo import ogr
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-gdal)")
    sys.exit(77)

ogr.UseExceptions()
CASES = 200 if "APOTHEM_LONG" in os.environ else 5
NUMBER = r"[-+]?[0-9][0-9.]*(?:e[-+]?[0-9]+)?"
VALID = {"POLYGON", "MULTIPOLYGON"}


def ring_around(rng, x, y, radius, n):
    """Vertices around a point, in the order of their angles; no two neighbours are as far apart as half a turn."""
    start = rng.uniform(0, 7)
    return [[x + r * math.cos(a), y + r * math.sin(a)] for k in range(n)
            for r, a in [(radius * rng.uniform(0.5, 1), start + 2 * math.pi * (k + rng.uniform(-0.2, 0.2)) / n)]]


def polygon(rng):
    """A polygon with up to nine holes, as WKT, anywhere."""
    dx, dy = (rng.choice([0, 1e6, -3.3]) for _ in range(2))
    rings = [ring_around(rng, dx, dy, 4, rng.randrange(4, 20))]
    inner = 4 * 0.5 * math.cos(math.pi / 3) - 0.1
    for i in range(-1, 2):
        for j in range(-1, 2):
            if math.hypot(i, j) / 2 + 0.24 < inner and rng.random() < 0.5:
                rings.append(ring_around(rng, dx + i / 2, dy + j / 2, 0.23, rng.randrange(3, 8)))
    text = ", ".join("(" + ", ".join(f"{x!r} {y!r}" for x, y in ring + ring[:1]) + ")" for ring in rings)
    return f"POLYGON ({text})", (dx, dy)


def numbers(text):
    return [float(word) for word in re.findall(NUMBER, text)]


def coordinates(geometry):
    """All of them, in the order of the geometry."""
    if geometry.GetGeometryCount() > 0:
        return [c for i in range(geometry.GetGeometryCount()) for c in coordinates(geometry.GetGeometryRef(i))]
    return [c for i in range(geometry.GetPointCount()) for c in geometry.GetPoint_2D(i)]


def json_numbers(value):
    return [c for part in value for c in json_numbers(part)] if isinstance(value, list) else [value]


def split(text, level):
    """The bracketed parts of a text that stand in so many brackets."""
    parts, depth, start = [], 0, 0
    for i, c in enumerate(text):
        if c == "(":
            start = i if depth == level else start
            depth += 1
        elif c == ")":
            depth -= 1
            if depth == level:
                parts.append(text[start:i + 1])
    return parts


class Checks:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.files = self.shapes = self.values = 0

    def run(self, *arguments):
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)

    def write(self, name, *arguments):
        """The file that a command writes, or None where it refuses its input."""
        path = self.folder / name
        path.unlink(missing_ok=True)
        done = self.run(*arguments, "-o", path)
        if done.returncode == 2:
            return None
        assert done.returncode == 0, (arguments, done.stderr)
        self.files += 1
        return path

    def read_wkt(self, path):
        text = path.read_text()
        geometry = ogr.CreateGeometryFromWkt(text)
        found = coordinates(geometry)
        assert found == numbers(text), path
        self.values += len(found)
        return geometry

    def read_geojson(self, path):
        document = json.loads(path.read_text())
        source = ogr.Open(str(path))
        layer = source.GetLayer(0)
        assert layer.GetFeatureCount() == len(document["features"]) > 0, path
        found = []
        for feature, own in zip(layer, document["features"]):
            own_numbers = json_numbers(own["geometry"]["coordinates"])
            assert coordinates(feature.GetGeometryRef()) == own_numbers, path
            for name, value in own["properties"].items():
                assert feature.GetField(name) == value, (path, name)
            found += own_numbers
            self.shapes += 1
        return found

    def command(self, *arguments):
        """Both formats of an output, which must hold the same; the geometry, or None."""
        wkt = self.write("a.wkt", *arguments)
        if wkt is None:
            return None
        geometry = self.read_wkt(wkt)
        if geometry.IsEmpty():
            return None
        geojson = self.write("a.geojson", *arguments)
        assert sorted(self.read_geojson(geojson)) == sorted(coordinates(geometry)), arguments
        return geometry

    def read_again(self, geometry, text):
        """Apothem reads each polygon of a file back to the same bits."""
        if geometry.GetGeometryName() not in VALID:
            return 0
        polygons = split(text[text.index("("):], 0 if geometry.GetGeometryName() == "POLYGON" else 1)
        batch = self.folder / "batch.txt"
        batch.write_text("".join(f"p{i} POLYGON {part}\n" for i, part in enumerate(polygons)))
        count = 0
        for part, line in zip(polygons, self.run("polygon", "--batch", batch).stdout.splitlines()):
            answer = json.loads(line)
            if "error" in answer:  # rings that touch at a point are valid for GDAL and refused here
                assert "touch" in answer["error"] or "repeats" in answer["error"], answer["error"]
                continue
            vertices = {tuple(face["polygon"][0][:2]) for face in answer["faces"]}
            values = numbers(part)
            assert vertices == set(zip(values[::2], values[1::2])), part[:200]
            count += 1
        return count


def outputs(one, other, rng):
    for what in ("skeleton", "faces", "offset:0.01", "singular-area", "incircle"):
        yield ("polygon", one, "--output", what)
    yield ("polygon", one, "--repair")
    yield ("contact", one, other, "--output", "overlap")
    for operation in ("union", "intersection", "difference"):
        yield ("boolean", one, other, operation)
    yield ("mesh", one, "--voronoi", str(rng.randrange(2, 20)), *rng.choice([[], ["--convex"]]))


def main():
    rng = random.Random(43)
    again = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        checks = Checks(sys.argv[1], folder)
        for _ in range(CASES):
            one, other = folder / "one.wkt", folder / "other.wkt"
            text, place = polygon(rng)
            one.write_text(text)
            while True:
                second, where = polygon(rng)
                if where == place:
                    break
            shift = rng.uniform(0.1, 5)
            other.write_text(re.sub(rf"({NUMBER}) ({NUMBER})", lambda m: f"{float(m[1]) + shift!r} {m[2]}", second))
            for arguments in outputs(one, other, rng):
                geometry = checks.command(*arguments)
                if geometry is not None:
                    again += checks.read_again(geometry, (folder / "a.wkt").read_text())
        assert checks.files > 15 * CASES, checks.files
        assert again > 30 * CASES, again
        print(f"{checks.files} files of {CASES} polygons, {checks.values} coordinates of WKT and {checks.shapes} features: "
              f"all bits as written; {again} polygons read again by Apothem")


if __name__ == "__main__":
    main()
