# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be said of a job, from the program's one table of options: the form, the check of what comes back, the words of
the command. There is no second list of options; only what the service decides itself is named."""
from __future__ import annotations

import hashlib
import json
import re
import shlex
import unicodedata
from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence

from ..options import Command, Option, option_table
from .files import checked_path, write_json
from .limits import Limits
from .refusal import Refusal, json_of

#: Where results go, how much of the machine a job has, how the program talks, what only a cluster wants.
decided_here = frozenset({"model", "out", "for-printer", "overwrite", "report", "resume", "keep-loop", "mixtures", "job", "dump-default", "json",
                          "progress", "quiet", "threads", "shard", "until", "fail-fast", "quick", "orientations"})
#: Shown first; all others behind "more".
basic = ("printer", "resins", "size", "unit", "width", "thickness", "quality", "label")
_part_words = frozenset({"model", "name", "copies", "at", "turn", "priority", "cuts", "box", "cylinder", "resin", "mixture"})
_longest_value = 4000
_most_values = 200
#: Leads out of the job's folder, alone or behind a mark of the option's own ("font=/x", "@../x").
_leads_out = re.compile(r"(?:^|[=:,;@\s])(?:/|~|\.\.(?:/|$))|/\.\.(?:/|$)")
PLAN = "tray.json"


def shown_options(verb: str = "slice") -> List[Option]:
    return [option for option in option_table()[verb].options if option.name not in decided_here]


def form() -> Dict[str, Any]:
    """For the page: groups in the order of --help."""
    groups: Dict[str, List[Dict[str, Any]]] = {}
    for option in shown_options():
        groups.setdefault(option.group, []).append({
            "name": option.name, "value": option.value, "default": option.default, "choices": list(option.choices),
            "flag": option.flag, "many": option.many, "separator": option.separator, "rare": option.rare, "help": option.help, "leaves": option.leaves,
            "basic": option.name in basic})
    return {"groups": [{"name": name, "options": options} for name, options in groups.items()], "basic": list(basic),
            "reads": [option.name for option in read_options()]}


def read_options() -> List[Option]:
    """Those that say how a file is read, and so what is seen of it before it is sliced."""
    shown = {option.name for option in shown_options()}
    return [option for option in option_table()["read"].options if option.name in shown]


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _texts(key)
            yield from _texts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _texts(inner)
    elif not isinstance(value, (int, float)):
        raise Refusal(400, "options are texts, numbers, true, false, or lists of them")


def _check_texts(name: str, value: Any) -> None:
    for text in _texts(value):
        if len(text) > _longest_value:
            raise Refusal(400, f"{name}: more than {_longest_value} characters; say it shorter")
        if any(unicodedata.category(c) in ("Cc", "Cs") for c in text):
            raise Refusal(400, f"{name}: has control characters; leave them out")
        if _leads_out.search(text):
            raise Refusal(400, f"{name}: {text[:80]!r} names a place outside of the job, whose files are what was handed in; hand "
                               "the file in with the model, and give its name")


def _one_or_many(option: Option, value: Any) -> Any:
    values = value if isinstance(value, list) else [value]
    if len(values) > _most_values:
        raise Refusal(400, f"{option.name}: more than {_most_values} values")
    if isinstance(value, list) and not option.many and not option.separator:
        raise Refusal(400, f"{option.name}: takes one value, and got a list")
    if any(isinstance(one, (list, dict)) for one in values):
        raise Refusal(400, f"{option.name}: takes texts and numbers")
    return value


def checked_options(options: Any, verb: str = "slice") -> Dict[str, Any]:
    """By their names, without what is at its default by saying nothing. Values are the program's to judge."""
    if not isinstance(options, dict):
        raise Refusal(400, "\"options\" is an object of names and values, as in a job file")
    command = option_table()[verb]
    checked: Dict[str, Any] = {}
    for name, value in options.items():
        if value is None or value == "" or value == []:
            continue
        option = _option(command, str(name))
        _check_texts(option.name, value)
        _one_or_many(option, value)
        try:
            option.words(value)
        except TypeError as error:
            raise Refusal(400, str(error)) from error
        checked[option.name] = value
    return checked


def checked_read_options(text: str) -> Dict[str, Any]:
    """From an address: an object in JSON; of it what reading takes."""
    said = json_of(text or "{}", "what is said of options")
    taken = {option.name for option in read_options()}
    return {name: value for name, value in checked_options(said).items() if name in taken}


def _option(command: Command, name: str) -> Option:
    try:
        option = command.option(name)
    except TypeError as error:
        raise Refusal(400, str(error)) from error
    if option.name in decided_here:
        raise Refusal(400, f"{option.name} is decided by the service; leave it out")
    return option


def checked_model(name: Any, files: Sequence[str]) -> str:
    """A file of the upload, or one in an archive of it ("a.zip/b.obj")."""
    if not isinstance(name, str):
        raise Refusal(400, "\"model\" is the name of a file that was handed in")
    checked_path(name)
    if name not in files and not any(name.startswith(f"{file}/") and file.lower().endswith(".zip") for file in files):
        raise Refusal(400, f"{name[:80]!r} was not handed in; its upload has {', '.join(files[:5]) or 'no files'}")
    return name


def checked_parts(parts: Any, files: Sequence[str], limits: Limits) -> List[Dict[str, Any]]:
    """Of a tray (data/schema/tray.schema.json)."""
    if not isinstance(parts, list) or not parts or not all(isinstance(part, dict) for part in parts):
        raise Refusal(400, "\"parts\" is a list of objects, one a part, as in a tray's plan")
    if len(parts) > limits.parts:
        raise Refusal(400, f"{len(parts)} parts, and a tray has {limits.parts} at most; copies of one part count once")
    checked = []
    for part in parts:
        words = {key: value for key, value in part.items() if key in _part_words or re.fullmatch(r"\{.+\}", key)}
        for key, value in words.items():
            _check_texts(key, value)
        if "model" in words:
            checked_model(words["model"], files)
        checked.append({**words, **checked_options({key: value for key, value in part.items() if key not in words})})
    return checked


def option_words(options: Dict[str, Any], verb: str = "slice") -> List[str]:
    command = option_table()[verb]
    return [word for name, value in options.items() for word in command.option(name).words(value)]


def _plan_of(what: Dict[str, Any]) -> Dict[str, Any]:
    return {"format": "voxtone-tray", "version": 1, "parts": what["parts"]}


def words_of(what: Dict[str, Any], at: Path, plan: str = "") -> List[str]:
    """Options and model. A tray's plan is written into the folder of its models, for it names them from there; without a
    name it has one of its own, hidden."""
    words = option_words(what["options"], what["verb"])
    if what["verb"] != "tray":
        return [*words, "--", what["model"]]
    text = _plan_of(what)
    plan = plan or f".tray-{hashlib.sha256(json.dumps(text).encode()).hexdigest()[:16]}.json"
    write_json(at / plan, text, lasting=False)
    return [*words, "--", plan]


def command_of(what: Dict[str, Any], at: Path, out: Path, threads: int, more: Sequence[str] = ()) -> List[str]:
    kept = ["--keep-loop"] if _has_loop(what) else []
    run = ["--json", f"--out={out}", *kept, *more, *([f"--threads={threads}"] if threads else [])]
    return [what["verb"], *run, *words_of(what, at, PLAN)]


def _has_loop(what: Dict[str, Any]) -> bool:
    """Whether one may be run: what it comes to stays with the job, for when it is changed (again.py)."""
    said = {**what["options"]}
    iterations = said.get("iterations", 0 if said.get("quality") == "draft" else "auto")
    return what["verb"] == "slice" and str(iterations) != "0" and said.get("show", "colour") == "colour"


def shell_line(what: Dict[str, Any]) -> str:
    """That does the same at the console, where the files are."""
    name = what.get("model") or PLAN
    plan = [shlex.join(["printf", "%s", json.dumps(_plan_of(what))]) + f" >{PLAN}"] if what["verb"] == "tray" else []
    out = "out/" + Path(name).stem
    return "\n".join([*plan, shlex.join(["voxtone", what["verb"], name, *option_words(what["options"], what["verb"]), "-o", out])])


def options_of_job_file(text: bytes) -> Dict[str, Any]:
    """Of a job file (data/schema/job.schema.json): its model by its last name, and what of it may be said here."""
    told = json_of(text, "the job file")
    if not isinstance(told, dict) or told.get("format") != "voxtone-job":
        raise Refusal(400, "this is no job file: \"format\" is not \"voxtone-job\"")
    names = {option.name for option in option_table()["slice"].options}
    known = {key: value for key, value in told.items() if key in names and key not in decided_here}
    defaults = {option.name: option.default for option in shown_options()}
    options = {key: value for key, value in known.items() if value not in ("", [], None) and _as_text(value) != defaults.get(key)}
    left = sorted(set(told) - set(known) - {"format", "version", "inputs", "model"} - decided_here)
    return {"model": Path(str(told.get("model", ""))).name, "options": options, "left_out": left}


def _as_text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)
