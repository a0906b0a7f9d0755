#!/usr/bin/env python3
"""Tables of the hopper and of the heap from the folders that `apothem sweep` has written.

    tables.py jam FLOWS [--reference quad,0.5]   jam probability, discharge rate, energy, blocks outside
    tables.py hazard FLOWS                       jams per discharged block, in windows of blocks
    tables.py pairs FLOWS OTHERS                 the same seeds and widths in two studies
    tables.py beverloo FLOWS                     fit of W = C rho_b sqrt(g) (D - k d)^(3/2)
    tables.py repose HEAPS                       angle of repose
    tables.py cost PACKS                         time per body and step, and what takes it
    tables.py outlines FILLS FOLDER              resting blocks of hopper-fill.json as drawings for soft-fill.json
    tables.py picture FILE.png LABEL=FLOWS ...   jam probability over the width, and discharge (with gnuplot)
    tables.py record FLOWS NAME                  NAME.csv and NAME-discharge.csv: what the tables above need of a study

FLOWS are made from hopper-flow.json or soft-flow.json, or are a recorded NAME.csv; HEAPS are made from repose.json, PACKS from
pack.json. Intervals are for 95 %.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess

D, RHO, G = 0.1, 2000.0, 9.81  # m, kg/m^3, m/s^2
MASS = RHO * math.pi * D**2 / 4  # kg, mean of a block


def wilson(k, n, z=1.959964):
    centre = (k + z * z / 2) / (n + z * z)
    half = z / (n + z * z) * math.sqrt(k * (n - k) / n + z * z / 4)
    return max(0, centre - half), min(1, centre + half)


# Quantiles of Student's distribution for 95 %, by degrees of freedom.
STUDENT = {1: 12.71, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262,
           10: 2.228, 12: 2.179, 15: 2.131, 20: 2.086, 30: 2.042, 60: 2.000, 10**9: 1.960}


def mean(values):
    """Mean, standard error and half of the t interval."""
    n = len(values)
    m = sum(values) / n
    if n < 2:
        return m, math.nan, math.nan
    error = math.sqrt(sum((v - m)**2 for v in values) / (n - 1) / n)
    t = STUDENT[max(k for k in STUDENT if k <= n - 1)]
    return m, error, t * error


def columns(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in rows[0]]
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}


def key_of(row):
    """Width and seed of a run, as its row has them."""
    return row.get("D/d") or "", row.get("fill.0.seed") or row["seed"]


class Flow:
    """A run of hopper-flow.json or soft-flow.json; discharge is its list of times in s and blocks in the bin."""

    def __init__(self, row, discharge):
        width, seed = key_of(row)
        self.width = float(width) if width else math.nan  # not said
        self.seed = int(seed)
        self.jammed = row["jammed"] == "true"
        self.emptied = row["emptied"] == "true"
        self.discharged = int(float(row["discharged"]))
        self.outside = int(float(row.get("outside") or 0))
        self.cpu = float(row.get("processor_time [s]") or row["wall_time [s]"])  # older tables: only the latter
        self.fallen = float(row["potential energy"])  # J, what was set free
        self.error = float(row["energy error"])
        self.times, self.counts = discharge

    def reached(self, share):
        """Index of the first row with this share of the blocks out, or nothing."""
        limit = (1 - share) * self.counts[0]
        return next((i for i, count in enumerate(self.counts) if count <= limit), None)

    def rate(self):
        """Blocks per second from 10 to 60 % discharged, or nothing."""
        start, end = self.reached(.1), self.reached(.6)
        if not self.emptied or start is None or end is None:
            return None
        return (self.counts[start] - self.counts[end]) / (self.times[end] - self.times[start])


def finished(path):
    """Rows of a study's table that are done."""
    with open(path, newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if row["status"] == "done"]


def discharge_of(recorded):
    """File of the discharges that belong to a recorded study."""
    return recorded.with_name(recorded.stem + "-discharge.csv")


def flows(study):
    """Runs of a study: the folder of a sweep, or a table that `record` has written."""
    study = pathlib.Path(study)
    if study.is_dir():
        rows, discharges = finished(study / "runs.csv"), {}
        for row in rows:
            history = columns(study / "runs" / row["run"] / "history.csv")
            discharges[key_of(row)] = history["time"], history["bin.count"]
    else:
        rows, discharges = finished(study), {}
        with open(discharge_of(study), newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                times, counts = discharges.setdefault(key_of(row), ([], []))
                times.append(float(row["time [s]"]))
                counts.append(float(row["blocks"]))
    return [Flow(row, discharges[key_of(row)]) for row in rows]


def record(args):
    name = pathlib.Path(args.name)
    table = name.with_name(name.name + ".csv")
    folder = pathlib.Path(args.folder)
    rows = finished(folder / "runs.csv")
    for row in rows:
        run = json.loads((folder / "runs" / row["run"] / "run.json").read_text(encoding="utf-8"))
        row["version"] = run["version"]
    with open(table, "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, ["D/d", "fill.0.seed", "status", "jammed", "emptied", "discharged", "outside", "energy error",
                                    "potential energy", "time [s]", "wall_time [s]", "processor_time [s]", "scene_hash",
                                    "final_state_hash", "stopped_by", "version"],
                             restval="", extrasaction="ignore", lineterminator="\n")
        out.writeheader()
        out.writerows(rows)
    with open(discharge_of(table), "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["D/d", "seed", "time [s]", "blocks"])
        for row, flow in zip(rows, flows(folder)):
            last = len(flow.times) - 1
            keep = {0, last, flow.reached(.1), flow.reached(.6)}  # those that the rate needs, and ten in a second
            for i, (time, count) in enumerate(zip(flow.times, flow.counts)):
                if i in keep or round(time / .1) > round(flow.times[max(0, i - 1)] / .1):
                    out.writerow([*key_of(row), f"{time:g}", f"{count:g}"])
    print(f"{table} and {discharge_of(table)}: {len(rows)} runs")


def by_width(runs):
    groups = {}
    for run in runs:
        groups.setdefault(run.width, []).append(run)
    return sorted(groups.items())


def reference(text):
    """Rows of the independent study for "shape,mu", by width."""
    if not text:
        return {}
    shape, mu = text.split(",")
    path = pathlib.Path(__file__).resolve().parent.parent / "reference" / "jam_box2d.csv"
    with open(path, newline="", encoding="utf-8") as file:
        return {float(r["D_over_d"]): r for r in csv.DictReader(file)
                if r["shape"] == shape and float(r["mu"]) == float(mu)}


def jam(args):
    other = reference(args.reference)
    print("D/d  jammed   probability           rate, 1/s        energy error  outside  neither  s per run"
          + ("   reference: jammed  probability     rate" if other else ""))
    for width, runs in by_width(flows(args.folder)):
        k, n = sum(r.jammed for r in runs), len(runs)
        low, high = wilson(k, n)
        rates = [r.rate() for r in runs if r.rate()]
        rate = "-"
        if rates:
            m, _, half = mean(rates)
            rate = f"{m:.1f}" + (f" +- {half:.1f}" if len(rates) > 1 else "") + f" ({len(rates)})"
        error = max(r.error / r.fallen for r in runs)
        line = (f"{width:<4g} {k:>3}/{n:<3}  {k / n:.2f} ({low:.2f} to {high:.2f})  {rate:<18} {error:.1e}"
                f"      {sum(r.outside for r in runs):<8} {sum(not (r.jammed or r.emptied) for r in runs):<7}"
                f"  {sum(r.cpu for r in runs) / n:.0f}")
        if width in other:
            o = other[width]
            line += (f"          {o['jammed']}/{o['n']}  {int(o['jammed']) / int(o['n']):.2f}"
                     f" ({float(o['lo']):.2f} to {float(o['hi']):.2f})  {o['rate'] or '-'}")
        print(line)


def fisher(a, n, b, m):
    """Two-sided exact test: probability of a of n and b of m, or a less likely table, if they have one proportion."""

    def ways(x):
        return math.comb(n, x) * math.comb(m, a + b - x)

    tables = [ways(x) for x in range(max(0, a + b - m), min(n, a + b) + 1)]
    return sum(w for w in tables if w <= ways(a)) / sum(tables)


def hazard(args):
    windows = [(0, 20), (20, 60), (60, 120), (120, 300)]
    print("D/d  jams per discharged block, with the number of jams, for blocks "
          + ", ".join(f"{a} to {b}" for a, b in windows))
    for width, runs in by_width(flows(args.folder)):
        cells = []
        for a, b in windows:
            exposure = sum(max(0, min(r.discharged, b) - a) for r in runs)
            jams = sum(r.jammed and a <= r.discharged < b for r in runs)
            cells.append(f"{jams / exposure:.4f} ({jams})" if exposure else "-")
        print(f"{width:<4g} " + "   ".join(cells))


def pairs(args):
    one = {(r.width, r.seed): r.jammed for r in flows(args.folder)}
    two = {(r.width, r.seed): r.jammed for r in flows(args.other)}
    print("D/d  both  first only  second only  neither  p of no difference (exact, McNemar)")
    for width in sorted({key[0] for key in one} & {key[0] for key in two}):
        keys = [key for key in one if key in two and key[0] == width]
        b = sum(one[k] and not two[k] for k in keys)
        c = sum(two[k] and not one[k] for k in keys)
        tail = sum(math.comb(b + c, i) for i in range(min(b, c) + 1)) / 2**(b + c)
        both = sum(one[k] and two[k] for k in keys)
        print(f"{width:<4g} {both:<5} {b:<11} {c:<12} {len(keys) - both - b - c:<8} {min(1, 2 * tail):.3f}")


def line_fit(points):
    """Weighted line y = a + b x through (x, y, standard error), and the covariances of a and b."""
    w = [1 / e**2 for _, _, e in points]
    sx = sum(wi * x for wi, (x, _, _) in zip(w, points))
    sy = sum(wi * y for wi, (_, y, _) in zip(w, points))
    sxx = sum(wi * x * x for wi, (x, _, _) in zip(w, points))
    sxy = sum(wi * x * y for wi, (x, y, _) in zip(w, points))
    det = sum(w) * sxx - sx * sx
    return (sxx * sy - sx * sxy) / det, (sum(w) * sxy - sx * sy) / det


def beverloo(args):
    rho_b = RHO * args.solid_fraction
    points = []
    print("D/d  rate, 1/s  (W / (rho_b sqrt(g)))^(2/3) / d")
    for width, runs in by_width(flows(args.folder)):
        rates = [r.rate() for r in runs if r.rate()]
        if len(rates) < 3:
            continue
        m, error, _ = mean(rates)
        y = (m * MASS / (rho_b * math.sqrt(G)))**(2 / 3) / D
        points.append((width, y, 2 / 3 * y * error / m))
        print(f"{width:<4g} {m:<10.1f} {y:.3f} +- {points[-1][2]:.3f}")
    if len(points) < 3:
        raise SystemExit("tables.py: fewer than three widths have three runs that emptied")

    def constants(some):
        a, b = line_fit(some)
        return (b**1.5, -a / b) if b > 0 else (math.nan, math.nan)  # rates that fall with the width

    c, k = constants(points)
    # Errors by leaving out one width at a time (jackknife).
    left = [constants(points[:i] + points[i + 1:]) for i in range(len(points))]
    n = len(points)
    spread = [math.sqrt((n - 1) / n * sum((v[j] - sum(u[j] for u in left) / n)**2 for v in left)) for j in (0, 1)]
    print(f"C = {c:.2f} +- {spread[0]:.2f}, k = {k:.2f} +- {spread[1]:.2f}, rho_b = {rho_b:.0f} kg/m^3")


def repose(args):
    angles = []
    with open(pathlib.Path(args.folder) / "runs.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["status"] != "done":
                continue
            # Area of the blocks over their solid fraction: a triangle on a plate of 3.2 m.
            area = float(row["heap"]) * 3.2 * 4 / float(row["core"])
            angles.append(math.degrees(math.atan(4 * area / 3.2**2)))
            print(f"seed {row['fill.0.seed']}: {row['blocks']} blocks, solid fraction {float(row['core']):.3f},"
                  f" angle {angles[-1]:.1f} degrees" + ("" if row["at rest"] == "true" else ", not at rest"))
    m, _, half = mean(angles)
    print(f"angle of repose {m:.1f} +- {half:.1f} degrees ({len(angles)} heaps)")


def cost(args):
    print("blocks  steps   ns per block and step  search  contact  rest   pairs, touching, per block")
    with open(pathlib.Path(args.folder) / "runs.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "done"]
    for row in rows:
        with open(pathlib.Path(args.folder) / "runs" / row["run"] / "run.json", encoding="utf-8") as file:
            run = json.load(file)
        n, time, pairs = int(row["blocks"]), run["wall_time"], run["pairs_per_step"]
        total = time["total"] - time["output"]
        print(f"{n:<7} {run['steps']:<7} {total / run['steps'] / n * 1e9:<22.0f} {time['search'] / total:<7.1%}"
              f" {time['contact'] / total:<8.1%} {1 - (time['search'] + time['contact']) / total:<6.1%}"
              f" {pairs['candidates'] / n:.2f}, {pairs['touching'] / n:.2f}")


def outlines(args):
    folder = pathlib.Path(args.to)
    folder.mkdir(parents=True, exist_ok=True)
    with open(pathlib.Path(args.folder) / "runs.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "done"]
    with open(folder / "seeds.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["import.0.file", "#seed"])
        for row in rows:
            with open(pathlib.Path(args.folder) / "runs" / row["run"] / "final.json", encoding="utf-8") as final:
                run = json.load(final)
            places = run["simulation"]["state"]["x"]
            drawing = folder / f"{row['fill.0.seed']}.wkt"
            with open(drawing, "w", encoding="utf-8") as out:
                for i, body in enumerate(run["model"]["bodies"]):
                    if not body["name"].startswith("block"):
                        continue
                    x, y, angle = places[3 * i:3 * i + 3]
                    c, s = math.cos(angle), math.sin(angle)
                    ring = [f"{x + c * u - s * v:.9g} {y + s * u + c * v:.9g}"
                            for u, v in zip(body["shape"][::2], body["shape"][1::2])]
                    out.write(f"POLYGON (({', '.join(ring + ring[:1])}))\n")
            table.writerow([drawing.resolve(), row["fill.0.seed"]])
    print(f"{len(rows)} drawings and seeds.csv in {folder}")


def picture(args):
    studies = [study.split("=", 1) for study in args.studies]
    groups = [(label, by_width(flows(folder))) for label, folder in studies]
    blocks, jams, curves = [], [], []

    def block(lines):
        blocks.append(f"$b{len(blocks)} << EOD\n" + "\n".join(lines) + "\nEOD\n")
        return f"$b{len(blocks) - 1}"

    def points(rows, label, colour, style):
        aside = .03 * (len(jams) - 1)  # so that intervals do not lie on each other
        data = block(f"{width + aside:g} {p:g} {low:g} {high:g}" for width, p, low, high in rows)
        jams.append(f"{data} using 1:2:3:4 with yerrorlines lc {colour} pt 7 {style} title '{label}'")

    for colour, (label, widths) in enumerate(groups, 1):
        rows = []
        for width, runs in widths:
            k = sum(r.jammed for r in runs)
            rows.append((width, k / len(runs), *wilson(k, len(runs))))
        points(rows, label, colour, "")
        for width, runs in widths:
            if width != args.width:
                continue
            for i, r in enumerate(runs):
                data = block(f"{t:g} {r.counts[0] - c:g}" for t, c in zip(r.times, r.counts))
                title = f"title '{label}'" if i == 0 else "notitle"
                curves.append(f"{data} using 1:2 with lines lc {colour} lw 0.7 {title}")
    for text, colour in zip(args.reference, ("black", "gray50", "brown", "dark-green")):
        rows = [(width, int(r["jammed"]) / int(r["n"]), float(r["lo"]), float(r["hi"]))
                for width, r in sorted(reference(text).items())]
        points(rows, f"Box2D, {text.replace(',', ', mu ')}", f"rgb '{colour}'", "dt 2")
    script = "".join(blocks) + f"""
set terminal pngcairo noenhanced size 1500,700 font ',13'
set output '{args.file}'
set multiplot layout 1,2
set bmargin {5 + 1.3 * len(jams):g}
set xlabel 'width of the opening D/d'
set ylabel 'probability of a jam, with 95 % intervals'
set yrange [0:1.02]
set offsets 0.3, 0.3, 0, 0
set key outside bottom center horizontal maxcols 2
plot {", ".join(jams)}
set xlabel 'time (s)'
set ylabel 'blocks that have come out'
set yrange [0:*]
set offsets 0, 0, 0, 0
set title 'D/d = {args.width:g}: each run'
plot {", ".join(curves) if curves else "NaN notitle"}
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for command in (jam, hazard, pairs, beverloo, repose, cost, outlines, picture, record):
        sub = commands.add_parser(command.__name__)
        if command is picture:
            sub.add_argument("file", metavar="FILE.png")
            sub.add_argument("studies", metavar="LABEL=FLOWS", nargs="+")
            sub.add_argument("--width", type=float, default=7, help="D/d of the discharge curves (7)")
            sub.add_argument("--reference", metavar="SHAPE,MU", action="append", default=[], help="as for jam; up to four")
        else:
            sub.add_argument("folder", metavar="FOLDER")
        sub.set_defaults(command=command)
        if command is pairs:
            sub.add_argument("other")
        if command is outlines:
            sub.add_argument("to", metavar="FOLDER")
        if command is record:
            sub.add_argument("name", metavar="NAME")
        if command is jam:
            sub.add_argument("--reference", metavar="SHAPE,MU", help="quad,0.5 or cross,0.0: rows of jam_box2d.csv beside ours")
        if command is beverloo:
            sub.add_argument("--solid-fraction", type=float, default=0.8, help="of the resting blocks (0.8)")
    args = parser.parse_args()
    try:
        args.command(args)
    except FileNotFoundError as error:
        raise SystemExit(f"tables.py: there is no {error.filename}; give a folder that `apothem sweep` has written") from None


if __name__ == "__main__":
    main()
