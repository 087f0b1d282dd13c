# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenAPI of the service: addresses from its table, options from the program's."""
from __future__ import annotations

from typing import Any, Dict, List

from ..options import Option
from ..program import version
from .form import shown_options


def _schema(option: Option) -> Dict[str, Any]:
    one: Dict[str, Any] = {"type": "boolean"} if option.flag else {"type": ["string", "number"]}
    if option.choices and not option.flag and not option.separator and "LIST" not in option.value:
        one = {"type": "string", "enum": list(option.choices)}
    told: Dict[str, Any] = {"oneOf": [one, {"type": "array", "items": one}]} if option.many else one
    return {**told, "description": option.help, **({"default": option.default} if option.default and not option.flag else {})}


def document(routes: List[Any]) -> Dict[str, Any]:
    options = {"type": "object", "additionalProperties": False, "properties": {o.name: _schema(o) for o in shown_options()}}
    job: Dict[str, Any] = {"type": "object", "properties": {
        "upload": {"type": "string", "description": "whose files it takes"},
        "job": {"type": "string", "description": "another job, whose files it takes"},
        "model": {"type": "string", "description": "a file of these; may be left away where there is one"},
        "parts": {"type": "array", "items": {"type": "object"}, "description": "of a tray, in the place of a model: data/schema/tray.schema.json"},
        "name": {"type": "string"}, "copies": {"type": "integer", "minimum": 1}, "held": {"type": "boolean"},
        "options": {"$ref": "#/components/schemas/Options"}}}
    estimate = {**job, "properties": {**{k: v for k, v in job["properties"].items() if k not in ("name", "copies", "held")},
                                      "full": {"type": "boolean"}, "who": {"type": "string", "description": "a newer question takes an older's place"}}}
    bodies = {"job": {"application/json": {"schema": job}}, "estimate": {"application/json": {"schema": estimate}},
              "bytes": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}}
    paths: Dict[str, Dict[str, Any]] = {}
    for route in routes:
        names = [name for name in ("id", "upload", "n") if "{" + name + "}" in route.pattern]
        entry: Dict[str, Any] = {"summary": route.what, "responses": {"200": {"description": "done"}, "4XX": {"description": "why not: {\"error\": \"...\"}"}}}
        if names:
            entry["parameters"] = [{"name": name, "in": "path", "required": True, "schema": {"type": "string"}} for name in names]
        if route.body:
            entry["requestBody"] = {"content": bodies[route.body]}
        if not route.pattern.startswith(("/page", "/plain")):
            paths.setdefault(route.pattern, {})[route.method.lower()] = entry
    return {"openapi": "3.1.0", "info": {"title": "voxtone serve", "version": version()},
            "security": [{"token": []}], "paths": paths,
            "components": {"securitySchemes": {"token": {"type": "http", "scheme": "bearer"}}, "schemas": {"Options": options}}}
