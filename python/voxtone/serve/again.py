# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished job made again, or changed: what of it stays, so that only what the change touches is made anew. Whether it
does stay the program decides, by its own identity of jobs: here files are laid where it looks for them."""
from __future__ import annotations

import functools
import os
import shutil
from pathlib import Path
from typing import Any, Dict, Set

from ..options import option_table
from ..program import program, version
from .files import link_tree

#: What is kept: all, what the loop came to, that where it ended by itself, what the loops of a tray's parts came to, nothing.
STACK, LOOP, SETTLED_LOOP, PARTS, NOTHING = "stack", "loop", "settled-loop", "parts", "nothing"
SKIN = "skin.mixtures"


def changed_options(before: Dict[str, Any], now: Dict[str, Any]) -> Set[str]:
    return {name for name in {*before, *now} if before.get(name) != now.get(name)}


def what_stays(before: Dict[str, Any], now: Dict[str, Any]) -> str:
    """Of the files of one job, in the words of two (job.json)."""
    if (before["verb"], before["model"]) != (now["verb"], now["model"]):
        return NOTHING
    table = {option.name: option.leaves or NOTHING for option in option_table()["slice"].options}
    left = {table.get(name, NOTHING) for name in changed_options(before["options"], now["options"])}
    if now["verb"] == "tray":
        return STACK if left <= {STACK} and before["parts"] == now["parts"] else PARTS
    return NOTHING if NOTHING in left else LOOP if left & {LOOP, SETTLED_LOOP} else STACK


def take_over(finished: Path, out: Path, stays: str) -> str:
    """Links what stays of the folder of a finished job into the new one's, which is empty. What was there to be taken."""
    if stays == STACK:
        link_tree(finished, out)
    elif stays == LOOP:
        stays = LOOP if _link(finished / SKIN, out / SKIN) else NOTHING
    elif stays == PARTS:
        linked = [_link(skin, out / skin.relative_to(finished)) for skin in sorted(finished.glob(f"parts/*/{SKIN}"))]
        stays = PARTS if any(linked) else NOTHING
    return stays


def this_program() -> str:
    """With its build: another one's stack is another stack."""
    return _version_of(program(), os.stat(program()).st_mtime)


@functools.lru_cache(maxsize=4)
def _version_of(file: str, changed: float) -> str:
    del file, changed  # the key of the cache
    return version()


def _link(file: Path, to: Path) -> bool:
    if not file.is_file():
        return False
    to.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.link(file, to)
    except OSError:
        shutil.copyfile(file, to)
    return True
