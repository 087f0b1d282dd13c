# SPDX-License-Identifier: GPL-3.0-or-later
"""A process of the program behind walls, which outlives who started it: its events go to a file, and a lock that it holds
says that it is there. Whoever comes later finds it again by these two."""
from __future__ import annotations

import errno
import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Dict, IO, List, Optional, Sequence, Union

from ..program import environment, program
from . import walls

_walls = str(Path(walls.__file__))


def folders_of_program() -> List[str]:
    """What it is made of, where it lies."""
    here = Path(program()).resolve()
    parts = [str(here.parent), str(here.parent.parent / "libexec"), str(here.parent.parent / "lib")]
    return parts + [os.environ[name] for name in ("VOXTONE_HELPERS",) if name in os.environ]


def start(words: Sequence[str], at: Path, read: Sequence[Path], write: Path, out: Union[IO[bytes], int], said: Union[IO[bytes], int],
          lock: Optional[int] = None, tied: bool = False) -> "subprocess.Popen[bytes]":
    """The program begins in the folder `at`, so that names of files mean those in it. `tied`: it ends with the thread that
    starts it."""
    temporary = write / "tmp"
    temporary.mkdir(exist_ok=True)
    variables: Dict[str, str] = {**environment(), "TMPDIR": str(temporary)}
    paths = [word for path in (*folders_of_program(), *map(str, read)) for word in ("--read", path)]
    command = [sys.executable, "-I", "-S", _walls, str(-1 if lock is None else lock), *paths, "--write", str(write), *(["--tied", str(os.getpid())] if tied else []), "--",
               program(), *words]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=said, cwd=at, env=variables,
                            start_new_session=True, pass_fds=[] if lock is None else [lock])


def take_lock(file: Path) -> Optional[int]:
    """Nothing while a process holds it."""
    lock = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(lock)
        if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
            raise
        return None
    return lock


def send(file: Path, number: signal.Signals) -> bool:
    """To who holds the lock; nobody else, whatever number it has come to have. False: it has just ended, or has not yet
    said who it is."""
    lock = take_lock(file)
    if lock is not None:
        os.close(lock)
        return False
    try:
        pid, _, began = file.read_text(encoding="ascii").strip().partition(" ")
        if not pid or walls.start_time(int(pid)) != began:
            return False
        os.kill(int(pid), number)
        return True
    except (OSError, ValueError):
        return False
