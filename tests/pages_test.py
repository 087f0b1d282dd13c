#!/usr/bin/env python3
# What pages say is there: links, anchors, pictures, cited decisions, verbs and options; lines end at 120 columns. Blocks
# of commands are ```sh run (run here, in one folder a page; "exit=N" is the code of its last command, the block "says"
# behind it is what stderr holds) or ```sh norun; options are looked up in both.
#   tests/pages_test.py PROGRAM TEST
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unicodedata

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.path.abspath(sys.argv[1])
PAGES = [ROOT / "README.md", ROOT / "HACKING.md", *sorted((ROOT / "docs").rglob("*.md"))]
faults = []


def fault(where, what):
    faults.append(f"{where}: {what}")


def name(page):
    return page.relative_to(ROOT)


def blocks(page):
    """(number of its first line, info words, lines) of each fenced block, and the lines outside of them."""
    inside, found, prose = None, [], []
    for number, line in enumerate(page.read_text().split("\n"), 1):
        if line.startswith("```"):
            if inside is None:
                inside = (number + 1, line[3:].split(), [])
            else:
                found.append(inside)
                inside = None
        elif inside is not None:
            inside[2].append(line)
        else:
            prose.append((number, line))
    if inside is not None:
        fault(name(page), f"the block of line {inside[0]} does not end")
    return found, prose


def anchors(page):
    slugs = set()
    for _, line in blocks(page)[1]:
        heading = re.match(r"#+ (.*)", line)
        if heading:
            text = "".join(c for c in heading[1].lower() if c in "-_ " or unicodedata.category(c)[0] in "LN")
            slugs.add(text.replace(" ", "-"))
    return slugs


def links():
    shown = set()
    for page in PAGES:
        for number, line in blocks(page)[1]:
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                at = (page.parent / path).resolve() if path else page
                shown.add(at)
                if not at.exists():
                    fault(f"{name(page)}:{number}", f"{target} is not there")
                elif anchor and anchor not in anchors(at):
                    fault(f"{name(page)}:{number}", f"{target}: {name(at)} has no such heading")
    for picture in sorted((ROOT / "docs").rglob("*")):
        if picture.suffix in {".png", ".svg"} and picture.resolve() not in shown:
            fault(name(picture), "no page shows it")


def citations():
    """docs/NAME.md and docs/decisions/NNN, as sources and pages cite them."""
    files = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True,
                           text=True, check=True).stdout.split("\n")
    for file in files:
        path = ROOT / file
        text_like = path.suffix in {".h", ".cpp", ".py", ".sh", ".md", ".txt", ".cmake", ".json", ".js"} or path.suffix == ""
        if not file or not text_like or not path.is_file() or path.stat().st_size > 1000000:
            continue
        text = path.read_text(errors="replace")
        for page in re.findall(r"\bdocs/([a-z][a-z0-9/-]*)\.md\b", text):
            if not (ROOT / "docs" / (page + ".md")).exists() and "build_identity_test" not in file:
                fault(file, f"cites docs/{page}.md, which is not there")
        for number in re.findall(r"\bdecisions/(\d{3})\b", text):
            if len(list((ROOT / "docs" / "decisions").glob(number + "-*.md"))) != 1:
                fault(file, f"cites docs/decisions/{number}, of which there is not one")


def decisions():
    for page in sorted((ROOT / "docs" / "decisions").glob("*.md")):
        heads = re.findall(r"^## (.*)", page.read_text(), re.MULTILINE)
        if heads != ["State", "Question", "Decision", "Consequences"]:
            fault(name(page), f"has the headings {heads}")
        if page.stat().st_size > 3000:
            fault(name(page), "is longer than 3 kB")


def columns():
    for page in PAGES:
        for number, line in enumerate(page.read_text().split("\n"), 1):
            if len(line) > 120 and not line.startswith(("|", "![")):
                fault(f"{name(page)}:{number}", f"{len(line)} columns, more than 120")


class Table:
    """What the program says of its verbs and their options."""

    def __init__(self):
        self.options, self.verbs = {}, {}

    def help_of(self, verbs):
        if verbs not in self.options:
            done = subprocess.run([PROGRAM, *verbs, "--help-all"], capture_output=True, text=True)
            own = done.stdout.split("\n" + "-" * 60)[0] if done.returncode == 0 else ""
            self.options[verbs] = set(re.findall(r"(?<![\w-])(--[a-z][a-z0-9-]*|-[a-zA-Z](?=[, ]))", own))
            listed = re.search(r"^Verbs:\n(.*?)(?:\n\n|\Z)", own, re.MULTILINE | re.DOTALL)
            self.verbs[verbs] = set(re.findall(r"^  ([a-z][a-z-]*)", listed[1], re.MULTILINE)) if listed else set()
        return self.options[verbs], self.verbs[verbs]

    def check(self, words, where):
        verbs = ()
        while True:
            options, below = self.help_of(verbs)
            if words and words[0] in below:
                verbs += (words.pop(0),)
            else:
                break
        if below and words and not words[0].startswith("-") and re.fullmatch("[a-z-]+", words[0]):
            return fault(where, f"voxtone {' '.join(verbs)} has no verb {words[0]}")
        for word in words:
            option = word.split("=")[0]
            if re.fullmatch(r"--[a-z][a-z0-9-]*|-[a-zA-Z]", option) and option not in options:
                fault(where, f"voxtone {' '.join(verbs)} has no option {option}")

    def all_options(self, verbs=()):
        options, below = self.help_of(verbs)
        return options.union(*(self.all_options(verbs + (verb,)) for verb in below))


def commands_in(lines):
    text = re.sub(r"\\\n\s*", " ", "\n".join(lines))
    for line in text.split("\n"):
        try:
            words = shlex.split(line, comments=True)
        except ValueError:
            continue
        for i, word in enumerate(words):
            if word.split("/")[-1] == "voxtone":
                tail = words[i + 1:]
                end = next((j for j, w in enumerate(tail) if w in {"|", "&&", ";", ">", "||"} or w.endswith(";")), len(tail))
                yield tail[:end]


def options():
    table = Table()
    if "calibrate" not in table.help_of(())[1]:
        print("skipped: this build is without `voxtone calibrate`, which pages tell of")
        sys.exit(77)
    known = table.all_options()
    others = set((ROOT / "tests" / "options_of_others.txt").read_text().split())
    for page in PAGES:
        found, prose = blocks(page)
        for number, info, lines in found:
            told = list(commands_in(lines))
            if told and info[:2] not in (["sh", "run"], ["sh", "norun"]):
                fault(f"{name(page)}:{number}", "commands are ```sh run or ```sh norun")
            for words in told if "exit=2" not in info else []:  # a command that is not understood is the example
                table.check(words, f"{name(page)}:{number}")
        for number, line in prose:
            if re.match(r" {4,}(\$ )?voxtone ", line):
                fault(f"{name(page)}:{number}", "commands stand in a block ```sh run or ```sh norun")
            for code in re.findall(r"`([^`]+)`", line):
                for words in commands_in([code]):
                    table.check(words, f"{name(page)}:{number}")
                for option in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]+", code):
                    if option not in known and option not in others:
                        fault(f"{name(page)}:{number}", f"no verb has the option {option}")


def words():
    """No identifier abbreviates what docs/glossary.md says is written out."""
    glossary = (ROOT / "docs" / "glossary.md").read_text()
    refused = set(re.search(r"a test refuses\s+`([^`]+)`", glossary)[1].split())
    for floor in ["base", "cli", "slicer", "io", "halftone", "calibration", "optics"]:
        for path in sorted([*(ROOT / floor).rglob("*.cpp"), *(ROOT / floor).rglob("*.h")]):
            for number, line in enumerate(path.read_text().split("\n"), 1):
                code = re.sub(r'"(?:[^"\\]|\\.)*"|//.*', "", line)
                for identifier in re.findall(r"\b[a-z][a-z0-9_]*\b", code):
                    short = refused.intersection(identifier.split("_"))
                    if short:
                        fault(f"{name(path)}:{number}", f"{identifier}: write {' '.join(short)} out; whoever searches finds words")


def messages():
    """What docs/messages/warnings.md quotes in its tables is said by a source."""
    sources = ""
    for floor in ["base", "cli", "slicer", "io", "halftone", "calibration", "optics"]:
        for path in sorted((ROOT / floor).rglob("*.cpp")):
            sources += " ".join(path.read_text().split())
    joined = re.sub(r'" *(?:// [^"]*)?"', "", sources)  # a string that goes on
    page = ROOT / "docs" / "messages" / "warnings.md"
    for number, line in enumerate(page.read_text().split("\n"), 1):
        if line.startswith("| ") and line != "| says | do |":
            for quoted in re.findall(r"`([^`]+)`", line.split(" | ")[0]):
                pattern = ".{0,40}?".join(re.escape(part) for part in quoted.split("…"))
                if not re.search(pattern, joined):
                    fault(f"{name(page)}:{number}", f"no source says: {quoted}")


def run():
    environment = dict(os.environ, PATH=f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}")
    ran = 0
    for page in PAGES:
        with tempfile.TemporaryDirectory(prefix="voxtone-pages-") as folder:
            spot = ROOT / "examples" / "models" / "spot"
            for file in spot.iterdir():
                shutil.copy(file, folder)
            shutil.copy(spot / "spot_texture.png", pathlib.Path(folder) / "photo.png")
            last = ""
            for number, info, lines in blocks(page)[0]:
                if info[:2] == ["sh", "run"]:
                    wanted = next((int(w[5:]) for w in info if w.startswith("exit=")), 0)
                    done = subprocess.run(["sh", "-ec" if not wanted else "-c", "\n".join(lines)], cwd=folder,
                                          env=environment, capture_output=True, text=True)
                    last = done.stderr + done.stdout
                    ran += 1
                    if done.returncode != wanted:
                        fault(f"{name(page)}:{number}", f"exit code {done.returncode} for {wanted}:\n{last}")
                elif info[:1] == ["says"]:
                    flat = " ".join(last.split())
                    for line in lines:
                        if " ".join(line.split()) not in flat:
                            fault(f"{name(page)}:{number}", f"does not say: {line}\nbut:\n{last}")
    if not ran:
        fault("pages", "no command was run")


TESTS = [links, citations, decisions, columns, options, messages, words, run]
next(test for test in TESTS if test.__name__ == sys.argv[2])()
print("\n".join(faults))
sys.exit(1 if faults else 0)
