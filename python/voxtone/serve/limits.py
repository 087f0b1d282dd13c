# SPDX-License-Identifier: GPL-3.0-or-later
"""What is taken at most. Each limit is told where it is met, with what to do."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Union

from .refusal import Refusal

MB = 1 << 20
GB = 1 << 30


@dataclass(frozen=True)
class Limits:
    file_bytes: int = 4 * GB  #: of one file handed in
    upload_bytes: int = 16 * GB  #: of all files of one upload
    upload_files: int = 2000  #: of one upload
    uploads: int = 500  #: that wait to be used
    upload_hours: float = 48  #: that an upload waits
    jobs: int = 2000  #: in the queue and kept
    parts: int = 500  #: of a tray
    copies: int = 200  #: handed in at once
    text_bytes: int = 1 * MB  #: of a request in JSON
    head_s: float = 15  #: until the head of a request is there
    silence_s: float = 20  #: without a byte, of a body or of who reads an answer
    slowest_bytes_s: float = 16 * 1024  #: of a body, after a first minute
    connections: int = 256
    watchers: int = 64  #: connections that wait for events
    free_bytes: int = 1 * GB  #: of the disk, below which nothing is begun or taken


def bytes_text(count: Union[int, float]) -> str:
    for unit, size in (("GB", GB), ("MB", MB), ("kB", 1024)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{int(count)} bytes"


def free_bytes(folder: "os.PathLike[str]") -> int:
    told = os.statvfs(folder)
    return told.f_bavail * told.f_frsize


def want_room(folder: "os.PathLike[str]", more: int, limits: Limits) -> None:
    free = free_bytes(folder)
    if free < more + limits.free_bytes:
        raise Refusal(507, f"the disk of the shop has {bytes_text(free)} left, and {bytes_text(limits.free_bytes)} are kept "
                           f"free for what runs: {bytes_text(more)} more are not taken; remove jobs that are done")
