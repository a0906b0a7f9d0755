#!/usr/bin/env python3
"""Counts of jams of all runs of the hopper, from the results that are shipped.

    counts.py collect             results/hopper.csv as it should be: the runs that are kept, then results/counts-before.csv
    counts.py table friction      the table of docs/verification.md: blocks with friction,
    counts.py table smooth        without friction,
    counts.py table deformable    and of finite elements

The tables have Wilson's intervals and, for rates, Student's, of 95 %; p is the probability of such different counts as
ours and Box2D's if both have one probability of a jam (Fisher's exact test, two-sided).
"""

import argparse
import csv
import json
import pathlib
import sys

import tables

HERE = pathlib.Path(__file__).resolve().parent
RESULTS = HERE / "results"
SETTING = ["shape", "mu", "young", "normal_stiffness", "damping_ratio", "packings"]
COLUMNS = [*SETTING, "D_over_d", "n", "jammed", "rate", "rate_half", "rate_n", "runs"]
NAMES = {"quad": "quadrilaterals", "cross": "crosses", "cross-bevelled": "crosses, inner corners cut"}
REMARKS = {"soft": "packings of the deformable runs", "bevelled": "packings of the deformable runs", "first": "other packings"}


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def kept_runs():
    """A row for each width of each study of which results/NAME.csv has every run."""
    rows = []
    for name, study in json.loads((RESULTS / "studies.json").read_text(encoding="utf-8")).items():
        path = RESULTS / f"{name}.csv"
        if not path.exists():
            continue
        for width, runs in tables.by_width(tables.flows(path)):
            rates = [run.rate() for run in runs if run.rate()]
            row = {"D_over_d": f"{width:g}", "n": len(runs), "jammed": sum(run.jammed for run in runs), "rate_n": len(rates),
                   "runs": path.name, **study["counted as"]}
            if rates:
                mean, _, half = tables.mean(rates)
                row["rate"] = f"{mean:.1f}"
                row["rate_half"] = f"{half:.1f}" if len(rates) > 1 else ""
            rows.append({column: row.get(column, "") for column in COLUMNS})
    return rows


def collect(_):
    rows = kept_runs() + [{**row, "runs": ""} for row in read(RESULTS / "counts-before.csv")]
    for row in rows:
        row["D_over_d"] = f"{float(row['D_over_d']):g}"
    rows.sort(key=lambda row: [row[key] for key in SETTING] + [float(row["D_over_d"])])
    out = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    out.writeheader()
    out.writerows(rows)


def share(jammed, n):
    low, high = tables.wilson(jammed, n)
    return f"{jammed} of {n}: {jammed / n:.2f} ({low:.2f} to {high:.2f})"


def table(args):
    chosen = {"friction": lambda row: not row["young"] and row["mu"] != "0.0",
              "smooth": lambda row: not row["young"] and row["mu"] == "0.0" and row["packings"] not in ("soft", "bevelled"),
              "deformable": lambda row: row["young"] or row["packings"] in ("soft", "bevelled")}[args.which]
    deformable = args.which == "deformable"
    first = {"friction": "blocks, mu = 0.5", "smooth": "blocks without friction", "deformable": "deformable blocks"}[args.which]
    head = [first, "E, Pa" if deformable else "damping ratio", "k_n, Pa", "D/d", "jammed", "rate, 1/s"]
    head += [] if deformable else ["Box2D: jammed", "p", "Box2D: rate, 1/s"]
    print("| " + " | ".join(head) + " | runs |")
    print("| " + " | ".join(["---"] * (len(head) + 1)) + " |")
    for row in read(RESULTS / "hopper.csv"):
        if not chosen(row):
            continue
        k, n = int(row["jammed"]), int(row["n"])
        blocks = NAMES[row["shape"]] + (f" ({REMARKS[row['packings']]})" if row["packings"] and not row["young"] else "")
        rate = "-"
        if row["rate"]:
            rate = row["rate"] + (f" +- {row['rate_half']}" if row["rate_half"] else "") + f" ({row['rate_n']})"
        cells = [blocks, (row["young"] or "rigid") if deformable else row["damping_ratio"], row["normal_stiffness"],
                 row["D_over_d"], share(k, n), rate]
        other = tables.reference(f"{row['shape']},{row['mu']}").get(float(row["D_over_d"]))
        if not deformable:
            cells += ["-", "-", "-"]
            if other:
                a, m = int(other["jammed"]), int(other["n"])
                cells[-3:] = [share(a, m), f"{tables.fisher(k, n, a, m):.2g}", other["rate"] or "-"]
        print("| " + " | ".join(cells) + f" | {row['runs'] or 'counts'} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    commands.add_parser("collect").set_defaults(command=collect)
    sub = commands.add_parser("table")
    sub.set_defaults(command=table)
    sub.add_argument("which", choices=["friction", "smooth", "deformable"])
    args = parser.parse_args()
    args.command(args)


if __name__ == "__main__":
    main()
