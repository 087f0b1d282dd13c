#!/usr/bin/env python3
# What pages say is there: links, anchors, pictures, cited decisions, verbs and options; lines end at 120 columns. Blocks
# of commands are ```sh run (run here, in one folder a page; "exit=N" is the code of its last command, the block "says"
# behind it is what stderr holds) or ```sh norun; options are looked up in both.
#   tests/pages_test.py PROGRAM TEST [WORD: only pages whose name has it]
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
PAGES = [page for page in PAGES if all(word in page.name for word in sys.argv[3:])]
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
        if heads != ["Question", "Decision", "Consequences"]:
            fault(name(page), f"has the headings {heads}")
        if page.stat().st_size > 3000:
            fault(name(page), "is longer than 3 kB")


def columns():
    """Lines end at 120 columns; pages, and all of them together, stay as short as they have become."""
    for page, most in (("README.md", 900), ("HACKING.md", 1500)):
        count = len((ROOT / page).read_text().split())
        if count > most:
            fault(page, f"{count} words, more than {most}")
    tracked = subprocess.run(["git", "ls-files", "-z", "*.md"], cwd=ROOT, capture_output=True, text=True).stdout.split("\0")
    total = sum((ROOT / page).stat().st_size for page in tracked if page and (ROOT / page).exists())
    if total > 139900:
        fault("all pages", f"{total} bytes, more than 139,900: say it once, where it belongs")
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
    for floor in ["base", "cli", "farm", "scattering", "slicer", "io", "halftone", "calibration", "optics"]:
        for path in sorted([*(ROOT / floor).rglob("*.cpp"), *(ROOT / floor).rglob("*.h")]):
            for number, line in enumerate(path.read_text().split("\n"), 1):
                code = re.sub(r'"(?:[^"\\]|\\.)*"|//.*', "", line)
                for identifier in re.findall(r"\b[a-z][a-z0-9_]*\b", code):
                    short = refused.intersection(identifier.split("_"))
                    if short:
                        fault(f"{name(path)}:{number}", f"{identifier}: write {' '.join(short)} out; whoever searches finds words")


def argument(text, at):
    """What stands in the bracket that ends before `at`."""
    depth, i = 1, at
    while depth:
        if text[i] in "\"'":
            i = re.compile(r"(?:[^\\\n%s]|\\.)*" % text[i]).match(text, i + 1).end()
        depth += (text[i] in "([{") - (text[i] in ")]}")
        i += 1
    return text[at:i - 1].strip()


def messages():
    """Every warning and every failure ends with a name that docs/messages has, with an example that a test runs."""
    said = set()
    for floor in ["base", "cli", "farm", "scattering", "slicer", "io", "halftone", "calibration", "optics"]:
        for path in sorted((ROOT / floor).rglob("*.cpp")):
            text = path.read_text()
            said.update(re.findall(r'named_warning\(\s*"([a-z0-9-]+)",', text))
            for call in re.finditer(r"\b(?:warn|warnings_?\.(?:push|emplace)_back|tell)\(", text):
                told = argument(text, call.end())
                if call[0] == "tell(" and "Kind::warned" not in told:
                    continue
                if re.search(r"[a-z]", "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', told))) and "named_warning(" not in told:
                    fault(f"{name(path)}:{text[:call.start()].count(chr(10)) + 1}", "a warning without a name (base/warning.h)")
    folder = ROOT / "docs" / "messages"
    rows = re.findall(r"^\| (`[a-z0-9-]+`(?:, `[a-z0-9-]+`)*) \|", (folder / "warnings.md").read_text(), re.MULTILINE)
    told = [word for row in rows for word in re.findall(r"`([^`]+)`", row)]
    for word in sorted(said.symmetric_difference(told)):
        fault("docs/messages/warnings.md", f"{word}: " + ("has no row" if word in said else "no source warns so"))
    failures = set(re.findall(r'return "([a-z-]+)";', (ROOT / "cli" / "program" / "outcome.cpp").read_text())) - {"done"}
    headed = set(re.findall(r"^## \d+ ([a-z-]+)$", (folder / "exit-codes.md").read_text(), re.MULTILINE))
    for word in sorted(failures.symmetric_difference(headed)):
        fault("docs/messages/exit-codes.md", f"{word}: " + ("has no heading" if word in failures else "no failure is called so"))
    examples = "".join("\n".join(lines) for page in folder.glob("*.md") for _, info, lines in blocks(page)[0] if info == ["says"])
    examples += (ROOT / "tests" / "data" / "bugs" / "expected.json").read_text()
    for path in (ROOT / "tests").rglob("*.cpp"):
        examples += " ".join(re.findall(r'Contains\("[^"\n]*"\)', path.read_text()))
    for path in (ROOT / "python" / "tests").glob("*.py"):
        examples += "".join(f"[{word}]" for word in re.findall(r'"([a-z0-9-]+)" in \[', path.read_text()))
    for word in sorted(said):
        if f"[{word}]" not in examples:
            fault("docs/messages", f"{word}: no test sees it")
    if sum(page.stat().st_size for page in folder.glob("*.md")) > 15000:
        fault("docs/messages", "are longer than 15 kB together")


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
