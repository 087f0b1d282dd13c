# SPDX-License-Identifier: GPL-3.0-or-later
"""Which jobs run now, and what becomes of them. A job ends by what it said last (events.jsonl) and by its exit code; 75,
85 and what was killed go on, with --resume where a loop left its state."""
from __future__ import annotations

import functools
import json
import os
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

from . import again, process
from .cluster import Cluster, ClusterRun
from .cluster import at_once as in_slurm_at_once
from .files import tree_bytes
from .form import command_of
from .limits import Limits, bytes_text, free_bytes
from .refusal import Refusal
from .store import CANCELLED, DONE, FAILED, HELD, RUNNING, WAITING, Job, Store, ended_states

_look_s = 0.5  #: at what runs
_most_kills = 3
_most_tries_again = 20
_known_loop = "the appearance loop was run before"  #: as the program notes it
_all_of_it = "all of it"
_save_s = 30  #: that jobs have to save themselves


class Running:
    """A job at work, started by us or found so."""

    def __init__(self, job: Job, child: "Optional[subprocess.Popen[bytes]]", at: int) -> None:
        self.job, self.child, self.at = job, child, at
        self.rest = b""
        self.last: Dict[str, Any] = {}
        self.warnings: List[str] = []
        self.stages = 0  #: that it began, of this try
        self.known_loops = 0  #: that were run before
        self.asked = ""  #: the wish that it was told of
        self.asked_at = 0.0
        self.may_go_again = True  #: by itself, where it says so

    def new_events(self) -> List[Dict[str, Any]]:
        with open(self.job.events, "rb") as file:
            file.seek(self.at)
            data = file.read()
        self.at += len(data)
        *lines, self.rest = (self.rest + data).split(b"\n")
        events = []
        for line in lines:
            try:
                event = json.loads(line)
            except ValueError:
                continue
            if isinstance(event, dict) and isinstance(event.get("event"), str):
                events.append(event)
        return events

    def has_ended(self) -> bool:
        if self.child:
            return self.child.poll() is not None
        lock = process.take_lock(self.job.lock)
        if lock is None:
            return False
        os.close(lock)
        return True

    def end(self, wish: str, late: bool) -> bool:
        """Whether it was told to."""
        return process.send(self.job.lock, signal.SIGKILL if late else signal.SIGINT if wish == "cancel" else signal.SIGTERM)


class InSlurm(Running):
    """Its events are made of what its tasks write."""

    def __init__(self, job: Job, cluster: Cluster, at: int) -> None:
        super().__init__(job, None, at)
        self._run = ClusterRun(job, cluster)

    def has_ended(self) -> bool:
        event = self._run.event()
        if event:
            self.warnings = event.pop("warnings", self.warnings)
            with open(self.job.events, "ab") as out:
                out.write(json.dumps(event, separators=(",", ":")).encode() + b"\n")
        self.may_go_again = not self._run.was_there  # its tasks have tried as often as they may
        return self._run.is_over

    def end(self, wish: str, late: bool) -> bool:
        return wish == "stop" or self._run.cancel()  # a service that ends leaves it there


class Runner:
    """`cluster`: what Slurm is asked with, where jobs are handed to it."""

    def __init__(self, store: Store, limits: Limits, at_once: int = 1, memory_bytes: int = 0, cluster: Optional[Cluster] = None) -> None:
        self._store, self._limits, self.cluster = store, limits, cluster
        self._at_once = in_slurm_at_once if cluster else at_once
        self._memory = memory_bytes or os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        self._running: Dict[str, Running] = {}
        self._wake = threading.Condition()
        self._woken = self._stopping = False
        self.paused = ""  #: why nothing is begun, in words
        self.tell_shop: Callable[[], Any] = lambda: None
        self._thread = threading.Thread(target=self._work, name="runner", daemon=True)

    def begin(self) -> None:
        for job in self._store.all():
            if job.state.state == RUNNING:
                self._find_again(job)
        self._thread.start()

    def wake(self) -> None:
        with self._wake:
            self._woken = True
            self._wake.notify()

    def stop(self) -> None:
        """What runs saves itself, and goes on when the service is started again."""
        self._stopping = True
        self.wake()
        self._thread.join(_save_s + 10)

    # What people ask for.

    def hold(self, job: Job) -> None:
        with self._store.lock:
            if job.state.state == WAITING:
                self._store.change(job, state=HELD, message="")
            elif job.state.state == RUNNING:
                self._store.change(job, wish="hold")
            elif job.state.state != HELD:
                raise Refusal(409, f"it is {job.state.state}; only what waits or runs can be held")
        self.wake()

    def release(self, job: Job) -> None:
        with self._store.lock:
            if job.state.state == HELD:
                self._store.change(job, state=WAITING, message="")
            elif job.state.state == RUNNING and job.state.wish == "hold":
                self._store.change(job, wish="go on")
            elif job.state.state not in (WAITING, RUNNING):
                raise Refusal(409, f"it is {job.state.state}; retry makes it again")
        self.wake()

    def cancel(self, job: Job) -> None:
        with self._store.lock:
            if job.state.state in (WAITING, HELD):
                self._store.change(job, state=CANCELLED, ended=time.time(), message="")
            elif job.state.state == RUNNING:
                self._store.change(job, wish="cancel")
            elif job.state.state != CANCELLED:
                raise Refusal(409, f"it is {job.state.state} already")
        self.wake()

    def retry(self, job: Job) -> None:
        with self._store.lock:
            if job.state.state not in (FAILED, CANCELLED):
                raise Refusal(409, f"it is {job.state.state}; only what failed or was cancelled is tried again")
            self._store.change(job, state=WAITING, message="", exit_code=None, tries=0, kills=0, not_before=0, wish="", leaves=0)
        self.wake()

    # The work.

    def _work(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._woken, self._pause())
                self._woken = False
            for running in list(self._running.values()):
                self._guarded(running.job, functools.partial(self._look_at, running))
            if self._stopping:
                self._running = {key: running for key, running in self._running.items() if not isinstance(running, InSlurm)}  # they go on
                if not self._running:
                    return
                continue
            self._start_what_fits()

    def _pause(self) -> Optional[float]:
        if self._running:
            return _look_s
        waiting = [job.state.not_before for job in self._store.all() if job.state.state == WAITING]
        if not waiting:
            return None
        return 5 if self.paused else max(0.05, min(60, min(waiting) - time.time()))

    def _guarded(self, job: Job, work: Callable[[], None]) -> None:
        """What goes wrong with one job is its own."""
        try:
            work()
        except Exception as error:  # pylint: disable=broad-except
            self._running.pop(job.id, None)
            if self._store.is_there(job):
                try:
                    self._store.change(job, state=WAITING, not_before=time.time() + 30, message=f"could not be looked after: {error}")
                except OSError:
                    job.state.state, job.state.not_before = WAITING, time.time() + 30  # the disk is full: told by the pause

    def _find_again(self, job: Job) -> None:
        """A job that ran when the service ended: at work still, or over."""
        if job.state.in_slurm:
            self._running[job.id] = InSlurm(job, self.cluster or Cluster(), job.events.stat().st_size if job.events.is_file() else 0)
            return
        events = job.events.read_bytes() if job.events.is_file() else b""
        begin = events.rfind(b'{"event":"start"')
        running = Running(job, None, max(begin, 0))
        self._running[job.id] = running

    def _start_what_fits(self) -> None:
        for job in self._store.all():
            if len(self._running) >= self._at_once:
                return
            if job.state.state != WAITING or job.state.not_before > time.time() or not self._has_memory(job):
                continue
            if not self._has_room(job):
                return
            self._guarded(job, functools.partial(self._start, job))

    def _has_memory(self, job: Job) -> bool:
        def needs(one: Job) -> int:
            return int((one.what.get("estimate") or {}).get("memory_bytes") or self._memory // 2)
        return bool(self.cluster) or not self._running or sum(needs(r.job) for r in self._running.values()) + needs(job) <= self._memory

    def _has_room(self, job: Job) -> bool:
        wanted = self._limits.free_bytes + int((job.what.get("estimate") or {}).get("disk_bytes") or 0)
        free = free_bytes(self._store.folder)
        paused = ""
        if free < wanted:
            paused = (f"The disk is full: {bytes_text(free)} are left, and {job.what.get('name')} wants {bytes_text(wanted)}. "
                      "Nothing is begun until there is room; results stay. Remove jobs that are done.")
        if paused != self.paused:
            self.paused = paused
            self.tell_shop()
        return not paused

    def _start(self, job: Job) -> None:
        lock = process.take_lock(job.lock)
        if lock is None:
            self._find_again(job)  # nobody but we starts it: it was begun before
            return
        try:
            self._store.change(job, state=RUNNING, wish="", tries=job.state.tries + 1, started=time.time(), message="", ended=0,
                               in_slurm=bool(self.cluster))
            threads = max(1, (os.cpu_count() or 1) // self._at_once) if self._at_once > 1 else 0
            words = command_of(job.what, job.input, job.out, threads, _how_to_begin(job.out))
            end = job.events.stat().st_size if job.events.exists() else 0
            with open(job.events, "ab") as out, open(job.folder / "said.txt", "ab") as said:
                begin = b"\n" if end and not _ends_with_line(job.events) else b""  # a line that was cut
                out.write(begin + json.dumps({"event": "start", "try": job.state.tries, "at": time.time()},
                                             separators=(",", ":")).encode() + b"\n")
                out.flush()
                if self.cluster:
                    self._running[job.id] = InSlurm(job, self.cluster, end)
                    return
                child = process.start(words, job.input, [job.input], job.folder, out, said, lock)
        finally:
            os.close(lock)
        self._running[job.id] = Running(job, child, end)

    def _look_at(self, running: Running) -> None:
        job = running.job
        ended = running.has_ended()
        if job.events.is_file():
            self._take_events(running)
        if ended:
            self._end(running)
            return
        wish = "stop" if self._stopping else job.state.wish
        if wish in ("cancel", "hold", "stop") and (wish != running.asked or time.time() - running.asked_at > _save_s):
            late = wish == running.asked
            if running.end(wish, late):
                running.asked, running.asked_at = wish, time.time()
                self._store.tell(job)

    def _take_events(self, running: Running) -> None:
        job, news = running.job, False
        for event in running.new_events():
            running.last = event
            news = True
            kind = event["event"]
            if kind == "start":
                job.progress = {"stage": "starts"}
                running.warnings = []
                running.stages = running.known_loops = 0
            elif kind == "note" and str(event.get("message", "")).startswith(_known_loop):
                running.known_loops += 1
            elif kind == "stage" and event.get("state") == "begin":
                running.stages += 1
                job.progress = {**job.progress, "stage": event.get("stage"), "done": 0, "steps": event.get("steps"),
                                "unit": event.get("unit")}
            elif kind == "progress":
                job.progress = {**job.progress, **{key: event.get(key) for key in ("stage", "done", "steps")},
                                "seconds_left": event.get("job_seconds_left"), "told": time.time()}
            elif kind == "warning":
                running.warnings.append(str(event.get("message")))
                job.state.warnings = running.warnings[:100]
        if news:
            self._store.tell(job)

    def _end(self, running: Running) -> None:
        self._running.pop(running.job.id, None)
        job, last = running.job, running.last
        code = running.child.returncode if running.child else None
        seconds = job.state.seconds + max(0.0, time.time() - job.state.started)
        ended: Dict[str, Any] = {"wish": "", "seconds": seconds, "ended": time.time(), "warnings": running.warnings[:100],
                                 "not_before": 0}
        job.progress = {}
        if last.get("event") == "result":
            result = last["result"] if isinstance(last.get("result"), dict) else {}
            verdict = result.get("verdict")
            reused = _reused(job, running)
            if reused == _all_of_it:
                ended["warnings"] = job.state.warnings
            self._store.change(job, state=DONE, exit_code=0 if code is None else code, message="", bytes=tree_bytes(job.folder),
                               verdict=verdict if isinstance(verdict, dict) else None, reused=reused, made_by=again.this_program(), **ended)
            return
        if last.get("event") == "error":
            code = int(last.get("exit_code") or 1)
        ended.update(self._after_failure(job, code, str(last.get("message") or _said(job)), running))
        if ended["state"] in ended_states:
            ended["bytes"] = tree_bytes(job.folder)
        self._store.change(job, **ended)

    def _after_failure(self, job: Job, code: Optional[int], message: str, running: Running) -> Dict[str, Any]:
        """What becomes of a job that came to no result. `code`: nothing where who saw it end is gone; below 0: a signal."""
        wish = job.state.wish
        if wish == "cancel":
            return {"state": CANCELLED, "message": ""}
        if wish == "hold":
            return {"state": HELD, "message": "held; goes on from where it was"}
        if self._stopping or wish == "go on" or code is None or code == 85 and running.may_go_again:
            return {"state": WAITING, "message": "was interrupted; goes on from where it was"}
        if code < 0:
            if job.state.kills + 1 >= _most_kills:
                return {"state": FAILED, "exit_code": code, "kills": 0,
                        "message": f"was killed from outside {_most_kills} times (signal {-code}), most often for want of memory; "
                                   "choose less size, draft quality, or ask who looks after the machine"}
            return {"state": WAITING, "kills": job.state.kills + 1, "not_before": time.time() + 2,
                    "message": f"was killed from outside (signal {-code}); tried again"}
        if code == 75 and running.may_go_again and (self.cluster or job.state.tries < _most_tries_again):  # Slurm may be away for days
            return {"state": WAITING, "message": message, "not_before": time.time() + min(600, 5 * 2 ** job.state.tries)}
        return {"state": FAILED, "exit_code": code, "message": message or f"ended with exit code {code}"}


def _reused(job: Job, running: Running) -> str:
    """As the program told: it began nothing, or took loops for done."""
    if job.what.get("takes") == again.STACK and not running.stages:
        return _all_of_it
    if not running.known_loops:
        return ""
    return "what the appearance loop came to" if job.what["verb"] == "slice" else f"what the loops of {running.known_loops} parts came to"


def _how_to_begin(out: Path) -> List[str]:
    """As the folder is: a loop goes on; what is not whole is made anew; a whole stack is found to be there."""
    if (out / "loop.checkpoint").exists():
        return ["--resume"]
    if any(not file.name.startswith(".") for file in out.iterdir()) and not (out / "manifest.json").exists():
        return ["--overwrite"]
    return []


def _ends_with_line(file: Path) -> bool:
    with open(file, "rb") as data:
        data.seek(-1, os.SEEK_END)
        return data.read(1) == b"\n"


def _said(job: Job) -> str:
    try:
        return (job.folder / "said.txt").read_text(errors="replace")[-2000:].strip().removeprefix("voxtone: ")
    except OSError:
        return ""
