# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs that Slurm runs. Each is a batch of one in SHOP/jobs/ID/cluster (`voxtone batch --slurm`), whose command is safe to
repeat: it hands over what is left, and nothing that waits or runs. So a service that was killed asks for all of them
again. What became of a job its tasks write (data/schema/batch-job.schema.json); a whole stack moves to SHOP/jobs/ID/out.
What tasks cannot write squeue tells: why one waits, that it was taken out by others, that it is gone once it was cancelled."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, IO, List, Optional, Tuple

from ..program import environment, program
from . import walls
from .files import read_json
from .form import PLAN, words_of
from .store import Job

at_once = 500  #: in Slurm; its queue is longer than ours may be
_handing_over = threading.BoundedSemaphore(2)
_look_s = 2.0
_plan = ".cluster.jsonl"
_name = "out"  #: of the one job
_seldom_s, _often_s = 10.0, 2.0  #: squeue is asked
_patience_s = 60.0  #: what one machine writes another sees later
_taken_out = ("Slurm's queue has it no more, and none of its tasks told how it ended: somebody took it out (scancel), or the cluster "
              "forgot it; retry hands it over again, and goes on from where it was")


@dataclass(frozen=True)
class Cluster:
    sbatch_options: Tuple[str, ...] = ()

    def why_not(self) -> str:
        """In words; empty: Slurm's commands are here."""
        missing = [name for name in ("sbatch", "squeue", "scancel", "scontrol") if not shutil.which(name)]
        return f"--slurm: {', '.join(missing)} not on this machine; start the service where jobs are handed in" if missing else ""

    def words(self, job: Job) -> List[str]:
        said = [f"--sbatch-option={option}" for option in self.sbatch_options]
        return ["batch", "--slurm", "--json", f"--out={folder_of(job)}", *said, "--", str(job.input / _plan)]


def folder_of(job: Job) -> Path:
    return job.folder / "cluster"


def write_plan(job: Job) -> None:
    """Beside its files, which it names from there."""
    what = job.what
    if what["verb"] == "tray":
        words_of(what, job.input, PLAN)
    row = {**what["options"], "name": _name, "model": what["model"] or PLAN}
    beside = job.input / (_plan + ".new")
    beside.write_text(json.dumps(row) + "\n", encoding="utf-8")
    beside.replace(job.input / _plan)


class SlurmQueue:
    """What waits and runs there, asked for all jobs at once, and never waited for: squeue is slow where the controller is
    away."""

    def __init__(self) -> None:
        self._child: "Optional[subprocess.Popen[bytes]]" = None
        self._out: "Optional[IO[bytes]]" = None
        self._asked = self._answered = 0.0  #: the last time; the last one that was answered
        self._known: Dict[str, List[Tuple[str, str]]] = {}

    def _look(self, every_s: float) -> None:
        if self._child is None or self._out is None:
            if time.monotonic() < self._asked + every_s:
                return
            self._asked, self._out = time.monotonic(), tempfile.TemporaryFile()  # pylint: disable=consider-using-with
            self._child = subprocess.Popen(["squeue", "--me", "--noheader", "--format=%F %t %r"], stdin=subprocess.DEVNULL, stdout=self._out,
                                           stderr=subprocess.DEVNULL)
        elif self._child.poll() is not None:
            if self._child.returncode == 0:
                self._out.seek(0)
                self._answered, self._known = self._asked, {}
                for line in self._out.read().decode(errors="replace").splitlines():
                    number, state, reason = [*line.split(None, 2), "", "", ""][:3]
                    self._known.setdefault(number, []).append((state, reason))
            self._out.close()
            self._child = self._out = None

    def tasks(self, numbers: List[str], since: float, often: bool = False) -> Optional[List[Tuple[str, str]]]:
        """State and reason ("PD", "Resources") of those that it has; nothing where it was not asked `since`, or does not
        answer."""
        self._look(_often_s if often else _seldom_s)
        return [task for number in numbers for task in self._known.get(number, [])] if self._answered > since else None


_queue = SlurmQueue()


def _why_it_waits(tasks: Optional[List[Tuple[str, str]]]) -> str:
    reasons = [reason for _, reason in tasks or [] if reason not in ("", "None", "Dependency")]
    return f"waits in Slurm ({reasons[0]})" if reasons else "waits in Slurm"


def _scancel(numbers: List[str]) -> None:
    """Not waited for: squeue tells when they are gone."""
    if numbers:
        subprocess.Popen(["scancel", *numbers], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class ClusterRun:
    """One job on its way through Slurm, as the runner looks at it (runner.Running)."""

    def __init__(self, job: Job, cluster: Cluster) -> None:
        self._job, self._cluster = job, cluster
        self._child: "Optional[subprocess.Popen[bytes]]" = None
        self.is_over = False
        self.was_there = False  #: Slurm took it
        self._has_slot = False
        self._looked = self._there_since = self._failed_since = self._cancelled_at = self._missed_since = 0.0

    def begin(self) -> None:
        """Once there is a place for it: estimates take a processor."""
        if (self._job.out / "manifest.json").is_file():  # when the service was killed it had moved there
            self.was_there = True
            return
        if self._is_handed_over() or not _handing_over.acquire(blocking=False):
            return
        self._has_slot = True
        try:
            write_plan(self._job)
            with open(self._job.folder / "said.txt", "ab") as said, open(self._told, "wb") as out:
                self._child = subprocess.Popen([program(), *self._cluster.words(self._job)], stdin=subprocess.DEVNULL, stdout=out, stderr=said,
                                               cwd=self._job.input, env=environment(), start_new_session=True)
            self._who.write_text(f"{self._child.pid} {walls.start_time(self._child.pid)}", encoding="ascii")
        except OSError:
            self._free()
            raise

    @property
    def _told(self) -> Path:
        return self._job.folder / "handed-over.jsonl"

    @property
    def _who(self) -> Path:
        return self._job.folder / "handing-over"

    def _is_handed_over(self) -> bool:
        """Just now, by us or by a service that was killed meanwhile."""
        if self._child:
            return self._child.poll() is None
        try:
            pid, _, began = self._who.read_text(encoding="ascii").partition(" ")
            return bool(began) and walls.start_time(int(pid)) == began
        except (OSError, ValueError):
            return False

    def _free(self) -> None:
        if self._has_slot:
            self._has_slot = False
            _handing_over.release()

    def event(self) -> Optional[Dict[str, Any]]:
        """What has happened since: the last one is a "result" or an "error"."""
        if self._cancelled_at:
            self.is_over = self.is_over or _queue.tasks(self.numbers(), self._cancelled_at, often=True) == []
            return None
        is_wanted = self._job.state.wish not in ("cancel", "hold")
        if not self.was_there and not self._child and is_wanted:
            self.begin()
        if self._child:
            code = self._child.poll()
            if code is None:
                return None
            self._free()
            self._child = None
            if code != 0 and is_wanted:
                return self._over({"event": "error", "exit_code": code, "message": self._refused()})
            self.was_there, self._there_since = code == 0, time.monotonic()
        if not self.was_there or time.monotonic() - self._looked < _look_s:
            return None
        self._looked = time.monotonic()
        return self._state()

    def _over(self, event: Dict[str, Any]) -> Dict[str, Any]:
        self.is_over = True
        return event

    def _refused(self) -> str:
        """Of the one job, or of all; without what is to be done at a console."""
        state = self._told_by_tasks()
        reason = str(state.get("message") or "").removeprefix("was not submitted: ")
        for line in reversed(self._told.read_text(errors="replace").splitlines()):
            try:
                event = json.loads(line)
            except ValueError:
                continue
            if event.get("event") == "error":
                message = str(event.get("message"))
                return reason if reason and reason in message else message
        return reason or "Slurm took no job; what was said tells why"

    def _told_by_tasks(self) -> Dict[str, Any]:
        return read_json(folder_of(self._job) / "batch" / f"{_name}.json") or {}

    def _take_result(self) -> None:
        made = folder_of(self._job) / _name
        if made.is_dir():
            shutil.rmtree(self._job.out, ignore_errors=True)
            os.rename(made, self._job.out)

    def _state(self) -> Optional[Dict[str, Any]]:
        tasks = _queue.tasks(self.numbers(), self._there_since)
        state = self._told_by_tasks()
        if state.get("state") == "done":
            self._take_result()
            _scancel(self.numbers()[-1:])  # nobody asks what became of it
            return self._over({"event": "result", "result": read_json(self._job.out / "report.json") or {},
                               "warnings": list((state.get("figures") or {}).get("warnings") or [])})
        if state.get("state") == "failed":
            # Handed over again while Slurm has it still it would count as there.
            self._failed_since = self._failed_since or time.monotonic()
            if _queue.tasks(self.numbers(closing=False), self._failed_since, often=True) != []:
                return None
            return self._over({"event": "error", "exit_code": state.get("exit_code") or 1, "message": state.get("message") or ""})
        if tasks != []:
            self._missed_since = 0
        elif not self._missed_since:
            self._missed_since = time.monotonic()
        elif time.monotonic() - self._missed_since > _patience_s:
            return self._over({"event": "error", "exit_code": 5, "message": _taken_out})
        stage = f"runs on {state['runner']['host']}" if state.get("state") == "running" and state.get("runner") else _why_it_waits(tasks)
        return {"event": "stage", "stage": stage, "state": "begin", "steps": 0} if self._job.progress.get("stage") != stage else None

    def numbers(self, closing: bool = True) -> List[str]:
        """Of Slurm's jobs: its stages, and the one that tells what became of them."""
        folder = folder_of(self._job) / "batch" / "slurm"
        stages = (read_json(folder / _name / "submission.json") or {}).get("stages") or []
        last = (read_json(folder / ".last.json") or {}).get("number") if closing else None
        return [str(number) for stage in stages for number in stage.get("numbers") or []] + ([str(last)] if last else [])

    def cancel(self) -> bool:
        """Takes it out of Slurm's queue; it is over once it is gone from there. False: it is just being handed over."""
        if self._is_handed_over():
            if self._child:
                self._child.terminate()
            return False
        self._free()
        numbers = self.numbers()
        self.is_over = not numbers
        _scancel(numbers)
        self._cancelled_at = time.monotonic()
        return True
