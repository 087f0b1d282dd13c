# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs that Slurm runs. Each is a batch of one in SHOP/jobs/ID/cluster (`voxtone batch --slurm`), whose command is safe to
repeat: it hands over what is left, and nothing that waits or runs. So a service that was killed asks for all of them
again. What became of a job its tasks write (data/schema/batch-job.schema.json); a whole stack moves to SHOP/jobs/ID/out."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple

from ..program import environment, program
from .files import read_json
from .form import PLAN, words_of
from .store import Job

at_once = 500  #: in Slurm; its queue is longer than ours may be
_handing_over = threading.BoundedSemaphore(2)
_look_s = 2.0
_plan = ".cluster.jsonl"
_name = "out"  #: of the one job


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


class ClusterRun:
    """One job on its way through Slurm, as the runner looks at it (runner.Running)."""

    def __init__(self, job: Job, cluster: Cluster) -> None:
        self._job, self._cluster = job, cluster
        self._child: "Optional[subprocess.Popen[bytes]]" = None
        self.is_over = False
        self._is_there = self._has_slot = False
        self._looked = 0.0

    def begin(self) -> None:
        """Once there is a place for it: estimates take a processor."""
        if self._child or self._is_there:
            return
        if (self._job.out / "manifest.json").is_file():  # when the service was killed it had moved there
            self._is_there = True
            return
        if not _handing_over.acquire(blocking=False):
            return
        self._has_slot = True
        try:
            write_plan(self._job)
            with open(self._job.folder / "said.txt", "ab") as said, open(self._told, "wb") as out:
                self._child = subprocess.Popen([program(), *self._cluster.words(self._job)], stdin=subprocess.DEVNULL, stdout=out, stderr=said,
                                               cwd=self._job.input, env=environment(), start_new_session=True)
        except OSError:
            self._free()
            raise

    @property
    def _told(self) -> Path:
        return self._job.folder / "handed-over.jsonl"

    def _free(self) -> None:
        if self._has_slot:
            self._has_slot = False
            _handing_over.release()

    def event(self) -> Optional[Dict[str, Any]]:
        """What has happened since: the last one is a "result" or an "error"."""
        if self.is_over:
            return None
        self.begin()
        if not self._is_there:
            code = self._child.poll() if self._child else None
            if code is None:
                return None
            self._free()
            if code != 0:
                return self._over({"event": "error", "exit_code": code, "message": self._refused()})
            self._is_there = True
        if time.monotonic() - self._looked < _look_s:
            return None
        self._looked = time.monotonic()
        return self._state()

    def _over(self, event: Dict[str, Any]) -> Dict[str, Any]:
        self.is_over = True
        return event

    def _refused(self) -> str:
        """Of the one job, or of all."""
        for line in reversed(self._told.read_text(errors="replace").splitlines()):
            try:
                event = json.loads(line)
            except ValueError:
                continue
            if event.get("event") == "error":
                return str(event.get("message"))
        state = self._told_by_tasks()
        return str(state.get("message") or "Slurm took no job; what was said tells why")

    def _told_by_tasks(self) -> Dict[str, Any]:
        return read_json(folder_of(self._job) / "batch" / f"{_name}.json") or {}

    def _take_result(self) -> None:
        made = folder_of(self._job) / _name
        if made.is_dir():
            shutil.rmtree(self._job.out, ignore_errors=True)
            os.rename(made, self._job.out)

    def _state(self) -> Optional[Dict[str, Any]]:
        state = self._told_by_tasks()
        if state.get("state") == "done":
            self._take_result()
            return self._over({"event": "result", "result": read_json(self._job.out / "report.json") or {},
                               "warnings": list((state.get("figures") or {}).get("warnings") or [])})
        if state.get("state") == "failed":
            return self._over({"event": "error", "exit_code": state.get("exit_code") or 1, "message": state.get("message") or ""})
        stage = f"runs on {state['runner']['host']}" if state.get("state") == "running" and state.get("runner") else "waits in Slurm"
        return {"event": "stage", "stage": stage, "state": "begin", "steps": 0} if self._job.progress.get("stage") != stage else None

    def numbers(self) -> List[str]:
        folder = folder_of(self._job) / "batch" / "slurm"
        stages = (read_json(folder / _name / "submission.json") or {}).get("stages") or []
        closing = (read_json(folder / ".last.json") or {}).get("number")
        return [str(number) for stage in stages for number in stage.get("numbers") or []] + ([str(closing)] if closing else [])

    def cancel(self) -> bool:
        """Takes it out of Slurm's queue. Whether it is gone."""
        if self._child and self._child.poll() is None:
            self._child.terminate()
            return False
        self._free()
        numbers = self.numbers()
        try:
            gone = not numbers or subprocess.run(["scancel", *numbers], capture_output=True, timeout=60, check=False).returncode == 0
        except (OSError, subprocess.TimeoutExpired):
            return False
        self.is_over = gone
        return gone
