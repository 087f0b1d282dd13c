# SPDX-License-Identifier: GPL-3.0-or-later
"""The program's own table of options, as `voxtone --help-json` prints it: there is no second list here."""
from __future__ import annotations

import difflib
import functools
import inspect
import json
import keyword
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

from .program import output_of, program


@dataclass(frozen=True)
class Option:
    name: str  #: without dashes
    positional: bool
    required: bool
    flag: bool
    can_be_turned_off: bool
    many: bool
    separator: str
    value: str
    default: str
    choices: Tuple[str, ...]
    group: str
    rare: bool
    help: str
    leaves: str = ""  #: of a finished job, where it has another value: "stack", "loop", "settled-loop", "nothing"

    @property
    def keyword(self) -> str:
        """The name where it is one of Python's; `8-bits` is _8_bits, a reserved word has _ behind it."""
        name = self.name.replace("-", "_")
        return "_" + name if name[0].isdigit() else name + "_" if keyword.iskeyword(name) else name

    def words(self, value: Any) -> List[str]:
        """`--name=value`; of a list one for each, or one with separators where the option has them."""
        if self.flag:
            if not isinstance(value, bool):
                raise TypeError(f"{self.keyword} is on or off; got {value!r}, give True or False")
            if value:
                return ["--" + self.name]
            return ["--no-" + self.name] if self.can_be_turned_off else []
        if isinstance(value, (list, tuple)):
            if not self.many or self.separator:
                return [f"--{self.name}={(self.separator or ',').join(map(text_of, value))}"]
            return [f"--{self.name}={text_of(v)}" for v in value]
        return [f"--{self.name}={text_of(value)}"]


def text_of(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        raise TypeError(f"{value!r} is no value of an option that takes one")
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return str(value)


@dataclass(frozen=True)
class Command:
    """A verb, or a step of a family of verbs."""
    path: Tuple[str, ...]
    help: str
    example: str
    options: Tuple[Option, ...]
    steps: Tuple["Command", ...]

    def step(self, name: str) -> Optional["Command"]:
        return next((step for step in self.steps if step.path[-1].replace("-", "_") == name), None)

    def option(self, name: str) -> Option:
        wanted = name.strip("_").replace("_", "-")
        for option in self.options:
            if option.name == wanted:
                return option
        near = difflib.get_close_matches(wanted, [o.name for o in self.options], 1)
        advice = f"did you mean {near[0].replace('-', '_')}?" if near else f"help(voxtone.{'.'.join(self.path)})"
        raise TypeError(f"voxtone {' '.join(self.path)} has no option {name!r}; {advice}")

    def words(self, arguments: Sequence[Any], keywords: Dict[str, Any]) -> List[str]:
        """The command line. Raises TypeError where Python would for a function of these arguments."""
        words, operands = list(self.path), []
        places = [option for option in self.options if option.positional]
        for place in places:
            if place.keyword in keywords and arguments:
                raise TypeError(f"{place.keyword} is given by its place and by its name")
        if len(arguments) > len(places) and not (places and places[-1].many):
            raise TypeError(f"voxtone {' '.join(self.path)} takes {len(places)} arguments besides its options, "
                            f"and {len(arguments)} were given")
        for value in arguments:
            operands += [text_of(v) for v in value] if isinstance(value, (list, tuple)) else [text_of(value)]
        for name, value in keywords.items():
            if value is None:
                continue
            option = self.option(name)
            if option.positional:
                operands += [text_of(v) for v in value] if isinstance(value, (list, tuple)) else [text_of(value)]
            else:
                words += option.words(value)
        return words + (["--", *operands] if operands else [])

    def signature(self) -> inspect.Signature:
        parameters = [inspect.Parameter(o.keyword, inspect.Parameter.VAR_POSITIONAL if o.many else
                                        inspect.Parameter.POSITIONAL_OR_KEYWORD) for o in self.options if o.positional]
        parameters = parameters[:1] if parameters and parameters[0].kind == parameters[0].VAR_POSITIONAL else parameters
        parameters += [inspect.Parameter(o.keyword, inspect.Parameter.KEYWORD_ONLY, default=None)
                       for o in self.options if not o.positional and o.name not in run_by_package]
        parameters.append(inspect.Parameter("progress", inspect.Parameter.KEYWORD_ONLY, default=None))
        return inspect.Signature(parameters)

    def documentation(self) -> str:
        lines = [self.help, ""]
        for option in self.options:
            if option.name not in run_by_package:
                lines.append(f"{option.keyword} {option.value}".rstrip() + f": {option.help}")
        return "\n".join(lines + ["", "On the command line: " + self.example])


#: How the program talks, which this package decides.
run_by_package = ("json", "progress", "quiet")


def _command(path: Tuple[str, ...], told: Dict[str, Any]) -> Command:
    path = path + (told["name"],)
    entries: List[Dict[str, Any]] = [{**option, "choices": tuple(option["choices"])} for option in told["options"]]
    options = tuple(Option(**entry) for entry in entries)
    return Command(path, told["help"], told["example"], options, tuple(_command(path, s) for s in told["steps"]))


@functools.lru_cache(maxsize=4)
def _table_of(file: str, changed: float) -> Dict[str, Command]:
    del file, changed  # the key of the cache
    told = json.loads(output_of(["--help-json"]))
    return {verb["name"]: _command((), verb) for verb in told["verbs"]}


def option_table() -> Dict[str, Command]:
    """Verb -> its command. Asked of the program once, and again when its file changes."""
    file = program()
    return _table_of(file, Path(file).stat().st_mtime)


def all_commands() -> Iterator[Command]:
    """Everything that can be run."""
    def below(command: Command) -> Iterator[Command]:
        if not command.steps:
            yield command
        for step in command.steps:
            yield from below(step)
    for verb in option_table().values():
        yield from below(verb)
