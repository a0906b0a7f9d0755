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
  {"in": DOCUMENT, "heading": "## Meshes", "rows": {"start of a row": ["name of a test"]}}
      A section that rests on tests: the tests exist, and every row of its tables is listed. Its key
      `text` lists in the same way what the section states outside of tables.
  {"in": DOCUMENT, "name": "Fig. 13"}
      Digits that are part of a name, or a choice of ours; nothing prints them.

`within` says by how much a fresh number may differ: "2%", "x3" (a factor, for times), "1e-3" (in the
unit of the text), "below" (a bound); without it by one unit of the last digit that is stated. Commands
are in `commands`, and the document names them by `named`; scenes need none, `apothem run` makes them. A
command is run once, when a number needs it.

With --write, stale numbers are replaced by fresh ones, with as many digits, here and in docs/numbers.json.

Exit code 1: a number is stale and not replaced, a passage is gone, or a test does not exist.
"""
import argparse
import csv as csv_module
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(
    r"(?<![\w.^#/])([-+]?(?:\d{1,3}(?: \d{3})+(?:\.\d+)?(?![\d.])|\d+\.\d+|\d+|\.\d+)(?:e[-+]?\d+)?)(k|M)?(?![\w])")
RANGE = re.compile(f"{NUMBER.pattern}(?: to {NUMBER.pattern})?")


class NotRun(Exception):
    """The command of a number is left out."""


class Problem(Exception):
    """What makes an entry wrong, whatever a fresh run prints."""


def number(text):
    match = NUMBER.search(text)
    if not match:
        raise Problem(f"'{text}' is no number")
    return value_of(match)


def value_of(match):
    digits = match.group(1).replace(" ", "")
    scale = {None: 1.0, "k": 1e3, "M": 1e6}[match.group(2)]
    mantissa, _, exponent = digits.partition("e")
    places = len(mantissa.partition(".")[2])
    unit = 10.0 ** (int(exponent or 0) - places)
    if "." not in mantissa and not exponent and match.group(2) is None:
        zeros = len(mantissa) - len(mantissa.rstrip("0"))
        unit = 10.0 ** min(zeros, max(0, len(mantissa.lstrip("+-")) - 2))
    return float(digits) * scale, unit * scale


def agrees(stated, now, within):
    """Whether a fresh number, or (least, largest), is what the document states."""
    low, high = now if isinstance(now, (tuple, list)) else (now, now)
    if not (math.isfinite(low) and math.isfinite(high)):
        return False
    if stated.strip().startswith("<") or within == "below":
        value, unit = number(stated)
        return high <= value + unit / 2
    ends = [number(end) for end in stated.split(" to ")]
    least, largest = ends[0][0], ends[-1][0]
    if within is None:
        slack = 1.0001 * max(unit for _, unit in ends)
    elif within.endswith("%"):
        slack = float(within[:-1]) / 100 * max(abs(least), abs(largest))
    elif within.startswith("x"):
        factor = float(within[1:])
        return low <= largest * factor and high >= least / factor
    else:
        slack = float(within)
    return low <= largest + slack and high >= least - slack


def written(value, like):
    """A number in the form of another one: as many significant digits, the same unit, blanks and exponent."""
    match = NUMBER.search(like)
    digits, suffix = match.group(1), match.group(2) or ""
    mantissa, _, exponent = digits.replace(" ", "").lstrip("+-").partition("e")
    value /= {"": 1.0, "k": 1e3, "M": 1e6}[suffix]
    places = max(1, len(mantissa.replace(".", "").lstrip("0")))
    if exponent:
        shown, power = f"{value:.{places - 1}e}".split("e")
        return f"{shown}e{int(power)}{suffix}"
    if value == 0:
        return "0" + suffix
    exact = float(f"{value:.{places - 1}e}")
    decimals = max(0, places - 1 - math.floor(math.log10(abs(exact))))
    blank = "" if 4 <= len(mantissa) < 5 and " " not in digits else " "
    shown = f"{exact:,.{decimals}f}".replace(",", blank)
    if digits.lstrip("+-").startswith("."):
        shown = shown.replace("0.", ".", 1)
    return shown + suffix


def restated(stated, now):
    """What a document should state in place of `stated`: a number, a range or a bound."""
    low, high = now if isinstance(now, (tuple, list)) else (now, now)
    if stated.strip().startswith("<"):
        power = math.floor(math.log10(high)) if high > 0 else -300
        bound = math.ceil(high / 10.0 ** power) * 10.0 ** power
        return f"< {written(bound, stated)}"
    ends = stated.split(" to ")
    if len(ends) == 1:
        return written((low + high) / 2, stated)
    return f"{written(low, ends[0])} to {written(high, ends[1])}"


class Fresh:
    """Runs commands, each once, and reads what they leave."""

    def __init__(self, root, commands, slow, options):
        self.root, self.commands, self.slow, self.options = root, commands, slow, options
        self.folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="numbers-"))
        self.done, self.files = {}, {}

    def program(self, word):
        folder = self.options.tests if word == "apothem_tests" else self.options.build
        path = self.root / folder / word
        if not path.exists():
            raise NotRun(f"{folder}/{word} is not built")
        return str(path)

    def run(self, name):
        """The output folder of a command, and what it printed."""
        if name not in self.done:
            self.done[name] = self.execute(name)
        if isinstance(self.done[name], Exception):
            raise self.done[name]
        return self.done[name]

    def execute(self, name):
        scene = self.root / "data/scenes" / (name + ".json")
        if name in self.commands:
            command = self.commands[name]
        elif scene.exists():
            command = {"run": f"apothem run data/scenes/{name}.json -o {{out}} --overwrite",
                       "quick": name not in self.slow}
        else:
            return Problem(f"no command and no scene is called {name}")
        if self.options.only and name not in self.options.only:
            return NotRun("left out")
        if self.options.quick and not command.get("quick"):
            return NotRun("not in the quick subset")
        folder = self.folder / name
        log = folder / "printed.txt"
        if self.options.keep and log.exists():
            return folder, log.read_text()
        shown = command["run"].replace("{out}", str(folder))
        if "$APOTHEM_POLYGONS" in shown and "APOTHEM_POLYGONS" not in os.environ:
            return NotRun("APOTHEM_POLYGONS names no folder")
        words = os.path.expandvars(shown).split()
        environment = dict(os.environ)
        while "=" in words[0]:
            key, value = words.pop(0).split("=", 1)
            environment[key] = value
        try:
            words[0] = self.program(words[0])
        except NotRun as why:
            return why
        words = [word.replace("~", " ") for word in words]  # a space within a word
        folder.mkdir(parents=True, exist_ok=True)
        print(f"running {shown}", file=sys.stderr, flush=True)
        result = subprocess.run(words, cwd=self.root, env=environment, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
        if result.returncode != command.get("exit", 0):
            return Problem(f"'{shown}' ended with exit code {result.returncode}")
        log.write_text(result.stdout)
        return folder, result.stdout

    def read(self, path):
        if path not in self.files:
            if path.suffix == ".json":
                self.files[path] = json.loads(path.read_text())
            else:
                with open(path, newline="") as file:
                    self.files[path] = list(csv_module.reader(file))
        return self.files[path]

    # What expressions may use.

    def out(self, name, pattern, group=1):
        """The first number that the pattern finds in what a command prints."""
        match = re.search(pattern, self.run(name)[1])
        if not match:
            raise Problem(f"{name} does not print '{pattern}'")
        return float(match.group(group).replace(" ", ""))

    def csv(self, name, first, second, column):
        """A column (title or number) of the row of accuracy.csv with these first two cells."""
        rows = self.read(self.run(name)[0] / "accuracy.csv")
        if isinstance(column, str):
            column = [title.split(" [")[0] for title in rows[0]].index(column)
        return float([row for row in rows if row[:2] == [first, second]][0][column])

    def total(self, name, method, column):
        """The sum of a column of accuracy.csv over the cases that are not random."""
        rows = self.read(self.run(name)[0] / "accuracy.csv")
        return sum(self.csv(name, r[0], method, column) for r in rows[1:]
                   if r[1] == method and not r[0].startswith("generic"))

    def crashes(self, name, method):
        """How often a method crashed, by pairs.csv."""
        rows = self.read(self.run(name)[0] / "pairs.csv")
        return sum(row[2] == method and row[3].startswith("crashed") for row in rows)

    def bench(self, name, of="time", command="benchmark"):
        """Of a case of the benchmark: least and largest time of an item in ns or rate in 1/s, or an extra number."""
        text = self.run(command)[1]
        start = text.index("{\n")
        cases = [c for c in json.loads(text[start:text.rindex("}") + 1])["cases"] if c["name"] == name]
        if not cases:
            raise Problem(f"the benchmark has no case {name}")
        times = cases[0]["times"]
        if of == "time":
            values = times
        elif of == "rate":
            values = [1e9 / time for time in times]
        else:
            values = [cases[0]["extras"][of]]
        return min(values), max(values)

    def expect(self, scene, quantity, take="last", field="value", nth=0):
        """The result of a scene's expectation; `field` may be error or relative as well."""
        data = self.read(self.run(scene)[0] / "run.json")
        found = [e for e in data["expectations"] if (e["quantity"], e["take"]) == (quantity, take)]
        if nth >= len(found):
            raise Problem(f"the scene {scene} expects no {take} of {quantity}")
        e = found[nth]
        error = e["value"] - e["expected"]
        return {"value": e["value"], "error": abs(error),
                "relative": abs(error / e["expected"]) if e["expected"] else math.nan}[field]

    def summary(self, scene, pointer):
        """A value of run.json."""
        at = self.read(self.run(scene)[0] / "run.json")
        for key in pointer.split("/"):
            at = at[int(key) if isinstance(at, list) else key]
        return at

    def history(self, scene, column, take="last", file="history.csv"):
        """The last, least, largest, or largest absolute value of a column of a scene's CSV file."""
        rows = self.read(self.run(scene)[0] / file)
        at = [i for i, title in enumerate(rows[0]) if title.split(" [")[0] == column][0]
        values = [float(row[at]) for row in rows[1:]]
        return {"first": lambda: values[0], "last": lambda: values[-1], "min": lambda: min(values),
                "max": lambda: max(values), "max_abs": lambda: max(map(abs, values))}[take]()

    def evaluate(self, expression, **more):
        def ratio(a, b):
            low_a, high_a = a if isinstance(a, tuple) else (a, a)
            low_b, high_b = b if isinstance(b, tuple) else (b, b)
            return low_a / high_b, high_a / low_b
        names = {f: getattr(self, f) for f in
                 ("out", "csv", "total", "crashes", "bench", "expect", "summary", "history")}
        names.update(ratio=ratio, abs=abs, max=max, min=min, sum=sum, str=str, sqrt=math.sqrt, range=range,
                     scaled=lambda a, s: (a[0] * s, a[1] * s) if isinstance(a, tuple) else a * s, **more)
        try:
            return eval(expression, {"__builtins__": {}, **names})  # from our own list
        except (KeyError, IndexError, ValueError, NameError, OSError, TypeError) as error:
            raise Problem(f"{expression}: {type(error).__name__} {error}") from error


def loose(text):
    """A pattern of a text in which any white space stands for any other."""
    return re.sub(r"(?:\\?\s)+", lambda _: r"\s+", re.escape(text))


class Document:
    def __init__(self, root, name):
        self.name = name
        self.text = (root / name).read_text()
        self.lines = self.text.split("\n")
        self.covered = []
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

    def uncovered(self):
        """Numbers that stand neither in an entry nor in code, links and addresses."""
        hidden = list(self.covered)
        for pattern in (r"```.*?```", r"`[^`]*`", r"\]\([^)]*\)", r"<[^>]*>", r"\n\d+\. "):
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
        self.table, self.problems, self.asserted = [], [], []

    def document(self, name):
        if name not in self.documents:
            self.documents[name] = Document(self.root, name)
        return self.documents[name]

    def compare(self, document, line, stated, expression, within, place=None, **more):
        """Returns what to state instead, or None. `place`: start and end of the number in the document."""
        if self.options.texts:
            compile(expression, expression, "eval")
            number(stated)
            return None
        try:
            now = self.fresh.evaluate(expression, **more)
        except NotRun as why:
            self.table.append((document.name, line, stated, "-", f"not run: {why}"))
            return None
        shown = " to ".join(f"{x:.7g}" for x in now) if isinstance(now, (tuple, list)) else f"{now:.7g}"
        right = agrees(stated, now, within)
        finite = all(map(math.isfinite, now if isinstance(now, (tuple, list)) else (now,)))
        new = restated(stated, now) if self.options.write and not right and place and finite else None
        self.table.append((document.name, line, stated, shown, "ok" if right else "written" if new else "STALE"))
        if new:
            document.replacements.append((*place, new))
        return new

    def commands_are_named(self, document, expressions):
        """The document names every command that the expressions use."""
        for name, command in self.commands.items():
            used = any(re.search(rf"'{re.escape(name)}'", e) for e in expressions)
            if name == "benchmark":
                used = used or any("bench(" in e for e in expressions)
            if used and " ".join(command["named"].split()) not in " ".join(document.text.split()):
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
            more = {"cells": cells, "row": re.sub(r" \(.*|\*", "", cells[0]), "first": first}
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

    def check(self):
        # Sections last: their rows may be covered by tables and passages.
        for kind, method in (("text", self.passage), ("table", self.whole_table), ("name", self.name),
                             ("heading", self.section)):
            for entry in self.entries:
                if kind not in entry or (kind == "text" and "heading" in entry):
                    continue
                try:
                    method(entry)
                except Problem as problem:
                    self.problems.append(str(problem))
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
        for name, line, stated, now, verdict in sorted(self.table):
            if not verdict.startswith("not run"):
                print(f"{name + ':' + str(line):<26} stated {stated:<18} now {now:<28} {verdict}")
        left_out = {}
        for name, line, _, _, verdict in sorted(self.table):
            if verdict.startswith("not run"):
                left_out.setdefault((verdict, name), set()).add(line)
        for (verdict, name), lines in left_out.items():
            print(f"{verdict}: {name}, lines {', '.join(map(str, sorted(lines)))}")
        if not self.options.texts:
            for name, line, what, test, file in sorted(self.asserted):
                print(f"{name + ':' + str(line):<26} {what[:48]:<48} asserted by the test '{test}' ({file})")
        for shown in ["README.md"] + self.options.uncovered:
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
    parser.add_argument("--texts", action="store_true", help="run nothing: do passages and tests exist?")
    parser.add_argument("--write", action="store_true", help="replace stale numbers by fresh ones")
    parser.add_argument("--only", nargs="*", default=[], help="only these commands and scenes")
    parser.add_argument("--keep", help="folder for the results; what is there already is not run again")
    parser.add_argument("--uncovered", nargs="*", default=[], help="list numbers without entry of these too")
    return Checker(*(lambda o: (o.root, o))(parser.parse_args())).check()


if __name__ == "__main__":
    sys.exit(main())
