# SPDX-License-Identifier: GPL-3.0-or-later
"""Hot folders: queues with a name. What has arrived, whole and with the files that it names, `voxtone batch --watch
--only-tell` says; each becomes a job with the options of SHOP/watch/NAME.json, a job file that may be changed at any
time. What was taken is noted (NAME.taken), so that a model that stays where it lies is sliced once."""
from __future__ import annotations

import collections
import errno
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Deque, Dict, List, Optional, Set

from . import process
from .files import read_json, sync_folder
from .form import options_of_job_file
from .refusal import Refusal
from .store import WAITING

if TYPE_CHECKING:
    from .shop import Shop

_is_name = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}\Z").match
_again_s = 10  #: after which is tried again what could not be taken, and a program that ended is started again
_most_said = 20
#: Why one cannot be taken now, and may be later: too many, no room, options that do not go.
_later = (429, 507, 422)


class NoQueue(Exception):
    """In words: why --watch is refused."""


class Watch:
    def __init__(self, shop: "Shop", name: str, folder: Path) -> None:
        self._shop, self.name, self.folder = shop, name, folder
        self._own = shop.folder / "watch"
        self._own.mkdir(exist_ok=True)
        self.options_file = self._own / f"{name}.json"
        self._ledger = self._own / f"{name}.taken"
        self._taken: Set[str] = set(self._ledger.read_text(encoding="ascii").split()) if self._ledger.exists() else set()
        self._waits: Dict[str, List[Path]] = {}  #: models that could not be taken yet
        self._why = ""
        self._said: Deque[str] = collections.deque(maxlen=_most_said)
        self._child: "Optional[subprocess.Popen[bytes]]" = None
        self._lock = threading.RLock()
        self._stopping = threading.Event()

    def begin(self) -> None:
        threading.Thread(target=self._listen, name=f"watch {self.name}", daemon=True).start()
        threading.Thread(target=self._try_again, name=f"later {self.name}", daemon=True).start()

    def stop(self) -> None:
        self._stopping.set()
        if self._child:
            try:
                os.killpg(self._child.pid, signal.SIGTERM)
            except ProcessLookupError:
                pass

    def state(self) -> Dict[str, Any]:
        with self._lock:
            return {"name": self.name, "folder": str(self.folder), "options": self.options_file.name if self.options_file.exists() else "",
                    "waits": len(self._waits), "why": self._why, "said": list(self._said)[-3:]}

    def _say(self, text: str) -> None:
        text = text.replace(f"{self.folder}/", "")
        with self._lock:
            if text in self._said:
                return
            self._said.append(text)
        self._shop.news.tell("shop")

    # What arrives.

    def _listen(self) -> None:
        work = self._own / f".{self.name}"
        work.mkdir(exist_ok=True)
        words = ["batch", f"--watch={self.folder}", "--only-tell", "--json", f"--out={work / 'none'}"]
        while not self._stopping.is_set():
            try:
                child = self._child = process.start(words, work, [self.folder], work, subprocess.PIPE, subprocess.DEVNULL, tied=True)
                assert child.stdout
                for line in child.stdout:
                    self._take_line(line)
                child.wait()
            except OSError as error:
                self._say(f"cannot be watched: {error}")
            self._stopping.wait(_again_s)

    def _take_line(self, line: bytes) -> None:
        try:
            event = json.loads(line)
        except ValueError:
            return
        if event.get("event") == "arrived":
            self._take(Path(event["model"]), [Path(file) for file in event["beside"]])
        elif event.get("event") in ("note", "warning", "error") and not str(event.get("message")).startswith("watching "):
            self._say(str(event.get("message")))

    def _try_again(self) -> None:
        while not self._stopping.wait(_again_s):
            with self._lock:
                waits = dict(self._waits)
            for model, beside in waits.items():
                self._take(Path(model), beside)

    def _take(self, model: Path, beside: List[Path]) -> None:
        """Makes a job of it; what cannot be now is tried again."""
        with self._lock:
            self._waits.pop(str(model), None)
            why = ""
            try:
                self._hand_in(model, beside)
            except Refusal as refusal:
                why = refusal.sentence
                if refusal.status in _later:
                    self._waits[str(model)] = beside
                else:
                    self._say(f"{model.name}: is left aside: {why}")
            except OSError as error:
                if error.errno == errno.ELOOP:
                    self._say(f"{model.name}: is left aside: it, or what it names, is a link; files are taken that lie in the folder")
                # Else it is being written anew, or gone: it will be told again.
            if self._why != (why if self._waits else ""):
                self._why = why if self._waits else ""
                self._shop.news.tell("shop")

    def _hand_in(self, model: Path, beside: List[Path]) -> None:
        files = [model, *beside]
        key = _key(self.name, files)
        if key in self._taken:
            return
        options = self._options()
        upload = self._shop.uploads.begin()
        try:
            for file in files:
                self._copy(upload, file)
            if _key(self.name, files) != key:
                return  # it was written anew meanwhile, and will arrive again
            name = model.relative_to(self.folder).as_posix()
            if self._shop.store.handed_in(f"{key}-0") is None:  # not before a service that was killed could note it
                self._leave_earlier(name)
                self._shop.hand_in({"upload": upload, "model": name, "options": options}, key, queue=self.name)
        finally:
            shutil.rmtree(self._shop.uploads.folder / upload, ignore_errors=True)
        self._taken.add(key)
        with open(self._ledger, "a", encoding="ascii") as ledger:
            ledger.write(key + "\n")
            ledger.flush()
            os.fsync(ledger.fileno())
        sync_folder(self._own)

    def _options(self) -> Dict[str, Any]:
        if not self.options_file.exists():
            return {}
        try:
            return dict(options_of_job_file(self.options_file.read_bytes())["options"])
        except Refusal as refusal:
            raise Refusal(422, f"{self.options_file}: {refusal.sentence}") from refusal

    def _copy(self, upload: str, file: Path) -> None:
        """A copy: who writes into the folder does not write into a job. Links are not followed out of it."""
        handle = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
        with os.fdopen(handle, "rb") as source:
            size = os.fstat(handle).st_size
            self._shop.uploads.add(upload, file.relative_to(self.folder).as_posix(), size, lambda out: shutil.copyfileobj(source, out, 1 << 20))

    def _leave_earlier(self, model: str) -> None:
        """A file that was written anew takes the place of what waits of it."""
        for job in self._shop.store.all():
            if job.what.get("queue") == self.name and job.what.get("model") == model and job.state.state == WAITING:
                self._shop.runner.cancel(job)
                self._shop.store.change(job, message="a newer file of this name has arrived")


def _key(name: str, files: List[Path]) -> str:
    """Of these files as they are now. Raises OSError."""
    told = [(file.as_posix(), *_stamp(file)) for file in files]
    return hashlib.sha256(json.dumps([name, told]).encode()).hexdigest()


def _stamp(file: Path) -> List[int]:
    told = os.lstat(file)
    return [told.st_size, told.st_mtime_ns, told.st_ino]


def watches_of(shop: "Shop", words: List[str]) -> List[Watch]:
    """Of NAME=FOLDER. Raises NoQueue."""
    made: Dict[str, Watch] = {}
    for word in words:
        name, equals, place = word.partition("=")
        folder = Path(place).resolve()
        if not equals or not _is_name(name):
            raise NoQueue(f"--watch {word}: say NAME=FOLDER, NAME of letters, digits, - and _")
        if name in made:
            raise NoQueue(f"--watch {word}: {name} is the name of another folder; give each queue a name of its own")
        if not folder.is_dir():
            raise NoQueue(f"--watch {word}: {place} is no folder; make it first")
        if folder == shop.folder or shop.folder in folder.parents or folder in shop.folder.parents:
            raise NoQueue(f"--watch {word}: the folder of the shop and a watched one lie in each other; name a folder beside {shop.folder}")
        made[name] = Watch(shop, name, folder)
    return list(made.values())
