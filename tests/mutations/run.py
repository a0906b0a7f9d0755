#!/usr/bin/env python3
"""Does the report show it where a formula is wrong, or a number of a reference?

    run.py texts                       the formulas of mutations.json stand in the sources, each once
    run.py references PROGRAM FOLDER [SCENES]   the figure of each reference passes, and fails with one changed number
    run.py formulas FOLDER             the same for each formula, in a copy of the sources that is built in FOLDER

A number of a reference is changed by half of the largest number of its column. Runs of scenes that PROGRAM has left in the
folder SCENES are not made again. The third command builds the program once for each formula, which takes minutes.
"""

import argparse
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MUTATIONS = json.loads(pathlib.Path(__file__).with_name("mutations.json").read_text(encoding="utf-8"))


def figures_pass(program, data, figures, folder):
    """Exit code 0 of `apothem reproduce`, or what it says of the numbers that are missed."""
    done = subprocess.run([program, "reproduce", *figures, "--verify", "--quick", "--data", data, "-o", folder],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    missed = [line.strip() for line in done.stdout.splitlines() if "MISSED" in line]
    if done.returncode not in (0, 1):
        missed.append(f"exit code {done.returncode}: {done.stdout.strip().splitlines()[-1]}")
    return done.returncode == 0, missed


def shown(what, before, after, missed):
    """Prints whether a mutation is seen, and returns it."""
    seen = before and not after
    print(f"{'seen' if seen else 'NOT SEEN' if before else 'FAILS WITHOUT IT'}: {what}"
          + (f"; {missed[0]}{f' and {len(missed) - 1} more' if len(missed) > 1 else ''}" if missed else ""), flush=True)
    return seen


def texts(_):
    wrong = 0
    for mutation in MUTATIONS["formulas"]:
        count = (ROOT / mutation["file"]).read_text(encoding="utf-8").count(mutation["old"])
        if count != 1:
            print(f"{mutation['file']} has this text {count} times: {mutation['old']}")
            wrong += 1
    return wrong == 0


def checksum(data):
    """FNV-1a, as the program names it."""
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return f"fnv1a64:{value:016x}"


def take_over(program, figures, scenes, runs):
    """Copies the runs of the scenes of figures to where `apothem reproduce` looks for them, with the key by which it knows
    its runs."""
    own = checksum(pathlib.Path(program).read_bytes())
    texts = [(ROOT / f"data/figures/{figure}.json").read_text(encoding="utf-8") for figure in figures]
    for name in sorted({name for text in texts for name in re.findall(r'"scene": "([^"]*)"', text)}):
        if not (scenes / name / "run.json").exists():
            continue
        shutil.copytree(scenes / name, runs / name)
        run = json.loads((runs / name / "run.json").read_text(encoding="utf-8"))
        record = {"key": checksum((run["scene_hash"] + own).encode()), "ended": run["status"] == "done"}
        (runs / name / "reproduced.json").write_text(json.dumps(record), encoding="utf-8")


def references(args):
    folder = pathlib.Path(args.folder)
    shutil.rmtree(folder, ignore_errors=True)
    data = folder / "data"
    shutil.copytree(ROOT / "data", data, ignore=shutil.ignore_patterns("fuzz"))
    figures = sorted({mutation["figure"] for mutation in MUTATIONS["references"]})
    if args.scenes:
        take_over(args.program, figures, pathlib.Path(args.scenes), folder / "out/runs")
    before, missed = figures_pass(args.program, data, figures, folder / "out")
    if not before:
        return shown(", ".join(figures), before, False, missed)
    good = True
    for mutation in MUTATIONS["references"]:
        figure = mutation["figure"]
        path = data / mutation["file"]
        unchanged = path.read_bytes()
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        row, column = mutation["row"], mutation["column"]
        values = [float(r[column]) for r in rows[1:]]
        rows[row][column] = repr(values[row - 1] + max(map(abs, values)) / 2)
        with open(path, "w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
        after, missed = figures_pass(args.program, data, [figure], folder / "out")
        good = shown(f"{mutation['file']}, row {row} of {rows[0][column]}, in {figure}", before, after, missed) and good
        path.write_bytes(unchanged)
    return good


def build(folder):
    subprocess.run(["cmake", "--build", folder / "build", "--target", "apothem_program"], check=True, stdout=subprocess.DEVNULL)
    return folder / "build" / "apothem"


def formulas(args):
    folder = pathlib.Path(args.folder).resolve()
    sources = folder / "sources"
    shutil.rmtree(sources, ignore_errors=True)
    shutil.copytree(ROOT, sources, ignore=shutil.ignore_patterns("build", "out", ".git"))
    subprocess.run(["cmake", "-S", sources, "-B", folder / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DCMAKE_UNITY_BUILD=ON", "-DAPOTHEM_TESTS=OFF"], check=True, stdout=subprocess.DEVNULL)
    figures = sorted({figure for mutation in MUTATIONS["formulas"] for figure in mutation["figures"]})
    unchanged, missed = figures_pass(build(folder), sources / "data", figures, folder / "unchanged")
    print(f"unchanged: {', '.join(figures)} {'pass' if unchanged else missed}", flush=True)
    good = unchanged
    for number, mutation in enumerate(MUTATIONS["formulas"]):
        path = sources / mutation["file"]
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(mutation["old"], mutation["new"]), encoding="utf-8")
        after, missed = figures_pass(build(folder), sources / "data", mutation["figures"], folder / f"changed-{number}")
        good = shown(f"{mutation['what']}, in {', '.join(mutation['figures'])}", unchanged, after, missed) and good
        path.write_text(text, encoding="utf-8")
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for command in (texts, references, formulas):
        sub = commands.add_parser(command.__name__)
        sub.set_defaults(command=command)
        if command is references:
            sub.add_argument("program")
        if command is not texts:
            sub.add_argument("folder")
        if command is references:
            sub.add_argument("scenes", nargs="?")
    args = parser.parse_args()
    return 0 if args.command(args) else 1


if __name__ == "__main__":
    sys.exit(main())
