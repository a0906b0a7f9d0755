#!/usr/bin/env python3
"""Makes the studies of the hopper that results/studies.json describes, and single runs of them again.

    study.py make NAME [--shard I/N] [-o FOLDER]    the fills and flows, in FOLDER; runs that are there are not done again
    study.py record NAME [-o FOLDER]                what FOLDER has becomes results/NAME.csv and results/NAME-discharge.csv
    study.py repeat NAME WIDTH SEED                 one run again, its hashes beside those in results/NAME.csv

A shard has every N-th seed: its fill and its flows at all widths. Shards may share a folder and may run on several machines.
`repeat` ends with exit code 1 if the final state has other bits, as it may have by a program of another version.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import tables

HERE = pathlib.Path(__file__).resolve().parent
RESULTS = HERE / "results"


class Study:
    def __init__(self, name, options):
        studies = json.loads((RESULTS / "studies.json").read_text(encoding="utf-8"))
        if name not in studies:
            raise SystemExit(f"study.py: studies.json has no study {name} (it has {', '.join(studies)})")
        about = studies[name]
        self.name, self.set, self.widths = name, about["set"], about["widths"]
        self.seeds = list(range(1, about["seeds"] + 1))
        self.folder = pathlib.Path(options.output or f"out/{name}")
        self.program, self.jobs = options.program, options.jobs

    def widths_table(self):
        """The rows of hopper-widths.csv that the study has, as a table of its own."""
        lines = (HERE / "hopper-widths.csv").read_text(encoding="utf-8").splitlines()
        rows = [line for line in lines[1:] if float(line.split(",")[0]) in self.widths]
        if len(rows) != len(self.widths):
            raise SystemExit(f"study.py: hopper-widths.csv has not all widths of {self.name}")
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / "widths.csv"
        path.write_text("\n".join([lines[0], *rows]) + "\n", encoding="utf-8")
        return str(path)

    def sweep(self, scene, *more):
        """Contacts that begin are not corrected (plain onsets): the dashpots take that energy anyway."""
        command = [self.program, "sweep", str(HERE / scene), "--vary", "fill.0.seed=" + ",".join(map(str, self.seeds)),
                   "--set", "time.onsets=plain", "--quiet", *more]
        for path, value in self.set.items():
            command += ["--set", f"{path}={value}"]
        done = subprocess.run(command, check=False)
        # 1: some runs are not done, which is no fault where what there is is collected.
        if done.returncode != 0 and not (done.returncode == 1 and "--collect" in more):
            raise subprocess.CalledProcessError(done.returncode, command)

    def make(self, *more):
        jobs = ["--jobs", str(self.jobs)] if self.jobs and not more else []
        fills = str(self.folder / "fills")
        if not more:
            self.sweep("hopper-fill.json", "-o", fills, *jobs)
        self.sweep("hopper-flow.json", "--table", self.widths_table(), "--from", fills, "-o", str(self.folder / "flows"),
                   *jobs, *more)


def make(study, options):
    if options.shard:
        part, parts = map(int, options.shard.split("/"))
        study.seeds = study.seeds[part - 1::parts]
    study.make()


def record(study, _):
    study.seeds = [seed for seed in study.seeds if (study.folder / f"fills/runs/seed={seed}/run.json").exists()]
    study.make("--collect")
    tables.record(argparse.Namespace(folder=study.folder / "flows", name=RESULTS / study.name))


def repeat(study, options):
    with open(RESULTS / f"{study.name}.csv", newline="", encoding="utf-8") as file:
        kept = [row for row in csv.DictReader(file)
                if (float(row["D/d"]), row["fill.0.seed"]) == (options.width, str(options.seed))]
    if not kept:
        raise SystemExit(f"study.py: {study.name}.csv has no run of this width and seed")
    study.widths, study.seeds = [options.width], [options.seed]
    with tempfile.TemporaryDirectory() as folder:
        study.folder = pathlib.Path(options.output or folder)
        study.make()
        with open(study.folder / "flows/runs.csv", newline="", encoding="utf-8") as file:
            again = next(csv.DictReader(file))
    for column in ("scene_hash", "final_state_hash", "stopped_by", "discharged"):
        print(f"{column:<17} kept {kept[0][column]:<26} now {again[column]}")
    same = again["final_state_hash"] == kept[0]["final_state_hash"]
    print(f"kept by version {kept[0]['version']}: " + ("the same bits" if same else "other bits"))
    return 0 if same else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for command in (make, record, repeat):
        sub = commands.add_parser(command.__name__)
        sub.set_defaults(command=command)
        sub.add_argument("name", metavar="NAME")
        if command is make:
            sub.add_argument("--shard", metavar="I/N", help="every N-th seed, from the I-th one on")
        if command is repeat:
            sub.add_argument("width", type=float, metavar="WIDTH", help="D/d")
            sub.add_argument("seed", type=int, metavar="SEED")
        sub.add_argument("-o", "--output", metavar="FOLDER", help="default: out/NAME; of repeat: none is kept")
        sub.add_argument("--program", default=os.environ.get("APOTHEM_PROGRAM", "apothem"), help="default: apothem")
        sub.add_argument("--jobs", type=int, help="runs at a time (default: one for each core)")
    options = parser.parse_args()
    try:
        return options.command(Study(options.name, options), options)
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"study.py: '{' '.join(error.cmd[:3])}' ended with exit code {error.returncode}") from None


if __name__ == "__main__":
    sys.exit(main())
