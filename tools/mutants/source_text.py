# SPDX-License-Identifier: GPL-3.0-or-later
"""A C++ source as tokens, brackets and statements: as much of the language as mutants need, and no more.

It leans on .clang-format: a binary operator stands between blanks, `<` of a template and `*` of a pointer do not.
"""
import bisect
import re

TOKEN = re.compile(r"""
    (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<directive>^[ \t]*\#(?:\\\n|[^\n])*)
  | (?P<string>(?:u8|[uUL])?R"(?P<mark>[^()\\\s]*)\(.*?\)(?P=mark)"|(?:u8|[uUL])?"(?:[^"\\\n]|\\.)*"|(?:u8|[uUL])?'(?:[^'\\\n]|\\.)+')
  | (?P<number>\.?\d(?:[eEpP][+-]|'?[\w.])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<sign><=>|<<=|>>=|\.\.\.|::|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[-+*/%&|^~!<>=?:;,.(){}\[\]\#@\\])
""", re.X | re.S | re.M)

BINDING = {"*": 10, "/": 10, "%": 10, "+": 9, "-": 9, "<<": 8, ">>": 8, "<=>": 7, "<": 6, "<=": 6, ">": 6, ">=": 6,
           "==": 5, "!=": 5, "&": 4, "^": 3, "|": 2, "&&": 1, "||": 0}
ENDS = {";", ",", "?", ":", "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=", "(", "[", "{"}
WORD_ENDS = {"return", "throw", "case", "else", "do", "co_return", "co_yield", "goto", "new", "delete", "typename"}
CONTROL = {"if", "for", "while", "switch", "catch"}
DECLARES = {"const", "auto", "static", "constexpr", "using", "struct", "class", "enum", "union", "typedef", "template",
            "static_assert", "thread_local", "volatile", "int", "double", "float", "bool", "char", "unsigned", "long",
            "short", "signed", "void", "namespace", "extern", "inline", "alignas", "friend", "typename"}
CLOSING = {"(": ")", "[": "]", "{": "}"}


class Token:
    __slots__ = ("kind", "text", "begin", "end", "partner", "angled", "code")

    def __init__(self, kind, text, begin, end):
        self.kind, self.text, self.begin, self.end = kind, text, begin, end
        self.partner = None   # index of the bracket that belongs to it
        self.angled = False   # within the angle brackets of a template
        self.code = False     # within the body of a function


class Statement:
    """Tokens [first, last], of which the last is its `;`."""

    def __init__(self, first, last, kind, plain):
        self.first, self.last = first, last
        self.kind = kind      # expression, return, jump, throw, declaration
        self.plain = plain    # holds no block: no body of a lambda


def follow(directive, branches):
    """Keeps which branches are compiled, as far as that can be told: those for sanitizers and of `#if 0` are not."""
    word, _, rest = directive.partition(" ")
    if word in ("if", "ifdef"):
        branches.append(not (rest.strip() == "0" or rest.startswith("__SANITIZE_")))
    elif word == "ifndef":
        branches.append(True)
    elif word in ("else", "elif") and branches:
        branches[-1] = True  # of two that cannot be told apart both count
    elif word == "endif" and branches:
        branches.pop()


class Source:
    def __init__(self, text):
        self.text, self.tokens, self.comments = text, [], []
        branches = []  # of #if: whether what follows is compiled
        for found in TOKEN.finditer(text):
            if found.lastgroup in ("comment", "directive"):
                self.comments.append(found.span())
                if found.lastgroup == "directive":
                    follow(found[0].lstrip(" \t#"), branches)
            elif all(branches):
                kind = "string" if found.lastgroup == "mark" else found.lastgroup
                self.tokens.append(Token(kind, found[0], *found.span()))
        self.line_begins = [0] + [found.end() for found in re.finditer("\n", text)]
        self._pair_brackets()
        self._find_templates()
        self.statements, self.conditions = [], []
        self._read()

    # Where things are

    def line(self, offset):
        return bisect.bisect_right(self.line_begins, offset)

    def lines_at(self, begin, end):
        """The whole lines that hold [begin, end): their begin and end."""
        to = self.text.find("\n", end)
        return self.line_begins[self.line(begin) - 1], len(self.text) if to < 0 else to

    def raw(self, begin, end):
        """Text without comments."""
        pieces, at = [], begin
        for first, last in self.comments:
            if last > begin and first < end:
                pieces.append(self.text[at:max(first, at)])
                at = min(last, end)
        return "".join([*pieces, self.text[at:end]])

    def slice(self, begin, end):
        """Text without comments, in one line."""
        return " ".join(self.raw(begin, end).split())

    def has_directive(self, begin, end):
        return any(begin <= first < end and not self.text.startswith("/", first) for first, _ in self.comments)

    def is_spaced(self, i):
        """Has the token blanks on both sides?"""
        token = self.tokens[i]
        return self.text[token.begin - 1].isspace() and self.text[token.end].isspace()

    # Brackets

    def _pair_brackets(self):
        open_ones = []
        for i, token in enumerate(self.tokens):
            if token.kind != "sign":
                continue
            if token.text in CLOSING:
                open_ones.append(i)
            elif token.text in CLOSING.values() and open_ones:
                token.partner = open_ones.pop()
                self.tokens[token.partner].partner = i

    def _find_templates(self):
        for i, token in enumerate(self.tokens):
            if token.text != "<" or token.angled or i == 0 or self.text[token.begin - 1].isspace() and self.tokens[i - 1].text != "template":
                continue
            depth, end = 0, None
            for j in range(i, min(i + 200, len(self.tokens))):
                depth += {"<": 1, ">": -1, ">>": -2}.get(self.tokens[j].text, 0) if self.tokens[j].kind == "sign" else 0
                if depth <= 0:
                    end = j
                    break
                if self.tokens[j].text in (";", "{", "}"):
                    break
            if end is not None:
                for j in range(i, end + 1):
                    self.tokens[j].angled = True

    # Blocks and statements

    def _opens(self, i, around):
        """What the `{` at i opens: namespace, type, function, block (of a control statement), lambda or values."""
        t = self.tokens
        before = t[i - 1].text if i else ";"
        if around in ("(", "[", "values"):
            return "lambda" if self._is_lambda(i) else "values"
        if around in ("namespace", "type"):
            first = i
            while first > 0 and (t[first - 1].text not in (";", "{", "}") or t[first - 1].text == "}" and t[first].text in (",", "{")):
                first = t[first - 1].partner if t[first - 1].text in (")", "]", "}") and t[first - 1].partner is not None else first - 1
            head = [token.text for token in t[first:i] if not token.angled]
            if "namespace" in head or "extern" in head and t[i - 1].kind == "string":
                return "namespace"
            calls = "(" in head
            if not calls and any(word in head for word in ("struct", "class", "union", "enum")):
                return "type"
            if before in (")", "const", "noexcept", "override", "final", "try") or before == "}" and calls:
                return "lambda" if self._is_lambda(i) else "function"
            if calls and "->" in head[head.index("("):] and t[i - 1].kind in ("name", "sign") and ":" not in head:
                return "function"
            return "lambda" if self._is_lambda(i) else "values"
        if before in (";", "{", "}", "else", "do", "try", ":"):
            return "block"
        if before == ")" and t[t[i - 1].partner - 1].text in (*CONTROL, "constexpr"):
            return "block"
        if self._is_lambda(i):
            return "lambda"
        first = i
        while first > 0 and (t[first - 1].kind == "name" or t[first - 1].angled or t[first - 1].text in ("::", ":", ",")):
            first -= 1
        return "type" if t[first].text in ("struct", "class", "enum", "union") else "values"

    def _is_lambda(self, i):
        t, j = self.tokens, i - 1
        if t[j].text not in (")", "]", "mutable", "noexcept"):
            k = j
            while k > 0 and (t[k].kind == "name" or t[k].angled or t[k].text in ("::", "&", "*")):
                k -= 1
            if t[k].text != "->":
                return False
            j = k - 1
        while t[j].text in ("mutable", "noexcept"):
            j -= 1
        if t[j].text == ")" and t[j].partner is not None:
            j = t[j].partner - 1
        if t[j].angled:
            while j > 0 and t[j].angled:
                j -= 1
        return t[j].text == "]" and t[j].partner is not None and not (
            t[t[j].partner - 1].kind == "name" and t[t[j].partner - 1].text != "return" or t[t[j].partner - 1].text in (")", "]"))

    def _read(self):
        t, around, begins = self.tokens, ["namespace"], [0]
        for i, token in enumerate(t):
            inside = [kind for kind in around if kind not in ("(", "[")]
            kind_here = next((k for k in reversed(inside) if k != "values"), "namespace")
            token.code = kind_here in ("function", "block", "lambda")
            at_block = around[-1] in ("function", "block", "lambda")
            if token.kind == "name":
                if at_block and token.text in ("else", "do"):
                    begins[-1] = i + 1
                continue
            if token.kind != "sign":
                continue
            if token.text in ("(", "["):
                around.append(token.text)
            elif token.text in (")", "]"):
                if around[-1] in ("(", "["):
                    around.pop()
                opener = token.partner
                if token.text == ")" and opener and around[-1] in ("function", "block", "lambda") and self._is_control(opener):
                    begins[-1] = i + 1
                    self._condition(opener, i)
            elif token.text == "{":
                opened = self._opens(i, around[-1])
                around.append(opened)
                begins.append(i + 1)
                token.code = token.code or opened in ("function", "lambda")
            elif token.text == "}":
                if len(around) > 1 and around[-1] not in ("(", "["):
                    closed = around.pop()
                    begins.pop()
                    if closed in ("block", "type", "function", "namespace") and around[-1] not in ("(", "["):
                        begins[-1] = i + 1
            elif token.text == ";" and around[-1] not in ("(", "["):
                if at_block:
                    self._statement(begins[-1], i)
                begins[-1] = i + 1
            elif token.text == ":" and at_block and t[begins[-1]].text in ("case", "default"):
                begins[-1] = i + 1

    def _is_control(self, opener):
        word = self.tokens[opener - 1].text
        return word in CONTROL or word == "constexpr" and self.tokens[opener - 2].text == "if"

    def _condition(self, opener, closer):
        if self.tokens[opener - 1].text != "if" or closer - opener < 2:
            return
        inside = self.tokens[opener + 1:closer]
        if any(token.text == ";" for token in inside) or self._declares(opener + 1, closer):
            return
        self.conditions.append((opener + 1, closer - 1))

    def _declares(self, first, last):
        """Does what begins here declare something? `Type name`, `ns::Type<int>& name`, `auto x`."""
        t = self.tokens
        if t[first].text in DECLARES or t[first].text == "[" and t[first + 1].text == "[":
            return True
        if t[first].kind != "name" and t[first].text != "::" or t[first].text in WORD_ENDS:
            return False
        i = first
        while i < last and (t[i].text == "::" or t[i].angled or t[i].kind == "name" and (i == first or t[i - 1].text == "::")):
            i += 1
        while i < last and t[i].text in ("&", "*", "&&", "const"):
            if self.is_spaced(i) and t[i].text != "const":
                return False
            i += 1
        return i > first and i < last + 1 and t[i].kind == "name" and not t[i].angled

    def _statement(self, first, last):
        t = self.tokens
        if first >= last:
            return
        word = t[first].text
        if word in ("break", "continue") or word == "return" and last == first + 1:
            kind = "jump"
        elif word in ("return", "throw"):
            kind = word
        elif word in ("case", "default", "goto") or self._declares(first, last):
            kind = "declaration"
        else:
            kind = "expression"
        plain = not any(token.text == "{" and self._opens_code(i) for i, token in enumerate(t[first:last], first))
        self.statements.append(Statement(first, last, kind, plain))

    def _opens_code(self, i):
        return i + 1 < len(self.tokens) and self._is_lambda(i)

    # Operands

    def left_operand(self, i, binding):
        """First token of what stands left of the operator at i."""
        t, j = self.tokens, i
        while j > 0:
            before = t[j - 1]
            if before.text in (")", "]", "}") and before.partner is not None:
                word = t[before.partner - 1]
                if before.text == "}" and self._opens_block(before.partner) or before.text == ")" and self._is_control(before.partner):
                    break
                j = before.partner
                continue
            if before.kind == "sign" and not before.angled:
                if before.text in ENDS:
                    break
                if before.text in BINDING and self.is_spaced(j - 1) and BINDING[before.text] < binding:
                    break
            if before.kind == "name" and before.text in WORD_ENDS:
                break
            j -= 1
        return j

    def _opens_block(self, i):
        return self.tokens[i - 1].text in (";", "{", "}", "else", "do", "try") or (
            self.tokens[i - 1].text == ")" and not self._is_lambda(i))

    def right_operand(self, i, binding):
        """Last token of what stands right of the operator at i."""
        t, j = self.tokens, i + 1
        while j < len(t):
            token = t[j]
            if token.text in CLOSING and token.partner is not None and token.kind == "sign":
                j = token.partner + 1
                continue
            if token.kind == "sign" and not token.angled:
                if token.text in ENDS or token.text in CLOSING.values():
                    break
                if token.text in BINDING and self.is_spaced(j) and BINDING[token.text] <= binding:
                    break
            j += 1
        return j - 1
