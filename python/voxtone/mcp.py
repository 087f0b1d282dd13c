# SPDX-License-Identifier: GPL-3.0-or-later
"""voxtone-mcp: the Model Context Protocol (2024-11-05) over stdin and stdout, one JSON-RPC message a line. What its tools
take comes from the program's table of options."""
from __future__ import annotations

import base64
import json
import re
import sys
from pathlib import Path
from typing import Any, Callable, Dict, List, TextIO, Tuple

from . import verbs
from .errors import Error
from .job import Job
from .options import Option, option_table, run_by_package
from .prints import Print
from .program import version

Content = List[Dict[str, Any]]
_versions = ("2024-11-05", "2025-03-26", "2025-06-18")


def _property(option: Option) -> Dict[str, Any]:
    one: Dict[str, Any] = {"type": "boolean"} if option.flag else {"type": ["string", "number"]}
    if option.choices and not option.flag:
        one = {"type": "string", "enum": list(option.choices)} if "LIST" not in option.value else {"type": "string"}
    told = {"type": "array", "items": one} if option.many else one
    return {**told, "description": option.help}


def _schema_of(verb: str, required: Tuple[str, ...]) -> Dict[str, Any]:
    options = [o for o in option_table()[verb].options if o.name not in run_by_package]
    return {"type": "object", "properties": {o.keyword: _property(o) for o in options}, "required": list(required),
            "additionalProperties": False}


def _text(value: Any) -> Content:
    return [{"type": "text", "text": value if isinstance(value, str) else json.dumps(value, indent=1)}]


def _folder_schema(what: str) -> Dict[str, Any]:
    return {"type": "object", "properties": {"out": {"type": "string", "description": what}}, "required": ["out"]}


class Server:
    """Jobs go on between calls: `slice` starts one, `status` tells of it, `cancel` ends it."""

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._jobs: Dict[str, Job] = {}
        self._tools: Dict[str, Tuple[Callable[[Dict[str, Any]], Content], str, Callable[[], Dict[str, Any]]]] = {
            "list": (self._list, "The printers and resin sets that voxtone knows",
                     lambda: {"type": "object", "properties": {}}),
            "estimate": (self._estimate, "What slicing would take: size, layers, resins, time, memory, disk",
                         lambda: _schema_of("estimate", ("model",))),
            "slice": (self._slice, "Start slicing a model or picture into a printable stack; `status` tells how far it is",
                      lambda: _schema_of("slice", ("model", "out"))),
            "status": (self._status, "How far a job is that `slice` started, and how it ended",
                       lambda: _folder_schema("the folder that the job was given")),
            "cancel": (self._cancel, "Stop a job", lambda: _folder_schema("the folder that the job was given")),
            "verdict": (self._verdict, "Will the print of a stack look as asked, and why not",
                        lambda: _folder_schema("folder of a stack")),
            "picture": (self._picture, "Pictures of the report: what was asked for, what the print will look like",
                        lambda: _folder_schema("folder of a stack")),
        }

    def answer(self, line: str) -> None:
        try:
            message = json.loads(line)
        except ValueError as error:
            self._say({"id": None, "error": {"code": -32700, "message": f"no JSON: {error}"}})
            return
        if not isinstance(message, dict) or not isinstance(message.get("method"), str):
            self._say({"id": None, "error": {"code": -32600, "message": "no request: it has no method"}})
            return
        if "id" not in message:
            return  # a notification
        params = message.get("params") or {}
        if not isinstance(params, dict) or not isinstance(params.get("arguments") or {}, dict):
            self._say({"id": message["id"], "error": {"code": -32602, "message": "params and their arguments are objects"}})
            return
        try:
            self._say({"id": message["id"], "result": self._result(message["method"], params)})
        except LookupError as error:
            self._say({"id": message["id"], "error": {"code": -32601, "message": str(error.args[0])}})
        except Error as error:
            self._say({"id": message["id"], "error": {"code": -32603, "message": str(error)}})

    def _result(self, method: str, params: Dict[str, Any]) -> Dict[str, Any]:
        if method == "initialize":
            asked = params.get("protocolVersion")
            return {"protocolVersion": asked if asked in _versions else _versions[0], "capabilities": {"tools": {}},
                    "serverInfo": {"name": "voxtone", "version": version().split()[1]}}
        if method == "ping":
            return {}
        if method == "tools/list":
            return {"tools": [{"name": name, "description": help_, "inputSchema": schema()}
                              for name, (_, help_, schema) in self._tools.items()]}
        if method != "tools/call":
            raise LookupError(f"{method} is not known here; initialize, ping, tools/list and tools/call are")
        name = params.get("name")
        if not isinstance(name, str) or name not in self._tools:
            raise LookupError(f"there is no tool {name!r}; there are {', '.join(self._tools)}")
        try:
            return {"content": self._tools[name][0](params.get("arguments") or {}), "isError": False}
        except (Error, TypeError, ValueError, OSError, KeyError) as error:
            return {"content": _text(str(error)), "isError": True}

    def _say(self, message: Dict[str, Any]) -> None:
        self._out.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self._out.flush()

    def _list(self, _: Dict[str, Any]) -> Content:
        return _text({"printers": verbs.printers(), "resin_sets": verbs.resin_sets()})

    def _estimate(self, arguments: Dict[str, Any]) -> Content:
        return _text(verbs.estimate(**arguments).result())

    def _slice(self, arguments: Dict[str, Any]) -> Content:
        out = str(Path(arguments["out"]).resolve())
        if out in self._jobs and not self._jobs[out].done:
            raise ValueError(f"{out}: a job is at work there; ask for its status, or cancel it")
        self._jobs[out] = verbs.slice(**arguments)
        return _text({"started": out})

    def _job(self, arguments: Dict[str, Any]) -> Job:
        out = str(Path(arguments["out"]).resolve())
        if out not in self._jobs:
            raise ValueError(f"{out}: no job was started there by this server; `verdict` reads a stack that is there")
        return self._jobs[out]

    def _status(self, arguments: Dict[str, Any]) -> Content:
        job = self._job(arguments)
        told: Dict[str, Any] = {"done": job.done, "seconds_left": job.seconds_left, "warnings": job.warnings}
        steps = [event for event in job.events if event["event"] in ("progress", "stage")]
        if steps and not job.done:
            told["stage"] = {key: steps[-1].get(key) for key in ("stage", "done", "steps", "seconds")}
        if job.done:
            try:
                job.result()
                told["ended"] = "well"
            except Error as error:
                told.update(ended="badly", exit_code=error.exit_code, message=str(error))
        return _text(told)

    def _cancel(self, arguments: Dict[str, Any]) -> Content:
        self._job(arguments).cancel()
        return _text("asked to stop")

    def _verdict(self, arguments: Dict[str, Any]) -> Content:
        stack = Print(arguments["out"])
        report = stack.report
        return _text({"verdict": stack.verdict, "warnings": report.get("warnings"), "size_mm": report.get("size_mm"),
                      "layers": report.get("layers"), "resins": report.get("resins")})

    def _picture(self, arguments: Dict[str, Any]) -> Content:
        content: Content = []
        for name, (kind, data) in Print(arguments["out"]).pictures.items():
            content += [{"type": "text", "text": name},
                        {"type": "image", "data": base64.b64encode(data).decode(), "mimeType": kind}]
        return content


def main() -> int:
    server = Server(sys.stdout)
    for line in sys.stdin:
        if re.search(r"\S", line):
            server.answer(line)
    for job in server._jobs.values():
        job.cancel()
    return 0


if __name__ == "__main__":
    sys.exit(main())
