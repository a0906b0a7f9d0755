"""Builds the Debian packages of a build folder and checks them: names, dependencies, files, and that the program runs
from the files of its package alone. Usage: check_debian_packages.py BUILD"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile


def output(*command, **options):
    result = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, **options)
    if result.returncode:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{result.stdout}")
    return result.stdout


def field(package, name):
    return output("dpkg-deb", "--field", package, name).strip()


def needs(package, name="Depends"):
    return re.findall(r"[a-z0-9][a-z0-9.+-]+(?=[ ,|]|$)", re.sub(r"\([^)]*\)", "", field(package, name)))


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()}


def check(build, scratch):
    log = output("cpack", "-G", "DEB", "--config", build / "CPackConfig.cmake", "-B", build / "packages",
                 stderr=subprocess.STDOUT)
    found = [pathlib.Path(path) for path in re.findall(r"package: (\S+\.deb) generated", log)]
    packages = {field(path, "Package"): path for path in found}
    assert {"apothem", "libapothem-dev"} <= set(packages), log
    program, library = packages["apothem"], packages["libapothem-dev"]
    version = field(program, "Version")
    assert program.name == f"apothem_{version}_{field(program, 'Architecture')}.deb", program

    depends = needs(program)
    assert not [name for name in depends if name.endswith("-dev")], depends
    for stem in ("libc6", "libcairo2", "libfmt", "libgmp10", "libmpfr6", "libsleef", "libvtk9"):
        assert [name for name in depends if name.startswith(stem)], f"{stem} is not in {depends}"
    assert not [name for name in depends if name.startswith("libgdal")], "GDAL is loaded when a drawing is read"
    assert [name for name in needs(program, "Recommends") if name.startswith("libgdal")]
    assert f"apothem (= {version})" in field(library, "Depends")

    unpacked = {}
    for name, path in packages.items():
        unpacked[name] = scratch / name
        output("dpkg-deb", "-x", path, unpacked[name])
    output("cmake", "--install", build, "--prefix", scratch / "installed/usr")
    # The Python module, where it was built, is installed by CMake alone.
    installed = {path for path in files(scratch / "installed") if not re.search(r"/python3[.\d]*/", path)}
    assert set().union(*map(files, unpacked.values())) == installed, "not what is installed"
    assert not [path for path in files(unpacked["apothem"]) if re.search(r"\.(a|hpp|cmake)$", path)]
    assert not [path for path in files(unpacked["libapothem-dev"]) if not re.search(r"\.(a|cpp|hpp|cmake)$", path)]

    root = unpacked["apothem"] / "usr"
    for path in ("share/man/man1/apothem.1", "share/bash-completion/completions/apothem", "share/doc/apothem/copyright",
                 "share/apothem/scene.schema.json"):
        assert (root / path).stat().st_size > 0, path
    apothem = root / "bin/apothem"
    assert output(apothem, "--version").strip().endswith(version)
    output(apothem, "run", root / "share/apothem/scenes/impact-asymmetric.json", "--verify", "-o", scratch / "run")
    polygon = json.loads(output(apothem, "polygon", root / "share/apothem/polygons/boulder.json", "--json"))
    assert polygon["area"] > 0
    # The program finds its data beside itself, not where it was built.
    (root / "share/apothem/figures/energy.json").unlink()
    figures = [line.split()[0] for line in output(apothem, "reproduce").splitlines()]
    assert "energy" not in figures and len(figures) == len(list((root / "share/apothem/figures").glob("*.json"))), figures
    for path in found:
        size = int(field(path, "Installed-Size"))
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB, installed {size / 1024:.1f} MB; needs {field(path, 'Depends')}")


if len(sys.argv) != 2:
    sys.exit(__doc__)
with tempfile.TemporaryDirectory() as folder:
    check(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(folder))
