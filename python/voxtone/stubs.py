# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m voxtone.stubs` writes verbs.pyi from the program's table, for editors and type checkers (tools/package)."""
from __future__ import annotations

import re
from typing import List

from .options import Command, Option, option_table, run_by_package


def _type_of(option: Option) -> str:
    if option.flag:
        return "Optional[bool]"
    if option.many or option.separator or re.search("LIST|ROLES|AXES|,", option.value):  # a list is joined by commas
        return "Union[Value, Sequence[Value], None]"
    return f"Union[Literal[{', '.join(map(repr, option.choices))}], str, None]" if option.choices else "Optional[Value]"


def _call(command: Command) -> str:
    places = [o for o in command.options if o.positional]
    parts = [f"*{places[0].keyword}: Value" if places[0].many else ", ".join(f"{o.keyword}: Value" for o in places)
             ] if places else []
    if not (places and places[0].many):
        parts.append("*")
    named = [o for o in command.options if not o.positional and o.name not in run_by_package]
    parts += [f"{o.keyword}: {_type_of(o)} = ..." for o in named]
    parts.append("progress: Optional[Progress] = ...")
    return f"    def __call__(self, {', '.join(parts)}) -> Job: ...\n"


def _class(command: Command, lines: List[str]) -> str:
    name = "_" + "_".join(command.path).replace("-", "_")
    body = "".join(f"    {step.path[-1].replace('-', '_')}: {_class(step, lines)}\n" for step in command.steps)
    lines.append(f"class {name}:\n{body or _call(command)}")
    return name


def stub() -> str:
    lines: List[str] = []
    verbs = "".join(f"{verb.path[0]}: {_class(verb, lines)}\n" for verb in option_table().values()
                    if verb.path[0] != "serve")  # a service, whose name a module has
    return ("# Made by python -m voxtone.stubs\nfrom os import PathLike\n"
            "from typing import Any, Dict, List, Literal, Optional, Sequence, Union\n\n"
            "from .job import Job, Progress\nfrom .mesh import Mesh\nfrom .prints import Print\n\n"
            "Value = Union[str, int, float, PathLike[str], Mesh, Print]\n\n" + "\n".join(lines) + "\n" + verbs +
            "\ndef printers() -> List[Dict[str, Any]]: ...\ndef resin_sets() -> List[Dict[str, Any]]: ...\n")


if __name__ == "__main__":
    print(stub(), end="")
