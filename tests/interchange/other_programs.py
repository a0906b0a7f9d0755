#!/usr/bin/env python3
"""Drawings and meshes that other programs write: by ezdxf, by gmsh, and GeoJSON as map programs write it. Each is read as
its program shows it, or refused with what is wrong and a remedy. Called with the program; ends with 77 where ezdxf or gmsh
is missing."""

import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import ezdxf
    import ezdxf.path
    import gmsh
    from ezdxf import units
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-ezdxf, python3-gmsh)")
    sys.exit(77)

CHORDS = 2e-3  # relative error of areas: chords of 4 degrees
CHORDS_OF_SPLINES = 5e-3  # eight chords for each control point, of five
SQUARE = [(0, 0), (2, 0), (2, 1), (0, 1)]
RING = [(0, 0), (2, 0), (2.5, 1), (1, 2), (-0.5, 1)]


def area(points):
    twice = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1]))
    return abs(twice) / 2


# ------------------------------------------------------------------------------------------------ what ezdxf shows

def is_shown(doc, entity):
    layer = doc.layers.get(entity.dxf.layer) if entity.dxf.layer in doc.layers else None
    hidden = layer is not None and (layer.is_off() or layer.is_frozen())
    return not hidden and not entity.dxf.get("invisible", 0)


def is_frozen(doc, entity):
    return entity.dxf.layer in doc.layers and doc.layers.get(entity.dxf.layer).is_frozen()


def shown_areas(doc, entities):
    """Of what is closed and shown, in square units of the drawing."""
    result = []
    for entity in entities:
        kind = entity.dxftype()
        if kind == "INSERT":
            # What stands in the block keeps its own layer, but that of layer 0 has the layer of the insert.
            if is_frozen(doc, entity):
                continue
            for single in entity.multi_insert() if entity.mcount > 1 else [entity]:
                parts = list(single.virtual_entities())
                for part in parts:
                    if part.dxf.layer == "0":
                        part.dxf.layer = entity.dxf.layer
                result += shown_areas(doc, parts)
        elif not is_shown(doc, entity):
            continue
        elif kind in ("SOLID", "TRACE", "3DFACE"):
            points = [entity.dxf.get(f"vtx{i}") for i in ((0, 1, 3, 2) if kind != "3DFACE" else (0, 1, 2, 3))]
            result.append(area([(p.x, p.y) for p in points]))
        elif kind == "HATCH":
            result += [area([(p.x, p.y) for p in path.flattening(1e-5)]) for path in ezdxf.path.from_hatch(entity)]
        elif kind in ("LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE"):
            points = [(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(1e-5)]
            result.append(area(points))
    return result


# ------------------------------------------------------------------------------------------------ drawings

def lwpolyline(place, layer):
    place.add_lwpolyline(RING, close=True, dxfattribs={"layer": layer})


def bulges(place, layer):
    place.add_lwpolyline([(0, 0, 0.5), (2, 0, 0), (2, 1, -0.2), (0, 1, 0)], format="xyb", close=True,
                         dxfattribs={"layer": layer})


def polyline_2d(place, layer):
    place.add_polyline2d(RING, dxfattribs={"layer": layer}).close(True)


def polyline_3d(place, layer):
    place.add_polyline3d([(x, y, 3 + x) for x, y in RING], dxfattribs={"layer": layer}).close(True)


def circle(place, layer):
    place.add_circle((1, 1), 1.5, dxfattribs={"layer": layer, "thickness": 2})


def ellipse(place, layer):
    place.add_ellipse((1, 1), (2, 1), 0.4, dxfattribs={"layer": layer})


def closed_spline(place, layer):
    points = [(0, 0, 0), (2, 0, 0), (3, 1, 0), (1, 2, 0), (0, 0, 0)]
    place.add_open_spline(points, dxfattribs={"layer": layer})


def hatch(place, layer):
    boundary = place.add_hatch(dxfattribs={"layer": layer}).paths.add_edge_path()
    boundary.add_line((0, 0), (2, 0))
    boundary.add_arc((1, 0), 1, 0, 180)


def solid(place, layer):
    place.add_solid([(0, 0), (2, 0), (0, 1), (2, 1)], dxfattribs={"layer": layer})


def face(place, layer):
    place.add_3dface([(0, 0), (2, 0), (2, 1), (0, 1)], dxfattribs={"layer": layer})


def mirrored(place, layer):
    place.add_lwpolyline(RING, close=True, dxfattribs={"layer": layer, "extrusion": (0, 0, -1), "elevation": 4})


def in_blocks(place, layer, **insert):
    doc = place.doc
    stone = doc.blocks.new("stone")
    stone.add_polyline2d(SQUARE, dxfattribs={"layer": "0"}).close(True)
    pair = doc.blocks.new("pair")
    pair.add_blockref("stone", (0, 0), dxfattribs={"layer": "0"})
    pair.add_blockref("stone", (0, 3), dxfattribs={"layer": "0", "xscale": 0.5, "yscale": 0.5})
    place.add_blockref("pair", (5, 5), dxfattribs={"layer": layer, **insert})


def blocks(place, layer):
    in_blocks(place, layer)


def scaled_blocks(place, layer):
    in_blocks(place, layer, xscale=-2, yscale=3, rotation=30)


def array_of_blocks(place, layer):
    in_blocks(place, layer, column_count=2, row_count=3, column_spacing=4, row_spacing=6)


R12 = [polyline_2d, polyline_3d, circle, solid, face, blocks, scaled_blocks, array_of_blocks]
NEWER = R12 + [lwpolyline, bulges, ellipse, closed_spline, hatch, mirrored]
VERSIONS = {"R12": R12, "R2000": NEWER, "R2004": NEWER, "R2007": NEWER, "R2010": NEWER, "R2013": NEWER, "R2018": NEWER}
LAYERS = ["stones", "Gewölbe", "Mauer 1", "石垣", "ÜBER"]
UNITS = [units.MM, units.CM, units.M, units.IN, units.FT, 0]


def annotate(doc, place):
    """What every drawing of an office has besides outlines, and what it does not show."""
    place.add_text("a note", dxfattribs={"layer": "notes"})
    place.add_point((9, 9))
    for name, hide in (("frozen", "freeze"), ("off", "off")):
        getattr(doc.layers.add(name), hide)()
        place.add_circle((50, 50), 1, dxfattribs={"layer": name})
    doc.layers.add("locked").lock()
    if doc.dxfversion > "AC1009":
        place.add_mtext("more", dxfattribs={"layer": "notes"})
        place.add_linear_dim(base=(0, -2), p1=(0, 0), p2=(3, 0)).render()
        place.add_leader([(0, 0), (9, 9)])
        place.add_xline((0, 0), (1, 1))
        doc.layout("Layout1").add_lwpolyline(SQUARE)  # open, in the paper space


class Case:
    def __init__(self, name, file, areas=None, refusal=None, keys=None, tolerance=CHORDS):
        self.name, self.file, self.areas, self.refusal, self.keys = name, file, areas, refusal, keys or {}
        self.tolerance = tolerance


def drawings(folder):
    number = 0
    for version, kinds in VERSIONS.items():
        for kind in kinds:
            number += 1
            doc = ezdxf.new(version)
            doc.units = UNITS[number % len(UNITS)]
            layer = LAYERS[number % len(LAYERS)]
            # Chinese signs are in no code page of a western drawing, so ezdxf writes them as \\U+XXXX.
            doc.layers.add(layer)
            kind(doc.modelspace(), layer)
            annotate(doc, doc.modelspace())
            # ezdxf writes no unit into drawings of R12.
            unit = units.conversion_factor(doc.units, units.M) if doc.units and version != "R12" else 1
            file = folder / f"{number}.dxf"
            doc.saveas(file)
            expected = [a * unit**2 for a in shown_areas(doc, doc.modelspace())]
            yield Case(f"{kind.__name__} in {version}, unit {doc.units}, layer {layer}", file, areas=expected,
                       keys={"layers": {layer: {"material": "marked"}}},
                       tolerance=CHORDS_OF_SPLINES if kind is closed_spline else CHORDS)


def refused_drawings(folder):
    def fit_spline(place):
        place.add_spline([(0, 0), (1, 1), (2, 0)], dxfattribs={"layer": "curves"})

    def periodic_spline(place):
        points = [(0, 0, 0), (2, 0, 0), (3, 1, 0), (1, 2, 0)]
        place.add_spline(dxfattribs={"layer": "curves"}).set_closed(points)

    def region(place):
        place.add_region(dxfattribs={"layer": "curves"})

    def solid_body(place):
        place.add_3dsolid(dxfattribs={"layer": "curves"})

    def mesh(place):
        with place.add_mesh(dxfattribs={"layer": "curves"}).edit_data() as data:
            data.add_face([(0, 0, 0), (1, 0, 0), (1, 1, 0)])

    def polyface(place):
        place.add_polyface(dxfattribs={"layer": "curves"}).append_face([(0, 0, 0), (1, 0, 0), (1, 1, 0)])

    def open_arc(place):
        place.add_arc((0, 0), 1, 0, 90, dxfattribs={"layer": "curves"})

    def open_line(place):
        place.add_line((0, 0), (1, 1), dxfattribs={"layer": "curves"})

    def missing_block(place):
        place.add_blockref("nowhere", (0, 0), dxfattribs={"layer": "curves"})

    def external(place):
        place.doc.add_xref_def("other.dwg", "other")
        place.add_blockref("other", (0, 0), dxfattribs={"layer": "curves"})

    for number, (kind, refusal) in enumerate([
            (fit_spline, "the SPLINE at line .*curves.*fit points.*not supported yet.*layer out"),
            (periodic_spline, "the SPLINE at line .*curves.*periodic.*not supported yet.*layer out"),
            (region, "the REGION at line .*curves.*not supported yet.*closed polyline"),
            (solid_body, "the 3DSOLID at line .*curves.*not supported yet"),
            (mesh, "the MESH at line .*curves.*not supported yet"),
            (polyface, "the POLYLINE at line .*curves.*mesh in space.*not supported yet"),
            (open_arc, "the ARC at line .*curves.*open.*close it"),
            (open_line, "the LINE at line .*curves.*open.*close it"),
            (missing_block, "the INSERT at line .*curves.*block \"nowhere\".*take"),
            (external, "the INSERT at line .*curves.*external reference.*bind")]):
        doc = ezdxf.new("R2010")
        doc.layers.add("curves")
        doc.modelspace().add_lwpolyline(SQUARE, close=True)
        kind(doc.modelspace())
        file = folder / f"refused-{number}.dxf"
        doc.saveas(file)
        yield Case(f"{kind.__name__} is refused", file, refusal=refusal)
        # On a layer that is left out it does not matter.
        yield Case(f"{kind.__name__} on a layer that is left out", file, areas=[2], keys={"layers": {"curves": False}})
    doc = ezdxf.new("R2010")
    doc.modelspace().add_lwpolyline(SQUARE, close=True)
    doc.modelspace().add_xline((0, 0), (1, 1))
    doc.saveas(folder / "construction.dxf")
    yield Case("a construction line between lines", folder / "construction.dxf", keys={"lines": "polygonize"},
               refusal="the XLINE at line .*without an end.*not supported yet.*trim")
    doc.saveas(folder / "binary.dxf", fmt="bin")
    yield Case("binary DXF", folder / "binary.dxf", refusal="binary.*not supported yet.*ASCII")
    doc.saveas(folder / "whole.dxf")
    text = (folder / "whole.dxf").read_text()
    (folder / "half.dxf").write_text(text[:len(text) // 2])
    yield Case("half a file", folder / "half.dxf", refusal="not valid DXF.*save it anew")


# ------------------------------------------------------------------------------------------------ maps

def maps(folder):
    house = [[7.1489466, 50.9653194], [7.1489765, 50.9652408], [7.1491593, 50.9652698], [7.1491291, 50.9653486]]
    plane = [[381234.5, 5646789.25], [381238.5, 5646789.25], [381238.5, 5646791.25], [381234.5, 5646791.25]]
    small = [[1, 2], [5, 2], [5, 4], [1, 4]]

    def write(name, ring, crs=None, kind="Polygon", text=None):
        ring = ring + ring[:1]
        polygons = {"Polygon": [ring], "MultiPolygon": [[ring], [[[x + 6, y] for x, y in ring]]]}
        geometry = {"type": kind, "coordinates": polygons[kind]}
        file = {"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"id": 7, "layer": "Häuser"}, "geometry": geometry}]}
        if crs:
            file["crs"] = {"type": "name", "properties": {"name": crs}}
        path = folder / f"{name}.geojson"
        path.write_bytes((text or (lambda t: t))(json.dumps(file, ensure_ascii=False)).encode())
        return path

    degrees = "degrees of longitude and latitude.*EPSG:32632.*\"scale\": 1"
    yield Case("a house without a crs", write("house", house), refusal=degrees)
    for number, crs in enumerate(["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4258"]):
        yield Case(f"a house in {crs}", write(f"house-{number}", house, crs), refusal=degrees)
    yield Case("degrees as metres, said so", write("said", small, "EPSG:4326"), areas=[8], keys={"scale": 1})
    yield Case("many houses", write("houses", house, kind="MultiPolygon"), refusal="degrees")
    southern = [[-70.5 + x / 1e4, -33.4 + y / 1e4] for x, y in small]
    yield Case("a house in Chile", write("south", southern), refusal="degrees.*EPSG:32719")
    for number, crs in enumerate(["urn:ogc:def:crs:EPSG::25832", "EPSG:32632"]):
        yield Case(f"metres in {crs}", write(f"plane-{number}", plane, crs), areas=[8])
    yield Case("US survey feet", write("feet", plane, "EPSG:2225"), areas=[8 * (1200 / 3937)**2])
    yield Case("a crs that nobody knows", write("odd", plane, "EPSG:999999"), refusal="not known.*scale")
    yield Case("metres without a crs", write("plane", plane), areas=[8])
    yield Case("a drawing near 0, 0", write("small", small), areas=[8])
    yield Case("two polygons", write("two", small, kind="MultiPolygon"), areas=[8, 8])
    yield Case("lines of Windows", write("crlf", small, text=lambda t: t.replace(", ", ",\r\n")), areas=[8])
    yield Case("a byte order mark", write("bom", small, text=lambda t: "\ufeff" + t), areas=[8])
    yield Case("a scale", write("scaled", house), areas=[area(house) * 4], keys={"scale": 2})
    yield Case("a layer", write("layer", small), areas=[8], keys={"layers": {"Häuser": {"material": "marked"}}})


# ------------------------------------------------------------------------------------------------ meshes

class MeshCase:
    def __init__(self, name, file, area=None, groups=None, refusal=None):
        self.name, self.file, self.area, self.groups, self.refusal = name, file, area, groups, refusal


def meshes(folder):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    number = 0

    def write(version, **options):
        nonlocal number
        number += 1
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        for key, value in options.items():
            gmsh.option.setNumber("Mesh." + key, value)
        file = folder / f"{number}.msh"
        gmsh.write(str(file))
        for key in options:
            gmsh.option.setNumber("Mesh." + key, 0)
        return file

    def disc(size, groups=True, order=1, quads=False, parts=0):
        gmsh.clear()
        gmsh.model.add("disc")
        surface = gmsh.model.occ.addDisk(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        curves = [tag for _, tag in gmsh.model.getBoundary([(2, surface)], oriented=False)]
        if groups:
            gmsh.model.setPhysicalName(1, gmsh.model.addPhysicalGroup(1, curves), "rim")
            if groups != "rim":
                gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, [surface]), "disc ö")
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        if quads:
            gmsh.option.setNumber("Mesh.Algorithm", 6)
            gmsh.model.mesh.setRecombine(2, surface)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        if parts:
            gmsh.model.mesh.partition(parts)
        # Straight edges of a polygon on the rim.
        total = 0
        types, _, nodes = gmsh.model.mesh.getElements(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        place = {t: (places[3 * i], places[3 * i + 1]) for i, t in enumerate(tags)}
        for kind, of_kind in zip(types, nodes):
            corners = {2: 3, 3: 4, 9: 6}[kind]
            for i in range(0, len(of_kind), corners):
                total += area([place[t] for t in of_kind[i:i + min(corners, 4)]])
        return total

    for version in (2.2, 4.1):
        for size in (0.5, 0.2):
            total = disc(size)
            yield MeshCase(f"disc {size}, {version}", write(version), total, ["disc ö", "rim"])
            total = disc(size, quads=True)
            yield MeshCase(f"quads {size}, {version}", write(version), total, ["disc ö", "rim"])
            total = disc(size, groups=False)
            yield MeshCase(f"no groups {size}, {version}", write(version), total, [])
            total = disc(size)
            yield MeshCase(f"parametric {size}, {version}", write(version, SaveParametric=1), total, ["disc ö", "rim"])
        for parts in (2, 4):
            total = disc(0.2, parts=parts)
            yield MeshCase(f"{parts} partitions, {version}", write(version), total, ["disc ö", "rim"])
        disc(0.5)
        yield MeshCase(f"binary, {version}", write(version, Binary=1), refusal="binary.*save it as text")
        disc(0.5, order=2)
        yield MeshCase(f"second order, {version}", write(version), refusal="of higher order.*-order 1")
        disc(0.5, groups="rim")
        yield MeshCase(f"no surface group, {version}", write(version),
                       refusal="no triangles or quadrilaterals.*Physical Surface.*SaveAll")
        total = disc(0.5, groups="rim")
        yield MeshCase(f"all saved, {version}", write(version, SaveAll=1), total, None)
        gmsh.clear()
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(3)
        yield MeshCase(f"a solid, {version}", write(version), refusal="tetrahedron.*gmsh -2|z = |z=")
    for version in (1.0, 4.0):
        disc(0.5)
        yield MeshCase(f"version {version}", write(version), refusal="version.*save it as 4.1 or 2.2")
    gmsh.finalize()


# ------------------------------------------------------------------------------------------------ the program

def main():
    program = sys.argv[1]
    faults = []
    count = {"read": 0, "refused": 0}

    def run(*arguments):
        return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)

    def judge_refusal(case, result):
        count["refused"] += 1
        message = result.stderr.strip()
        if result.returncode != 2:
            faults.append(f"{case.name}: exit code {result.returncode} instead of 2")
        elif not re.search(case.refusal, message):
            faults.append(f"{case.name}: says {message}")
        elif case.file.name not in message or "\n" in message or ".cpp" in message:
            faults.append(f"{case.name}: does not name the file in one line: {message}")

    def check_drawings(cases, folder):
        """What `apothem check` says of a scene that imports the files of these cases, with materials and places of their own."""
        scene = {"materials": {f"{kind} {i}": {"density": 1} for i in range(len(cases)) for kind in ("m", "marked")},
                 "contact": {"normal_stiffness": 1e6, "overlaps": "accept"}, "time": {"end": 1e-6}, "import": []}
        for i, case in enumerate(cases):
            layers = {name: keys and {"material": f"marked {i}"} for name, keys in case.keys.get("layers", {}).items()}
            scene["import"].append({"file": str(case.file), "material": f"m {i}", "offset": [100 * i, 0], **case.keys,
                                    "layers": layers})
        path = folder / "scene.json"
        path.write_text(json.dumps(scene))
        return run("check", "--json", path)

    def judge_drawings(cases, folder):
        """Files that are read stand in one scene, as each start of the program loads GDAL, which takes longest. If one of them
        is refused, each stands in a scene of its own."""
        result = check_drawings(cases, folder)
        if len(cases) == 1 and cases[0].refusal:
            return judge_refusal(cases[0], result)
        if result.returncode != 0:
            if len(cases) == 1:
                count["read"] += 1
                return faults.append(f"{cases[0].name}: refused: {result.stderr.strip()}")
            before = len(faults)
            for case in cases:
                judge_drawings([case], folder)
            if len(faults) == before:
                faults.append(f"{cases[0].name} and {len(cases) - 1} more in one scene: refused: {result.stderr.strip()}")
            return None
        bodies = json.loads(result.stdout)["bodies"]
        count["read"] += len(cases)
        for i, case in enumerate(cases):
            own = [b for b in bodies if b["material"] in (f"m {i}", f"marked {i}")]
            found, expected = sorted(b["area"] for b in own), sorted(case.areas)
            same = len(found) == len(expected) and all(math.isclose(a, b, rel_tol=case.tolerance) for a, b in zip(found, expected))
            if not same:
                faults.append(f"{case.name}: areas {found} instead of {expected}")
            marked = any(keys for keys in case.keys.get("layers", {}).values())
            if marked and any(b["material"] != f"marked {i}" for b in own):
                faults.append(f"{case.name}: bodies are not on the layer {list(case.keys['layers'])}")
        return None

    def judge_mesh(case):
        result = run("mesh", case.file)
        if case.refusal:
            return judge_refusal(case, result)
        count["read"] += 1
        if result.returncode != 0:
            return faults.append(f"{case.name}: refused: {result.stderr.strip()}")
        groups = re.findall(r"^group +(.*): [0-9]+ nodes", result.stdout, re.MULTILINE)
        if case.groups is not None and sorted(groups) != sorted(case.groups):
            faults.append(f"{case.name}: groups {groups} instead of {case.groups}")
        found = re.search(r"sum ([0-9.e+-]+) m", result.stdout)
        if not found or not math.isclose(float(found.group(1)), case.area, rel_tol=1e-5):
            faults.append(f"{case.name}: area {found and found.group(1)} instead of {case.area}")
        return None

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for cases in (drawings, refused_drawings, maps):
            every = list(cases(folder))
            judge_drawings([case for case in every if not case.refusal], folder)
            for case in every:
                if case.refusal:
                    judge_drawings([case], folder)
        for case in meshes(folder):
            judge_mesh(case)
    total = count["read"] + count["refused"]
    print(f"{total} files of other programs: {count['read']} read, {count['refused']} refused")
    if total < 100:
        faults.append(f"only {total} files")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
