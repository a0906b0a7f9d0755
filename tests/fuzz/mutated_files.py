#!/usr/bin/env python3
"""Mutated scenes and files of all kinds: the program neither crashes, nor takes long, nor much memory.

    mutated_files.py PROGRAM [FIRST] [COUNT]

Each case depends on its number alone, so that a failing one can be repeated by itself. It ends with an exit code that
the program has for its errors, with one line for an error of the input, within 20 s and with less than 2 GB of memory.
APOTHEM_LONG=1 in the environment runs 5000 cases where CI has a share.
"""
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

SECONDS = 20
MEMORY = 2 << 30  # bytes
ENDS = {0, 1, 2, 3}  # exit codes: 4 would be lack of memory
NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
EXTREMES = [b"0", b"-1", b"1", b"2", b"1e9", b"1e-9", b"1e300", b"-1e300", b"1e-300", b"1e308", b"1e999", b"0.5",
            b"1000000", b"2147483648", b"-0", b"nan", b"null", b"\"a\"", b"[]", b"{}", b"4294967296", b"1e17"]
BLOCK = """{ "materials": { "m": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 1e8 }, "time": { "end": 1e-3 }, %s }"""
SQUARE = """"bodies": [ { "name": "a", "material": "m", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ]"""
SOURCE = pathlib.Path(__file__).resolve().parents[2]


def mutated(data, rng):
    """A file with one to six small changes."""
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        if not data:
            return data
        way = rng.randrange(10)
        at = rng.randrange(len(data))
        end = min(len(data), at + rng.choice([1, 1, 4, 20, 200]))
        numbers = list(NUMBER.finditer(data))
        if way < 4 and numbers:  # another number
            found = rng.choice(numbers)
            if rng.random() < .6:
                new = rng.choice(EXTREMES)
            else:
                try:
                    new = repr(float(found.group()) * rng.choice([-1, 0.1, 10, 1e3, 1 + 1e-9, 1e-3])).encode()
                except ValueError:
                    new = b"7"
            data = data[:found.start()] + new + data[found.end():]
        elif way == 4:
            data = data[:at] + data[end:]
        elif way == 5:
            data = data[:at] + data[at:end] * rng.choice([2, 3]) + data[end:]
        elif way == 6:
            data = data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1:]
        elif way == 7 and rng.random() < .3:
            data = data[:at]
        elif way == 8:
            lines = data.split(b"\n")
            i, k = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[i], lines[k] = lines[k], lines[i]
            data = b"\n".join(lines)
        else:
            words = list(re.finditer(rb"[A-Za-z_]+", data))
            if words:
                one, other = rng.choice(words), rng.choice(words)
                data = data[:one.start()] + other.group() + data[one.end():]
    return data


class Seeds:
    """Files that are right, with the commands that read them."""

    def __init__(self, program, folder):
        self.folder = folder
        self.kinds = {}
        for path in sorted(SOURCE.glob("data/scenes/*.json")) + sorted(SOURCE.glob("data/studies/*.json")):
            if path.stat().st_size < 6000:
                self.add("scene", path.read_bytes(), "scenes/f.json", ["check", "F"],
                         ["run", "F", "-o", "out", "--quiet", "--until", "1e-12"])
        for path in sorted(SOURCE.glob("data/meshes/*.msh")):
            self.add("mesh", path.read_bytes(), "f.msh", ["mesh", "F"], ["check", "mesh.json"])
        self.text("mesh.json", BLOCK % '"bodies": [ { "name": "a", "material": "m", "mesh": { "file": "f.msh" } } ]')
        ring = "0 0, 1 0, 2 0, 2 1, 1.5 0.5, 1 3, 0 1"
        self.add("polygon", f"POLYGON (({ring}))".encode(), "f.wkt", ["polygon", "F", "--json"], ["contact", "F", "F"],
                 ["mesh", "F", "--voronoi", "20"])
        rings = b"a 4 0 0 1 0 1 1 0 1\nb 5 0 0 2 0 2 1 1 0.5 0 2\n"
        self.add("batch", rings * 3, "f.txt", ["polygon", "--batch", "F"])
        self.add("batch", b"p 3 0 0 1 0 0 1 4 0.2 0.2 1 0.2 1 1 0.2 1\n" * 3, "f.txt", ["contact", "--batch", "F"])
        for name in ("slope.dxf", "wall.wkt"):
            self.drawing((SOURCE / "data/drawings" / name).read_bytes(), name.split(".")[1])
        shapes = ", ".join('{"type": "Feature", "properties": {"layer": "a"}, "geometry": {"type": "Polygon", '
                           f'"coordinates": [[[{x}, 0], [{x + 1}, 0], [{x}, 1], [{x}, 0]]]}}}}' for x in (0, 2))
        self.drawing(f'{{"type": "FeatureCollection", "features": [{shapes}]}}'.encode(), "geojson")
        self.drawing(b"id,x,y\n1,0,0\n1,1,0\n1,0,1\n2,3,0\n2,4,0\n2,3,1\n", "csv")
        self.add("table", b"time.end,contact.normal_stiffness\n1e-3,1e8\n2e-3,1e7\n", "f.csv",
                 ["sweep", "square.json", "--dry-run", "--table", "F", "-o", "study"])
        self.text("square.json", BLOCK % SQUARE)
        self.results(program)

    def add(self, kind, data, name, *commands):
        self.kinds.setdefault(kind, []).append((data, name, commands))

    def text(self, name, text):
        (self.folder / name).write_text(text)

    def drawing(self, data, form):
        scene = f"drawing-{form}.json"
        self.text(scene, BLOCK % f'"import": [ {{ "file": "f.{form}", "material": "m" }} ]')
        self.add("drawing", data, f"f.{form}", ["check", scene])

    def results(self, program):
        scene = (SOURCE / "data/scenes/meshed-incline.json").read_bytes()
        (self.folder / "run.json").write_bytes(scene)
        subprocess.run([program, "run", "run.json", "-o", "done", "--quiet", "--until", "2e-4"], cwd=self.folder,
                       check=True, stderr=subprocess.DEVNULL)
        done = self.folder / "done"
        files = [p for p in sorted(done.rglob("*")) if p.is_file()]
        for path in files:
            name = "results/" + str(path.relative_to(done))
            data = path.read_bytes()
            if name.endswith(".vtu") or path.name in ("frames.pvd", "names.csv"):
                self.add("frames", data, name, ["view", "results", "-o", "v.html"],
                         ["picture", "results", "-o", "p.svg", "--chains"])
            elif name.endswith(".csv"):
                self.add("history", data, name, ["picture", "results", "-o", "p.svg", "--plot", path.stem],
                         ["view", "results", "-o", "v.html"])
            elif path.name == "checkpoint.json":
                self.add("checkpoint", data, name, ["run", "run.json", "-o", "results", "--resume", "--quiet", "--until",
                                                    "2.1e-4"])
                self.add("checkpoint", data, name, ["run", "run.json", "-o", "out", "--from", "results", "--quiet",
                                                    "--until", "1e-12"])


class Case:
    """One file of a kind, changed, and a command that reads it."""

    def __init__(self, seeds, number):
        rng = random.Random(number)
        kind = rng.choice(sorted(seeds.kinds) + ["scene"] * 6)
        data, self.name, commands = rng.choice(seeds.kinds[kind])
        self.data = mutated(data, rng)
        self.words = [self.name if word == "F" else word for word in rng.choice(commands)]

    def set_up(self, seeds, folder):
        for path in seeds.folder.iterdir():
            if path.is_file():
                shutil.copy(path, folder)
        shutil.copytree(SOURCE / "data/drawings", folder / "drawings")
        (folder / "scenes").mkdir()
        if self.name.startswith("results/"):
            shutil.copytree(seeds.folder / "done", folder / "results")
        (folder / self.name).write_bytes(self.data)

    def defect(self, program, folder):
        """What is wrong with how the program ends, or nothing."""
        def limits():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY + (1 << 29),) * 2)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with open(folder / "err", "wb") as err:
            process = subprocess.Popen([program, *self.words], cwd=folder, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=err, preexec_fn=limits)
        start = time.monotonic()
        pid, status, used = os.wait4(process.pid, os.WNOHANG)
        while pid == 0:
            if time.monotonic() - start > SECONDS:
                process.kill()
                os.wait4(process.pid, 0)
                return f"takes longer than {SECONDS} s"
            time.sleep(.003)
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
        process.returncode = code = os.waitstatus_to_exitcode(status)
        text = (folder / "err").read_text(errors="replace")
        errors = [line for line in text.splitlines() if not line.startswith("apothem: warning: ")]
        if code not in ENDS:
            return f"exit code {code}: {text[:300]}"
        if used.ru_maxrss * 1024 > MEMORY:
            return f"{used.ru_maxrss >> 10} MiB of memory"
        if code == 2 and len(errors) != 1 and "--batch" not in self.words:  # which says them line by line
            return f"{len(errors)} lines of error: {text[:300]}"
        return None


def judge(program, seeds, number):
    case = Case(seeds, number)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case.set_up(seeds, folder)
        defect = case.defect(program, folder)
        if defect:
            kept = pathlib.Path(tempfile.gettempdir()) / f"apothem-mutated-{number}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(folder, kept)
            print(f"case {number}: in {kept}: apothem {' '.join(case.words)}: {defect}", flush=True)
    return defect is not None


def main():
    program = os.path.abspath(sys.argv[1])
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    usual = 5000 if "APOTHEM_LONG" in os.environ else 80
    count = int(sys.argv[3]) if len(sys.argv) > 3 else usual
    with tempfile.TemporaryDirectory() as name:
        seeds = Seeds(program, pathlib.Path(name))
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            failed = sum(pool.map(lambda number: judge(program, seeds, number), range(first, first + count)))
    print(f"{count} cases, {failed} with a defect")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
