# SPDX-License-Identifier: GPL-3.0-or-later
"""One exception for each exit code of the program; the message is the program's."""
from __future__ import annotations

import re
from typing import Any, Optional


_at_end = re.compile(r"\[([a-z0-9-]+)\]\s*\Z")


def name_of_message(message: str) -> str:
    """What stands in brackets at its end, "" where nothing does: docs/messages has the remedy under it."""
    found = _at_end.search(message)
    return found[1] if found else ""


class Warned(str):
    """The text of a warning."""

    @property
    def name(self) -> str:
        """Of its kind: "thin-walls"."""
        return name_of_message(self)


class Error(Exception):
    """A verb did not end as asked."""
    exit_code = -1

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result  #: what was made or found nevertheless
        self.name = name_of_message(message)  #: of its kind: "invalid-input"


class Bug(Error):
    """A fault of voxtone: please report it."""
    exit_code = 1


class UsageError(Error):
    """An option that there is not, or a value that it does not take."""
    exit_code = 2


class InputError(Error):
    """A model, job or table that cannot be used."""
    exit_code = 3


class FileError(Error):
    """A file could not be read or written, or a part of voxtone is not installed."""
    exit_code = 4


class Unfinished(Error):
    """No memory, or cancelled."""
    exit_code = 5


class Cancelled(Unfinished):
    """By Job.cancel()."""


class CheckFailed(Error):
    """`verify` found faults, or with strict=True the print, which is there, will not look as asked."""
    exit_code = 6


class TryAgain(Error):
    """Nothing is wrong with the job: the disk is full, or another job holds the folder."""
    exit_code = 75


class Stopped(Error):
    """On request; progress is saved, run it again."""
    exit_code = 85


class Killed(Error):
    """By a signal, which says nothing of the job."""


class ProgramMissing(Error):
    """The program voxtone is not there."""


_kinds = {kind.exit_code: kind
          for kind in (Bug, UsageError, InputError, FileError, Unfinished, CheckFailed, TryAgain, Stopped)}


def _said_of_files(result: Any) -> str:
    """What `voxtone read` found wrong with each file, which stands in its result."""
    files = result.get("files", []) if isinstance(result, dict) else []
    return "; ".join(str(one["error"]) for one in files if isinstance(one, dict) and one.get("error"))


def error_of(exit_code: int, message: str, result: Optional[Any] = None) -> Error:
    if exit_code < 0:
        return Killed(message or f"voxtone was killed by signal {-exit_code}", result)
    message = message or _said_of_files(result) or f"voxtone ended with exit code {exit_code}"
    error = _kinds.get(exit_code, Error)(message, result)
    error.exit_code = exit_code
    return error
