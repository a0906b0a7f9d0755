#!/usr/bin/env python3
"""Lines of geometry/, lib/ and apps/ that the tests of a build folder have run, by gcov: coverage.py BUILD.

The build folder is that of the preset `coverage`, in which tests have been run since. A line counts once, however many
objects and templates have it."""
import collections
import gzip
import json
import pathlib
import subprocess
import sys
import tempfile

build = pathlib.Path(sys.argv[1]).resolve()
source = pathlib.Path(__file__).resolve().parents[1]
runs = collections.defaultdict(lambda: collections.defaultdict(int))
for notes in sorted(build.rglob("*.gcno")):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gcov", "--json-format", str(notes)], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        for result in pathlib.Path(folder).glob("*.gcov.json.gz"):
            for file in json.loads(gzip.decompress(result.read_bytes()))["files"]:
                path = pathlib.Path(file["file"])
                if source in path.parents:
                    for line in file["lines"]:
                        runs[str(path.relative_to(source))][line["line_number"]] += line["count"]
rooms = collections.Counter()
of_room = collections.Counter()
for file, lines in runs.items():
    room = "/".join(file.split("/")[:2])
    if room.split("/")[0] in ("geometry", "lib", "apps"):
        rooms[room] += len(lines)
        of_room[room] += sum(count > 0 for count in lines.values())
for room in sorted(rooms):
    print(f"{room:24} {of_room[room]:6} of {rooms[room]:6} lines, {100 * of_room[room] / rooms[room]:5.1f} %")
print(f"{'all':24} {sum(of_room.values()):6} of {sum(rooms.values()):6} lines, "
      f"{100 * sum(of_room.values()) / sum(rooms.values()):5.1f} %")
