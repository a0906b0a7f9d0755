#!/usr/bin/env python3
"""Walks through a page of the guide literally, in an empty folder.

  ```jsonc with a first line "// NAME.json"   is written to that file
  ```sh                                       is run, with the program first on the PATH
  ```text behind a block of commands          its lines must be printed by these commands, in this order

White space counts as one blank; lines that the page does not show may stand between. A comment
`<!-- exit code 2 -->` before a block of commands says that it fails so, and `<!-- not run -->` that it is not
run. With --not-yet, blocks that use these sub-commands or options are left out as long as the program
does not have them.

Exit code 1: a command ends otherwise, or does not print what the page shows.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FENCE = re.compile(r"(?:<!-- (?P<note>[^>]*) -->\n)?```(?P<kind>\w+)\n(?P<text>.*?)^```$", re.M | re.S)


class Wrong(Exception):
    """What is wrong with the page."""


class Walk:
    def __init__(self, program, folder, not_yet):
        self.program, self.folder, self.not_yet = program.resolve(), folder, not_yet
        self.printed, self.commands = None, 0

    def run(self, command):
        environment = dict(os.environ, PATH=f"{self.program.parent}:{os.environ['PATH']}")
        return subprocess.run(["bash", "-e", "-c", command], cwd=self.folder, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)

    def is_missing(self, text):
        """Something that the program does not have yet, and the block uses."""
        for feature in self.not_yet:
            words = feature.split()
            used = rf"apothem {words[0]}\b" + (rf".*{re.escape(words[1])}\b" if words[1:] else "")
            if re.search(used, text):
                help_text = self.run("apothem --help" if len(words) == 1 else f"apothem {words[0]} --help").stdout
                if not re.search(rf"^ +({re.escape(words[-1])})\b", help_text, re.M):
                    return feature
        return None

    def commands_of(self, text, note, line):
        self.printed = None
        missing = self.is_missing(text)
        if note == "not run" or missing:
            print(f"line {line}: left out" + (f", there is no '{missing}' yet" if missing else ""))
            return
        expected = int(re.fullmatch(r"exit code (\d+)", note).group(1)) if note else 0
        result = self.run(text)
        if result.returncode != expected:
            raise Wrong(f"line {line}: exit code {result.returncode}, not {expected}:\n{text}{result.stdout}")
        self.printed = result.stdout
        self.commands += 1

    def lines_of(self, text, line):
        if self.printed is None:
            return
        left = [" ".join(printed.split()) for printed in re.split(r"[\n\r]", self.printed)]
        for shown in (" ".join(one.split()) for one in text.splitlines()):
            if shown not in left:
                raise Wrong(f"line {line}: this is not printed (here): {shown}\nbut:\n{self.printed}")
            left = left[left.index(shown) + 1:]

    def page(self, text):
        for block in FENCE.finditer(text):
            line = text.count("\n", 0, block.start("kind")) + 1
            kind, body = block["kind"], block["text"]
            if kind in ("json", "jsonc"):
                name = re.match(r"// (\S+\.json)\n", body)
                if name:
                    (self.folder / name.group(1)).write_text(body)
            elif kind == "sh":
                self.commands_of(body, block["note"], line)
            elif kind == "text":
                self.lines_of(body, line)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--program", required=True, type=pathlib.Path, help="apothem")
    parser.add_argument("--not-yet", action="append", default=[], help="SUB or 'SUB --option' that may be missing")
    parser.add_argument("--keep", type=pathlib.Path, help="an empty folder for the files, which stay there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or pathlib.Path(scratch)
        walk = Walk(options.program, folder, options.not_yet)
        try:
            walk.page(options.page.read_text())
        except Wrong as wrong:
            print(f"{options.page}: {wrong}")
            return 1
    print(f"{options.page}: {walk.commands} blocks of commands do what the page says")
    return 0 if walk.commands else 1


if __name__ == "__main__":
    sys.exit(main())
