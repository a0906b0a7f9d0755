"""The check of the documents' numbers, on a folder with a program, a document and a list of its own."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "docs/check_numbers.py"


class Numbers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for name in ("docs", "tests", "build", "data/scenes"):
            (self.root / name).mkdir(parents=True)
        self.write("tests/test_a.cpp", 'TEST_CASE("a lever is in balance", "[lever]") {}\n'
                                       'TEST_CASE("a long name of a test that is divided "\n  "into two") {}\n')
        self.write("build/apothem", "#!/bin/sh\necho force 12.5 N, error 3e-9, 7 failures\n")
        (self.root / "build/apothem").chmod(0o755)
        self.write("README.md", "Printed by `apothem lever`: force 12.5\nN, error 3e-9, 7 failures.\n\n"
                                "| case | force |\n| --- | --- |\n| lever (2) | 12.5 |\n\n"
                                "## Levers\n| check | result |\n| --- | --- |\n| balance | holds |\n")
        self.entries = [
            {"in": "README.md", "text": "force {12.5} N, error {3e-9}, {7} failures.",
             "values": ["out('lever', 'force (\\\\S+)')".replace("\\\\", "\\"),
                        "out('lever', r'error ([^,]+)')", "out('lever', r'(\\d) failures')"]},
            {"in": "README.md", "table": "| case |", "cells": {"force": ["out(row, r'force (\\S+)')"]}},
            {"in": "README.md", "heading": "## Levers", "rows": {"balance": ["a lever is in balance"]}}]

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        (self.root / name).write_text(text)

    def check(self, *options):
        self.write("docs/numbers.json", json.dumps({
            "commands": {"lever": {"run": "apothem lever", "named": "apothem lever", "quick": True}},
            "entries": self.entries}))
        result = subprocess.run([sys.executable, SCRIPT, "--root", self.root, "--build", "build", *options],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        return result.returncode, result.stdout

    def replace(self, old, new, name="README.md"):
        self.write(name, (self.root / name).read_text().replace(old, new))

    def test_numbers_that_a_command_prints_are_ok(self):
        code, text = self.check()
        self.assertEqual(code, 0, text)
        self.assertIn("4 numbers ok, 0 stale", text)
        self.assertIn("asserted by the test 'a lever is in balance' (tests/test_a.cpp)", text)
        self.assertNotIn("no entry covers", text)

    def test_a_number_that_has_changed_is_stale_and_named_with_its_line(self):
        self.replace("force 12.5 N", "force 12.7 N", "build/apothem")
        code, text = self.check()
        self.assertEqual(code, 1)
        self.assertRegex(text, r"README.md:1 +stated 12.5 +now 12.7 +STALE")
        self.assertRegex(text, r"README.md:6 +stated 12.5 +now 12.7 +STALE")
        self.assertRegex(text, r"README.md:2 +stated 3e-9 +now 3e-09 +ok")

    def test_stale_numbers_are_replaced_in_their_form(self):
        self.write("build/apothem", "#!/bin/sh\necho force 1987.6 N, error 4.2e-8, 7 failures\n")
        code, text = self.check("--write")
        self.assertEqual(code, 0, text)
        self.assertIn("1 numbers ok, 0 stale, 3 written", text)
        page = (self.root / "README.md").read_text()
        self.assertIn("force 1990\nN, error 4e-8, 7 failures", page)
        self.assertIn("| lever (2) | 1990 |", page)
        self.entries = json.loads((self.root / "docs/numbers.json").read_text())["entries"]
        self.assertEqual(self.entries[0]["text"], "force {1990} N, error {4e-8}, {7} failures.")
        code, text = self.check()
        self.assertEqual(code, 0, text)
        self.assertIn("4 numbers ok, 0 stale", text)

    def test_ranges_and_bounds_are_replaced(self):
        self.write("README.md", "Printed by `apothem lever`: from 0.31 to 0.52 of 10 250 and < 1e-9 of 45k\n")
        self.entries = [{"in": "README.md", "text": "from {0.31 to 0.52} of {10 250} and {< 1e-9} of {45k}",
                         "values": ["(0.617, 1.04)", "23456.7", "3.2e-9 + 0 * out('lever', r'force (\\S+)')", "61234"]}]
        self.check("--write")
        self.assertEqual((self.root / "README.md").read_text(),
                         "Printed by `apothem lever`: from 0.62 to 1.0 of 23 457 and < 4e-9 of 61k\n")

    def test_a_fresh_number_may_differ_by_what_the_entry_says(self):
        self.replace("force 12.5 N", "force 12.7 N", "build/apothem")
        self.entries = self.entries[:1]
        for within, code in (("2%", 0), ("1%", 1), ("x1.1", 0), ("0.3", 0), ("0.1", 1), ("below", 1)):
            self.entries[0]["within"] = [within, None, None]
            self.assertEqual(self.check()[0], code, within)

    def test_a_passage_a_row_or_a_test_that_is_gone_is_wrong_without_any_run(self):
        self.replace("error 3e-9", "error 4e-9")
        code, text = self.check("--texts")
        self.assertEqual(code, 1)
        self.assertIn("WRONG not in README.md", text)
        self.replace("error 4e-9", "error 3e-9")
        self.assertEqual(self.check("--texts")[0], 0)
        self.replace("| balance | holds |", "| balance | holds |\n| weight | 1 |")
        self.assertIn("no test is named for the row: weight", self.check("--texts")[1])
        self.replace("\n| weight | 1 |", "")
        self.replace("a lever is", "a lever was", "tests/test_a.cpp")
        code, text = self.check("--texts")
        self.assertEqual(code, 1)
        self.assertIn("the test does not exist: a lever is in balance", text)

    def test_a_test_name_may_be_written_in_two_parts(self):
        self.entries[2]["rows"]["balance"] = ["a long name of a test that is divided into two"]
        self.assertEqual(self.check("--texts")[0], 0)

    def test_a_command_that_the_document_does_not_name_is_wrong(self):
        self.replace("`apothem lever`", "a program")
        self.assertIn("does not name the command: apothem lever", self.check("--texts")[1])

    def test_a_command_that_fails_is_wrong(self):
        self.replace("#!/bin/sh", "#!/bin/sh\nexit 3", "build/apothem")
        code, text = self.check()
        self.assertEqual(code, 1)
        self.assertIn("'apothem lever' ended with exit code 3", text)

    def test_numbers_of_the_readme_without_an_entry_are_listed(self):
        self.replace("## Levers", "Fig. 5 weighs 8.25 kg.\n\n## Levers")
        self.entries.append({"in": "README.md", "name": "Fig. 5"})
        text = self.check()[1]
        self.assertIn("README.md:8: no entry covers 8.25", text)
        self.assertNotIn("no entry covers 5", text)

    def test_a_program_that_is_not_built_leaves_its_numbers_out(self):
        (self.root / "build/apothem").unlink()
        code, text = self.check()
        self.assertEqual(code, 0)
        self.assertIn("build/apothem is not built: README.md, lines 1, 2, 6", text)


if __name__ == "__main__":
    unittest.main()
