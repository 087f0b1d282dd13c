# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts faults into a source, asleep until the environment names one."""
import re

VARIABLE, REACHED = "VOXTONE_MUTANT", "VOXTONE_MUTANTS_REACHED"
HEADER = "base/mutant.h"

SWITCH = f"""#pragma once
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <type_traits>
namespace voxtone {{
inline const int mutant_awake = [] {{
    const char* text = std::getenv("{VARIABLE}");
    return text ? std::atoi(text) : 0;
}}();
// With -1, the file that is told once of each mutant that would have been awake; opened before a sandbox closes.
inline const int mutants_reached = [] {{
    const char* name = std::getenv("{REACHED}");
    return name ? open(name, O_WRONLY | O_CREAT | O_APPEND, 0644) : -1;
}}();
inline unsigned char mutant_was_reached[1 << 16] = {{}};
inline bool mutant_reached(int number) {{
    if (__atomic_exchange_n(&mutant_was_reached[number], 1, __ATOMIC_RELAXED) == 0 && mutants_reached >= 0) {{
        char text[16];
        if (write(mutants_reached, text, std::snprintf(text, sizeof text, "%d\\n", number)) < 0) return false;
    }}
    return false;
}}
// In what was a constant: an initialiser that can be computed by the compiler would be, with all asleep.
inline bool mutant_at_run_time(int number) {{
    return mutant_awake == number || (mutant_awake < 0 && mutant_reached(number));
}}
constexpr bool mutant(int number) {{
    if (std::is_constant_evaluated()) return false;
    return mutant_at_run_time(number);
}}
}}  // namespace voxtone
"""


class Fault(Exception):
    """What is wrong with mutants, in a sentence."""


def only_place(text, part, what):
    found = text.count(part)
    if found != 1:
        raise Fault(f"{what} is there {found} times and must be there once: {part!r}")
    return text.index(part)


class Mutant:
    """One of a list."""
    KEYS = {"id", "file", "find", "replace", "what", "tests"}
    is_condition = False

    def __init__(self, line, origin, number):
        missing, unknown = self.KEYS - line.keys(), line.keys() - self.KEYS - {"within"}
        self.id, self.number = line.get("id", f"{origin}, number {number}"), number
        if missing or unknown:
            raise Fault(f"{self.id}: keys missing {sorted(missing)}, unknown {sorted(unknown)}")
        self.file, self.what, self.find = line["file"], line["what"], line["find"]
        self.replace = " ".join(line["replace"].split("\n"))  # a line stays a line: compilers name lines
        tests = line["tests"]
        self.tests = [tests] if isinstance(tests, str) else tests
        self.within = line.get("within")

    def place(self, text):
        """Where it is in its file: begin and end."""
        begin = 0
        if self.within is not None:
            begin = only_place(text, self.within, f"{self.id}: in {self.file}, `within`")
            text = self.within
        begin += only_place(text, self.find, f"{self.id}: in {self.file}, `find`")
        if "//" in self.find or self.find == self.replace or (self.replace.rstrip().endswith(";") and not self.is_statement()):
            raise Fault(f"{self.id}: a comment in `find`, nothing changed, or a statement for an expression")
        return begin, begin + len(self.find)

    def is_statement(self):
        return self.find.rstrip().endswith(";")

    def programs(self):
        return [test.split(":")[0] for test in self.tests]


class DrawnMutant:
    """One that draw.py drew."""
    tests = ()

    def __init__(self, candidates, slip, room, number):
        self.number, self.room, self.file, self.kind = number, room, slip.file, slip.kind
        self.span = slip.begin, slip.end
        self.find = candidates.source.text[slip.begin:slip.end]
        self.replace, self.is_condition = candidates.chosen(slip), slip.is_condition
        self.before, self.after = candidates.shown(slip)
        self.id = f"{slip.file}:{candidates.source.line(slip.at)}"
        self.what = f"{self.before}  ->  {self.after or '(dropped)'}"

    def place(self, text):
        if text[slice(*self.span)] != self.find:
            raise Fault(f"{self.id}: the file changed while mutants were drawn")
        return self.span

    def is_statement(self):
        return self.find.endswith(";")

    def programs(self):
        return []


def weave(text, placed):
    """The text with all mutants asleep in it; `placed` holds (begin, end, mutant)."""
    pieces, at = [], 0
    while placed:
        begin, end = min(((b, e) for b, e, _ in placed), key=lambda span: (span[0], -span[1]))
        here = [m for b, e, m in placed if (b, e) == (begin, end)]
        within = [(b - begin, e - begin, m) for b, e, m in placed if b < end and (b, e) != (begin, end)]
        for _, inner_end, mutant in within:
            if begin + inner_end > end:
                raise Fault(f"{here[0].id}, {mutant.id}: each begins in the other's text; let one `find` hold the other")
        placed = [(b, e, m) for b, e, m in placed if b >= end]
        pieces += [text[at:begin], asleep(here, weave(text[begin:end], within))]
        at = end
    return "".join(pieces) + text[at:]


def asleep(mutants, text):
    if mutants[0].is_statement():
        return "".join(f"if (voxtone::mutant({m.number})) {{ {m.replace} }} else " for m in mutants) + f"{{ {text} }}"
    if any(m.is_condition for m in mutants):  # what becomes a bool by itself is one before there is a choice
        text = f"static_cast<bool>({text})"
    return "(" + "".join(f"voxtone::mutant({m.number}) ? ({m.replace}) : " for m in mutants) + f"({text}))"


def without_crossing(mutants):
    """Those drawn mutants of a file whose texts hold each other or lie apart; of two that cross, the first."""
    kept = []
    for mutant in mutants:
        begin, end = mutant.span
        if all(e <= begin or end <= b or (b <= begin and end <= e) or (begin <= b and e <= end) for b, e in (m.span for m in kept)):
            kept.append(mutant)
    return kept


def declared_in(lines, number):
    """The line in which a constant begins whose value goes on in this one; else this one."""
    begin = number
    while begin > 0 and "constexpr" not in lines[begin] and lines[begin - 1].strip() and not lines[begin - 1].rstrip().endswith((";", "}")):
        begin -= 1
    return begin if "constexpr" in lines[begin] else number


def at_run_time(text, numbers, is_header=False):
    """Constants in these lines, counted from 0, become variables: constexpr is computed before there is an environment."""
    lines = text.split("\n")
    for number in sorted(set(numbers)):
        first = declared_in(lines, number)
        declared = "static inline const " if is_header and "static" in lines[first] else "static const "
        constant = re.sub(r"^(\s*)(?:static |inline )*constexpr (?=[\w:<>, ]+(?:\[\w*\])? ?(?:=|\{|$))", rf"\1{declared}", lines[first])
        if constant != lines[first] or constant.lstrip().startswith(declared):
            lines[first] = constant
            lines[number] = lines[number].replace("voxtone::mutant(", "voxtone::mutant_at_run_time(")
    return "\n".join(lines)


def mutated(text, mutants):
    """The source with its mutants; its lines stay where they are."""
    placed = [(*mutant.place(text), mutant) for mutant in mutants]
    numbers = [text[:begin].count("\n") for begin, _, _ in placed]
    is_header = bool(mutants) and mutants[0].file.endswith(".h")
    return f'#include "{HEADER}"\n#line 1\n' + at_run_time(weave(text, placed), numbers, is_header)
