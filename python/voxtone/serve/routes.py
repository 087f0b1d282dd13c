# SPDX-License-Identifier: GPL-3.0-or-later
"""What there is behind the door: one function for each address, in one table that the OpenAPI is made from, too."""
from __future__ import annotations

import json
import re
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List

from ..options import option_table
from . import pages
from .door import Door
from .downloads import file_name, send_file, send_zip
from .form import checked_model, checked_read_options, form, option_words, options_of_job_file, shell_line
from .openapi import document
from .refusal import Refusal
from .shop import Shop
from .upload import files_of, is_id, likely_models

_page = Path(__file__).parent / "page"
_page_files = {"page.css": "text/css", "plate.js": "text/javascript", "form.js": "text/javascript", "page.js": "text/javascript", "new.js": "text/javascript",
               "queue.js": "text/javascript", "result.js": "text/javascript", "tools.js": "text/javascript", "icon.svg": "image/svg+xml"}
_pictures = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".webp": "image/webp"}
_is_key = re.compile(r"[A-Za-z0-9_-]{8,80}\Z").match
_breath_s = 20  #: between two signs of life of a stream


@dataclass(frozen=True)
class Route:
    method: str
    pattern: str  #: "{id}" is a job, "{upload}" an upload, "{n}" a number
    what: str
    do: Callable[..., None]
    body: str = ""  #: of the OpenAPI: "job", "estimate", "bytes"

    @property
    def matcher(self) -> "re.Pattern[str]":
        inner = re.escape(self.pattern).replace(r"\{id\}", "(?P<id>[0-9a-f]{32})").replace(r"\{upload\}", "(?P<upload>[0-9a-f]{32})")
        return re.compile(inner.replace(r"\{n\}", "(?P<n>[0-9]{1,6})").replace(r"\{file\}", r"(?P<file>[a-z.]{1,20})") + r"\Z")


class Routes:
    def __init__(self, shop: Shop) -> None:
        self._shop = shop
        self.table: List[Route] = [
            Route("GET", "/", "the page", self._index),
            Route("GET", "/plain", "the page without script", self._plain),
            Route("POST", "/plain", "what the page without script sends", self._plain_form),
            Route("GET", "/page/{file}", "a file of the page", self._page_file),
            Route("GET", "/shop", "whether the queue stands, and why; what is kept", self._state),
            Route("GET", "/options", "the options of a job, for a form", self._options),
            Route("GET", "/openapi.json", "this list", self._openapi),
            Route("GET", "/printers", "printers", self._list("printers")),
            Route("GET", "/resins", "resin sets", self._list("resins")),
            Route("POST", "/uploads", "hand in a file: raw bytes, ?name=cow.obj; &into=UPLOAD adds it to others", self._upload, "bytes"),
            Route("GET", "/uploads/{upload}", "its files, and which are models", self._uploaded),
            Route("GET", "/uploads/{upload}/picture", "a picture that was handed in, ?name=", self._uploaded_picture),
            Route("GET", "/uploads/{upload}/read", "what a file holds, ?name=; &options= as a job has them, in JSON", self._read),
            Route("GET", "/uploads/{upload}/look", "the same as a picture from three sides", self._look),
            Route("GET", "/uploads/{upload}/job-file", "the options of a job file that was handed in, ?name=", self._job_file),
            Route("POST", "/estimate", "what a job will take; \"full\" asks for each resin, too", self._estimate, "estimate"),
            Route("GET", "/jobs", "all jobs, in the order of the queue", self._jobs),
            Route("POST", "/jobs", "hand in a job; with the head Idempotency-Key it is one, however often it is sent", self._hand_in, "job"),
            Route("GET", "/events", "changes of all jobs, as server-sent events", self._all_events),
            Route("GET", "/jobs/{id}", "one job", self._job),
            Route("DELETE", "/jobs/{id}", "remove it and all that it made", self._remove),
            *(Route("POST", f"/jobs/{{id}}/{name}", what, self._act(name)) for name, what in _acts.items()),
            Route("GET", "/jobs/{id}/events", "the program's own events, from the first on, until it ends", self._events),
            Route("GET", "/jobs/{id}/files", "what was handed in for it", self._job_files),
            Route("GET", "/jobs/{id}/read", "what a file of it holds, ?name=&options=", self._read),
            Route("GET", "/jobs/{id}/look", "the same as a picture from three sides", self._look),
            Route("GET", "/jobs/{id}/report", "report.html", self._made("report.html", "text/html; charset=utf-8")),
            Route("GET", "/jobs/{id}/report.json", "report.json", self._made("report.json", "application/json")),
            Route("GET", "/jobs/{id}/manifest.json", "manifest.json", self._made("manifest.json", "application/json")),
            Route("GET", "/jobs/{id}/tray.png", "a tray from above", self._made("tray.png", "image/png")),
            Route("GET", "/jobs/{id}/tray.json", "where the parts of a tray lie", self._made("tray.json", "application/json")),
            Route("GET", "/jobs/{id}/printer.zip", "what the printer's computer takes", self._zip("printer")),
            Route("GET", "/jobs/{id}/out.zip", "all that it made", self._zip("")),
            Route("GET", "/jobs/{id}/layers/{n}.png", "a layer", self._layer),
            Route("GET", "/jobs/{id}/log", "what the program said", self._log)]
        self._matchers = [(route, route.matcher) for route in self.table]

    def answer(self, door: Door, method: str, path: str, query: Dict[str, str]) -> None:
        others = False
        for route, matcher in self._matchers:
            found = matcher.match(path)
            if found and route.method == method:
                route.do(door, query, **found.groupdict())
                return
            others = others or bool(found)
        raise Refusal(405 if others else 404, "that cannot be done there" if others else "there is nothing of that name")

    # The page.

    def _index(self, door: Door, query: Dict[str, str]) -> None:
        door.send_bytes((_page / "index.html").read_bytes(), "text/html; charset=utf-8")

    def _plain(self, door: Door, query: Dict[str, str]) -> None:
        door.send_bytes(pages.plain_page(self._shop, query.get("said", "")), "text/html; charset=utf-8")

    def _plain_form(self, door: Door, query: Dict[str, str]) -> None:
        pages.take_form(self._shop, door)

    def _page_file(self, door: Door, query: Dict[str, str], file: str) -> None:
        kind = _page_files.get(file)
        if kind is None:
            raise Refusal(404, "there is nothing of that name")
        door.send_bytes((_page / file).read_bytes(), kind + "; charset=utf-8", more={"Cache-Control": "no-cache"})

    def _state(self, door: Door, query: Dict[str, str]) -> None:
        door.send_json(self._shop.state())

    def _options(self, door: Door, query: Dict[str, str]) -> None:
        door.send_json(form())

    def _openapi(self, door: Door, query: Dict[str, str]) -> None:
        door.send_json(document(self.table))

    def _list(self, what: str) -> Callable[..., None]:
        def do(door: Door, query: Dict[str, str]) -> None:
            door.send_json(self._shop.asking.ask(["list", what, "--json"], self._shop.asking.nowhere, what)["result"])
        return do

    # Files.

    def _upload(self, door: Door, query: Dict[str, str]) -> None:
        if door.content_type() in ("application/x-www-form-urlencoded", "multipart/form-data", "text/plain"):
            raise Refusal(415, "send the bytes of one file as they are, with Content-Type: application/octet-stream")
        name = query.get("name", "")
        upload = query.get("into") or self._shop.uploads.begin()
        def write(out: Any) -> None:
            for piece in door.read_body(self._shop.limits.file_bytes):
                out.write(piece)
        self._shop.uploads.add(upload, name, door.body_left, write)
        self._tell_upload(door, upload)

    def _tell_upload(self, door: Door, upload: str) -> None:
        files = self._shop.uploads.files(upload)
        door.send_json({"upload": upload, "files": files, "models": likely_models(files)})

    def _uploaded(self, door: Door, query: Dict[str, str], upload: str) -> None:
        self._tell_upload(door, upload)

    def _file_of(self, upload: str, query: Dict[str, str]) -> str:
        name = query.get("name", "")
        if name not in [file["name"] for file in self._shop.uploads.files(upload)]:
            raise Refusal(404, "that file was not handed in")
        return name

    def _uploaded_picture(self, door: Door, query: Dict[str, str], upload: str) -> None:
        name = self._file_of(upload, query)
        kind = _pictures.get(Path(name).suffix.lower())
        if kind is None:
            raise Refusal(404, "that is no picture that a browser shows")
        send_file(door, self._shop.uploads.path(upload), name, kind)

    def _contents(self, query: Dict[str, str], of: Dict[str, str]) -> Dict[str, Any]:
        """What is read of a file, and its picture: one run tells both."""
        at = self._shop.uploads.path(of["upload"]) if "upload" in of else self._shop.store.get(of["id"]).input
        name = checked_model(query.get("name"), [str(file["name"]) for file in files_of(at)])
        options = checked_read_options(query.get("options", ""))
        who = f"read {at.parent.name}/{at.name} {name}"
        return self._shop.asking.ask(["read", "--json", *option_words(options, "read"), "--", name], at, who, drawn=True)

    def _read(self, door: Door, query: Dict[str, str], **of: str) -> None:
        told = self._contents(query, of)
        door.send_json({"result": told["result"], "warnings": told["warnings"], "has_picture": "picture" in told})

    def _look(self, door: Door, query: Dict[str, str], **of: str) -> None:
        told = self._contents(query, of)
        if "picture" not in told:
            raise Refusal(404, told["result"]["files"][0].get("error") or "there is no picture of it")
        door.send_bytes(told["picture"], "image/png")

    def _job_file(self, door: Door, query: Dict[str, str], upload: str) -> None:
        file = self._shop.uploads.path(upload) / self._file_of(upload, query)
        if file.stat().st_size > self._shop.limits.text_bytes:
            raise Refusal(413, "a job file is not that large")
        door.send_json(options_of_job_file(file.read_bytes()))

    def _estimate(self, door: Door, query: Dict[str, str]) -> None:
        asked = door.json_body()
        door.send_json(self._shop.estimate(asked, str(asked.get("who") or asked.get("upload"))[:80]))

    # Jobs.

    def _told(self, job: Any) -> Dict[str, Any]:
        return {**job.summary(), "command": shell_line(job.what)}

    def _jobs(self, door: Door, query: Dict[str, str]) -> None:
        number = self._shop.news.last
        door.send_json({"jobs": [self._told(job) for job in self._shop.store.all()], "revision": number, **self._shop.state()})

    def _hand_in(self, door: Door, query: Dict[str, str]) -> None:
        key = door.headers.get("Idempotency-Key", "")
        if key and not _is_key(key):
            raise Refusal(400, "Idempotency-Key has 8 to 80 letters, digits, - or _")
        jobs = self._shop.hand_in(door.json_body(), key)
        door.send_json({"id": jobs[0].id, "jobs": [self._told(job) for job in jobs]}, 202)

    def _job(self, door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
        door.send_json(self._told(self._shop.store.get(id)))

    def _job_files(self, door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
        files = files_of(self._shop.store.get(id).input)
        door.send_json({"job": id, "files": files, "models": likely_models(files)})

    def _remove(self, door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
        self._shop.store.remove(self._shop.store.get(id))
        door.send_json({"removed": id})

    def _act(self, name: str) -> Callable[..., None]:
        def do(door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
            if door.body_left:
                door.json_body()
            act(self._shop, name, id)
            door.send_json(self._told(self._shop.store.get(id)))
        return do

    # Results.

    def _made(self, name: str, kind: str) -> Callable[..., None]:
        def do(door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
            send_file(door, self._shop.store.get(id).out, name, kind)
        return do

    def _zip(self, below: str) -> Callable[..., None]:
        def do(door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
            job = self._shop.store.get(id)
            if not (job.out / "manifest.json").is_file():
                raise Refusal(404, "there is no whole stack yet")
            send_zip(door, job.out / below if below else job.out, Path(str(job.what["name"])).stem + ("-printer" if below else ""))
        return do

    def _layer(self, door: Door, query: Dict[str, str], id: str, n: str) -> None:  # pylint: disable=redefined-builtin
        send_file(door, self._shop.store.get(id).out, f"layers/slice_{int(n):05d}.png", "image/png")

    def _log(self, door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
        job = self._shop.store.get(id)
        send_file(door, job.folder, "events.jsonl", "text/plain; charset=utf-8", file_name(str(job.what["name"]), ".jsonl"))

    # Streams.

    def _watch(self, door: Door, stream: Callable[[], None]) -> None:
        watchers = door.server.connections.watchers
        if not watchers.acquire(blocking=False):
            raise Refusal(429, "too many watch already; close some pages")
        try:
            door.begin_answer(200, "text/event-stream", None, {"X-Accel-Buffering": "no"})
            if door.command != "HEAD":
                stream()
        finally:
            watchers.release()

    def _all_events(self, door: Door, query: Dict[str, str]) -> None:
        said = door.headers.get("Last-Event-ID") or query.get("since") or "0"
        since = int(said) if re.fullmatch(r"[0-9]{1,15}", said) else 0

        def stream() -> None:
            at = since
            while True:
                news = self._shop.news.wait(at, _breath_s)
                if news is None:
                    return
                at, changed = news
                door.wfile.write(b"".join(self._event(what, at) for what in changed) or b": still here\n\n")
                time.sleep(0.1)  # several changes are one
        self._watch(door, stream)

    def _event(self, what: str, number: int) -> bytes:
        if what == "shop":
            return _sse("shop", self._shop.state(), number)
        try:
            return _sse("job", self._told(self._shop.store.get(what)), number)
        except Refusal:
            return _sse("gone", {"id": what}, number)

    def _events(self, door: Door, query: Dict[str, str], id: str) -> None:  # pylint: disable=redefined-builtin
        job = self._shop.store.get(id)

        def stream() -> None:
            at, rest, number = 0, b"", self._shop.news.last
            while True:
                ended = job.state.state not in ("waiting", "held", "running") or not self._shop.store.is_there(job)
                if job.events.is_file():
                    with open(job.events, "rb") as file:
                        file.seek(at)
                        data = file.read()
                    at += len(data)
                    *lines, rest = (rest + data).split(b"\n")
                    door.wfile.write(b"".join(b"data: " + line + b"\n\n" for line in lines if line))
                if ended:
                    door.wfile.write(_sse("end", self._told(job) if self._shop.store.is_there(job) else {"id": job.id}))
                    return
                news = self._shop.news.wait(number, _breath_s)
                if news is None:
                    return
                number = news[0]
                if not news[1]:
                    door.wfile.write(b": still here\n\n")
        self._watch(door, stream)


def _sse(kind: str, value: Any, number: int = 0) -> bytes:
    head = f"id: {number}\n" if number else ""
    return f"{head}event: {kind}\ndata: {json.dumps(value, separators=(',', ':'))}\n\n".encode()


_acts = {"hold": "keep it from running; what runs saves itself", "release": "let it run", "cancel": "end it",
         "retry": "run what failed or was cancelled again", "up": "before the one that it waits for", "down": "behind the next one",
         "keep": "never remove it by age or size", "unkeep": "as all others"}


def act(shop: Shop, name: str, job_id: str) -> None:
    job = shop.store.get(job_id)
    if name in ("up", "down"):
        shop.store.swap(job, name == "up")
    elif name in ("keep", "unkeep"):
        shop.store.change(job, kept=name == "keep", leaves=0)
    else:
        getattr(shop.runner, name)(job)
