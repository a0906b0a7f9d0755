"""Every public name has a docstring and a stub; the examples of docs/python run, and are typed."""
import ast
import importlib.util
import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import apothem
from support import SOURCE, FolderCase

STUBS = ast.parse((pathlib.Path(apothem.__file__).parent / "__init__.pyi").read_text())
EXAMPLES = SOURCE / "docs/python"
OF_PYTHON = {"__init__", "__len__", "__enter__", "__exit__"}


def members(name):
    """The public members of a class of the module, and the special ones that users call."""
    own = getattr(apothem, name)
    if issubclass(own, tuple):
        return set(own._fields)
    return {m for m in vars(own) if not m.startswith("_") or m in OF_PYTHON}


class Stubs(unittest.TestCase):
    def test_every_public_name_has_a_stub_and_a_docstring(self):
        stubs = {node.name: node for node in STUBS.body
                 if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_")}
        public = {name for name in apothem.__all__ if not name.startswith("_")}
        self.assertEqual(set(stubs), public)
        for name in sorted(public):
            with self.subTest(name=name):
                self.assertTrue(inspect.getdoc(getattr(apothem, name)))

    def test_every_member_has_a_stub_and_a_docstring(self):
        for node in STUBS.body:
            if not isinstance(node, ast.ClassDef) or issubclass(getattr(apothem, node.name), Exception):
                continue
            with self.subTest(name=node.name):
                stubs = {m.name if isinstance(m, ast.FunctionDef) else m.target.id for m in node.body}
                own = members(node.name)
                if "__init__" not in stubs:
                    own.discard("__init__")  # nobody makes objects of this class
                self.assertEqual(stubs, own)
                for member in own - OF_PYTHON:
                    self.assertTrue(inspect.getdoc(getattr(getattr(apothem, node.name), member)), member)

    def test_the_arguments_of_stubs_are_those_of_the_module(self):
        for owner, functions in [(apothem, STUBS)] + [
                (getattr(apothem, n.name), n) for n in STUBS.body if isinstance(n, ast.ClassDef)]:
            if inspect.isclass(owner) and issubclass(owner, (tuple, Exception)):
                continue
            for node in functions.body:
                if not isinstance(node, ast.FunctionDef) or node.decorator_list or (
                        node.name in OF_PYTHON - {"__init__"}):
                    continue
                signature = getattr(owner, node.name).__doc__.splitlines()[0]
                names = re.findall(r"(\w+): ", re.sub(r"self: [^,)]+(, )?", "", signature, count=1))
                with self.subTest(owner=owner, name=node.name):
                    self.assertEqual([a.arg for a in node.args.args if a.arg != "self"], names)

    def test_units_are_named_where_numbers_are(self):
        for owner, names in [(apothem.Bodies, ["position", "velocity", "force", "mass", "inertia"]),
                             (apothem.Nodes, ["position", "displacement", "velocity", "force"]),
                             (apothem.Forces, ["bodies", "nodes"]),
                             (apothem.Elements, ["stress"]), (apothem.Polygon, ["area", "centroid"]),
                             (apothem.Simulation, ["time", "step_size", "origin", "contacts",
                                                   "energies", "momenta"]),
                             (apothem, ["contact", "overlap"])]:
            for name in names:
                text = re.sub(r"\([a-z0-9, ]*\)", "", getattr(owner, name).__doc__)  # sizes of arrays
                self.assertRegex(text, r"\b(m|s|rad|N|J|kg|Pa|m/s|m\^2)\b", name)


class Examples(FolderCase):
    def test_code_in_the_pages(self):
        pages = sorted((SOURCE / "docs").rglob("*.md"))
        blocks = [(page, code) for page in pages
                  for code in re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.M | re.S)]
        self.assertGreaterEqual(len(blocks), 2)
        for page, code in blocks:
            with self.subTest(page=page):
                done = subprocess.run([sys.executable, "-c", code], cwd=SOURCE, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)

    def run_example(self, name, *words):
        environment = dict(os.environ, MPLCONFIGDIR=str(self.folder), MPLBACKEND="Agg")
        done = subprocess.run([sys.executable, EXAMPLES / name, *words], cwd=self.folder,
                              env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def needs(self, *modules):
        for module in modules:
            if importlib.util.find_spec(module) is None:
                self.skipTest(module + " is not installed")

    def test_stones(self):
        self.needs("matplotlib")
        self.run_example("stones.py")
        self.assertGreater((self.folder / "stones.png").stat().st_size, 10000)

    def test_repose(self):
        rows = self.run_example("repose.py", "60").replace("°", "").splitlines()[1:]
        slopes = [float(row.split()[2]) for row in rows]
        self.assertEqual(len(slopes), 3)
        self.assertGreater(slopes[0], 5)
        self.assertGreater(min(slopes[1:]), slopes[0] + 3)
        self.assertLess(max(slopes), 60)

    def test_own_shapes(self):
        self.needs("matplotlib", "meshio", "shapely")
        text = self.run_example("own_shapes.py", "own_shapes.png")
        self.assertRegex(text, r"wedge and (bitten|letter|star): \d+ N at")
        self.assertGreater((self.folder / "own_shapes.png").stat().st_size, 10000)

    def test_examples_are_typed(self):
        mypy = shutil.which("mypy")
        if mypy is None:
            self.skipTest("mypy is not installed")
        package = pathlib.Path(apothem.__file__).parent
        for files in [[package], sorted(EXAMPLES.glob("*.py"))]:
            done = subprocess.run([mypy, "--ignore-missing-imports", "--strict-equality",
                                   "--cache-dir", self.folder / "cache", *files],
                                  cwd=self.folder, capture_output=True, text=True,
                                  env=dict(os.environ, MYPYPATH=str(package.parent)))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
