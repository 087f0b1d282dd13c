# SPDX-License-Identifier: GPL-3.0-or-later
"""What browsers are told as it happens: jobs by the number of their last change, so that who comes back asks for what is
newer than what he has."""
from __future__ import annotations

import threading
from typing import Dict, List, Optional, Tuple


class News:
    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._last = 0
        self._of: Dict[str, int] = {}  #: job, or "shop" -> number of its last change
        self._closed = False

    def tell(self, what: str) -> int:
        with self._changed:
            self._last += 1
            self._of.pop(what, None)
            self._of[what] = self._last  # last in order
            self._changed.notify_all()
            return self._last

    def forget(self, what: str) -> None:
        """Once nobody can be behind."""
        with self._changed:
            self._of.pop(what, None)

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    @property
    def last(self) -> int:
        with self._changed:
            return self._last

    def wait(self, since: int, timeout: float) -> Optional[Tuple[int, List[str]]]:
        """What changed after `since`, the latest last; an empty list after a time without news, nothing once closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._last > since or self._closed, timeout)
            if self._closed:
                return None
            newer = []
            for what, number in reversed(self._of.items()):
                if number <= since:
                    break
                newer.append(what)
            return self._last, newer[::-1]
