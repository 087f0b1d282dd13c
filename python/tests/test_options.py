# SPDX-License-Identifier: GPL-3.0-or-later
import ast
import inspect

import pytest

import voxtone
from voxtone.options import all_commands, option_table
from voxtone.stubs import stub


def test_every_verb_of_the_program_is_a_function():
    hidden = {"task", "serve"}  # what a cluster's scripts call, and what lasts
    for name in option_table():
        assert name in hidden or repr(getattr(voxtone, name)) == f"<voxtone {name}>"


def test_keywords_are_the_options_of_the_table():
    for command in all_commands():
        names = [option.keyword for option in command.options]
        assert len(names) == len(set(names))
        for name in names:
            assert name.isidentifier()
            assert command.option(name).keyword == name
        command.signature()
    assert "size" in inspect.signature(voxtone.slice).parameters
    assert "LENGTH" in voxtone.slice.__doc__
    assert repr(voxtone.calibrate.edge.fit) == "<voxtone calibrate edge fit>"


def words(*arguments, **options):
    return option_table()["slice"].words(arguments, options)


def test_values_become_words():
    assert words("a.glb", size="60mm") == ["slice", "--size=60mm", "--", "a.glb"]
    assert words("a.glb", "b.glb") == ["slice", "--", "a.glb", "b.glb"]
    assert words(report=False, keep_thin=True, seed=None) == ["slice", "--no-report", "--keep-thin"]
    assert words(scale=0.5, threads=2) == ["slice", "--scale=0.5", "--threads=2"]
    assert words(load=["C", "M", "W"]) == ["slice", "--load=C,M,W"]
    assert words(label=["one, two", "three"]) == ["slice", "--label=one, two", "--label=three"]
    assert option_table()["proof"].words((), {"overwrite": False}) == ["proof"]


def test_mistakes_are_python_errors():
    with pytest.raises(TypeError, match="did you mean size"):
        voxtone.slice("a.glb", sise="60mm")
    with pytest.raises(TypeError, match="True or False"):
        voxtone.slice("a.glb", report="no")
    with pytest.raises(TypeError, match="no value"):
        voxtone.slice("a.glb", size=True)
    with pytest.raises(TypeError, match="decided by this package"):
        voxtone.slice("a.glb", json=True)
    with pytest.raises(TypeError, match="wants a step: chart"):
        voxtone.calibrate("x")
    with pytest.raises(AttributeError, match="there are chart"):
        voxtone.calibrate.nonsense
    with pytest.raises(TypeError, match="1 arguments besides"):
        voxtone.verify("a", "b")


def test_types_for_editors_are_python():
    tree = ast.parse(stub())
    names = {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
    assert names == set(option_table()) - {"serve"}  # a service, whose name a module has


def test_printers_and_resin_sets():
    assert "stratasys-j750-hm" in [printer["id"] for printer in voxtone.printers()]
    assert "vero-opaque" in [resins["name"] for resins in voxtone.resin_sets()]
