#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every mutant of the list has its place (tools/mutate --check), faults are put into a text as tools/mutate says, and what
is drawn is a slip in what is computed."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
TOOL = str(pathlib.Path(__file__).resolve().parent.parent / "tools/mutate")
loader = importlib.machinery.SourceFileLoader("mutate", TOOL)
mutate = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutate", loader))
loader.exec_module(mutate)
import draw  # noqa: E402, of tools/mutants
import weave  # noqa: E402


def mutant(number, find, replace, file="a/b.cpp", **more):
    line = {"id": f"m{number}", "file": file, "find": find, "replace": replace, "what": "", "tests": ["t"], **more}
    return mutate.Mutant(line, "here", number)


def woven(text, *mutants):
    return weave.weave(text, [(*m.place(text), m) for m in mutants])


class Weaving(unittest.TestCase):
    def test_an_expression_is_chosen_where_it_stands(self):
        self.assertEqual(woven("x = a + b;", mutant(1, "a + b", "a - b")), "x = (voxtone::mutant(1) ? (a - b) : (a + b));")

    def test_two_faults_of_one_expression(self):
        self.assertEqual(woven("a < b", mutant(1, "a < b", "a <= b"), mutant(2, "a < b", "true")),
                         "(voxtone::mutant(1) ? (a <= b) : voxtone::mutant(2) ? (true) : (a < b))")

    def test_a_fault_within_another(self):
        self.assertEqual(woven("f(a, b)", mutant(1, "f(a, b)", "0"), mutant(2, "b", "c")),
                         "(voxtone::mutant(1) ? (0) : (f(a, (voxtone::mutant(2) ? (c) : (b)))))")

    def test_a_statement(self):
        self.assertEqual(woven("{ ++n; }", mutant(1, "++n;", "")), "{ if (voxtone::mutant(1)) {  } else { ++n; } }")

    def test_within_says_which(self):
        self.assertEqual(woven("a b, a c", mutant(1, "a", "d", within="a c")), "a b, (voxtone::mutant(1) ? (d) : (a)) c")

    def test_what_is_not_there_once_is_refused(self):
        for text in ("", "ab ab"):
            with self.assertRaises(mutate.Fault):
                woven(text, mutant(1, "ab", "c"))

    def test_texts_that_cross_are_refused(self):
        with self.assertRaises(mutate.Fault):
            woven("a + b * c", mutant(1, "a + b", "0"), mutant(2, "b * c", "0"))

    def test_unknown_keys_are_refused(self):
        with self.assertRaises(mutate.Fault):
            mutant(1, "a", "b", test="t")

    def test_constants_become_variables(self):
        self.assertEqual(weave.at_run_time("    constexpr int n = 3;", [0]), "    static const int n = 3;")
        self.assertEqual(weave.at_run_time("constexpr std::array<double, 2> n{3, 1};", [0]), "static const std::array<double, 2> n{3, 1};")
        self.assertEqual(weave.at_run_time("    static constexpr int n = 3;", [0], is_header=True), "    static inline const int n = 3;")
        self.assertEqual(weave.at_run_time("f();\nconstexpr int n{\n    3};", [2]), "f();\nstatic const int n{\n    3};")
        self.assertEqual(weave.at_run_time("f();\nconstexpr std::array<int, 1> n\n    {{3}};", [2]), "f();\nstatic const std::array<int, 1> n\n    {{3}};")
        self.assertTrue(weave.mutated("\nconstexpr int n = 3;", [mutant(1, "3", "4")]).endswith("\nstatic const int n = (voxtone::mutant_at_run_time(1) ? (4) : (3));"))


def slips(body, head="void f() {"):
    """kind -> what stands for what, in the body of a function."""
    candidates = draw.Candidates("a/b.cpp", f"{head}\n{body}\n}}\n")
    found = {}
    for slip in candidates.slips:
        text = candidates.source.text
        found.setdefault(slip.kind, set()).add((text[slip.begin:slip.end], candidates.chosen(slip)))
    return found


class Drawing(unittest.TestCase):
    def test_an_operator_takes_what_binds_closer(self):
        self.assertEqual(slips("int x = a - b * c + d;")["operator"],
                         {("a - b * c", "a + b * c"), ("b * c", "b / c"), ("a - b * c + d", "a - b * c - d")})
        self.assertEqual(slips("bool x = a && b || c < d + 1;")["logic"],
                         {("a && b", "a || b"), ("a && b || c < d + 1", "a && b && c < d + 1")})

    def test_a_whole_statement_where_types_may_differ(self):
        self.assertEqual(slips("return a + b;")["operator"], {("return a + b;", "return a - b;")})
        self.assertEqual(slips("x += b;")["operator"], {("x += b;", "x -= b;")})
        self.assertEqual(slips("x = -b;")["sign"], {("x = -b;", "x = +b;")})

    def test_borders_and_relations(self):
        found = slips("for (int i = 0; i < n; ++i) g(i);")
        self.assertEqual(found["border"], {("i < n", "i <= n")})
        self.assertEqual(found["relation"], {("i < n", "i >= n")})
        self.assertEqual(found["constant"], {("0", "1")})
        self.assertEqual(found["dropped"], {("g(i);", "")})

    def test_constants(self):
        self.assertEqual(slips("double x = 0.5f + v[0] + 7u;")["constant"],
                         {("0.5f", "(0.5f * 2)"), ("0.5f", "0.0f"), ("0", "1"), ("7u", "(7u + 1)"), ("7u", "0u")})
        self.assertEqual(slips("", head="constexpr double least = 1e-3;\nvoid f() {")["constant"], {("1e-3", "(1e-3 * 2)"), ("1e-3", "0.0")})

    def test_arguments_are_exchanged(self):
        self.assertEqual(slips("const int x = a.g(b, c + 1);")["arguments"], {("a.g(b, c + 1)", "a.g(c + 1, b)")})
        self.assertNotIn("arguments", slips("x = std::max(a, b);"))  # nothing changes
        self.assertNotIn("arguments", slips("Outline outline(a, b);"))  # declares

    def test_conditions(self):
        self.assertEqual(slips("if (a) b();\nelse if (c > 1) d();")["condition"], {("a", "!(a)"), ("c > 1", "!(c > 1)")})
        self.assertNotIn("condition", slips("if (const auto x = f(); x) b();\nif constexpr (c) d();"))
        one = draw.Candidates("a/b.cpp", "void f() { if (a) b(); }")
        woven_ = weave.asleep([weave.DrawnMutant(one, slip, "a", 1) for slip in one.slips if slip.kind == "condition"], "a")
        self.assertEqual(woven_, "(voxtone::mutant(1) ? (!(a)) : (static_cast<bool>(a)))")

    def test_statements_are_dropped(self):
        self.assertEqual(slips("int n = 3;\nfor (;;) {\nif (a) continue;\nthrow E(b);\n}\nx = [&](int k) { g(k); return k; }(2);")["dropped"],
                         {("continue;", ""), ("throw E(b);", ""), ("g(k);", ""), ("x = [&](int k) { g(k); return k; }(2);", "")})

    def test_what_is_left_alone(self):
        for text in ("// a + b", "/* f(a, b) */", "#define X a + b", "const char* s = \"a + b\";", "std::vector<int, 3> x;",
                     "VOXTONE_EXPECT(a < 3);", "static_assert(a < 3);", "const Foo* a = nullptr, & b = c;", "list.reserve(3 * n);",
                     "constexpr auto x = f(3);", "enum { first = 3, second };",
                     "struct Piece {\n double own = 0;\n };", "switch (a) { case 3: ; }"):
            self.assertEqual({k: v for k, v in slips(text).items() if k != "dropped"}, {}, text)
        self.assertEqual(draw.Candidates("a/b.cpp", "namespace a {\nint f(int x = 3);\nstruct S { int n = 2; };\n}").slips, [])
        self.assertNotIn("constant", slips("throw InputError(fmt::format(\"{}\", a + 1));"))
        self.assertNotIn("dropped", slips("list.reserve(n);\nif (progress) progress->advance();"))

    def test_what_no_release_compiles_is_left_alone(self):
        self.assertEqual(slips("#ifdef __SANITIZE_THREAD__\na = b + 1;\n#else\n;\n#endif\n#if 0\nc = d + 1;\n#endif"), {})
        self.assertIn("operator", slips("#ifdef __SANITIZE_THREAD__\n;\n#else\na = b + c;\n#endif"))
        self.assertIn("operator", slips("#ifdef X\na = b + c;\n#endif"))

    def test_members_are_read(self):
        text = "struct S {\n    S(int a) : a_{a}, b_(a) { a_ = 1; }\n    int at(int i) const { return i + 1; }\n    int a_ = 5;\n};\n"
        kinds = sorted((slip.kind, slip.text) for slip in draw.Candidates("a/b.cpp", text).slips)
        self.assertEqual(kinds, [("constant", "(1 + 1)"), ("constant", "(1 + 1)"), ("constant", "0"), ("constant", "0"), ("dropped", ""), ("operator", "-")])

    def test_all_that_is_drawn_of_the_tree_can_be_woven(self):
        listed = mutate.files_of_tree()
        for room in ("io/layers", "halftone/loop", "base"):
            drawn = mutate.draw_mutants([room], 100, 5)
            self.assertGreater(len(drawn), 150)
            self.assertEqual([(m.id, m.after) for m in drawn], [(m.id, m.after) for m in mutate.draw_mutants([room], 100, 5)])
            self.assertNotEqual([m.id for m in drawn], [m.id for m in mutate.draw_mutants([room], 100, 6)])
            for file, of_file in mutate.by_file(drawn).items():
                text = (mutate.ROOT / file).read_text()
                self.assertEqual(mutate.with_faults(file, of_file).count("\n"), text.count("\n") + 2, file)
            self.assertTrue({m.file for m in drawn} <= set(draw.room_sources(listed, room)))

    def test_what_is_known_as_equivalent_is_not_drawn(self):
        one = mutate.draw_mutants(["base"], 1, 3)[0]
        known = {(one.file, one.before, one.after)}
        files = draw.room_sources(mutate.files_of_tree(), "base")
        shown = [(slip.file, *candidates.shown(slip)) for candidates, slip in draw.draw(mutate.ROOT, files, 2, 3, known)]
        self.assertEqual(len(shown), 2)
        self.assertNotIn((one.file, one.before, one.after), shown)


class TheList(unittest.TestCase):
    def test_every_mutant_has_its_place(self):
        mutate.check(mutate.read_mutants())

    def test_every_equivalent_has_its_reason(self):
        for line in mutate.json.loads(mutate.EQUIVALENT.read_text()):
            self.assertEqual(sorted(line), ["file", "find", "replace", "why"], line)
            self.assertGreater(len(line["why"]), 20, line)


if __name__ == "__main__":
    unittest.main()
