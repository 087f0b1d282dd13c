# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm of a test's own, as tests/cli/one_node_slurm.h has one: controller and one node with keys, ports and files of their
own, run by whoever runs the test, and no service of the system."""
from __future__ import annotations

import os
import pwd
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Callable, Dict, List

configuration = Path(__file__).resolve().parents[2] / "tests/data/one-node-slurm.conf"
_path = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/usr/local/sbin", "/sbin"])  #: daemons lie where users' does not lead


def what_is_missing() -> str:
    missing = [name for name in ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel") if not shutil.which(name, path=_path)]
    return f"{', '.join(missing)} not here (Debian: slurm-wlm munge)" if missing else ""


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def until(so: Callable[[], object], seconds: float = 120) -> None:
    end = time.monotonic() + seconds
    while not so():
        assert time.monotonic() < end
        time.sleep(0.1)


class OneNodeSlurm:
    """`folder`: a short path, for the name of a socket lies in it. Processes end with close()."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._daemons = folder, {}  # type: Path, Dict[str, subprocess.Popen[bytes]]
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        words = {"HOST": socket.gethostname().partition(".")[0], "USER": pwd.getpwuid(os.getuid()).pw_name, "FOLDER": str(folder),
                 "CONTROLLER_PORT": str(_free_port()), "NODE_PORT": str(_free_port())}
        text = configuration.read_text(encoding="ascii")
        for word, value in words.items():
            text = text.replace(f"@{word}@", value)
        (folder / "slurm.conf").write_text(text)
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        try:
            self._start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder / 'munge.socket'}", f"--pid-file={folder / 'munged.pid'}",
                        f"--log-file={folder / 'munged.log'}", f"--seed-file={folder / 'munged.seed'}")
            until((folder / "munge.socket").exists)
            self.start_controller()
            self.start_node()
        except BaseException:
            self.close()
            raise

    def _start(self, program: str, *words: str) -> None:
        with open(self._folder / f"{program}.out", "ab") as out:
            self._daemons[program] = subprocess.Popen([str(shutil.which(program, path=_path)), *words], stdin=subprocess.DEVNULL, stdout=out, stderr=out)

    def start_controller(self) -> None:
        self._start("slurmctld", "-D", "-f", str(self._folder / "slurm.conf"))

    def start_node(self) -> None:
        self._start("slurmd", "-D", "-f", str(self._folder / "slurm.conf"))
        until(lambda: ask("sinfo", "--noheader", "--format=%T").startswith(("idle", "mixed", "allocated")))

    def kill(self, program: str) -> None:
        daemon = self._daemons.pop(program)
        daemon.send_signal(signal.SIGKILL)
        daemon.wait()

    def close(self) -> None:
        ask("scancel", "--me", "--signal=KILL", "--full")
        for program in list(self._daemons):
            self.kill(program)
        os.environ.pop("SLURM_CONF", None)

    def logs(self) -> str:
        return "".join(f"--- {file.name}\n{file.read_text(errors='replace')[-3000:]}" for file in sorted(self._folder.glob("*.log")))


def ask(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


def queue() -> List[str]:
    return ask("squeue", "--noheader", "--format=%i %t %r").splitlines()
