"""The check of the documents' numbers, on a folder with a program, a document and a list of its own."""
import contextlib
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "docs/check_numbers.py"
sys.path.insert(0, str(SCRIPT.parent))
import check_numbers


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

    def check(self, *options, command=None, machine=None):
        self.write("docs/numbers.json", json.dumps({
            "commands": {"lever": command or {"run": "apothem lever", "named": "apothem lever", "quick": True}},
            "machine": machine, "entries": self.entries}))
        words = ["--root", str(self.root), "--build", "build", *options]
        text = io.StringIO()
        with (mock.patch.object(sys, "argv", [str(SCRIPT), *words]), contextlib.redirect_stdout(text),
              contextlib.redirect_stderr(io.StringIO())):
            code = check_numbers.main()
        return code, text.getvalue()

    def replace(self, old, new, name="README.md"):
        self.write(name, (self.root / name).read_text().replace(old, new))

    def test_numbers_that_a_command_prints_are_ok(self):
        code, text = self.check()
        self.assertEqual(code, 0, text)
        self.assertIn("4 numbers ok, 0 stale", text)
        self.assertIn("asserted by the test 'a lever is in balance' (tests/test_a.cpp)", text)
        self.assertNotIn("no entry covers", text)

    def test_the_script_and_commands_that_run_at_the_same_time_say_the_same(self):
        self.replace("force 12.5 N", "force 12.7 N", "build/apothem")
        said = self.check("--quick")
        self.assertEqual(self.check("--quick", "--jobs", "2"), said)
        done = subprocess.run([sys.executable, SCRIPT, "--root", self.root, "--build", "build", "--quick"],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), said)

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
        self.entries = [self.entries[0], {"in": "README.md", "columns": ["force"]}]
        for within, code in (("2%", 0), ("1%", 1), ("x1.1", 0), ("0.3", 0), ("0.1", 1), ("below", 1)):
            self.entries[0]["within"] = [within, None, None]
            self.assertEqual(self.check()[0], code, within)

    def test_round_off_may_be_larger_by_the_factor_that_the_entry_says(self):
        self.replace("error 3e-9", "error 2.9e-8", "build/apothem")
        self.entries = [self.entries[0], {"in": "README.md", "columns": ["force"]}]
        for within, code in (("below", 1), ("below x10", 0), ("below x9", 1)):
            self.entries[0]["within"] = [None, within, None]
            self.assertEqual(self.check()[0], code, within)

    def test_a_printed_table_is_compared_letter_by_letter_also_without_programs(self):
        self.write("data/table.py", "print('| size | count |\\n| --- | --- |\\n| 1 | 20 |\\n')\n")
        self.write("README.md", "By `table.py`:\n\n| size | count |\n| --- | --- |\n| 1 | 21 |\n")
        self.entries = [{"in": "README.md", "table": "| size |", "printed": "lever"}]
        run = {"run": "python3 data/table.py", "named": "table.py", "data": True}
        code, text = self.check("--texts", command=run)
        self.assertEqual(code, 1)
        self.assertRegex(text, r"README.md:3 +stated a table +now lever +STALE")
        self.assertEqual(self.check("--texts", "--write", command=run)[0], 0)
        self.assertIn("| 1 | 20 |\n", (self.root / "README.md").read_text())
        code, text = self.check("--texts", command=run)
        self.assertEqual(code, 0)
        self.assertIn("1 numbers ok", text)

    def benchmark(self, arithmetic, quad):
        """A program that prints times of two cases, ns; the document states 2 Gop/s, 100 ns and a ratio of 200."""
        cases = [{"name": "machine_arithmetic", "times": [arithmetic], "extras": {}},
                 {"name": "quad", "times": [quad, 1.1 * quad], "extras": {"error": 1e-15}}]
        self.write("build/apothem", "#!/bin/sh\ncat <<END\n" + json.dumps({"cases": cases}, indent=1) + "\nEND\n")
        self.write("README.md", "`apothem lever`: arithmetic 2 to 2 G/s, pair 100 to 110 ns, error 1e-15, 200 times.\n")
        machine = "scaled(bench('machine_arithmetic', 'rate', 'lever'), 1e-9)"
        ratio = "ratio(bench('quad', 'time', 'lever'), bench('machine_arithmetic', 'time', 'lever'))"
        self.entries = [{"in": "README.md", "text": text, "values": [value], "within": "x1.2"} for text, value in (
            ("arithmetic {2 to 2} G/s", machine), ("pair {100 to 110} ns", "bench('quad', 'time', 'lever')"),
            ("error {1e-15},", "bench('quad', 'error', 'lever')"), ("{200} times", ratio))]
        return machine

    def test_times_are_compared_as_if_on_the_machine_of_the_document(self):
        machine = self.benchmark(.5, 100)
        self.assertEqual(self.check(machine=machine)[0], 0)
        machine = self.benchmark(1.5, 300)  # a machine of a third of the speed
        code, text = self.check(machine=machine)
        self.assertEqual(code, 0, text)
        self.assertRegex(text, r"stated 100 to 110 +now 100 to 110 \(as if there\) +ok")
        machine = self.benchmark(.5, 300)  # the same machine, and the pair takes three times as long
        code, text = self.check(machine=machine)
        self.assertEqual(code, 1)
        self.assertRegex(text, r"stated 100 to 110 +now 300 to 330 \(as if there\) +STALE")
        self.assertRegex(self.check("--times", "x4", machine=machine)[1], r"now 300 to 330 \(as if there\) +ok")

    def test_a_stale_time_is_measured_again_before_it_counts(self):
        machine = self.benchmark(.5, 100)
        right = (self.root / "build/apothem").read_text()
        self.benchmark(.5, 1000)
        wrong = (self.root / "build/apothem").read_text()
        self.write("build/right", right)
        self.write("build/wrong", wrong)
        for turns, code in ((1, 0), (2, 0), (3, 1)):  # so often the machine is disturbed
            self.write("build/turns", str(turns))
            self.write("build/apothem", '#!/bin/sh\ncd "$(dirname "$0")"\nleft=$(cat turns)\n'
                                        'echo $((left - 1)) > turns\n'
                                        'if [ "$left" -gt 0 ]; then . ./wrong; else . ./right; fi\n')
            result, text = self.check("--times", "x4", machine=machine)
            self.assertEqual(result, code, text)

    def test_what_a_test_compares_is_a_number_of_the_document(self):
        report = ("<Catch><TestCase>" + "".join(
            f"<Expression><Original>{left} &lt; 1e-12</Original><Expanded>{value} &lt; 0.000000000001</Expanded>"
            "</Expression>" for left, value in (
                ("error / scale", "0.0000000000003"), ("error / scale", "0.0000000000005"), ("other", "1.0f")))
            + "<Expression><Original>x == Approx( 2 )</Original><Expanded>2.002 == Approx( 2.0 )</Expanded></Expression>"
            "</TestCase></Catch>")
        self.write("report.xml", report)
        self.write("build/apothem_tests", '#!/bin/sh\n[ "$1" = "a lever is in balance" ] || exit 4\n'
                   'while [ "$1" != -o ]; do shift; done\ncp report.xml "$2"\n')
        (self.root / "build/apothem_tests").chmod(0o755)
        self.write("README.md", "Errors 5e-13, 3e-13, relative 0.001, twice.\n")
        seen = "seen('a lever is in balance', '{}'{})"
        self.entries = [{"in": "README.md", "text": "Errors {5e-13}, {3e-13}, relative {0.001},", "values": [
            "max(" + seen.format("error / scale", "") + ")", seen.format("error / scale", ", 0"),
            "max(" + seen.format("x", "") + ")"]},
            {"in": "README.md", "text": "{2} times", "values": ["times_seen('a lever is in balance', 'error / scale')"]}]
        self.write("README.md", "Errors 5e-13, 3e-13, relative 0.001, 2 times.\n")
        code, text = self.check("--tests", "build")
        self.assertEqual(code, 0, text)
        self.assertIn("4 numbers ok", text)

    def test_results_of_scenes_that_are_there_are_not_run_again(self):
        self.write("data/scenes/fall.json", "{}")
        (self.root / "there/fall").mkdir(parents=True)
        self.write("there/fall/run.json", json.dumps({"expectations": [
            {"quantity": "y", "take": "last", "value": 1.25, "expected": 1.0}]}))
        self.write("README.md", "It falls to 1.25 m.\n")
        self.entries = [{"in": "README.md", "text": "to {1.25} m", "values": ["expect('fall', 'y')"]}]
        code, text = self.check("--scenes", str(self.root / "there"))
        self.assertEqual(code, 0, text)
        self.assertIn("1 numbers ok", text)

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

    def test_a_number_of_the_readme_without_an_entry_is_wrong(self):
        self.replace("## Levers", "Apples cost 5 and weigh 8.25 kg (Fig. 7).\n\n## Levers")
        self.entries.append({"in": "README.md", "name": "cost 5"})
        code, text = self.check("--texts")
        self.assertEqual(code, 1)
        self.assertIn("WRONG README.md:8: no entry covers 8.25", text)
        self.assertNotIn("no entry covers 5", text)
        self.assertNotIn("no entry covers 7", text)

    def test_first_and_named_columns_of_tables_are_conditions_and_others_are_results(self):
        self.write("README.md", "| check | target | result |\n| --- | --- | --- |\n| 3 m | 1e-6 | 4e-8 |\n")
        self.entries = [{"in": "README.md", "columns": ["target"]}]
        text = self.check("--texts")[1]
        self.assertIn("no entry covers 4e-8", text)
        self.assertIn("1 entries wrong", text)
        self.entries[0]["columns"] = ["aim"]
        self.assertIn("no table of README.md has a column aim", self.check("--texts")[1])

    def test_a_program_that_is_not_built_leaves_its_numbers_out(self):
        (self.root / "build/apothem").unlink()
        code, text = self.check()
        self.assertEqual(code, 0)
        self.assertIn("build/apothem is not built: README.md, lines 1, 2, 6", text)


if __name__ == "__main__":
    unittest.main()
