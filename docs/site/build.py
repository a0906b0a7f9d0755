#!/usr/bin/env python3
"""Builds the site: the pages of docs/, the reference of the public headers, and that of the Python module.

The pages are copied to a folder of their own, to which this script adds one for the module (from its docstrings) and
one that leads to the reference of the headers. Sphinx makes HTML of them, and a warning of it is
an error: links and formulas are checked. Doxygen makes the reference of the headers.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

# What MathJax needs to set TeX as SVG.
MATHJAX_PARTS = ["MathJax.js", "config/TeX-AMS_SVG-full.js", "extensions", "jax/element", "jax/input/TeX",
                 "jax/output/SVG"]
DOXYGEN = """PROJECT_NAME = Apothem
OUTPUT_DIRECTORY = "{out}"
INPUT = {headers}
STRIP_FROM_PATH = "{root}/lib" "{root}"
FULL_PATH_NAMES = YES
HTML_OUTPUT = cpp
GENERATE_LATEX = NO
GENERATE_TREEVIEW = NO
SOURCE_BROWSER = NO
VERBATIM_HEADERS = NO
EXTRACT_ALL = YES
HAVE_DOT = NO
CLASS_GRAPH = NO
JAVADOC_AUTOBRIEF = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = APOTHEM_INLINE= APOTHEM_NOINLINE=
EXCLUDE_SYMBOLS = *_detail
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
"""
CPP = """# C++ library

The public headers are included as `<apothem/ROOM/NAME.hpp>`. [As a library](user-guide.md#as-a-library) says how a program of
your own finds and uses them, and [a force of your own](how-to/own-force.md) shows one.

<p><a href="cpp/annotated.html">Classes and structs</a>, <a href="cpp/files.html">headers</a>,
<a href="cpp/namespacemembers_func.html">functions</a></p>
"""
NO_MODULE = """# Python

This site was made without the Python module. With the CMake option `APOTHEM_PYTHON` its reference stands here.
"""


def toctrees(index):
    """Hidden tables of contents: one for each section of an index, of the pages that it links."""
    text = ""
    sections = re.split(r"^## ", index, flags=re.M)
    for section in sections[1:] or sections:
        pages = re.findall(r"^- \[[^\]]*\]\(([^)#]+)\.md\)", section, re.M)
        caption = section.partition("\n")[0].removeprefix("# ")
        if pages:
            text += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"
    return text


def copy_pages(root, stage, mathjax):
    """The pages, beside links to what they refer to."""
    shutil.rmtree(stage, ignore_errors=True)
    stage.mkdir(parents=True)
    pages = stage / "docs"
    shutil.copytree(root / "docs", pages, ignore=shutil.ignore_patterns(
        "site", "scene_reference.py", "check_numbers.py", "fresh_numbers.py", "number_forms.py", "__pycache__", "numbers.json",
        "*.gnuplot"))
    for entry in root.iterdir():
        if entry.name not in ("docs", "build") and not entry.name.startswith("."):
            (stage / entry.name).symlink_to(entry)
    shutil.copy(root / "docs/site/conf.py", pages)
    static = pages / "_static"
    static.mkdir()
    shutil.copy(root / "docs/site/site.css", static)
    for part in MATHJAX_PARTS:
        source, target = mathjax / part, static / "mathjax" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target)
        else:
            shutil.copy(source, target)
    return pages


def complete_theme(html, normalize):
    """Puts into the site what Debian's Furo takes from a server: a style sheet, and a module of JavaScript,
    which browsers do not load from a disk."""
    styles, scripts = html / "_static/styles/furo.css", html / "_static/scripts"
    text = styles.read_text()
    styles.write_text(text.replace("@import url(/javascript/normalize.css/normalize.css);", normalize.read_text()))
    script = (scripts / "furo.js").read_text()
    line = 'import Gumshoe from "./gumshoe-patched.js";'
    if line in script:
        (scripts / "furo.js").write_text((scripts / "gumshoe-patched.js").read_text() + script.replace(line, ""))
    if re.search(r"url\(/|^import ", styles.read_text() + (scripts / "furo.js").read_text(), re.M):
        sys.exit("the site needs a server: Furo takes more from one than complete_theme knows")


def headers_of(root):
    listed = (root / "cmake/public_headers.cmake").read_text()
    return re.findall(r"^  ([\w/]+\.hpp)$", listed, re.M)


def describe_headers(root, html, scratch):
    """The reference of the public headers, in html/cpp."""
    files = [root / header if header.startswith("geometry/") else root / "lib" / header
             for header in headers_of(root)]
    scratch.mkdir(parents=True, exist_ok=True)
    doxyfile = scratch / "Doxyfile"
    doxyfile.write_text(DOXYGEN.format(out=html, root=root, headers=" ".join(f'"{file}"' for file in files)))
    return subprocess.run(["doxygen", doxyfile], check=False).returncode


def write_module(pages, module):
    """The page of the Python module."""
    text = "# Python\n\n```{eval-rst}\n.. automodule:: apothem\n   :members:\n   :undoc-members:\n```\n"
    (pages / "python.md").write_text(text if module else NO_MODULE)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder; the site lies in html below it")
    parser.add_argument("--version", required=True)
    parser.add_argument("--module", type=pathlib.Path, help="folder with the built Python module, for its docstrings")
    parser.add_argument("--sphinx", default="sphinx-build", help="the program of Sphinx")
    parser.add_argument("--mathjax", default="/usr/share/javascript/mathjax", type=pathlib.Path, help="MathJax 2")
    parser.add_argument("--normalize", default="/usr/share/javascript/normalize.css/normalize.css", type=pathlib.Path,
                        help="normalize.css, on which Furo depends")
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2], type=pathlib.Path)
    options = parser.parse_args()
    root, out = options.root.resolve(), options.out.resolve()
    pages = copy_pages(root, out / "source", options.mathjax)
    (pages / "cpp.md").write_text(CPP)
    write_module(pages, options.module)
    for index in (pages / "index.md", pages / "how-to/index.md"):
        text = index.read_text().replace("- [Extending](extending.md)\n", "- [Extending](extending.md)\n"
                                         "- [C++ library](cpp.md)\n- [Python](python.md)\n")
        index.write_text(text + toctrees(text))
    environment = dict(os.environ, APOTHEM_VERSION=options.version, PYTHONPATH=str(options.module or ""))
    html = out / "html"
    shutil.rmtree(html, ignore_errors=True)
    command = [options.sphinx, "-q", "-W", "--keep-going", "-b", "html", pages, html]
    failed = subprocess.run(command, env=environment, check=False).returncode
    if failed:
        return failed
    complete_theme(html, options.normalize)
    return describe_headers(root, html, out / "doxygen")


if __name__ == "__main__":
    sys.exit(main())
