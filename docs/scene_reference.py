#!/usr/bin/env python3
"""Writes docs/scene-reference.md, the tables of all keys of a scene, from docs/scene.schema.json.

With --check nothing is written; exit code 1 says that the file is not what the schema gives, or that a
key has no description.
"""
import argparse
import difflib
import json
import pathlib
import re
import sys

DOCS = pathlib.Path(__file__).resolve().parent
UNIT = re.compile(r" ?\[(m|s|1/s|m/s|m/s\^2|rad|rad/s|kg/m\^3|Pa|N|N/m\^3|J)\](?=[.:,; ])")
HEAD = """# All keys of a scene

*Written by `docs/scene_reference.py` from [scene.schema.json](scene.schema.json), which editors and tests use as well.
[The scene format](scene-format.md) explains in words what the keys do together.*

In the column of defaults, "needed" says that the object must have the key. Where the cell is empty, the meaning says what
holds without the key; if it says nothing, then nothing happens without it. All quantities are in SI units, angles in
radians. `[x, y]` are two numbers. File names are relative to the folder of the scene.

"""
# The objects of a scene, in the order of the tables: where an object stands, and its place in the schema.
RIGID, MESHED, MESH = "definitions/rigid_body", "definitions/deformable_body", "definitions/mesh"
PRESCRIBED = RIGID + "/properties/motion/anyOf/1"
OBJECTS = [
    ("The scene", "", ""),
    ("Gravity that changes", "gravity", "definitions/gravity"),
    ("Materials", "materials.NAME", "properties/materials/additionalProperties"),
    ("Damping of a material", "materials.NAME.damping",
     "properties/materials/additionalProperties/properties/damping"),
    ("Contact", "contact", "properties/contact"),
    ("Friction", "contact.friction", "properties/contact/properties/friction"),
    ("Damping of contacts", "contact.damping", "definitions/damping"),
    ("Rules for pairs", "contact.pairs[]", "properties/contact/properties/pairs/items"),
    ("Friction of a pair", "contact.pairs[].friction",
     "properties/contact/properties/pairs/items/properties/friction"),
    ("Damping of a pair", "contact.pairs[].damping",
     "properties/contact/properties/pairs/items/properties/damping"),
    ("Rigid bodies", "bodies[]", RIGID),
    ("Prescribed motion", "bodies[].motion", PRESCRIBED),
    ("Walls that hold a force", "bodies[].motion.servo",
     RIGID + "/properties/motion/anyOf/2/properties/servo"),
    ("Bodies with a mesh", "bodies[]", MESHED),
    ("Meshes", "bodies[].mesh", MESH),
    ("Rectangle", "bodies[].mesh.rectangle", MESH + "/properties/rectangle"),
    ("Disc", "bodies[].mesh.disc", MESH + "/properties/disc"),
    ("Half disc", "bodies[].mesh.half_disc", MESH + "/properties/half_disc"),
    ("Filled polygon", "bodies[].mesh.fill", MESH + "/properties/fill"),
    ("Voronoi cells", "bodies[].mesh.voronoi", MESH + "/properties/voronoi"),
    ("Mirror image", "bodies[].mesh.mirror", MESH + "/properties/mirror"),
    ("Supports", "bodies[].supports[]", "definitions/support"),
    ("Loads", "bodies[].loads[]", "definitions/load"),
    ("Places on a mesh", "bodies[].supports[].where, bodies[].loads[].where", "definitions/place"),
    ("Fills", "fill[]", "definitions/fill"),
    ("Shapes of blocks", "fill[].shapes[]", "definitions/shape"),
    ("Random quadrilateral", "fill[].shapes[].quadrilateral",
     "definitions/shape/properties/quadrilateral"),
    ("Random polygon", "fill[].shapes[].polygon_random", "definitions/shape/properties/polygon_random"),
    ("Cross", "fill[].shapes[].cross", "definitions/shape/properties/cross"),
    ("Distribution of diameters", "fill[].diameter", "definitions/fill/properties/diameter/oneOf/1"),
    ("Lognormal diameters", "fill[].diameter.lognormal",
     "definitions/fill/properties/diameter/oneOf/1/properties/lognormal"),
    ("Elements of blocks", "fill[].mesh", "definitions/fill/properties/mesh"),
    ("Batches", "fill[].repeat", "definitions/fill/properties/repeat"),
    ("Imports", "import[]", "definitions/import"),
    ("Layers of an import", "import[].layers.NAME", "definitions/import_layer"),
    ("Elements of imported bodies", "import[].mesh, import[].layers.NAME.mesh",
     "definitions/filling/oneOf/1"),
    ("Regions", "regions.NAME", "properties/regions/additionalProperties"),
    ("World", "world", "properties/world"),
    ("Stop rules", "stop[]", "properties/stop/items"),
    ("Time", "time", "properties/time"),
    ("Output", "output", "properties/output"),
    ("History", "output.history", "properties/output/properties/history"),
    ("Tracked bodies and points", "output.history.track[]",
     "properties/output/properties/history/properties/track/items"),
    ("Checkpoints", "output.checkpoint", "properties/output/properties/checkpoint/oneOf/1"),
    ("Expectations", "expect[]", "definitions/expectation"),
    ("Measures", "measure[]", "properties/measure/items"),
]


class Reference:
    def __init__(self, schema):
        self.schema = schema
        self.sections = {pointer: title for title, _, pointer in OBJECTS}
        self.problems = []

    def at(self, pointer):
        node = self.schema
        for key in filter(None, pointer.split("/")):
            node = node[int(key)] if isinstance(node, list) else node[key]
        return node

    def resolved(self, node, pointer):
        """A node with what it refers to; its own keywords win. And where that stands."""
        while "$ref" in node:
            pointer = node["$ref"].removeprefix("#/")
            node = {**self.at(pointer), **{k: v for k, v in node.items() if k != "$ref"}}
            if "$ref" in self.at(pointer):
                node["$ref"] = self.at(pointer)["$ref"]
        return node, pointer

    def link(self, pointer):
        title = self.sections[pointer]
        return f"[{title}](#{title.lower().replace(' ', '-')})"

    def type_of(self, node, pointer):
        node, pointer = self.resolved(node, pointer)
        if pointer in self.sections:
            return self.link(pointer)
        if "const" in node:
            return f"`{json.dumps(node['const'])}`"
        if "enum" in node:
            return " or ".join(f"`{json.dumps(value)}`" for value in node["enum"])
        for choice in ("oneOf", "anyOf"):
            if choice in node and any("required" not in way for way in node[choice]):
                ways = [self.type_of(way, f"{pointer}/{choice}/{i}") for i, way in enumerate(node[choice])]
                return ", or ".join(dict.fromkeys(ways))
        kind = node.get("type")
        if kind == "array":
            return self.list_of(node, pointer)
        if kind == "object":
            members = node.get("additionalProperties")
            if isinstance(members, dict):
                return f"an object of {self.type_of(members, pointer + '/additionalProperties')}"
            inner = [self.type_of(v, f"{pointer}/properties/{k}") for k, v in node["properties"].items()]
            return "`{ " + ", ".join(f'"{k}"' for k in node["properties"]) + " }`: " + ", ".join(inner)
        if kind in ("number", "integer"):
            return ("number" if kind == "number" else "whole number") + self.bounds(node)
        return {"string": "text", "boolean": "`true` or `false`"}.get(kind, "anything")

    def list_of(self, node, pointer):
        items, inner = node["items"], pointer + "/items"
        kind = self.type_of(items, inner)
        size = node.get("minItems")
        if size is not None and size == node.get("maxItems"):
            return f"[{', '.join([kind] * size)}]"
        return f"list of {kind}"

    @staticmethod
    def bounds(node):
        low, above = node.get("minimum"), node.get("exclusiveMinimum")
        high, below = node.get("maximum"), node.get("exclusiveMaximum")
        words = []
        if low is not None and high is not None:
            return f", {low:g} to {high:g}"
        for sign, value in ((">=", low), (">", above), ("<=", high), ("<", below)):
            if value is not None:
                words.append(f"{sign} {value:g}")
        return ", " + " and ".join(words) if words else ""

    def row(self, key, node, pointer, needed):
        node, where = self.resolved(node, pointer)
        text = node.get("description", "")
        if not text and where in self.sections:
            text = self.at(where).get("description", "") or self.sections[where] + "."
        if not text:
            self.problems.append(f"{pointer} has no description")
        units = UNIT.findall(text)
        if len(set(units)) > 1:
            self.problems.append(f"{pointer} has two units: {', '.join(units)}")
        default = "needed" if needed else ""
        if "default" in node:
            value = node["default"]
            default = f"`{value:.4g}`" if isinstance(value, float) else f"`{json.dumps(value)}`"
            if isinstance(value, list):
                default = "`[" + ", ".join(f"{v:.4g}" for v in value) + "]`"
        cells = [f"`{key}`", self.type_of(self.at(pointer), pointer), units[0] if units else "", default,
                 UNIT.sub("", text)]
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    def table(self, title, place, pointer):
        node = self.at(pointer)
        lines = [f"## {title}", ""]
        if place:
            lines += ["In " + ", ".join(f"`{one}`" for one in place.split(", ")) + ". "
                      + node.get("description", ""), ""]
        lines += ["| key | value | unit | default | meaning |", "| --- | --- | --- | --- | --- |"]
        for key, value in node["properties"].items():
            if "not" in value:  # a key of objects of another kind, of which the schema says so
                continue
            lines.append(self.row(key, value, f"{pointer}/properties/{key}".lstrip("/"),
                                  key in node.get("required", [])))
        return "\n".join(line.rstrip() for line in lines) + "\n"

    def text(self):
        return HEAD + "\n".join(self.table(*one) for one in OBJECTS)

    def unlisted(self):
        """Objects of the schema that have keys but no table."""
        shown = {pointer for _, _, pointer in OBJECTS} | {RIGID + "/properties/motion/anyOf/2"}

        def walk(node, pointer):
            if isinstance(node, dict):
                if isinstance(node.get("properties"), dict) and pointer not in shown:
                    yield pointer
                for key, value in node.items():
                    yield from walk(value, f"{pointer}/{key}".lstrip("/"))
            elif isinstance(node, list):
                for i, value in enumerate(node):
                    yield from walk(value, f"{pointer}/{i}")
        return [pointer for pointer in walk(self.schema, "") if not pointer.endswith("properties")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare the file, and write nothing")
    parser.add_argument("--schema", default=DOCS / "scene.schema.json", type=pathlib.Path)
    parser.add_argument("--output", default=DOCS / "scene-reference.md", type=pathlib.Path)
    options = parser.parse_args()
    reference = Reference(json.loads(options.schema.read_text()))
    text = reference.text()
    problems = reference.problems + [f"{pointer} has no table" for pointer in reference.unlisted()]
    if options.check:
        old = options.output.read_text() if options.output.exists() else ""
        problems += list(difflib.unified_diff(old.splitlines(), text.splitlines(), options.output.name,
                                              "what the schema gives", lineterm="", n=0))
    else:
        options.output.write_text(text)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
