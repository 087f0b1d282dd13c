# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws faults of the places of a room: where a slip of the pen would leave a program that compiles.

Not touched: comments, texts and what is formatted into them, contracts, types and template arguments, array sizes and
labels of cases, declarations that nothing computes, what only reserves memory or reports progress.
"""
import itertools
import json
import random
import re
from dataclasses import dataclass

from source_text import BINDING, WORD_ENDS, Source

ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
RELATIONAL = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
LOGICAL = {"&&": "||", "||": "&&"}
SYMMETRIC = {"max", "min", "swap", "hypot", "abs", "gcd", "lcm", "if", "for", "while", "switch", "catch", "sizeof", "decltype"}
UNSEEN = {"format", "format_to", "print", "named_warning", "VOXTONE_EXPECT", "VOXTONE_ENSURE", "VOXTONE_DEBUG_EXPECT",
          "contract_violated", "static_assert", "reserve", "begin_stage", "advance"}
IDLE = re.compile(r"(?:[\w.\[\]*]|->|::)*\b(?:reserve|shrink_to_fit|begin_stage|end_stage|advance|check_cancelled|named_warning|VOXTONE_\w+)\("
                  r"|static_cast<void>")
CONSTANT = re.compile(r"^\s*(?:static |inline )*constexpr (?:double|float|int|std::size_t) \w+ ?(?:=|\{)[^;]*;")


@dataclass(frozen=True)
class Slip:
    """`text` stands for [at, to); `begin`, `end` are what is chosen between as a whole."""
    file: str
    kind: str
    at: int
    to: int
    text: str
    begin: int
    end: int
    is_condition: bool = False


class Candidates:
    """All slips of a source."""

    def __init__(self, file, text):
        self.file, self.source, self.slips = file, Source(text), []
        self.t = self.source.tokens
        self.hidden = self._hidden()
        self.starts = {}  # statement of a token, the innermost last
        for statement in self.source.statements:
            for i in range(statement.first, statement.last + 1):
                known = self.starts.get(i)
                if known is None or statement.last - statement.first < known.last - known.first:
                    self.starts[i] = statement
        for i, token in enumerate(self.t):
            if token.code and not token.angled and not self.hidden[i]:
                self._operators(i, token)
                self._literal(i, token)
                self._call(i, token)
        self._constants()
        self._conditions()
        self._dropped()
        unique = {(slip.at, slip.to, slip.text): slip for slip in self.slips}
        self.slips = [slip for slip in unique.values() if not self.source.has_directive(slip.begin, slip.end)]

    def _hidden(self):
        """What is spoken, promised, or computed by the compiler."""
        hidden = [False] * len(self.t)
        for i, token in enumerate(self.t):
            following = self.t[i + 1] if i + 1 < len(self.t) else token
            end = None
            if token.kind == "name" and token.text in UNSEEN and following.text == "(":
                end = following.partner
            elif token.text == "throw":
                end = next((j for j in range(i, len(self.t)) if self.t[j].text == ";"), None)
            elif token.text == "case":
                end = next((j for j in range(i, len(self.t)) if self.t[j].text == ":"), None)
            elif token.text == "constexpr" and self.t[i - 1].text != "if":
                end = next((j for j in range(i, len(self.t)) if self.t[j].text in (";", "{")), None)
            elif token.text == "constexpr":
                end = following.partner
            for j in range(i, (end or i - 1) + 1):
                hidden[j] = True
        return hidden

    def _add(self, kind, at, to, text, first, last, choose_statement=False, is_condition=False):
        """A slip in the expression of tokens [first, last]; of the whole statement, where types may differ."""
        statement = self.starts.get(first)
        begin, end = self.t[first].begin, self.t[last].end
        if choose_statement and statement and statement.plain and statement.kind in ("expression", "return"):
            begin, end = self.t[statement.first].begin, self.t[statement.last].end
        self.slips.append(Slip(self.file, kind, at, to, text, begin, end, is_condition))

    def _operators(self, i, token):
        if token.kind != "sign" or token.text in "(){}[];,":
            return
        text, before, after = token.text, self.t[i - 1], self.t[i + 1]
        if before.kind == "string" or after.kind == "string" or before.text == "operator":
            return
        if text in ("+=", "-=", "*=", "/="):
            statement = self.starts.get(i)
            if statement and statement.plain and statement.kind == "expression":
                self._add("operator", token.begin, token.end, ARITHMETIC[text], i, i, choose_statement=True)
            return
        unary = text == "-" and (before.kind == "sign" and before.text not in (")", "]", "}") or before.text in WORD_ENDS)
        if unary:
            self._add("sign", token.begin, token.end, "+", i, self._end_of_operand(i), choose_statement=True)
            return
        if text not in BINDING or not self.source.is_spaced(i):
            return
        first, last = self.source.left_operand(i, BINDING[text]), self.source.right_operand(i, BINDING[text])
        if first >= i or last <= i or any(self.t[j].kind == "string" for j in range(first, last + 1)):
            return
        if text in ARITHMETIC:
            self._add("operator", token.begin, token.end, ARITHMETIC[text], first, last, choose_statement=True)
        for other in RELATIONAL.get(text, ()):
            self._add("border" if other[0] == text[0] and text not in ("==", "!=") else "relation", token.begin, token.end, other, first, last)
        if text in LOGICAL:
            self._add("logic", token.begin, token.end, LOGICAL[text], first, last)

    def _end_of_operand(self, i):
        j = i + 1
        while j + 1 < len(self.t):
            if self.t[j].text in ("(", "[", "{") and self.t[j].partner is not None:
                j = self.t[j].partner
            following = self.t[j + 1]
            if following.text in ("(", "[", ".", "->", "::") or following.angled or self.t[j].text in (".", "->", "::", "-", "*", "!") or (
                    following.text == "{" and self.t[j].kind == "name"):
                j += 1
                continue
            return j
        return j

    def _literal(self, i, token):
        if token.kind != "number":
            return
        before = self.t[i - 1].text
        statement = self.starts.get(i)
        if before == "[" and statement and statement.kind == "declaration" and self.t[i - 2].kind == "name" and self.t[i + 1].text == "]" and (
                self.t[i + 2].text in (";", "=", "{", ",")) and not any(t.text == "=" for t in self.t[statement.first:i]):
            return
        for text in other_numbers(token.text):
            self._add("constant", token.begin, token.end, text, i, i)

    def _call(self, i, token):
        if token.text != "(" or self.t[i - 1].kind != "name" or self.t[i - 1].text in SYMMETRIC | UNSEEN or token.partner is None:
            return
        statement = self.starts.get(i)
        if self.source.text[token.begin - 1].isspace() or i >= 2 and (self.t[i - 2].kind == "name" and self.t[i - 2].text not in WORD_ENDS or
                                                                      self.t[i - 2].angled):
            return  # a keyword's, or a declaration's
        if i >= 2 and self.t[i - 2].text in ("&", "*") and not self.source.is_spaced(i - 2) and statement and statement.kind == "declaration":
            return
        arguments = self._arguments(i)
        first = i - 1
        while first > 0 and (self.t[first - 1].text in ("::", ".", "->") or self.t[first].text in ("::", ".", "->") and (
                self.t[first - 1].kind == "name" or self.t[first - 1].text in (")", "]"))):
            first = self.t[first - 1].partner if self.t[first - 1].text in (")", "]") else first - 1
            if self.t[first].text in ("(", "[") and self.t[first - 1].kind == "name" and self.t[first - 1].text not in WORD_ENDS | {"if", "while"}:
                first -= 1
        if self.hidden[first] or self.t[first].text in ("(", "["):
            return
        for (a, b), (c, d) in zip(arguments, arguments[1:]):
            left, right = (self.source.slice(self.t[x].begin, self.t[y].end) for x, y in ((a, b), (c, d)))
            tokens = self.t[a:d + 1]
            if left == right or any(one.kind == "string" or one.text in ("{", "=") for one in tokens):
                continue
            self._add("arguments", self.t[a].begin, self.t[d].end, f"{right}, {left}", first, token.partner, choose_statement=True)

    def _arguments(self, i):
        found, first, j = [], i + 1, i + 1
        while j <= self.t[i].partner:
            token = self.t[j]
            if token.kind == "sign" and token.text in ("(", "[", "{") and token.partner is not None:
                j = token.partner
            elif not token.angled and (token.text == "," or j == self.t[i].partner):
                if j > first:
                    found.append((first, j - 1))
                first = j + 1
            j += 1
        return found

    def _constants(self):
        """Named constants of one line, whose value at_run_time lets be chosen."""
        for i, token in enumerate(self.t):
            if token.kind == "number" and not token.angled:
                begin, end = self.source.lines_at(token.begin, token.end)
                if CONSTANT.match(self.source.text[begin:end]):
                    for text in other_numbers(token.text):
                        self.slips.append(Slip(self.file, "constant", token.begin, token.end, text, token.begin, token.end))

    def _conditions(self):
        for first, last in self.source.conditions:
            if any(self.hidden[i] for i in range(first, last + 1)):
                continue
            begin, end = self.t[first].begin, self.t[last].end
            self.slips.append(Slip(self.file, "condition", begin, end, f"!({self.source.slice(begin, end)})", begin, end, is_condition=True))

    def _dropped(self):
        for statement in self.source.statements:
            if statement.kind not in ("expression", "jump", "throw"):
                continue
            begin, end = self.t[statement.first].begin, self.t[statement.last].end
            if not IDLE.match(self.source.slice(begin, end)):
                self.slips.append(Slip(self.file, "dropped", begin, end, "", begin, end))

    # What is shown, and chosen between

    def _with(self, begin, end, slip):
        raw = self.source.raw
        return " ".join((raw(begin, slip.at) + slip.text + raw(slip.to, end)).split())

    def shown(self, slip):
        """The lines as they are and as the slip makes them."""
        begin, end = self.source.lines_at(slip.at, slip.to)
        return self.source.slice(begin, end), self._with(begin, end, slip)

    def chosen(self, slip):
        """What is compiled beside [begin, end)."""
        return "" if slip.kind == "dropped" else self._with(slip.begin, slip.end, slip)


def other_numbers(text):
    plain = text.replace("'", "").lower()
    is_hex = plain.startswith("0x")
    is_float = not is_hex and any(sign in plain for sign in ".e")
    try:
        value = float(plain.rstrip("f")) if is_float else int(re.sub(r"[uzl]+$", "", plain), 0 if not plain.startswith("0") or is_hex else 8)
    except ValueError:
        return []
    suffix = ("f" if plain.endswith("f") else "") if is_float else re.search(r"[uzl]*$", plain)[0]
    zero, one = ("0.0" + suffix, "1.0" + suffix) if is_float else ("0" + suffix, "1" + suffix)
    if value == 0:
        return [one]
    if is_float:
        return [f"({text} * 2)", zero]
    return [f"({text} + 1)", zero]


def room_sources(listed, room):
    """Sources of a room, of those listed: `.cpp` alone, since a header's fault would rebuild all that include it."""
    return [name for name in sorted(listed) if name.endswith(".cpp") and name.rsplit("/", 1)[0] == room]


def equivalents(file):
    """(file, line, line with the slip) of those that were looked at, and change nothing that can be seen."""
    return {(line["file"], line["find"], line["replace"]) for line in json.loads(file.read_text())} if file.is_file() else set()


def draw(root, files, count, seed, known):
    """Up to `count` slips at different places of `files`, each place as likely as any other: (candidates, slip)."""
    places = []
    for name in files:
        candidates, of_place = Candidates(name, (root / name).read_text()), {}
        for slip in candidates.slips:
            of_place.setdefault((slip.at, slip.to), []).append((candidates, slip))
        places += of_place.values()
    chance = random.Random(seed)
    chance.shuffle(places)
    drawn = (chance.choice(slips) for slips in places)
    fresh = ((candidates, slip) for candidates, slip in drawn if (slip.file, *candidates.shown(slip)) not in known)
    return list(itertools.islice(fresh, count))
