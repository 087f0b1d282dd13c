# SPDX-License-Identifier: GPL-3.0-or-later
"""A `voxtone serve` from Python, with the functions of this package:

    shop = voxtone.connect("http://127.0.0.1:8750/?token=...")
    stack = shop.slice("cow.glb", size="60mm", out="out/cow").result()  # made there, fetched to out
"""
from __future__ import annotations

import http.client
import json
import os
import secrets
import shutil
import tempfile
import threading
import time
import urllib.parse
import zipfile
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Union

from .errors import Cancelled, Error, InputError, Warned, error_of
from .job import Event, Progress
from .mesh import Mesh
from .prints import Print

Model = Union[str, "os.PathLike[str]", Mesh]
_ended = ("done", "failed", "cancelled")


class Shop:
    """`files` of its functions are what a model names beside itself; a folder in the place of a model has them all."""

    def __init__(self, address: str, token: str = "") -> None:
        parts = urllib.parse.urlsplit(address)
        if parts.scheme not in ("http", "https") or not parts.netloc:
            raise ValueError(f"{address!r} is no address; give what `voxtone serve` printed")
        self._host, self._secure = parts.netloc, parts.scheme == "https"
        self._token = token or dict(urllib.parse.parse_qsl(parts.query)).get("token", "")
        self.ask("GET", "/shop")

    def _connection(self, timeout: float) -> http.client.HTTPConnection:
        kind = http.client.HTTPSConnection if self._secure else http.client.HTTPConnection
        return kind(self._host, timeout=timeout)

    def open(self, method: str, path: str, body: Any = None, headers: Optional[Dict[str, str]] = None,
             timeout: float = 300) -> Tuple[http.client.HTTPConnection, http.client.HTTPResponse]:
        """The answer, to be read. Raises InputError with the service's sentence."""
        connection = self._connection(timeout)
        try:
            connection.request(method, path, body, {"Authorization": f"Bearer {self._token}", **(headers or {})})
            answer = connection.getresponse()
            if answer.status >= 400:
                told = answer.read()
                try:
                    sentence = json.loads(told)["error"]
                except (ValueError, KeyError, TypeError):
                    sentence = f"{self._host} answered {answer.status} {answer.reason}"
                raise InputError(sentence)
        except BaseException:
            connection.close()
            raise
        return connection, answer

    def ask(self, method: str, path: str, value: Any = None, key: str = "") -> Any:
        headers = {**({"Content-Type": "application/json"} if value is not None else {}), **({"Idempotency-Key": key} if key else {})}
        body = json.dumps(value).encode() if value is not None else b"" if method == "POST" else None
        connection, answer = self.open(method, path, body, headers)
        try:
            return json.loads(answer.read())
        finally:
            connection.close()

    def upload(self, model: Model, files: Sequence["os.PathLike[str]"] = ()) -> Tuple[str, str]:
        """Hands files in; the upload, and the model's name in it."""
        if isinstance(model, Mesh):
            with tempfile.TemporaryDirectory(prefix="voxtone-") as folder:
                file = Path(folder) / "model.glb"
                model.write(file)
                return self.upload(file, files)
        given = Path(model)
        named = [(f, f.relative_to(given).as_posix()) for f in sorted(given.rglob("*")) if f.is_file()] if given.is_dir() else [(given, given.name)]
        upload = ""
        told: Dict[str, Any] = {}
        for file, name in [*named, *((Path(f), Path(f).name) for f in files)]:
            query = urllib.parse.urlencode([("name", name), *([("into", upload)] if upload else [])])
            with open(file, "rb") as data:
                length: Dict[str, str] = {"Content-Type": "application/octet-stream", "Content-Length": str(file.stat().st_size)}
                connection, answer = self.open("POST", f"/uploads?{query}", data, length)
                with answer:
                    told = json.loads(answer.read())
                connection.close()
            upload = told["upload"]
        if given.is_dir() and len(told.get("models", [])) != 1:
            raise InputError(f"{given} has {len(told.get('models', []))} models; give one's file, and the others as files")
        return upload, told["models"][0] if given.is_dir() else given.name

    def slice(self, model: Model, *, files: Sequence["os.PathLike[str]"] = (), out: Optional[Any] = None,
              progress: Optional[Progress] = None, name: str = "", **options: Any) -> "RemoteJob":
        upload, inside = self.upload(model, files)
        return self._hand_in({"upload": upload, "model": inside}, options, out, progress, name)

    def tray(self, parts: Sequence[Dict[str, Any]], *, files: Sequence["os.PathLike[str]"] = (), out: Optional[Any] = None,
             progress: Optional[Progress] = None, name: str = "", **options: Any) -> "RemoteJob":
        """`parts` as in a tray's plan; `files` are the models that they name."""
        if not files:
            raise InputError("give the models of the parts as files=[...]")
        upload, _ = self.upload(files[0], files[1:])
        return self._hand_in({"upload": upload, "parts": [dict(part) for part in parts]}, options, out, progress, name)

    def _hand_in(self, asked: Dict[str, Any], options: Dict[str, Any], out: Optional[Any], progress: Optional[Progress],
                 name: str) -> "RemoteJob":
        body: Dict[str, Any] = {**asked, "options": _by_their_names(options)}
        if name:
            body["name"] = name
        return RemoteJob(self, self.ask("POST", "/jobs", body, secrets.token_hex(16))["id"], out, progress)

    def estimate(self, model: Model, *, files: Sequence["os.PathLike[str]"] = (), quick: bool = False, **options: Any) -> Dict[str, Any]:
        upload, inside = self.upload(model, files)
        asked = {"upload": upload, "model": inside, "options": _by_their_names(options), "full": not quick}
        result: Dict[str, Any] = self.ask("POST", "/estimate", asked)["result"]
        return result

    def jobs(self) -> List[Dict[str, Any]]:
        told: List[Dict[str, Any]] = self.ask("GET", "/jobs")["jobs"]
        return told

    def job(self, job_id: str, out: Optional[Any] = None) -> "RemoteJob":
        """One that was handed in before."""
        return RemoteJob(self, job_id, out)

    def printers(self) -> List[Dict[str, Any]]:
        told: List[Dict[str, Any]] = self.ask("GET", "/printers")
        return told

    def resin_sets(self) -> List[Dict[str, Any]]:
        told: List[Dict[str, Any]] = self.ask("GET", "/resins")
        return told


def _by_their_names(options: Dict[str, Any]) -> Dict[str, Any]:
    named = {key.strip("_").replace("_", "-"): value for key, value in options.items() if value is not None}
    return {key: [str(one) for one in value] if isinstance(value, (list, tuple)) else os.fspath(value) if isinstance(value, os.PathLike) else value
            for key, value in named.items()}


class RemoteJob:
    """As a Job is: its events, `cancel()`, `result()`. It goes on when this program ends."""

    def __init__(self, shop: Shop, job_id: str, out: Optional[Any] = None, progress: Optional[Progress] = None) -> None:
        self.id = job_id
        self._shop, self._out = shop, Path(out) if out else None
        if progress:
            threading.Thread(target=self._tell, args=(progress,), daemon=True).start()

    def _tell(self, progress: Progress) -> None:
        for event in self:
            progress(event)

    def __iter__(self) -> Iterator[Event]:
        """From the first on, until it ends."""
        connection, answer = self._shop.open("GET", f"/jobs/{self.id}/events")
        kind = ""
        with answer:
            for line in answer:
                word, _, text = line.decode().strip().partition(": ")
                if word == "event":
                    kind = text
                elif word == "data":
                    if kind == "end":
                        break
                    yield json.loads(text)
        connection.close()

    @property
    def state(self) -> Dict[str, Any]:
        told: Dict[str, Any] = self._shop.ask("GET", f"/jobs/{self.id}")
        return told

    @property
    def done(self) -> bool:
        return self.state["state"] in _ended

    @property
    def warnings(self) -> List[Warned]:
        return [Warned(text) for text in self.state["warnings"]]

    @property
    def seconds_left(self) -> Optional[float]:
        return self.state["progress"].get("seconds_left")

    def cancel(self) -> None:
        self._act("cancel")

    def hold(self) -> None:
        self._act("hold")

    def release(self) -> None:
        self._act("release")

    def _act(self, act: str) -> None:
        self._shop.ask("POST", f"/jobs/{self.id}/{act}", {})

    def remove(self) -> None:
        """It and all that it made, there."""
        self._shop.ask("DELETE", f"/jobs/{self.id}")

    def wait(self, timeout: Optional[float] = None) -> bool:
        """Whether it has ended."""
        until = None if timeout is None else time.monotonic() + timeout
        while not self.done:
            if until is not None and time.monotonic() > until:
                return False
            time.sleep(0.3)
        return True

    def result(self, timeout: Optional[float] = None) -> Any:
        """The Print, fetched to `out`; without one what report.json says."""
        if not self.wait(timeout):
            raise TimeoutError(f"voxtone is at work still after {timeout} s")
        told = self.state
        if told["state"] == "cancelled":
            raise Cancelled(told["message"] or "cancelled")
        if told["state"] == "failed":
            raise error_of(told["exit_code"] or 1, told["message"])
        if self._out is None:
            return self._shop.ask("GET", f"/jobs/{self.id}/report.json")
        self._fetch(self._out)
        return Print(self._out)

    def _fetch(self, out: Path) -> None:
        if out.exists() and any(out.iterdir()):
            raise Error(f"{out} holds something already; name another folder")
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out.parent) as archive:
            connection, answer = self._shop.open("GET", f"/jobs/{self.id}/out.zip")
            with answer:
                shutil.copyfileobj(answer, archive)
            connection.close()
            zipfile.ZipFile(archive).extractall(out)


def connect(address: str, token: str = "") -> Shop:
    """The service at the address that it printed; the token stands in it, or is given."""
    return Shop(address, token)
