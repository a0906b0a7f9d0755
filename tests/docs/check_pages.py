#!/usr/bin/env python3
"""Checks links, commands and JSON of the documents.

  links      a relative link leads to a file that exists, and its anchor to a heading there
  commands   in blocks of commands and in `apothem ...` within text: the sub-command and its options stand in
             the program's help; files below data/, docs/ and tests/ exist
  JSON       parses; a block whose first line is "// NAME.json" is a whole scene, which `apothem check` accepts

With --not-yet, a sub-command that the program does not have yet is no error.
Exit code 1: something is wrong; each line says where.
"""
import argparse
import functools
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def slug(heading):
    """The anchor of a heading, as GitHub makes it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def without_comments(text):
    """JSON without its // comments, which may not begin within a string."""
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m.group(1) or "", text)


class Pages:
    def __init__(self, root, program, not_yet):
        self.root, self.program, self.not_yet = root, program, not_yet
        self.problems, self.counts = [], {"links": 0, "commands": 0, "JSON blocks": 0}

    def names(self):
        listed = sorted(self.root.glob("*.md")) + sorted((self.root / "docs").rglob("*.md"))
        return listed + sorted((self.root / "data").rglob("*.md"))

    @functools.lru_cache(maxsize=None)
    def anchors(self, path):
        text = FENCE.sub("", path.read_text())
        return {slug(heading) for heading in re.findall(r"^#+ +(.*)$", text, re.M)}

    @functools.lru_cache(maxsize=None)
    def help(self, *words):
        return subprocess.run([self.program, *words, "--help"], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False).stdout

    @functools.lru_cache(maxsize=None)
    def options(self, sub):
        return set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", self.help(sub)))

    def subcommands(self):
        return set(re.findall(r"^  ([a-z]+) ", self.help().partition("Subcommands:")[2], re.M))

    def wrong(self, page, text, position, what):
        line = text.count("\n", 0, position) + 1
        self.problems.append(f"{page.relative_to(self.root)}:{line}: {what}")

    def links(self, page, text):
        prose = FENCE.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)
        prose = re.sub(r"`[^`\n]*`", lambda m: " " * len(m.group(0)), prose)
        for match in LINK.finditer(prose):
            target = match.group(1)
            if re.match(r"[a-z]+:", target):
                continue
            self.counts["links"] += 1
            name, _, anchor = target.partition("#")
            file = (page.parent / name).resolve() if name else page
            if not file.exists():
                self.wrong(page, text, match.start(), f"there is no file {target}")
            elif anchor and file.suffix == ".md" and anchor not in self.anchors(file):
                self.wrong(page, text, match.start(), f"there is no heading {target}")

    def command(self, page, text, position, line, files):
        """One command line that may call the program; `files`: those it names must exist."""
        try:
            words = shlex.split(line, comments=True)
        except ValueError:
            return
        if files:
            for word in words:
                if re.match(r"(data|docs|tests)/[\w./-]+$", word) and not (self.root / word).exists():
                    self.wrong(page, text, position, f"there is no file {word}")
        calls = [i for i, word in enumerate(words) if re.fullmatch(r"(\S*/)?apothem", word)]
        for i in calls:
            self.counts["commands"] += 1
            rest = words[i + 1:]
            sub = rest[0] if rest and not rest[0].startswith("-") else None
            if sub in self.not_yet or sub == "SUB":
                continue
            if sub and sub not in self.subcommands():
                self.wrong(page, text, position, f"there is no command: apothem {sub}")
                continue
            known = self.options(sub) if sub else {"--help", "--version"}
            for word in rest:
                option = re.fullmatch(r"(--?[a-z][\w-]*)(=.*)?", word)
                if option and option.group(1) not in known and f"{sub} {option.group(1)}" not in self.not_yet:
                    self.wrong(page, text, position, f"apothem {sub} has no option {option.group(1)}")

    def commands(self, page, text):
        for block in FENCE.finditer(text):
            if block.group(1) not in ("sh", "bash"):
                continue
            start = block.start(2)
            for line in re.finditer(r"(?:[^\n]*\\\n)*[^\n]+", block.group(2)):
                for part in re.split(r"&&|\||;|<\(", line.group(0).replace("\\\n", " ")):
                    self.command(page, text, start + line.start(), part.rstrip(" )"), True)
        prose = FENCE.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)
        for line in re.finditer(r"^ {4}(?:\S*/)?apothem .*$", prose, re.M):
            self.wrong(page, text, line.start(), "a command that is not in a block of commands (```sh)")
        for span in re.finditer(r"`((?:\S*/)?apothem [^`]+)`", prose):
            self.command(page, text, span.start(), re.sub(r"[()\[\]]", " ", span.group(1).replace("\n", " ")), False)

    def scene(self, page, text, position, name, body):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            file = folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            for known in (self.root / name).parent.parent.glob("*") if "/" in name else []:
                if known.is_dir() and not (file.parent.parent / known.name).exists():
                    (file.parent.parent / known.name).symlink_to(known)
            file.write_text(body)
            result = subprocess.run([self.program, "check", file], text=True, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, check=False)
            if result.returncode != 0:
                self.wrong(page, text, position, f"the scene {name} is refused: {result.stdout.strip()}")

    def json(self, page, text):
        for block in FENCE.finditer(text):
            if block.group(1) not in ("json", "jsonc"):
                continue
            self.counts["JSON blocks"] += 1
            body = without_comments(block.group(2)).strip()
            try:
                json.loads("{" + body + "}" if body.startswith('"') else body)
            except json.JSONDecodeError as error:
                self.wrong(page, text, block.start(), f"no valid JSON: {error}")
                continue
            name = re.match(r"// (\S+\.json)\n", block.group(2))
            if name:
                self.scene(page, text, block.start(), name.group(1), block.group(2))

    def check(self):
        for page in self.names():
            text = page.read_text()
            self.links(page, text)
            if page.name != "CHANGELOG.md":  # which names commands of earlier versions
                self.commands(page, text)
            self.json(page, text)
        for problem in self.problems:
            print(problem)
        print(", ".join(f"{n} {what}" for what, n in self.counts.items()) + f": {len(self.problems)} problems")
        return 1 if self.problems or not all(self.counts.values()) else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", required=True, type=pathlib.Path, help="apothem")
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parents[2], type=pathlib.Path)
    parser.add_argument("--not-yet", action="append", default=[], help="SUB or 'SUB --option' that may be missing")
    options = parser.parse_args()
    return Pages(options.root, options.program.resolve(), set(options.not_yet)).check()


if __name__ == "__main__":
    sys.exit(main())
