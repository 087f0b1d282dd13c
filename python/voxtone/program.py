# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the program is, and how it is run."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Dict, List

from .errors import ProgramMissing, error_of

#: The program that a wheel carries (tools/package wheel), with the libraries that it loads.
_carried = Path(__file__).parent / "program"


def program() -> str:
    """The file of the program: $VOXTONE_PROGRAM, else what this package carries, else the PATH's."""
    named = os.environ.get("VOXTONE_PROGRAM")
    if named:
        if not os.access(named, os.X_OK):
            raise ProgramMissing(f"VOXTONE_PROGRAM names {named}, which is no program; name voxtone's file")
        return named
    if (_carried / "bin/voxtone").exists():
        return str(_carried / "bin/voxtone")
    found = shutil.which("voxtone")
    if not found:
        raise ProgramMissing("the program voxtone is not on the PATH; install the package voxtone, or name its file "
                             "in the environment variable VOXTONE_PROGRAM")
    return found


def environment() -> Dict[str, str]:
    """What the program runs in."""
    variables = dict(os.environ)
    if program().startswith(str(_carried)):
        before = variables.get("LD_LIBRARY_PATH")
        variables["LD_LIBRARY_PATH"] = str(_carried / "lib") + (":" + before if before else "")
    return variables


def output_of(words: List[str]) -> str:
    """What a short run prints."""
    run = subprocess.run([program(), *words], capture_output=True, text=True, env=environment(), check=False)
    if run.returncode != 0:
        raise error_of(run.returncode, run.stderr.strip().removeprefix("voxtone: "))
    return run.stdout


def version() -> str:
    """Of the program, with its build."""
    return output_of(["--version"]).strip()
