# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job made, on its way out: files as they are, folders as a ZIP that is written while it is sent."""
from __future__ import annotations

import os
import re
import stat
import zipfile
from pathlib import Path
from typing import IO, Any, Iterator, Optional, cast
from urllib.parse import quote

from .door import Door, sandbox_policy
from .refusal import Refusal

_piece = 1 << 18


def open_inside(folder: Path, name: str) -> "Optional[Any]":
    """A regular file below the folder; no link is followed on the way. Nothing where there is none."""
    at = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        parts = name.split("/")
        for part in parts[:-1]:
            inner = os.open(part, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=at)
            os.close(at)
            at = inner
        file = os.open(parts[-1], os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=at)
    except OSError:
        return None
    finally:
        os.close(at)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        return None
    return os.fdopen(file, "rb")


def file_name(name: str, ending: str) -> str:
    """For Content-Disposition: letters of ours, and the true ones beside."""
    plain = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip("-.")[:80] or "voxtone"
    return f"attachment; filename=\"{plain}{ending}\"; filename*=UTF-8''{quote(name[:120] + ending, safe='')}"


def send_file(door: Door, folder: Path, name: str, kind: str, download: str = "", policy: str = sandbox_policy) -> None:
    try:
        file = open_inside(folder, name)
    except OSError:
        file = None
    if file is None:
        raise Refusal(404, "that is not there, or not yet")
    with file:
        size = os.fstat(file.fileno()).st_size
        door.begin_answer(200, kind, size, {"Content-Disposition": download} if download else {}, policy)
        if door.command == "HEAD":
            return
        while size:
            data = file.read(min(_piece, size))
            if not data:
                door.close_connection = True
                return
            size -= len(data)
            door.wfile.write(data)


class _Answer:
    """A file that can only be written on."""

    def __init__(self, door: Door) -> None:
        self._door, self._at = door, 0

    def write(self, data: bytes) -> int:
        self._door.wfile.write(data)
        self._at += len(data)
        return len(data)

    def tell(self) -> int:
        return self._at

    def flush(self) -> None:
        pass


def _files_below(folder: Path) -> Iterator[str]:
    for below, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            if not name.startswith("."):
                yield (Path(below) / name).relative_to(folder).as_posix()


def send_zip(door: Door, folder: Path, name: str) -> None:
    """Stored: bitmaps are compressed already."""
    if not folder.is_dir() or folder.is_symlink():
        raise Refusal(404, "that is not there, or not yet")
    door.begin_answer(200, "application/zip", None, {"Content-Disposition": file_name(name, ".zip")}, sandbox_policy)
    if door.command == "HEAD":
        return
    with zipfile.ZipFile(cast(IO[bytes], _Answer(door)), "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
        for inner in _files_below(folder):
            file = open_inside(folder, inner)
            if file is None:
                continue
            with file, archive.open(zipfile.ZipInfo(inner), "w", force_zip64=True) as entry:
                while True:
                    data = file.read(_piece)
                    if not data:
                        break
                    entry.write(data)
