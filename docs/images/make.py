#!/usr/bin/env python3
"""Pictures of the documents, and a digest of the data that each shows.

    make.py PROGRAM [NAME ...]           makes pictures (default: all that take seconds) and their digests anew
    make.py PROGRAM --check [NAME ...]   says which pictures are stale: the program's data are not those of the picture

`cmake --build build/release --target apothem_images` does the first. digests.json has up to 40 numbers of each column, to
three digits; a picture is stale where one of them has moved by more than a hundredth of the column's range.
"""

import argparse
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DIGESTS = HERE / "digests.json"
SAMPLES = 40


def run(program, *arguments, folder):
    subprocess.run([program, *map(str, arguments)], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def of_figure(name):
    """A figure of the report, with the tables that it draws."""
    def make(program, folder):
        run(program, "reproduce", name, "-o", "report", folder=folder)
        figure = folder / "report" / name
        tables = sorted(figure.glob("*.csv"))
        if not tables:  # fields: the results that they show
            tables = sorted((folder / "report/runs").glob("*/energy.csv"))
        return sorted(figure.glob("*.png"))[0], tables
    return make


def of_impact(program, folder):
    for scene in ("impact-asymmetric", "impact-asymmetric-area"):
        run(program, "run", ROOT / f"data/scenes/{scene}.json", "--quiet", folder=folder)
    (folder / "docs/images").mkdir(parents=True)
    subprocess.run(["gnuplot", HERE / "impact.gnuplot"], cwd=folder, check=True)
    return folder / "docs/images/impact.png", sorted(folder.glob("out/*/history.csv"))


PICTURES = {"fig-19": of_figure("fig-19"), "energy": of_figure("energy"), "impact": of_impact,
            "fig-28": of_figure("fig-28")}


def numbers(rows):
    """The columns of a table that are numbers throughout."""
    columns = []
    for column in zip(*rows):
        try:
            columns.append([float(value) for value in column])
        except ValueError:
            pass
    return columns


def digest_of(tables):
    digest = {}
    for table in tables:
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))[1:]
        step = max(1, len(rows) // SAMPLES)
        digest[f"{table.parent.name}/{table.name}"] = [[float(f"{value:.3g}") for value in column]
                                                      for column in numbers(rows[::step])]
    return digest


def differences(kept, fresh):
    for name in sorted(kept.keys() | fresh.keys()):
        before, now = kept.get(name, []), fresh.get(name, [])
        if [len(column) for column in before] != [len(column) for column in now]:
            yield f"{name} has other rows or columns"
            continue
        for number, (old, new) in enumerate(zip(before, now)):
            scale = max(old) - min(old) if old else 0
            if any(abs(a - b) > .01 * scale + .006 * abs(a) for a, b in zip(old, new)):
                yield f"{name}, column {number + 1}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}; all by default")
    parser.add_argument("--check", action="store_true", help="compare, and write nothing")
    options = parser.parse_intermixed_args()
    if not shutil.which("gnuplot"):
        print("skipped: there is no gnuplot (Debian: gnuplot-nox)")
        return 77
    digests = json.loads(DIGESTS.read_text()) if DIGESTS.exists() else {}
    stale = []
    for name in options.names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            picture, tables = PICTURES[name](options.program.resolve(), pathlib.Path(folder))
            digest = digest_of(tables)
            if options.check:
                stale += [f"{name}.png is stale: {what}" for what in differences(digests.get(name, {}), digest)]
                continue
            shutil.copy(picture, HERE / f"{name}.png")
            digests[name] = digest
            lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(digests[name])}" for name in sorted(digests))
            DIGESTS.write_text("{\n" + lines + "\n}\n")
    for line in stale:
        print(line)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
