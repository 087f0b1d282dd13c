# SPDX-License-Identifier: GPL-3.0-or-later
"""A shop: its folder, its queue and all that looks after them. One service at a time has it."""
from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any, Dict, List, Optional

from . import process
from .asking import Asking
from .cluster import Cluster
from .events import News
from .files import read_json, write_json
from .form import (checked_model, checked_options, checked_parts, option_words, words_of)
from .limits import Limits
from .refusal import Refusal
from .retention import Retention
from .runner import Runner
from .store import HELD, WAITING, Job, Store
from .tokens import Token
from .upload import Uploads, files_of, is_id, likely_models
from .watch import Watch, watches_of

_format = {"format": "voxtone-shop", "version": 1}


class ShopIsTaken(Exception):
    pass


class Shop:
    def __init__(self, folder: Path, limits: Limits, at_once: int = 1, memory_bytes: int = 0, keep_days: float = 0,
                 keep_bytes: int = 0, cluster: Optional[Cluster] = None) -> None:
        self.folder, self.limits = folder.resolve(), limits
        self._claim()
        self.news = News()
        self.token = Token(self.folder / "token")
        self.uploads = Uploads(self.folder / "uploads", limits)
        self.store = Store(self.folder / "jobs", limits, self._tell)
        self.runner = Runner(self.store, limits, at_once, memory_bytes, cluster)
        self.runner.tell_shop = lambda: self.news.tell("shop")
        self.asking = Asking(self.folder / "asking")
        self.retention = Retention(self.store, keep_days, keep_bytes)
        self.watches: List[Watch] = []

    def _claim(self) -> None:
        """A folder that is not there, is empty or is a shop's. Raises ShopIsTaken."""
        self.folder.mkdir(parents=True, exist_ok=True)
        known = read_json(self.folder / "shop.json")
        if known is None and any(self.folder.iterdir()):
            raise ShopIsTaken(f"{self.folder} holds other things, and a shop wants a folder of its own; name another with --folder")
        if known is not None and (known.get("format"), known.get("version")) != ("voxtone-shop", 1):
            raise ShopIsTaken(f"{self.folder} is no shop of this version of voxtone; name another folder with --folder")
        os.chmod(self.folder, 0o700)
        lock = process.take_lock(self.folder / "lock")
        if lock is None:
            raise ShopIsTaken(f"another `voxtone serve` works in {self.folder}; use its page, or name another folder with --folder")
        self._lock = lock
        if known is None:
            write_json(self.folder / "shop.json", _format)

    def watch(self, words: List[str]) -> None:
        """NAME=FOLDER of each queue. Raises NoQueue."""
        self.watches = watches_of(self, words)

    def begin(self) -> None:
        self.runner.begin()
        self.retention.begin()
        for watch in self.watches:
            watch.begin()

    def stop(self) -> None:
        for watch in self.watches:
            watch.stop()
        self.news.close()
        self.runner.stop()

    def _tell(self, job: Job) -> None:
        job.revision = self.news.tell(job.id)

    def state(self) -> Dict[str, Any]:
        return {"paused": self.runner.paused, "keeps": self.retention.sentence(), "watches": [watch.state() for watch in self.watches]}

    # Handing in.

    def source_of(self, asked: Dict[str, Any]) -> Path:
        """Files of an upload, or of another job, which is made again or changed."""
        if "upload" in asked:
            return self.uploads.path(str(asked["upload"]))
        if "job" in asked:
            return self.store.get(str(asked["job"])).input
        raise Refusal(400, "say which files: \"upload\", or \"job\" for those of another job")

    def checked(self, asked: Dict[str, Any], source: Path) -> Dict[str, Any]:
        """A job in the program's words. Raises Refusal."""
        files = files_of(source)
        names = [file["name"] for file in files]
        if asked.get("parts") is not None:
            parts = checked_parts(asked["parts"], names, self.limits)
            return {"verb": "tray", "model": None, "parts": parts, "options": checked_options(asked.get("options", {}), "tray")}
        model = asked.get("model")
        if model is None:
            likely = likely_models(files)
            if len(likely) != 1:
                raise Refusal(400, f"say which file is the \"model\": there are {', '.join(likely[:8]) or 'none'}")
            model = likely[0]
        return {"verb": "slice", "model": checked_model(model, names), "parts": None,
                "options": checked_options(asked.get("options", {}))}

    def hand_in(self, asked: Dict[str, Any], key: str = "", queue: str = "") -> List[Job]:
        """`copies` jobs of one request. Asked twice with one key they are the same jobs. `queue`: the hot folder that they
        came by."""
        source = self.source_of(asked)
        what = self.checked(asked, source)
        copies = asked.get("copies", 1)
        if isinstance(copies, bool) or not isinstance(copies, int) or not 1 <= copies <= self.limits.copies:
            raise Refusal(400, f"\"copies\" is a number from 1 to {self.limits.copies}")
        self._ask_console(what, source)
        name = asked.get("name") or what["model"] or f"tray of {sum(_copies(part) for part in what['parts'])}"
        if not isinstance(name, str) or len(name) > 300:
            raise Refusal(400, "\"name\" is a text of up to 300 characters")
        what["queue"] = queue
        what["name"] = "".join(c for c in name if c.isprintable()).strip() or "job"
        what["estimate"] = _figures(asked.get("estimate"))
        what["changed_from"] = asked.get("changed_from") if is_id(str(asked.get("changed_from"))) else None
        state = HELD if asked.get("held") is True else WAITING
        # A cluster's tasks begin in an empty folder (docs/batch.md).
        finished = None if "upload" in asked or self.runner.cluster else self.store.get(str(asked["job"]))
        jobs = [self.store.add({**what, "key": f"{key}-{copy}" if key else "", **(_numbered(what, copy, copies))}, source, state, finished)
                for copy in range(copies)]
        self.runner.wake()
        return jobs

    def _ask_console(self, what: Dict[str, Any], source: Path) -> None:
        """The sentence that the console has for options that do not go."""
        if what["verb"] == "slice":
            self.asking.ask(["slice", "--dump-default", *option_words(what["options"])], source, f"check {time.monotonic_ns()}")

    def estimate(self, asked: Dict[str, Any], who: str) -> Dict[str, Any]:
        source = self.source_of(asked)
        what = self.checked(asked, source)
        quick = [] if asked.get("full") is True else ["--quick"]
        words = ["estimate", "--json", *quick, *words_of(what, source)]
        return self.asking.ask(words, source, f"estimate {who}")


def _copies(part: Dict[str, Any]) -> int:
    copies = part.get("copies", 1)
    return copies if isinstance(copies, int) and not isinstance(copies, bool) else 1


def _numbered(what: Dict[str, Any], copy: int, copies: int) -> Dict[str, Any]:
    return {"name": f"{what['name']} ({copy + 1} of {copies})"} if copies > 1 else {}


def _figures(estimate: Optional[Any]) -> Optional[Dict[str, Any]]:
    if not isinstance(estimate, dict):
        return None
    kept = {key: estimate.get(key) for key in ("seconds", "memory_bytes", "disk_bytes", "ml", "layers")}
    return {key: value for key, value in kept.items() if isinstance(value, (int, float)) and 0 <= value < 1e15}
