# SPDX-License-Identifier: GPL-3.0-or-later
"""The page for browsers without script: hand in, see how far all is, fetch results. Its forms carry a word that other pages
cannot know, beside the Origin that the door looks at."""
from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any, Dict, Iterator
from urllib.parse import parse_qsl, quote

from .door import Door
from .form import basic, shown_options
from .forms import read_form
from .refusal import Refusal
from .store import DONE, RUNNING, Job
from .upload import likely_models

if TYPE_CHECKING:
    from .shop import Shop

_actions = {"waiting": ("hold", "cancel", "up", "down"), "held": ("release", "cancel"), "running": ("hold", "cancel"),
            "failed": ("retry", "remove"), "cancelled": ("retry", "remove"), "done": ("remove",)}


def _field(option: Any) -> str:
    label = f'<label title="{escape(option.help)}">{escape(option.name)} '
    if option.choices:
        choices = "".join(f'<option{" selected" if choice == option.default else ""}>{escape(choice)}</option>' for choice in option.choices)
        return f'{label}<select name="{option.name}">{choices}</select></label>'
    return f'{label}<input name="{option.name}" placeholder="{escape(option.default)}"></label>'


def _state_text(job: Job) -> str:
    if job.state.state == RUNNING and job.progress.get("steps"):
        return f"running: {job.progress['stage']}, {job.progress.get('done', 0)} of {job.progress['steps']}"
    verdict = (job.state.verdict or {}).get("sentence", "") if job.state.state == DONE else ""
    return ": ".join(part for part in (job.state.state, job.state.message, verdict) if part)


def _row(job: Job, form: str) -> str:
    acts = "".join(f'<button name="act" value="{act} {job.id}">{act}</button>' for act in _actions[job.state.state])
    links = "".join(f' <a href="/jobs/{job.id}/{where}">{what}</a>' for what, where in (("report", "report"), ("for the printer", "printer.zip"))
                    ) if (job.out / "manifest.json").is_file() else ""
    return (f'<tr><td>{escape(str(job.what["name"]))}<td>{escape(_state_text(job))}{links}'
            f'<td><form method="post" action="/plain">{form}{acts}</form></tr>')


def plain_page(shop: "Shop", said: str) -> bytes:
    form = f'<input type="hidden" name="form" value="{shop.token.form}">'
    fields = " ".join(_field(option) for option in shown_options() if option.name in basic)
    rows = "".join(_row(job, form) for job in shop.store.all())
    paused = f'<p role="alert">{escape(shop.runner.paused)}</p>' if shop.runner.paused else ""
    told = f'<p role="alert">{escape(said[:2000])}</p>' if said else ""
    return f"""<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>voxtone</title><link rel="stylesheet" href="/page/page.css"><body class="plain"><h1>voxtone</h1>{told}{paused}
<form method="post" action="/plain" enctype="multipart/form-data">{form}
<p><label>Model, with its textures <input type="file" name="file" multiple required></label></p>
<p>{fields}</p><p><button name="act" value="slice">Slice</button></p></form>
<h2>Jobs</h2><table>{rows or "<tr><td>None yet.</tr>"}</table><p><a href="/plain">Look again</a></p></body></html>""".encode()


def take_form(shop: "Shop", door: Door) -> None:
    if door.content_type() == "application/x-www-form-urlencoded":
        data = b"".join(door.read_body(10000)).decode("utf-8", "replace")
        said = _act(shop, dict(parse_qsl(data)))
    elif door.content_type() == "multipart/form-data":
        said = _hand_in(shop, door)
    else:
        raise Refusal(415, "this address takes what the page without script sends")
    door.send_bytes(b"", "text/plain", 303, {"Location": "/plain" + (f"?said={quote(said, safe='')}" if said else "")})


def _check(shop: "Shop", fields: Dict[str, str]) -> None:
    if not shop.token.is_form(fields.get("form", "")):
        raise Refusal(403, "only the page of this service may ask for that")


def _act(shop: "Shop", fields: Dict[str, str]) -> str:
    from .routes import act  # pylint: disable=import-outside-toplevel,cyclic-import
    _check(shop, fields)
    name, _, job = fields.get("act", "").partition(" ")
    try:
        if name == "remove":
            shop.store.remove(shop.store.get(job))
        elif name in {word for words in _actions.values() for word in words}:
            act(shop, name, job)
        else:
            raise Refusal(400, "that cannot be done")
    except Refusal as refusal:
        return refusal.sentence
    return ""


def _hand_in(shop: "Shop", door: Door) -> str:
    upload = ""

    def take(name: str, data: Iterator[bytes], fields: Dict[str, str]) -> None:
        nonlocal upload
        _check(shop, fields)
        upload = upload or shop.uploads.begin()
        total = [0]

        def write(out: Any) -> None:
            for piece in data:
                total[0] += len(piece)
                if total[0] > shop.limits.file_bytes:
                    raise Refusal(413, "the file is too large")
                out.write(piece)
        shop.uploads.add(upload, name.replace("\\", "/").split("/")[-1], 0, write)

    fields = read_form(door.headers.get("Content-Type", ""), iter(door.read_body(shop.limits.upload_bytes)), take)
    _check(shop, fields)
    if not upload:
        return "no file was chosen"
    defaults = {option.name: option.default for option in shown_options()}
    options = {name: value for name, value in fields.items() if name in basic and value not in ("", defaults.get(name))}
    try:
        models = likely_models(shop.uploads.files(upload))
        for model in models:
            shop.hand_in({"upload": upload, "model": model, "options": options})
        if not models:
            return "none of the files is a model or picture that can be sliced"
    except Refusal as refusal:
        return refusal.sentence
    return ""
