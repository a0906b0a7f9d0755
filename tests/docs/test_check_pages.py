"""The check of links, commands and JSON, on a folder with a program and pages of its own."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent / "check_pages.py"
PAGE = """# A page of *mine*
See [the other](docs/other.md#a-part-of-it) and [above](#a-page-of-mine).
```sh
apothem run data/a.json --fast \\
    --quiet   # a comment
```
Say `apothem run SCENE --fast`.
```jsonc
// scene.json
{ "a": 1 }  // a comment
```
```jsonc
"b": { "url": "http://x" }
```
"""
PROGRAM = """#!/bin/sh
case $1$2 in
--help) printf 'Subcommands:\\n  run    runs\\n  check  checks\\n' ;;
run--help) echo "  --fast  --quiet" ;;
check--help) echo "  --json" ;;
check*) grep -q '"a"' $2 || { echo "no a"; exit 2; } ;;
esac
"""


class Check(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.scratch.name)
        (self.root / "docs").mkdir()
        (self.root / "data").mkdir()
        (self.root / "data/a.json").write_text("{}")
        (self.root / "docs/other.md").write_text("# Other\n## A part of it\n")
        self.program = self.root / "apothem"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def tearDown(self):
        self.scratch.cleanup()

    def check(self, old="", new="", *options):
        self.assertIn(old, PAGE)
        (self.root / "README.md").write_text(PAGE.replace(old, new) if old else PAGE)
        result = subprocess.run([sys.executable, SCRIPT, "--root", self.root, "--program", self.program, *options],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        return result.returncode, result.stdout

    def wrong(self, old, new, message):
        code, text = self.check(old, new)
        self.assertEqual(code, 1, text)
        self.assertIn(message, text)

    def test_a_command_outside_of_a_block(self):
        self.wrong("Say `apothem run", "Say\n\n    apothem run x\n\n`apothem run", "not in a block of commands")

    def test_a_page_that_is_right(self):
        code, text = self.check()
        self.assertEqual(code, 0, text)
        self.assertIn("2 links, 2 commands, 2 JSON blocks: 0 problems", text)

    def test_links(self):
        self.wrong("docs/other.md#", "docs/none.md#", "README.md:2: there is no file docs/none.md")
        self.wrong("#a-part-of-it", "#a-part", "README.md:2: there is no heading docs/other.md#a-part")
        self.wrong("#a-page-of-mine", "#mine", "README.md:2: there is no heading #mine")

    def test_commands(self):
        self.wrong("--quiet", "--loud", "README.md:4: apothem run has no option --loud")
        self.wrong("SCENE --fast", "SCENE --slow", "README.md:7: apothem run has no option --slow")
        self.wrong("apothem run data", "apothem walk data", "README.md:4: there is no command: apothem walk")
        self.wrong("data/a.json", "data/b.json", "README.md:4: there is no file data/b.json")
        self.assertEqual(self.check("apothem run data", "apothem walk data", "--not-yet", "walk")[0], 0)

    def test_json(self):
        self.wrong('{ "a": 1 }', '{ "a": 1, }', "README.md:8: no valid JSON")
        self.wrong('{ "a": 1 }', '{ "c": 1 }', "README.md:8: the scene scene.json is refused: no a")
        self.wrong('"b": {', '"b": ', "README.md:12: no valid JSON")


if __name__ == "__main__":
    unittest.main()
