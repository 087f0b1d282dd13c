# SPDX-License-Identifier: GPL-3.0-or-later
"""Short runs of the program that answer a question: what a file holds, what a job will take. The newest question of who
asks is the one that counts: an older one of his is ended."""
from __future__ import annotations

import collections
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence

from . import process
from .refusal import Refusal

_at_once = 2
_kept = 300
_picture = "picture.png"
_longest_s = 180


class Asking:
    def __init__(self, folder: Path) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        self._folder = folder
        self.nowhere = folder / "nowhere"  #: for questions about no file
        self.nowhere.mkdir()
        self._lock = threading.Lock()
        self._slots = threading.BoundedSemaphore(_at_once)
        self._asked: Dict[str, "subprocess.Popen[bytes]"] = {}
        self._newest: Dict[str, object] = {}
        self._answers: "collections.OrderedDict[str, Dict[str, Any]]" = collections.OrderedDict()

    def ask(self, words: Sequence[str], at: Path, who: str, drawn: bool = False) -> Dict[str, Any]:
        """The result of `voxtone WORDS --json` in the folder `at`; where it is to be `drawn`, with a "picture", the bytes of
        a PNG. Raises Refusal with the program's own sentence."""
        key = hashlib.sha256(json.dumps([list(words), drawn, str(at), _state_of(at)]).encode()).hexdigest()
        with self._lock:
            known = self._answers.get(key)
            if known is not None:
                self._answers.move_to_end(key)
                return known
            me = self._newest[who] = object()
            older = self._asked.get(who)
            if older:
                _end(older)
        if not self._slots.acquire(timeout=_longest_s):
            raise Refusal(429, "others ask much just now; ask again in a minute")
        try:
            answer = self._run(words, at, who, me, drawn)
        finally:
            self._slots.release()
        with self._lock:
            self._answers[key] = answer
            while len(self._answers) > _kept:
                self._answers.popitem(last=False)
        return answer

    def _run(self, words: Sequence[str], at: Path, who: str, me: object, drawn: bool) -> Dict[str, Any]:
        work = Path(tempfile.mkdtemp(dir=self._folder))
        if drawn:
            words = [words[0], f"--picture={work / _picture}", *words[1:]]
        try:
            with open(work / "out", "wb") as out, open(work / "said", "wb") as said:
                with self._lock:
                    if self._newest.get(who) is not me:
                        raise _overtaken()
                    child = self._asked[who] = process.start(words, at, [at], work, out, said)
                try:
                    code = child.wait(_longest_s)
                except subprocess.TimeoutExpired as error:
                    _end(child)
                    raise Refusal(422, f"no answer within {_longest_s} s; slice it, which takes the time that it takes") from error
                finally:
                    with self._lock:
                        if self._asked.get(who) is child:
                            del self._asked[who]
            return self._answer(work, code, lambda: self._newest.get(who) is not me)
        finally:
            shutil.rmtree(work, ignore_errors=True)

    @staticmethod
    def _answer(work: Path, code: int, is_overtaken: Any) -> Dict[str, Any]:
        last = _last_event((work / "out").read_bytes())
        if last.get("event") == "result":
            picture = work / _picture
            return {"result": last["result"], "warnings": last["warnings"], **({"picture": picture.read_bytes()} if picture.is_file() else {})}
        if code < 0 and is_overtaken():
            raise _overtaken()
        message = last.get("message") or (work / "said").read_text(errors="replace").strip().removeprefix("voxtone: ")
        raise Refusal(422, str(message) or f"the program ended with exit code {code}")


def _overtaken() -> Refusal:
    return Refusal(409, "a newer question of yours took the place of this one")


def _end(child: "subprocess.Popen[bytes]") -> None:
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def _state_of(at: Path) -> List[Any]:
    """Of what was handed in; what is arriving, or is ours, has a hidden name."""
    found = []
    for below, _, names in os.walk(at):
        for name in names:
            if not name.startswith("."):
                told = os.lstat(os.path.join(below, name))
                found.append((os.path.relpath(os.path.join(below, name), at), told.st_mtime_ns, told.st_size))
    return sorted(found)


def _last_event(data: bytes) -> Dict[str, Any]:
    """With the warnings before it."""
    last: Optional[Dict[str, Any]] = None
    warnings: List[str] = []
    for line in data.split(b"\n"):
        try:
            event = json.loads(line)
        except ValueError:
            continue
        if isinstance(event, dict) and "event" in event:
            last = event
            if event["event"] == "warning":
                warnings.append(str(event.get("message")))
    if last is None:
        try:
            return {"event": "result", "result": json.loads(data), "warnings": []}  # `list` prints plain JSON
        except ValueError:
            return {}
    return {**last, "warnings": warnings}
