# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are there whole or not at all, also after a power cut; and names that stay in their folder."""
from __future__ import annotations

import json
import os
import shutil
import unicodedata
from pathlib import Path
from typing import Any, Dict, Optional

from .refusal import Refusal

_longest_name = 200  #: bytes: a name of 255 has room for what we put behind it
_deepest = 12


def sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_json(file: Path, value: Dict[str, Any], lasting: bool = True) -> None:
    """`lasting`: also where the power goes now."""
    beside = file.with_name("." + file.name + ".new")
    with open(beside, "w", encoding="utf-8") as out:
        json.dump(value, out, ensure_ascii=True, indent=1)
        out.flush()
        if lasting:
            os.fsync(out.fileno())
    os.replace(beside, file)
    if lasting:
        sync_folder(file.parent)


def read_json(file: Path) -> Optional[Dict[str, Any]]:
    """Nothing where it is not there or is none."""
    try:
        value = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return value if isinstance(value, dict) else None


def checked_path(name: str) -> str:
    """A name, or names of folders and a name with "/" between, that leads down only. Raises Refusal."""
    parts = name.split("/")
    if len(parts) > _deepest:
        raise Refusal(400, f"the path has more than {_deepest} folders; hand in the folder that holds the model")
    for part in parts:
        if part in ("", ".", "..") or "\\" in part or any(unicodedata.category(c) in ("Cc", "Cs") for c in part):
            raise Refusal(400, f"{name[:80]!r} is no name of a file to be kept; name it without \\, control characters, "
                               "empty or dotted parts")
        if part.startswith("."):
            raise Refusal(400, f"{part[:80]!r} begins with a dot, which hides a file; give it another name")
        if len(part.encode()) > _longest_name:
            raise Refusal(400, f"{part[:40]!r}... is longer than {_longest_name} bytes; give it a shorter name")
    return name


def link_tree(source: Path, target: Path) -> None:
    """The same files under another folder; copies where the disk has no links."""
    for folder, _, names in os.walk(source):
        into = target / os.path.relpath(folder, source)
        into.mkdir(parents=True, exist_ok=True)
        for name in names:
            if name.startswith("."):
                continue  # arriving, or ours
            try:
                os.link(os.path.join(folder, name), into / name, follow_symlinks=False)
            except OSError:
                shutil.copyfile(os.path.join(folder, name), into / name, follow_symlinks=False)


def tree_bytes(folder: Path) -> int:
    """Of regular files, each counted once."""
    seen, total = set(), 0
    for below, _, names in os.walk(folder):
        for name in names:
            try:
                told = os.lstat(os.path.join(below, name))
            except OSError:
                continue
            if (told.st_dev, told.st_ino) not in seen:
                seen.add((told.st_dev, told.st_ino))
                total += told.st_blocks * 512
    return total
