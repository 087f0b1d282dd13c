# SPDX-License-Identifier: GPL-3.0-or-later
"""A service of its own for a test: started, killed, started again; and a client that says what it wants byte by byte."""
from __future__ import annotations

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import voxtone

#: A box is sliced in half a second.
draft = {"quality": "draft", "report": True}


#: The service with other limits, so that nobody waits for its own: {"head_s": 3}.
_with_limits = """import functools, json, sys
from voxtone.serve import __main__ as service
service.Limits = functools.partial(service.Limits, **json.loads(sys.argv.pop(1)))
sys.exit(service.main())"""


class Served:
    def __init__(self, folder: Path, *options: str, limits: Optional[Dict[str, float]] = None) -> None:
        self.folder, self.options = folder, options
        self.code = ["-c", _with_limits, json.dumps(limits)] if limits else ["-m", "voxtone.serve"]
        self.port = 0
        self.start()

    def start(self) -> None:
        words = [sys.executable, *self.code, "--folder", str(self.folder), "--port", str(self.port), "--no-browser", *self.options]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            raise RuntimeError(self.process.stderr.read())
        self.port = int(self.address.split(":")[2].split("/")[0])
        self.token = self.address.partition("token=")[2]

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self._end()

    def stop(self) -> int:
        self.process.send_signal(signal.SIGTERM)
        return self._end()

    def _end(self) -> int:
        code = self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()
        return code

    def kill_jobs(self) -> None:
        """As a power cut would; the service is dead already."""
        for lock in self.folder.glob("jobs/*/running.lock"):
            pid, _, began = lock.read_text().strip().partition(" ")
            if pid and voxtone_walls().start_time(int(pid)) == began:
                os.killpg(int(pid), signal.SIGKILL)

    def request(self, method: str, path: str, body: Optional[bytes] = None, headers: Optional[Dict[str, str]] = None,
                token: bool = True) -> Tuple[int, bytes, Any]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=180)
        try:
            said = {**({"Authorization": f"Bearer {self.token}"} if token else {}), **(headers or {})}
            connection.request(method, path, body, said)
            answer = connection.getresponse()
            return answer.status, answer.read(), answer.headers
        finally:
            connection.close()

    def ask(self, method: str, path: str, value: Any = None, **headers: str) -> Any:
        body = None if value is None else json.dumps(value).encode()
        more = {"Content-Type": "application/json", **{name.replace("_", "-"): text for name, text in headers.items()}}
        status, data, _ = self.request(method, path, body, more)
        if status >= 400:
            raise AssertionError(f"{method} {path}: {status} {data[:500]!r}")
        return json.loads(data)

    def upload(self, *files: Path) -> str:
        upload = ""
        for file in files:
            told = self.request("POST", f"/uploads?name={file.name}" + (f"&into={upload}" if upload else ""), file.read_bytes(),
                                {"Content-Type": "application/octet-stream"})
            assert told[0] == 200, told
            upload = json.loads(told[1])["upload"]
        return upload

    def uploads_of(self, upload: str) -> Path:
        """The one file of it."""
        return next((self.folder / "uploads" / upload).iterdir())

    def wait_for(self, job: str, *states: str, seconds: float = 180) -> Dict[str, Any]:
        until = time.monotonic() + seconds
        while True:
            told = self.ask("GET", f"/jobs/{job}")
            if told["state"] in states:
                return told
            assert time.monotonic() < until and told["state"] not in {"failed"} - set(states), told
            time.sleep(0.05)

    def raw(self, data: bytes, seconds: float = 200) -> bytes:
        """All that is answered until the end."""
        with socket.create_connection(("127.0.0.1", self.port), seconds) as connection:
            try:
                connection.sendall(data)
            except OSError:
                pass
            answer = b""
            try:
                while True:
                    piece = connection.recv(1 << 16)
                    if not piece:
                        return answer
                    answer += piece
            except (ConnectionError, socket.timeout):
                return answer


def voxtone_walls() -> Any:
    from voxtone.serve import walls
    return walls


def write_box(file: Path, size: Tuple[float, float, float] = (6, 3, 1.5)) -> Path:
    from conftest import box
    mesh = box(size)
    mesh.colours = [[0.6 * (i & 1), 0.5 * (i >> 1 & 1), 0.6 * (i >> 2 & 1)] for i in range(8)]
    mesh.write(file)
    return file


def bits(out: Path) -> str:
    """Of the stack."""
    return json.loads((out / "manifest.json").read_text())["content_sha256"]


def console_bits(model: Path, out: Path, **options: Any) -> str:
    voxtone.slice(model, out=out, **options).result()
    return bits(out)
