"""The walk through a page fails where a command fails or prints something else, on a program of its own."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent / "walk_through.py"
PAGE = """# A page
```jsonc
// a.json
{ "force": 12.5 }
```
```sh
apothem run a.json
```
```text
force  12.5 N
done
```
<!-- exit code 2 -->
```sh
apothem check b.json
```
<!-- not run -->
```sh
apothem explode
```
"""
PROGRAM = """#!/bin/sh
case $1 in
--help) echo "  run  runs" ;;
run) test -f $2 && echo "some line" && echo "force 12.5 N" && echo "done" ;;
*) exit 2 ;;
esac
"""


class Walk(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        self.program = self.folder / "apothem"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def tearDown(self):
        self.scratch.cleanup()

    def walk(self, page, *options):
        (self.folder / "page.md").write_text(page)
        result = subprocess.run([sys.executable, SCRIPT, self.folder / "page.md", "--program", self.program, *options],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        return result.returncode, result.stdout

    def test_a_page_that_is_right(self):
        code, text = self.walk(PAGE)
        self.assertEqual(code, 0, text)
        self.assertIn("2 blocks of commands do what the page says", text)

    def test_a_number_that_is_wrong(self):
        code, text = self.walk(PAGE.replace("force  12.5", "force  12.6"))
        self.assertEqual(code, 1)
        self.assertIn("line 9: this is not printed (here): force 12.6 N", text)

    def test_lines_in_another_order(self):
        self.assertEqual(self.walk(PAGE.replace("force  12.5 N\ndone", "done\nforce  12.5 N"))[0], 1)

    def test_a_command_that_fails(self):
        code, text = self.walk(PAGE.replace("// a.json", "// c.json"))
        self.assertEqual(code, 1)
        self.assertIn("line 6: exit code 1, not 0", text)

    def test_a_command_that_should_fail(self):
        self.assertEqual(self.walk(PAGE.replace("check b.json", "run a.json"))[0], 1)

    def test_a_page_without_commands(self):
        self.assertEqual(self.walk("# Nothing\n")[0], 1)

    def test_what_the_program_does_not_have_yet(self):
        page = PAGE + "```sh\napothem picture out\n```\n"
        self.assertEqual(self.walk(page)[0], 1)
        code, text = self.walk(page, "--not-yet", "picture")
        self.assertEqual(code, 0, text)
        self.assertIn("left out, there is no 'picture' yet", text)
        self.program.write_text(PROGRAM.replace("runs\"", "runs\"; echo \"  picture  draws\""))
        self.assertEqual(self.walk(page, "--not-yet", "picture")[0], 1)


if __name__ == "__main__":
    unittest.main()
