# SPDX-License-Identifier: GPL-3.0-or-later
"""Becomes a program that sees the files of its job alone (Landlock, Linux 5.19), run by its file:

    python3 -I walls.py LOCK --read PATH... --write PATH... [--tied PID] -- PROGRAM ARGUMENT...

The descriptor LOCK (-1: none) is locked by who started it and stays so until the program and all that it starts have
ended; the file says who that is, "PID START_TIME". Where the kernel knows no Landlock there are no walls: names of files
in what users say are refused all the same (form.py)."""
from __future__ import annotations

import ctypes
import os
import signal
import sys
from typing import Dict, List, Sequence

_create_ruleset, _add_rule, _restrict_self = 444, 445, 446
_no_new_privileges = 38
_signal_with_parent = 1
_path_beneath = 1
#: linux/landlock.h: execute, write, read file, read dir, remove dir, remove file, make char, dir, reg, sock, fifo, block,
#: sym, refer (2), truncate (3).
_execute, _read_file, _read_folder = 1 << 0, 1 << 2, 1 << 3
_write_file, _truncate = 1 << 1, 1 << 14
_all_of = {2: (1 << 14) - 1}
_reading = _execute | _read_file | _read_folder
#: What a program needs besides its job: libraries, fonts, what the machine has.
_machine = ("/usr", "/lib", "/lib64", "/bin", "/opt", "/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/fonts", "/etc/localtime",
            "/etc/alternatives", "/proc", "/sys", "/dev")


class _Ruleset(ctypes.Structure):
    _fields_ = [("files", ctypes.c_uint64)]


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = [("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32)]


_libc = ctypes.CDLL(None, use_errno=True)


def landlock_version() -> int:
    """0 where there is none; 1 cannot link or rename from folder to folder, which stacks are made by."""
    return max(0, _libc.syscall(_create_ruleset, None, ctypes.c_size_t(0), ctypes.c_uint32(1)))


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return  # what is not there is not seen
    if not os.path.isdir(path):
        rights &= _execute | _read_file | _write_file | _truncate
    rule = _Beneath(rights, parent)
    _libc.syscall(_add_rule, ruleset, _path_beneath, ctypes.byref(rule), ctypes.c_uint32(0))
    os.close(parent)


def build_walls(read: Sequence[str], write: Sequence[str]) -> bool:
    version = landlock_version()
    if version < 2:
        return False
    handled = _all_of[2] | (_truncate if version >= 3 else 0)
    wanted = _Ruleset(handled)
    ruleset = _libc.syscall(_create_ruleset, ctypes.byref(wanted), ctypes.c_size_t(ctypes.sizeof(wanted)), ctypes.c_uint32(0))
    if ruleset < 0:
        return False
    for path in (*_machine, *read):
        _allow(ruleset, path, _reading & handled)
    for path in ("/dev/null", "/dev/shm"):
        _allow(ruleset, path, handled)
    for path in write:
        _allow(ruleset, path, handled)
    _libc.prctl(_no_new_privileges, 1, 0, 0, 0)
    done = _libc.syscall(_restrict_self, ruleset, ctypes.c_uint32(0)) == 0
    os.close(ruleset)
    return done


def start_time(pid: int) -> str:
    """Of a process, in ticks since the machine began, as /proc tells; "" of none."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return ""


def main() -> None:
    lock, words = int(sys.argv[1]), sys.argv[2:]
    paths: Dict[str, List[str]] = {"--read": [], "--write": [], "--tied": []}
    while words[0] != "--":
        paths[words[0]].append(words[1])
        words = words[2:]
    if lock >= 0:
        os.ftruncate(lock, 0)
        os.pwrite(lock, f"{os.getpid()} {start_time(os.getpid())}\n".encode(), 0)
    for parent in paths["--tied"]:
        _libc.prctl(_signal_with_parent, signal.SIGTERM, 0, 0, 0)
        if os.getppid() != int(parent):  # it has ended already
            return
    build_walls(paths["--read"], paths["--write"])
    os.execv(words[1], words[1:])


if __name__ == "__main__":
    main()
