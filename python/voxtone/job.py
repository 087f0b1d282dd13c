# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of the program: followed by its events, cancelled, and ended by a result or an exception."""
from __future__ import annotations

import atexit
import json
import signal
import subprocess
import tempfile
import threading
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Set

from .errors import Cancelled, Error, Unfinished, Warned, error_of
from .program import environment, program

Event = Dict[str, Any]  #: {"event": "progress", "stage": "layers", "done": 1842, "steps": 3920, ...}
Progress = Callable[[Event], None]

_running: Set["Job"] = set()


@atexit.register
def _cancel_all() -> None:
    for job in list(_running):
        job.cancel()


def _failed_check(result: Any) -> str:
    """What exit code 6 is for: the sentence of a verdict, or the first fault."""
    if isinstance(result, dict) and "sentence" in result.get("verdict", {}):
        return result["verdict"]["sentence"]
    if isinstance(result, dict) and result.get("faults"):
        fault = result["faults"][0]
        return f"{result.get('fault_count', len(result['faults']))} faults; {fault['where']}: {fault['what']}"
    return ""


class Job:
    """Runs since it was made. Iterating gives every event from the first on, and ends with the job; `result()` waits and
    gives what the verb made, or raises its Error. In a `with` block a job that is left early is cancelled."""

    def __init__(self, words: Sequence[str], finish: Callable[[Any], Any] = lambda result: result,
                 progress: Optional[Progress] = None, cleanup: Callable[[bool], None] = lambda succeeded: None) -> None:
        self.command: List[str] = [program(), *words]
        self._finish, self._progress, self._cleanup = finish, progress, cleanup
        self._events: List[Event] = []
        self._other: List[str] = []
        self._news = threading.Condition()
        self._done = self._cancelled = False
        self._failure: Optional[BaseException] = None
        self._value: Any = None
        self._told = tempfile.TemporaryFile("w+", errors="replace")
        try:
            self._process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=self._told,
                                             stdin=subprocess.DEVNULL, text=True, errors="replace", env=environment())
        except OSError:
            cleanup(False)
            raise
        _running.add(self)
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._thread.start()

    def __iter__(self) -> Iterator[Event]:
        at = 0
        while True:
            with self._news:
                self._news.wait_for(lambda: at < len(self._events) or self._done)
                if at == len(self._events):
                    return
                event = self._events[at]
            at += 1
            yield event

    def __enter__(self) -> "Job":
        return self

    def __exit__(self, *_: object) -> None:
        if not self.done:
            self.cancel()
            self.wait()

    @property
    def done(self) -> bool:
        return self._done

    @property
    def events(self) -> List[Event]:
        """So far."""
        with self._news:
            return list(self._events)

    @property
    def warnings(self) -> List[Warned]:
        return [Warned(event["message"]) for event in self.events if event["event"] == "warning"]

    @property
    def seconds_left(self) -> Optional[float]:
        """By the last event that knew."""
        left = [event["job_seconds_left"] for event in self.events if "job_seconds_left" in event]
        return 0.0 if self._done else left[-1] if left else None

    def cancel(self) -> None:
        """Asks the program to stop; it ends within seconds and leaves no half-made stack. `result()` raises Cancelled."""
        if not self._done:
            self._cancelled = True
            self._process.send_signal(signal.SIGINT)

    def wait(self, timeout: Optional[float] = None) -> bool:
        """Whether it has ended."""
        self._thread.join(timeout)
        return not self._thread.is_alive()

    def result(self, timeout: Optional[float] = None) -> Any:
        if not self.wait(timeout):
            raise TimeoutError(f"voxtone is at work still after {timeout} s")
        if self._failure:
            raise self._failure
        return self._value

    def _follow(self) -> None:
        try:
            self._read_events()
        except BaseException as failure:  # pylint: disable=broad-except
            self._failure = failure  # of the callback: told by result()
            self.cancel()
        try:
            self._process.stdout.read()  # type: ignore[union-attr]
            self._end(self._process.wait())
        except BaseException as failure:  # pylint: disable=broad-except
            self._failure = self._failure or failure
        finally:
            _running.discard(self)
            self._process.stdout.close()  # type: ignore[union-attr]
            self._told.close()
            try:
                self._cleanup(self._failure is None)
            finally:
                with self._news:
                    self._done = True
                    self._news.notify_all()

    def _read_events(self) -> None:
        for line in self._process.stdout:  # type: ignore[union-attr]
            try:
                event = json.loads(line)
            except ValueError:
                event = None
            if not isinstance(event, dict) or "event" not in event:
                self._other.append(line)  # `list` and `status` print plain JSON
                continue
            with self._news:
                self._events.append(event)
                self._news.notify_all()
            if self._progress:
                self._progress(event)

    def _end(self, code: int) -> None:
        last = self._events[-1] if self._events else {}
        result = last.get("result") if last.get("event") == "result" else None
        if result is None and code == 0 and self._other:
            result = json.loads("".join(self._other))
        value = self._finish(result) if code in (0, 6) and result is not None else result
        if code == 0:
            self._value = value
            return
        self._told.seek(0)
        message = last.get("message") if last.get("event") == "error" else None
        message = message or (_failed_check(result) if code == 6 else "")
        message = message or self._told.read().strip().removeprefix("voxtone: ")
        error: Error = error_of(code, message, value)
        if self._cancelled and isinstance(error, Unfinished):
            error = Cancelled(message)
        self._failure = self._failure or error
