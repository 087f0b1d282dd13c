# SPDX-License-Identifier: GPL-3.0-or-later
"""A request that is not granted; JSON of strangers."""
from __future__ import annotations

import json
import math
from typing import Any, NoReturn, Union

_deepest = 32


class Refusal(Exception):
    """Ends a request: `status` is a 4xx, or 503 or 507 where it may be granted another time."""

    def __init__(self, status: int, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status
        self.sentence = sentence


def json_of(data: Union[str, bytes], where: str) -> Any:
    """As the standard has it (RFC 8259): numbers are finite; and not nested deeper than we can tell it on. Raises Refusal."""
    try:
        value = json.loads(data, parse_constant=_no_number, parse_float=_finite)
    except (ValueError, RecursionError) as error:
        raise Refusal(400, f"{where} is no JSON: {error}") from error
    level = [value]
    for _ in range(_deepest):
        level = [inner for one in level if isinstance(one, (dict, list)) for inner in (one.values() if isinstance(one, dict) else one)]
        if not level:
            return value
    raise Refusal(400, f"{where} is nested more than {_deepest} deep")


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"{text} is no number")


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _no_number(text)
