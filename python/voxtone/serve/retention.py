# SPDX-License-Identifier: GPL-3.0-or-later
"""What has ended goes by age and size, where that was asked for; a day before it does, that is told with the job."""
from __future__ import annotations

import threading
import time
from typing import List, Optional

from .limits import bytes_text
from .refusal import Refusal
from .store import Job, Store, ended_states

_notice_s = 24 * 3600
_look_s = 600


class Retention:
    """`days`, `bytes`: 0 keeps all."""

    def __init__(self, store: Store, days: float, most_bytes: int) -> None:
        self._store, self._days, self._bytes = store, days, most_bytes

    def begin(self) -> None:
        if self._days or self._bytes:
            threading.Thread(target=self._work, name="retention", daemon=True).start()

    def sentence(self) -> str:
        limits = [f"{self._days:g} days" if self._days else "", bytes_text(self._bytes) if self._bytes else ""]
        told = " and ".join(limit for limit in limits if limit)
        return f"Jobs that have ended are kept for {told}; a day before one goes it says so." if told else ""

    def _work(self) -> None:
        while True:
            self.look(time.time())
            time.sleep(_look_s)

    def look(self, now: float) -> None:
        """Gives notice, takes it back, and removes what has had its day."""
        going = set(job.id for job in self._too_old(now) + self._too_many())
        for job in self._store.all():
            if job.state.state not in ended_states:
                continue
            if job.id not in going:
                if job.state.leaves:
                    self._store.change(job, leaves=0)
            elif not job.state.leaves:
                self._store.change(job, leaves=now + _notice_s)
            elif job.state.leaves <= now:
                try:
                    self._store.remove(job)
                except Refusal:
                    continue

    def _ended(self) -> List[Job]:
        """The oldest first, without those that are to be kept."""
        ended = [job for job in self._store.all() if job.state.state in ended_states]
        return sorted((job for job in ended if not job.state.kept), key=lambda job: job.state.ended)

    def _too_old(self, now: float) -> List[Job]:
        most: Optional[float] = self._days * 24 * 3600 if self._days else None
        return [job for job in self._ended() if most is not None and now + _notice_s - job.state.ended > most]

    def _too_many(self) -> List[Job]:
        if not self._bytes:
            return []
        over = sum(job.state.bytes for job in self._store.all()) - self._bytes
        gone = []
        for job in self._ended():
            if over <= 0:
                break
            over -= job.state.bytes
            gone.append(job)
        return gone
