"""Fresh numbers: commands, each run once, and what expressions may ask of what they leave."""
import atexit
import csv as csv_module
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as Xml
from concurrent.futures import ThreadPoolExecutor
from xml.sax.saxutils import unescape

from number_forms import Problem


class NotRun(Exception):
    """The command of a number is left out."""


class Time(tuple):
    """Least and largest value of what depends on the speed of the machine; `power` is that of its unit of time, or 0 of a
    ratio of times."""

    def __new__(cls, low, high, power):
        self = super().__new__(cls, (low, high))
        self.power = power
        return self


def ends(value):
    return value if isinstance(value, tuple) else (value, value)


def scaled(value, factor):
    if isinstance(value, Time):
        return Time(value[0] * factor, value[1] * factor, value.power)
    return (value[0] * factor, value[1] * factor) if isinstance(value, tuple) else value * factor


def ratio(a, b):
    """Of two values or ranges; of two times it does not depend on the speed of the machine."""
    (low_a, high_a), (low_b, high_b) = ends(a), ends(b)
    if not isinstance(a, Time) and not isinstance(b, Time):
        return low_a / high_b, high_a / low_b
    return Time(low_a / high_b, high_a / low_b, getattr(a, "power", 0) - getattr(b, "power", 0))


class Fresh:
    """Runs commands, each once, and reads what they leave."""

    def __init__(self, root, commands, slow, options):
        self.root, self.commands, self.slow, self.options = root, commands, slow, options
        self.folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="numbers-"))
        if not options.keep:
            atexit.register(shutil.rmtree, self.folder, ignore_errors=True)
        self.done, self.files, self.speed = {}, {}, None
        self.asked = set()  # commands that the expressions since the last `asked.clear()` have used

    def program(self, word):
        if word == "python3":
            return sys.executable
        folder = self.options.tests if word == "apothem_tests" else self.options.build
        path = self.root / folder / word
        if not path.exists():
            raise NotRun(f"{folder}/{word} is not built")
        return str(path)

    def run(self, name):
        """The output folder of a command, and what it printed."""
        self.asked.add(name)
        if name not in self.done:
            try:
                self.done[name] = self.execute(name)
            except (NotRun, Problem) as why:
                self.done[name] = why
        if isinstance(self.done[name], Exception):
            raise self.done[name]
        return self.done[name]

    def run_together(self, jobs):
        """Runs the commands of the quick subset, so many at a time."""
        def attempt(name):
            try:
                self.run(name)
            except (NotRun, Problem):
                pass  # whoever asks for its numbers is told

        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(attempt, [name for name, command in self.commands.items() if "quick" in command]))

    def forget(self, names):
        """Lets these commands run again when they are asked for, if nothing is kept."""
        if names and not self.options.keep:
            self.speed = None
        for name in [] if self.options.keep else names:
            self.done.pop(name, None)
            self.files = {path: data for path, data in self.files.items()
                          if not isinstance(path, pathlib.Path) or path.parent != self.folder / name}

    def execute(self, name):
        if name in self.commands:
            command = self.commands[name]
        elif (self.root / "data/scenes" / (name + ".json")).exists():
            there = pathlib.Path(self.options.scenes or "", name)
            if self.options.scenes and (there / "run.json").exists():
                return there, ""
            command = {"run": f"apothem run data/scenes/{name}.json -o {{out}} --overwrite",
                       "quick": name not in self.slow}
        else:
            raise Problem(f"no command and no scene is called {name}")
        quick = command.get("quick")
        if self.options.only and name not in self.options.only:
            raise NotRun("left out")
        if self.options.texts and not command.get("data"):
            raise NotRun("not of data alone")
        if self.options.quick and not (quick or command.get("data")):
            raise NotRun("not in the quick subset")
        text = quick if self.options.quick and isinstance(quick, str) else command["run"]
        folder = self.folder / name
        log = folder / "printed.txt"
        if self.options.keep and log.exists():
            return folder, log.read_text()
        shown = text.replace("{out}", str(folder))
        if "{program}" in shown:
            shown = shown.replace("{program}", self.program("apothem"))
        shown = re.sub(r"\{([\w-]+)\}", lambda match: str(self.run(match.group(1))[0]), shown)
        if "$APOTHEM_POLYGONS" in shown and "APOTHEM_POLYGONS" not in os.environ:
            raise NotRun("APOTHEM_POLYGONS names no folder")
        words = os.path.expandvars(shown).split()
        environment = dict(os.environ)
        while "=" in words[0]:
            key, value = words.pop(0).split("=", 1)
            environment[key] = value
        words = [self.program(words[0])] + [word.replace("~", " ") for word in words[1:]]  # a space within a word
        folder.mkdir(parents=True, exist_ok=True)
        if not command.get("data"):
            print(f"running {shown}", file=sys.stderr, flush=True)
        result = subprocess.run(words, cwd=self.root, env=environment, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
        if result.returncode != command.get("exit", 0):
            raise Problem(f"'{shown}' ended with exit code {result.returncode}: {result.stdout[-300:]}")
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

    def listed(self, name, start, nth):
        """The nth number, from 0, of the line "start: ..." that a command prints: a ratio of times. 0 if there are fewer."""
        match = re.search(rf"^{re.escape(start)}: (.*)$", self.run(name)[1], re.MULTILINE)
        if not match:
            raise Problem(f"{name} prints no line {start}")
        numbers = [float(number) for number in match.group(1).split()]
        return Time(numbers[nth], numbers[nth], 0) if nth < len(numbers) else 0.0

    def csv(self, name, first, second, column):
        """A column (title or number) of the row of accuracy.csv with these first two cells."""
        rows = self.read(self.run(name)[0] / "accuracy.csv")
        title = column
        if isinstance(column, str):
            column = [title.split(" [")[0] for title in rows[0]].index(column)
        value = float([row for row in rows if row[:2] == [first, second]][0][column])
        if title in ("time", "largest_time"):
            return Time(value, value, 1)
        return Time(value, value, 0) if title in ("least_ratio", "largest_ratio") else value

    def total(self, name, method, column):
        """The sum of a column of accuracy.csv over the cases that are not random."""
        rows = self.read(self.run(name)[0] / "accuracy.csv")
        return sum(self.csv(name, r[0], method, column) for r in rows[1:]
                   if r[1] == method and not r[0].startswith("generic"))

    def crashes(self, name, method):
        """How often a method crashed, by pairs.csv."""
        rows = self.read(self.run(name)[0] / "pairs.csv")
        return sum(row[2] == method and row[3].startswith("crashed") for row in rows)

    def results(self, command):
        """What the benchmark prints with --json."""
        text = self.run(command)[1]
        return json.loads(text[text.index("{\n"):text.rindex("}") + 1])

    def grows(self, family, command):
        """The power of the size with which the time of a family of the benchmark grows."""
        [power] = [g["exponent"] for g in self.results(command)["growth"] if g["family"] == family]
        return Time(power, power, 0)

    def bench(self, name, of="time", command="benchmark"):
        """Of a case of the benchmark: least and largest time of an item in ns or rate in 1/s, or an extra number."""
        cases = [c for c in self.results(command)["cases"] if c["name"] == name]
        if not cases and self.options.quick:
            raise NotRun("not in the quick subset")
        if not cases:
            raise Problem(f"the benchmark has no case {name}")
        times = cases[0]["times"]
        if of == "time":
            return Time(min(times), max(times), 1)
        if of == "rate":
            return Time(1e9 / max(times), 1e9 / min(times), -1)
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

    def column(self, name, file, title, where, value):
        """The numbers of a column of a table that a command leaves, in rows with this value in the column `where`."""
        rows = self.read(self.run(name)[0] / file)
        titles = [text.split(" [")[0] for text in rows[0]]
        return [float(row[titles.index(title)]) for row in rows[1:] if float(row[titles.index(where)]) == value]

    def seen(self, test, left, nth=None):
        """Least and largest value of the left side of an assertion of a test case, by its text: `error / scale` of
        CHECK(error / scale < 1e-12). Of a comparison with Approx it is the relative difference. With nth, from 0, only
        that one."""
        values = [value for text, value in self.assertions(test) if text == left]
        if not values:
            raise Problem(f"the test '{test}' asserts nothing of {left}")
        return (min(values), max(values)) if nth is None else values[nth]

    def times_seen(self, test, left):
        """How often a test case makes this assertion."""
        return sum(text == left for text, _ in self.assertions(test))

    def assertions(self, test):
        """Texts and values of the left sides of all comparisons that a test case asserts, in their order."""
        name = f"test {test}"
        if name not in self.files:
            if self.options.texts or self.options.quick:
                raise NotRun("of a test")
            if self.options.only and test not in self.options.only:
                raise NotRun("left out")
            self.files[name] = list(compared(self.asserted_by(test)))
        return self.files[name]

    def asserted_by(self, test):
        """What Catch2 reports of a test case that passes, as XML."""
        folder = self.folder / "tests"
        folder.mkdir(parents=True, exist_ok=True)
        report = folder / (re.sub(r"\W+", "-", test) + ".xml")
        if self.options.keep and report.exists():
            return report
        print(f"running the test {test}", file=sys.stderr, flush=True)
        program = self.program("apothem_tests")
        name = re.sub(r"([,\[\]\\*\"])", r"\\\1", test)
        result = subprocess.run([program, name, "-s", "-r", "xml", "-o", str(report), "-w", "NoTests"], cwd=self.root,
                                env={**os.environ, "APOTHEM_DIGITS": "25"}, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
        if result.returncode != 0:
            report.unlink(missing_ok=True)
            raise Problem(f"the test '{test}' fails")
        return report

    def machine(self, reference):
        """How many times as fast as the machine of the documents this one is, by an expression of `reference` (text that
        the documents state, and expression) in the same unit; 1 if that is left out."""
        if self.speed is None:
            try:
                low, high = self.evaluate(reference["value"])
                self.speed = math.sqrt(low * high / (reference["stated"][0] * reference["stated"][1]))
            except NotRun:
                self.speed = 1.0
        return self.speed

    def evaluate(self, expression, **more):
        names = {f: getattr(self, f) for f in
                 ("out", "listed", "csv", "column", "total", "crashes", "bench", "grows", "expect", "summary", "history", "seen",
                  "times_seen")}
        names.update(timed=lambda time: Time(time, time, 1), mean=lambda values: sum(values) / len(values), ratio=ratio,
                     scaled=scaled, abs=abs, max=max, min=min, sum=sum, str=str, sqrt=math.sqrt, range=range,
                     span=lambda a, b: Time(ends(a)[0], ends(b)[1], getattr(a, "power", 0)), **more)
        try:
            return eval(expression, {"__builtins__": {}, **names})  # from our own list
        except (KeyError, IndexError, ValueError, NameError, OSError, TypeError) as error:
            raise Problem(f"{expression}: {type(error).__name__} {error}") from error


NUMBER = r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf|nan)f?"
COMPARED = re.compile(rf"^({NUMBER})\s*(<=|>=|<|>|==)\s*(?:({NUMBER})|Approx\( ({NUMBER}) \))$")


def number_of(text):
    """A number as Catch2 prints it; those of single precision end in f."""
    return float(re.sub(r"(?<=[\d.])f$", "", text))


def compared(report):
    """Texts of the left sides of the comparisons of numbers in a report of Catch2, and their values."""
    original = None
    for _, element in Xml.iterparse(report):
        if element.tag == "Original":
            original = unescape(element.text.strip())
        elif element.tag == "Expanded" and original is not None:
            match = COMPARED.match(" ".join(element.text.split()))
            if match:
                left = re.split(r"\s(?:<=|>=|<|>|==)\s", original)[0].strip()
                value = number_of(match.group(1))
                if match.group(4):
                    expected = number_of(match.group(4))
                    value = abs(value - expected) / abs(expected) if expected else abs(value)
                yield " ".join(left.split()), value
        elif element.tag == "Expression":
            element.clear()
