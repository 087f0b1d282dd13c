# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs on disk, one folder each. What a job is stays as it was handed in (job.json); how far it is goes by rename
(state.json). Nothing else is remembered: who starts the service again finds the queue as it was.

    SHOP/jobs/ID/job.json  state.json  input/  out/  events.jsonl  said.txt  running.lock  tmp/
"""
from __future__ import annotations

import os
import secrets
import shutil
import threading
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

from . import again
from .files import link_tree, read_json, sync_folder, write_json
from .limits import Limits
from .refusal import Refusal
from .upload import is_id, new_id

WAITING, HELD, RUNNING, DONE, FAILED, CANCELLED = "waiting", "held", "running", "done", "failed", "cancelled"
ended_states = (DONE, FAILED, CANCELLED)


@dataclass
class State:
    state: str = WAITING
    order: float = 0  #: in the queue
    wish: str = ""  #: what is to become of a running job: "hold", "cancel"
    tries: int = 0
    kills: int = 0  #: by somebody else, while we looked on
    started: float = 0  #: the last time; seconds since 1970, as all here
    ended: float = 0
    not_before: float = 0
    seconds: float = 0  #: at work, all tries
    exit_code: Optional[int] = None
    message: str = ""  #: in words: why it waits, failed
    verdict: Optional[Dict[str, Any]] = None
    warnings: List[str] = field(default_factory=list)
    bytes: int = 0  #: on disk, once it has ended
    kept: bool = False  #: never goes by age or size
    leaves: float = 0  #: when it goes; 0: it does not
    in_slurm: bool = False  #: where it runs
    made_by: str = ""  #: the program, once it is done
    reused: str = ""  #: in words: what was not made anew


@dataclass
class Job:
    id: str
    folder: Path
    what: Dict[str, Any]  #: job.json
    state: State
    revision: int = 0
    progress: Dict[str, Any] = field(default_factory=dict)  #: of what runs

    @property
    def out(self) -> Path:
        return self.folder / "out"

    @property
    def input(self) -> Path:
        return self.folder / "input"

    @property
    def events(self) -> Path:
        return self.folder / "events.jsonl"

    @property
    def lock(self) -> Path:
        return self.folder / "running.lock"

    @property
    def keeps_loop(self) -> bool:
        return (self.out / again.SKIN).is_file()

    def summary(self) -> Dict[str, Any]:
        told = asdict(self.state)
        return {"id": self.id, **{key: self.what.get(key) for key in ("name", "verb", "model", "parts", "options", "created",
                                                                      "estimate", "changed_from", "queue")},
                **told, "revision": self.revision, "progress": self.progress, "keeps_loop": self.keeps_loop,
                "has_report": (self.out / "report.html").is_file(), "has_stack": (self.out / "manifest.json").is_file()}


class Store:
    """All jobs, in memory as on disk. `news` is told of each change."""

    def __init__(self, folder: Path, limits: Limits, news: Callable[[Job], None]) -> None:
        self.folder, self._limits, self._news = folder, limits, news
        self.lock = threading.RLock()
        self._jobs: Dict[str, Job] = {}
        self._by_key: Dict[str, str] = {}
        self._trash = folder.with_name("trash")
        for made in (folder, self._trash):
            made.mkdir(exist_ok=True)
        for below in sorted(folder.iterdir()):
            self._find(below)
        self.empty_trash()

    def _find(self, below: Path) -> None:
        what = read_json(below / "job.json") if is_id(below.name) else None
        if what is None:  # begun to be handed in, and never answered
            shutil.rmtree(below, ignore_errors=True)
            return
        known = {key: value for key, value in (read_json(below / "state.json") or {}).items() if key in State.__dataclass_fields__}
        self._remember(Job(below.name, below, what, State(**known)))

    def _remember(self, job: Job) -> None:
        self._jobs[job.id] = job
        if job.what.get("key"):
            self._by_key[job.what["key"]] = job.id

    def all(self) -> List[Job]:
        """In the order of the queue."""
        with self.lock:
            return sorted(self._jobs.values(), key=lambda job: (job.state.order, job.id))

    def get(self, job_id: str) -> Job:
        with self.lock:
            job = self._jobs.get(job_id) if is_id(job_id) else None
        if job is None:
            raise Refusal(404, "there is no such job; it was removed, or the address is wrong")
        return job

    def handed_in(self, key: str) -> Optional[Job]:
        """By the key of who hands in, who may not have got the answer."""
        with self.lock:
            return self._jobs.get(self._by_key.get(key, ""))

    def add(self, what: Dict[str, Any], source: Path, state: str = WAITING, finished: Optional[Job] = None) -> Job:
        """Once it returns the job is there, whatever happens. One key is one job. `finished`: whose files it takes, and
        what of its results stays."""
        job_id = new_id()
        new = self.folder / f".{job_id}.new"
        try:
            new.mkdir()
            link_tree(source, new / "input")
            (new / "out").mkdir()
            what = {**what, "takes": self._take_over(what, finished, new / "out")}
            with self.lock:
                known = self.handed_in(what.get("key") or "")
                if known:
                    return known
                if len(self._jobs) >= self._limits.jobs:
                    raise Refusal(429, f"{self._limits.jobs} jobs are here, and no more are taken; remove some that are done")
                order = 1 + max([job.state.order for job in self._jobs.values()], default=0)
                job = Job(job_id, self.folder / job_id, {**what, "created": time.time()}, State(state=state, order=order))
                if finished and what["takes"] == again.STACK:  # nothing is said of it anew
                    job.state.warnings = finished.state.warnings
                write_json(new / "state.json", asdict(job.state))
                write_json(new / "job.json", job.what)
                os.rename(new, job.folder)
                sync_folder(self.folder)
                self._remember(job)
        finally:
            shutil.rmtree(new, ignore_errors=True)
        self._news(job)
        return job

    @staticmethod
    def _take_over(what: Dict[str, Any], finished: Optional[Job], out: Path) -> str:
        if finished is None or finished.state.state != DONE:
            return again.NOTHING
        stays = again.what_stays(finished.what, what)
        if stays == again.STACK and finished.state.made_by != again.this_program():
            return again.NOTHING
        return again.take_over(finished.out, out, stays)

    def change(self, job: Job, lasting: bool = True, **changes: Any) -> None:
        with self.lock:
            for key, value in changes.items():
                setattr(job.state, key, value)
            if job.id in self._jobs:
                write_json(job.folder / "state.json", asdict(job.state), lasting)
        self._news(job)

    def tell(self, job: Job) -> None:
        """Of its progress, which is not kept."""
        self._news(job)

    def swap(self, job: Job, up: bool) -> None:
        """With the next that waits."""
        with self.lock:
            queue = [other for other in self.all() if other.state.state in (WAITING, HELD)]
            if job not in queue:
                raise Refusal(409, "it is not in the queue; what runs or has ended has no place there")
            at = queue.index(job) + (-1 if up else 1)
            if not 0 <= at < len(queue):
                return
            mine, theirs = job.state.order, queue[at].state.order
            self.change(queue[at], order=mine)
            self.change(job, order=theirs)

    def remove(self, job: Job) -> None:
        """Gone at once for all; the files follow."""
        with self.lock:
            if job.state.state == RUNNING:
                raise Refusal(409, "it runs; cancel it first")
            os.rename(job.folder, self._trash / f"{job.id}-{secrets.token_hex(4)}")
            del self._jobs[job.id]
            self._by_key.pop(job.what.get("key") or "", None)
        self._news(job)
        threading.Thread(target=self.empty_trash, daemon=True).start()

    def is_there(self, job: Job) -> bool:
        with self.lock:
            return job.id in self._jobs

    def empty_trash(self) -> None:
        for folder in self._trash.iterdir():
            shutil.rmtree(folder, ignore_errors=True)
