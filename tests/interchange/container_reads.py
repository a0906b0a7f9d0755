#!/usr/bin/env python3
"""Programs of others read the container of all frames as they read files of frames: ParaView (both of its readers of XDMF),
meshio and h5py. Called with the program; ends with 77 where one of them is missing."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))

# Runs in ParaView's Python, which takes long to start: of all files, blocks, cells and arrays at every time, as JSON.
LOOK = """
import json, sys
from paraview import servermanager, simple
answers = []
for file in sys.argv[1:]:
    answer = {}
    for reader in (simple.XDMFReader(FileNames=[file]), simple.Xdmf3ReaderT(FileName=[file])):
        reader.UpdatePipelineInformation()
        times = list(reader.TimestepValues)
        frames = []
        for time in times:
            reader.UpdatePipeline(time)
            data = servermanager.Fetch(reader)
            parts = [data]
            if data.IsA("vtkMultiBlockDataSet"):
                parts = [data.GetBlock(i) for i in range(data.GetNumberOfBlocks())]
            frame = []
            while parts:
                part = parts.pop(0)
                if part.IsA("vtkMultiBlockDataSet"):
                    parts = [part.GetBlock(i) for i in range(part.GetNumberOfBlocks())] + parts
                    continue
                arrays = {}
                for of in (part.GetPointData(), part.GetCellData()):
                    for i in range(of.GetNumberOfArrays()):
                        array = of.GetArray(i)
                        arrays[array.GetName()] = [array.GetTuple(k)[0] for k in range(array.GetNumberOfTuples())]
                frame.append({"points": part.GetNumberOfPoints(), "cells": part.GetNumberOfCells(), "arrays": arrays,
                              "bounds": part.GetBounds()})
            frames.append(frame)
        answer[reader.GetXMLName()] = {"times": times, "frames": frames}
    answers.append(answer)
print("ANSWER" + json.dumps(answers))
"""


def run(program, scene, folder):
    scene_file = folder.with_suffix(".json")
    scene_file.write_text(json.dumps(scene))
    subprocess.run([program, "run", scene_file, "-o", folder, "--quiet"], check=True)


def paraview(folder, files):
    script = folder / "look.py"
    script.write_text(LOOK)
    result = subprocess.run(["pvpython", script, *files], capture_output=True, text=True, check=False)
    found = re.search("ANSWER(.*)", result.stdout)
    if not found:
        raise SystemExit(f"pvpython has failed: {result.stdout}\n{result.stderr}")
    return json.loads(found[1])


def main():
    try:
        import h5py
        import meshio
        import meshio_reads
    except ImportError as missing:
        print(f"skipped: {missing} (Debian: python3-meshio, python3-h5py)")
        return 77
    if not shutil.which("pvpython"):
        print("skipped: there is no pvpython (Debian: paraview, python3-paraview)")
        return 77
    faults = []

    def check(what, is_so):
        if not is_so:
            faults.append(what)

    scenes = {"scene": meshio_reads.SCENE, "empty": meshio_reads.EMPTY}
    with tempfile.TemporaryDirectory() as name:
        for scene_name, scene in scenes.items():
            run(sys.argv[1], scene, pathlib.Path(name) / f"{scene_name}-files")
            run(sys.argv[1], {**scene, "output": {**scene["output"], "format": "xdmf"}}, pathlib.Path(name) / scene_name)
        seen = [pathlib.Path(name) / scene_name / file for scene_name in scenes for file in ("frames.xdmf", "contacts.xdmf")]
        answers = dict(zip(seen, paraview(pathlib.Path(name), seen)))
        for scene_name in scenes:
            files, whole = pathlib.Path(name) / f"{scene_name}-files", pathlib.Path(name) / scene_name
            singles = [meshio.read(file) for file in sorted((files / "frames").glob("bodies_*.vtu"))]
            times = [float(single.field_data["TimeValue"][0]) for single in singles]
            # HDF5 alone.
            with h5py.File(whole / "frames.h5") as numbers:
                check(f"{scene_name}: groups {list(numbers)}", list(numbers) == [f"{i:06}" for i in range(len(times))])
                for group, single in zip(numbers.values(), singles):
                    check(f"{group}: time", group["time"][0] == times[int(group.name[1:])])
                    if len(single.points) == 0:
                        check(f"{group}: is not empty", "empty" in group["bodies"])
                        continue
                    check(f"{group}: points", (group["bodies/points"][()] == single.points[:, :2]).all())
                    velocity = group["bodies/point_data/velocity"][()]
                    check(f"{group}: velocity", (velocity == single.point_data["velocity"][:, :2]).all())
            # meshio.
            with meshio.xdmf.TimeSeriesReader(whole / "frames.xdmf") as series:
                points, _ = series.read_points_cells()
                check(f"{scene_name}: {series.num_steps} steps in meshio", series.num_steps == len(times))
                check(f"{scene_name}: points in meshio", (points == singles[0].points[:, :2]).all())
                for i in range(1 if scene_name == "empty" else len(times)):
                    time, of_points, of_cells = series.read_data(i)
                    check(f"{scene_name}: time {time} in meshio", time == times[i])
                    check(f"{scene_name}: displacement in meshio",
                          (of_points["displacement"] == singles[i].point_data["displacement"][:, :2]).all())
                    check(f"{scene_name}: cells in meshio", "body" in of_cells)
            # ParaView.
            for file in ("frames.xdmf", "contacts.xdmf"):
                for reader, answer in answers[whole / file].items():
                    check(f"{scene_name}: {answer['times']} in {reader}", answer["times"] == times)
                    for i, frame in enumerate(answer["frames"]):
                        single = singles[i]
                        if file == "contacts.xdmf":
                            check(f"{scene_name}: {len(frame)} blocks in {reader}", len(frame) >= 3)
                            check(f"{scene_name}: contacts in {reader}", "phi" in frame[0]["arrays"])
                            continue
                        check(f"{scene_name}: {len(frame)} grids in {reader}", len(frame) == 1)
                        if len(single.points) == 0:
                            check(f"{scene_name}: body in {reader}", frame[0]["arrays"]["body"] == [-1])
                            continue
                        bounds = [f(single.points[:, k]) for k in (0, 1) for f in (min, max)]
                        check(f"{scene_name}: bounds {frame[0]['bounds']} in {reader}", frame[0]["bounds"][:4] == bounds)
                        check(f"{scene_name}: displacement in {reader}",
                              frame[0]["arrays"]["displacement"] == list(single.point_data["displacement"][:, 0]))
    for fault in sorted(set(faults)):
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
