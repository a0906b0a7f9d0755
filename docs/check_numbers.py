#!/usr/bin/env python3
"""Compares the numbers of the documents with a fresh run of the commands that print them.

docs/numbers.json lists the numbers. An entry is one of:

  {"in": DOCUMENT, "text": "the force is {9.605e5} N", "values": ["expect('impact', 'b.fy', 'max')"]}
      A passage with its numbers in braces, and an expression for each of them. `{< 1e-9}` is a bound,
      `{20 to 30}` a range. The expression gives a number, or the least and the largest of several.
  {"in": DOCUMENT, "table": "| case |", "cells": {"edge": ["csv('accuracy', row, 'edge', 'time')"]}}
      All rows of the table whose header starts so. The expressions belong to the numbers of a cell, from
      left to right; `row` is the first cell of the row, `first` the last one that is not empty, `cells`
      are all. `where` (an expression) chooses rows. Numbers that a cell leaves out at its end must be 0.
  {"in": DOCUMENT, "table": "| case |", "printed": COMMAND}
      The whole table, letter by letter, as the command prints it.
  {"in": DOCUMENT, "heading": "## Meshes", "rows": {"start of a row": ["name of a test"]}}
      A section that rests on tests: the tests exist, and every row of its tables is listed. Its key
      `text` lists in the same way what the section states outside of tables.
  {"in": DOCUMENT, "name": "Fig. 13"}
      Digits that are part of a name, or a choice of ours; nothing prints them.
  {"in": DOCUMENT, "columns": ["check", "reference"]}
      Columns of tables that say what is done, and what should come out: conditions of ours, values of theory or of a
      source. The first column of every table and the titles of columns are such.

Expressions may use the methods of `Fresh` in docs/fresh_numbers.py: `out` for what a command prints, `expect`,
`summary` and `history` for the run of a scene, `bench` for a case of the benchmark, `csv`, `total` and `crashes` for
`apothem accuracy`, and `seen` for the values that a test case compares with its bounds.

`within` says by how much a fresh number may differ: "2%", "x3" (a factor, for times), "1e-3" (in the
unit of the text), "below" (a bound), "below x10" (at most ten times as much: round-off); without it by one unit of the
last digit that is stated. Commands are in `commands`, and the document names them by `named`; scenes need none,
`apothem run` makes them. A command is run once, when a number needs it; with --quick only those that have the key `quick`,
which may be a shorter command; --jobs runs so many of these at a time, first of all. {NAME} in a command is the folder of
another one's results, {program} is apothem. A command of `data` needs no program that has to be built.

Times are compared as if on the machine of the documents: they are multiplied by the rate of its arithmetic now over
the one that the documents state (`machine`), both measured by the benchmark. With --times all of them, and all ratios
of times, may differ by one factor, which is for a machine that others use; a command whose times differ by more is run
again, up to twice, before they count as stale.

With --write, stale numbers are replaced by fresh ones, with as many digits, here and in docs/numbers.json; so are all
times that a whole run gives (without --quick), that those of a page are of one machine.

Exit code 1: a number is stale and not replaced, a passage is gone, a test does not exist, or a number of README.md or
docs/verification.md stands in no entry.
"""
import argparse
import json
import math
import pathlib
import re
import sys

from number_forms import RANGE, Problem, agrees, number, restated
from fresh_numbers import Fresh, NotRun, Time, scaled


CHECKS = "docs/verification.md"  # the page that names the command of every number


def loose(text):
    """A pattern of a text in which any white space stands for any other."""
    return re.sub(r"(?:\\?\s)+", lambda _: r"\s+", re.escape(text))


class Document:
    def __init__(self, root, name):
        self.name = name
        self.text = (root / name).read_text()
        self.lines = self.text.split("\n")
        self.covered = []
        self.given = set()  # titles of columns that say what is done
        self.replacements = []  # (start, end, text)

    def line(self, position):
        return self.text.count("\n", 0, position) + 1

    def write(self, path):
        """Replaces numbers, the last ones first."""
        for start, end, text in sorted(self.replacements, reverse=True):
            self.text = self.text[:start] + text + self.text[end:]
        path.write_text(self.text)

    def places(self, passage):
        """Where the numbers in braces of a passage stand."""
        pattern = "".join(f"({loose(piece)})" if k % 2 else loose(piece)
                          for k, piece in enumerate(re.split(r"[{}]", passage)))
        match = re.search(pattern, self.text)
        return [match.span(k + 1) for k in range(match.re.groups)]

    def find(self, passage):
        """Start and end of a passage; any white space stands for any other."""
        pattern = loose(passage.strip())
        found = list(re.finditer(pattern, self.text))
        if len(found) != 1:
            raise Problem(f"{'not' if not found else 'more than once'} in {self.name}: {passage}")
        return found[0].span()

    def section(self, heading):
        """First line (from 0) behind a heading, and the line of the next one."""
        at = [i for i, line in enumerate(self.lines) if line.startswith(heading)]
        if len(at) != 1:
            raise Problem(f"{'no' if not at else 'more than one'} heading in {self.name}: {heading}")
        end = at[0] + 1
        while end < len(self.lines) and not self.lines[end].startswith("#"):
            end += 1
        return at[0], end

    def rows(self, first, end):
        """Lines of table rows between two lines, with their cells; headers are left out."""
        for i in range(first, end):
            line = self.lines[i]
            ruled = i + 1 < len(self.lines) and self.lines[i + 1].startswith("| ---")
            if line.startswith("|") and not line.startswith("| ---") and not ruled:
                yield i, [cell.strip() for cell in line.strip("|").split("|")]

    def conditions(self):
        """Where tables say what is done: titles, first columns, and the columns that an entry names."""
        titles, start = None, 0
        for line in self.lines:
            if not line.startswith("|"):
                titles = None
            elif titles is None:
                titles = [cell.strip() for cell in line.strip("|").split("|")]
                yield start, start + len(line)
            else:
                bars = [m.start() for m in re.finditer(r"\|", line)]
                for column, (begin, end) in enumerate(zip(bars, bars[1:])):
                    if column == 0 or titles[column] in self.given:
                        yield start + begin, start + end
            start += len(line) + 1

    def uncovered(self):
        """Numbers that stand neither in an entry nor in code, links, headings, conditions and numbers of figures."""
        hidden = list(self.covered) + list(self.conditions())
        for pattern in (r"```.*?```", r"`[^`]*`", r"\[[^\]]*\]\([^)]*\)", r"<[^>]*>", r"\n\d+\. ", r"\n#[^\n]*",
                        r"\b(?:Figs?|Secs?|Eqs?)\.\s+[\d.]+(?:-\d+|(?:,| and| to)\s+\d+)*"):
            hidden += [m.span() for m in re.finditer(pattern, self.text, re.DOTALL)]
        for match in re.finditer(r"(?<![\w.])[-+]?\.?\d[\d.,]*(?:e[-+]?\d+)?", self.text):
            if not any(a <= match.start() < b for a, b in hidden):
                yield self.line(match.start()), match.group().rstrip(".,")


def tests_of(root):
    """Names of the test cases and of the scripts that are tests, by file."""
    names = {}
    for path in (root / "tests").rglob("CMakeLists.txt"):
        for name in re.findall(r"add_test\(NAME ([\w.]+)", path.read_text()):
            names[name] = path.relative_to(root)
    for path in (root / "tests").rglob("*.cpp"):
        for match in re.finditer(r'TEST_CASE\(\s*((?:"[^"]*"\s*)+)', path.read_text()):
            names["".join(re.findall(r'"([^"]*)"', match.group(1)))] = path.relative_to(root)
    return names


class Checker:
    def __init__(self, root, options):
        self.root, self.options = root, options
        data = json.loads((root / "docs/numbers.json").read_text())
        self.entries, self.commands = data["entries"], data["commands"]
        self.fresh = Fresh(root, self.commands, data.get("slow scenes", []), options)
        self.tests = tests_of(root)
        self.documents = {}
        self.machine = self.speed_of_the_documents(data.get("machine"))
        self.repeated = {}  # how often commands were run again because of their times
        self.table, self.problems, self.asserted = [], [], []

    def speed_of_the_documents(self, expression):
        """Least and largest speed of the machine that the documents state by an entry with this expression."""
        for entry in self.entries:
            if expression and expression in entry.get("values", []):
                stated = re.findall(r"\{([^}]*)\}", entry["text"])[entry["values"].index(expression)].split(" to ")
                return {"stated": (number(stated[0])[0], number(stated[-1])[0]), "value": expression}
        return None

    def document(self, name):
        if name not in self.documents:
            self.documents[name] = Document(self.root, name)
        return self.documents[name]

    def compare(self, document, line, stated, expression, within, place=None, **more):
        """Returns what to state instead, or None. `place`: start and end of the number in the document."""
        number(stated)
        try:
            now, compared, right = self.agreement(stated, expression, within, more)
            while isinstance(now, Time) and not right and self.options.times and self.run_again():
                now, compared, right = self.agreement(stated, expression, within, more)
        except NotRun as why:
            if not self.options.texts:
                self.table.append((document.name, line, stated, "-", f"not run: {why}"))
            return None
        low, high = compared if isinstance(compared, (tuple, list)) else (compared, compared)
        shown = f"{low:.7g} to {high:.7g}" if isinstance(compared, (tuple, list)) else f"{low:.7g}"
        if compared is not now:
            shown += " (as if there)"
        new = None
        if self.options.write and place and math.isfinite(low) and math.isfinite(high):
            if (isinstance(now, Time) and not self.options.quick) or not right:
                new = restated(stated, now)
            new = new if new != stated else None
        self.table.append((document.name, line, stated, shown, "written" if new else "ok" if right else "STALE"))
        if new:
            document.replacements.append((*place, new))
        return new

    def agreement(self, stated, expression, within, more):
        """The fresh value, what it is compared as, and whether it agrees."""
        self.fresh.asked.clear()
        now = self.fresh.evaluate(expression, **more)
        compared = now
        if isinstance(now, Time):
            if now.power and self.machine:
                compared = scaled(now, self.fresh.machine(self.machine) ** now.power)
            within = self.options.times or within
        return now, compared, agrees(stated, compared, within)

    def run_again(self):
        """Lets the commands that were just asked for run once more; False if they have been, twice."""
        again = {name for name in self.fresh.asked if self.repeated.get(name, 0) < 2}
        for name in again:
            self.repeated[name] = self.repeated.get(name, 0) + 1
        self.fresh.forget(again)
        return bool(again)

    def commands_are_named(self, document, expressions):
        """The document names every command that the expressions use."""
        for name, command in self.commands.items():
            used = any(re.search(rf"'{re.escape(name)}'", e) for e in expressions)
            if name == "benchmark":
                used = used or any("bench(" in e for e in expressions)
            if used:
                self.is_named(document, command)

    def is_named(self, document, command):
        """The README leaves the commands to the page of all checks."""
        texts = [document.text]
        if document.name == "README.md" and (self.root / CHECKS).exists():
            texts.append(self.document(CHECKS).text)
        if not any(" ".join(command["named"].split()) in " ".join(text.split()) for text in texts):
            raise Problem(f"{document.name} does not name the command: {command['named']}")

    def passage(self, entry):
        document = self.document(entry["in"])
        text = entry["text"]
        stated = re.findall(r"\{([^}]*)\}", text)
        if len(stated) != len(entry["values"]):
            raise Problem(f"{len(stated)} numbers and {len(entry['values'])} values: {text}")
        self.commands_are_named(document, entry["values"])
        start, end = document.find(re.sub(r"[{}]", "", text))
        document.covered.append((start, end))
        places = document.places(text)
        pieces = re.split(r"[{}]", text)
        words_before = 0
        for k, piece in enumerate(re.split(r"\{[^}]*\}", text)[:-1]):
            words_before += len(piece.split())
            position = [m.start() for m in re.finditer(r"\S+", document.text[start:end])]
            line = document.line(start + position[min(words_before, len(position) - 1)])
            within = entry.get("within")
            within = within[k] if isinstance(within, list) else within
            new = self.compare(document, line, stated[k], entry["values"][k], within, places[k])
            pieces[2 * k + 1] = new or stated[k]
            words_before += len(stated[k].split())
        entry["text"] = "".join("{" + piece + "}" if k % 2 else piece for k, piece in enumerate(pieces))

    def whole_table(self, entry):
        document = self.document(entry["in"])
        at = [i for i, line in enumerate(document.lines) if line.startswith(entry["table"])]
        if len(at) != 1:
            raise Problem(f"{len(at)} tables in {document.name} start with: {entry['table']}")
        if "printed" in entry:
            self.printed_table(document, entry, at[0])
            return
        titles = [cell.strip() for cell in document.lines[at[0]].strip("|").split("|")]
        for title in entry["cells"]:
            if title not in titles:
                raise Problem(f"the table {entry['table']} has no column {title}")
        self.commands_are_named(document, [v for values in entry["cells"].values() for v in values])
        last, rows, first = at[0], 0, ""
        while document.lines[last].startswith("|"):
            last += 1
        for i, cells in document.rows(at[0], last):
            first = cells[0] or first
            more = {"cells": cells, "row": re.sub(r" \(.*|[*`]|,.*", "", cells[0]), "first": first}
            if "where" in entry and not self.fresh.evaluate(entry["where"], **more):
                continue
            rows += 1
            for title, values in entry["cells"].items():
                column = titles.index(title)
                bars = [m.start() for m in re.finditer(r"\|", document.lines[i])]
                start = sum(len(line) + 1 for line in document.lines[:i]) + bars[column] + 1
                found = list(RANGE.finditer(document.text[start:start + bars[column + 1] - bars[column] - 1]))
                stated = [m.group() for m in found]
                spans = [(start + m.start(), start + m.end()) for m in found]
                if len(stated) > len(values):
                    raise Problem(f"{document.name}:{i + 1}: more numbers than values in column {title}")
                for k, value in enumerate(values):
                    within = entry.get("within")
                    within = within[k] if isinstance(within, list) else within
                    self.compare(document, i + 1, stated[k] if k < len(stated) else "0", value, within,
                                 spans[k] if k < len(spans) else None, **more)
            start = sum(len(line) + 1 for line in document.lines[:i])
            document.covered.append((start, start + len(document.lines[i])))
        if rows == 0:
            raise Problem(f"no row of the table {entry['table']} is chosen")

    def printed_table(self, document, entry, first):
        """The lines of a table are those that a command prints."""
        self.is_named(document, self.commands[entry["printed"]])
        last = first
        while document.lines[last].startswith("|"):
            last += 1
        start = sum(len(line) + 1 for line in document.lines[:first])
        stated = "\n".join(document.lines[first:last])
        document.covered.append((start, start + len(stated)))
        try:
            printed = self.fresh.run(entry["printed"])[1].split("\n")
        except NotRun as why:
            if not self.options.texts:
                self.table.append((document.name, first + 1, "a table", "-", f"not run: {why}"))
            return
        begin = [i for i, line in enumerate(printed) if line.startswith(entry["table"])]
        if len(begin) != 1:
            raise Problem(f"{entry['printed']} prints {len(begin)} tables that start with: {entry['table']}")
        end = begin[0]
        while printed[end].startswith("|"):
            end += 1
        now = "\n".join(printed[begin[0]:end])
        verdict = "ok" if now == stated else "written" if self.options.write else "STALE"
        self.table.append((document.name, first + 1, "a table", entry["printed"], verdict))
        if verdict == "written":
            document.replacements.append((start, start + len(stated), now))

    def section(self, entry):
        document = self.document(entry["in"])
        first, end = document.section(entry["heading"])
        listed = dict(entry["rows"])
        for i, cells in document.rows(first, end):
            start = sum(len(line) + 1 for line in document.lines[:i])
            end_of_row = start + len(document.lines[i])
            if any(a < end_of_row and b > start for a, b in document.covered):
                continue
            keys = [key for key in listed if document.lines[i].strip("| ").startswith(key)]
            if not keys:
                raise Problem(f"{document.name}:{i + 1}: no test is named for the row: {cells[0]}")
            document.covered.append((start, end_of_row))
            self.assert_by(document, i + 1, cells[0], listed[max(keys, key=len)])
        for key in listed:
            if not any(line.strip("| ").startswith(key) for line in document.lines[first:end]):
                raise Problem(f"the section {entry['heading']} has no row: {key}")
        for text, tests in entry.get("text", {}).items():
            start, finish = document.find(text)
            document.covered.append((start, finish))
            self.assert_by(document, document.line(start), text, tests)

    def assert_by(self, document, line, what, tests):
        for test in tests:
            if test not in self.tests:
                self.problems.append(f"{document.name}:{line}: the test does not exist: {test}")
            else:
                self.asserted.append((document.name, line, what, test, self.tests[test]))

    def name(self, entry):
        document = self.document(entry["in"])
        names = entry["name"] if isinstance(entry["name"], list) else [entry["name"]]
        for text in names:
            document.covered.append(document.find(text))

    def columns(self, entry):
        document = self.document(entry["in"])
        for title in entry["columns"]:
            if not any(re.match(rf"\|.*\| {re.escape(title)} \|", line) for line in document.lines):
                raise Problem(f"no table of {document.name} has a column {title}")
        document.given.update(entry["columns"])

    def check(self):
        if self.options.jobs > 1:
            self.fresh.run_together(self.options.jobs)
        # Sections last: their rows may be covered by tables and passages.
        for kind, method in (("text", self.passage), ("table", self.whole_table), ("name", self.name),
                             ("columns", self.columns), ("heading", self.section)):
            for entry in self.entries:
                if kind not in entry or (kind == "text" and "heading" in entry):
                    continue
                try:
                    method(entry)
                except Problem as problem:
                    self.problems.append(str(problem))
        for name in ("README.md", CHECKS):
            if (self.root / name).exists():
                self.problems += [f"{name}:{line}: no entry covers {text}" for line, text in self.document(name).uncovered()]
        self.report()
        if self.options.write:
            self.write()
        return 1 if self.problems or any(row[4] == "STALE" for row in self.table) else 0

    def write(self):
        for name, document in self.documents.items():
            if document.replacements:
                document.write(self.root / name)
        if not any(row[4] == "written" for row in self.table):
            return
        path = self.root / "docs/numbers.json"
        text = path.read_text()
        before = json.loads(text)["entries"]
        for old, new in zip(before, self.entries):
            if old.get("text") != new.get("text"):
                text = text.replace(json.dumps(old["text"], ensure_ascii=False),
                                    json.dumps(new["text"], ensure_ascii=False))
        path.write_text(text)

    def report(self):
        # What is wrong stands at the end, where a long output is not cut.
        for name, line, stated, now, verdict in sorted(self.table, key=lambda row: (row[4] == "STALE", row)):
            if verdict == "STALE" or (not verdict.startswith("not run") and not self.options.brief):
                print(f"{name + ':' + str(line):<26} stated {stated:<18} now {now:<28} {verdict}")
        left_out = {}
        for name, line, _, _, verdict in sorted(self.table):
            if verdict.startswith("not run"):
                left_out.setdefault((verdict, name), set()).add(line)
        for (verdict, name), lines in left_out.items():
            print(f"{verdict}: {name}, lines {', '.join(map(str, sorted(lines)))}")
        if not self.options.texts and not self.options.brief:
            for name, line, what, test, file in sorted(self.asserted):
                print(f"{name + ':' + str(line):<26} {what[:48]:<48} asserted by the test '{test}' ({file})")
        for shown in self.options.uncovered:
            for line, text in self.document(shown).uncovered():
                print(f"{shown}:{line}: no entry covers {text}")
        for problem in self.problems:
            print(f"WRONG {problem}")
        verdicts = [row[4].split(":")[0] for row in self.table]
        print(f"{verdicts.count('ok')} numbers ok, {verdicts.count('STALE')} stale, {verdicts.count('written')} written, "
              f"{verdicts.count('not run')} not run; {len(self.asserted)} assertions by tests; "
              f"{len(self.problems)} entries wrong")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path)
    parser.add_argument("--build", default="build/release", help="folder of apothem")
    parser.add_argument("--tests", default="build/release", help="folder of apothem_tests")
    parser.add_argument("--quick", action="store_true", help="only the commands that take seconds")
    parser.add_argument("--jobs", type=int, default=1, help="how many commands of the quick subset run at a time")
    parser.add_argument("--texts", action="store_true", help="do passages and tests exist, and what follows from data alone")
    parser.add_argument("--write", action="store_true", help="replace stale numbers by fresh ones")
    parser.add_argument("--only", nargs="*", default=[], help="only these commands, scenes and test cases")
    parser.add_argument("--scenes", help="folder with results of scenes, in place of new runs")
    parser.add_argument("--brief", action="store_true", help="print only what is wrong")
    parser.add_argument("--times", help="by how much times and their ratios may differ, like x4")
    parser.add_argument("--keep", help="folder for the results; what is there already is not run again")
    parser.add_argument("--uncovered", nargs="*", default=[], help="list numbers without entry of these documents")
    return Checker(*(lambda o: (o.root, o))(parser.parse_args())).check()


if __name__ == "__main__":
    sys.exit(main())
