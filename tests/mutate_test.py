#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every mutant of the list has its place (tools/mutate --check), and faults are put into a text as tools/mutate says."""
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


def mutant(number, find, replace, file="a/b.cpp", **more):
    line = {"id": f"m{number}", "file": file, "find": find, "replace": replace, "what": "", "tests": ["t"], **more}
    return mutate.Mutant(line, "here", number)


def woven(text, *mutants):
    return mutate.weave(text, [(*m.place(text), m) for m in mutants])


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
        one = [mutant(1, "3", "4")]
        self.assertEqual(mutate.at_run_time("    constexpr int n = 3;", one), "    static const int n = 3;")
        self.assertEqual(mutate.at_run_time("constexpr std::array<double, 2> n{3, 1};", one), "static const std::array<double, 2> n{3, 1};")
        member = [mutant(1, "3", "4", file="a/b.h")]
        self.assertEqual(mutate.at_run_time("    static constexpr int n = 3;", member), "    static inline const int n = 3;")


class TheList(unittest.TestCase):
    def test_every_mutant_has_its_place(self):
        mutate.check(mutate.read_mutants())


if __name__ == "__main__":
    unittest.main()
