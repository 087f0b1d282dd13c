# SPDX-License-Identifier: GPL-3.0-or-later
"""multipart/form-data, as browsers without script send files: read as it comes, each file straight to where it goes."""
from __future__ import annotations

import re
from typing import Callable, Dict, Iterator, Optional, Tuple

from .refusal import Refusal

_longest_head = 8192
_longest_field = 8192
_most_parts = 200


class _Stream:
    def __init__(self, pieces: Iterator[bytes]) -> None:
        self._pieces, self._kept = pieces, b""

    def _more(self) -> bool:
        data = next(self._pieces, b"")
        self._kept += data
        return bool(data)

    def until(self, mark: bytes, most: int) -> bytes:
        while mark not in self._kept:
            if len(self._kept) > most or not self._more():
                raise Refusal(400, "the form is cut short, or too long")
        data, _, self._kept = self._kept.partition(mark)
        return data

    def pieces_until(self, mark: bytes) -> Iterator[bytes]:
        while True:
            at = self._kept.find(mark)
            if at >= 0:
                data, self._kept = self._kept[:at], self._kept[at + len(mark):]
                if data:
                    yield data
                return
            sure = len(self._kept) - len(mark)
            if sure > 0:
                yield self._kept[:sure]
                self._kept = self._kept[sure:]
            if not self._more():
                raise Refusal(400, "the form is cut short")

    def take(self, count: int) -> bytes:
        while len(self._kept) < count and self._more():
            pass
        data, self._kept = self._kept[:count], self._kept[count:]
        return data


def _names(head: bytes) -> Tuple[str, Optional[str]]:
    text = head.decode("utf-8", "replace")
    field = re.search(r'(?i)content-disposition:[^\r\n]*?;\s*name="([^"\r\n]*)"', text)
    file = re.search(r'(?i)content-disposition:[^\r\n]*?;\s*filename="([^"\r\n]*)"', text)
    if not field:
        raise Refusal(400, "a part of the form has no name")
    return field[1], file[1].replace("%22", '"') if file else None


def read_form(content_type: str, pieces: Iterator[bytes], take: Callable[[str, Iterator[bytes], Dict[str, str]], None]) -> Dict[str, str]:
    """The fields; `take` is given each file: its name, its bytes, and the fields before it."""
    boundary = re.search(r'(?i)boundary="?([0-9A-Za-z\'()+_,./:=?-]{1,70})"?', content_type)
    if not boundary:
        raise Refusal(400, "the form says no boundary")
    stream, mark = _Stream(pieces), b"--" + boundary[1].encode()
    fields: Dict[str, str] = {}
    stream.until(mark, _longest_head)
    for _ in range(_most_parts):
        if stream.take(2) == b"--":
            return fields
        name, file = _names(stream.until(b"\r\n\r\n", _longest_head))
        data = stream.pieces_until(b"\r\n" + mark)
        if file is None:
            value = b""
            for piece in data:
                value += piece
                if len(value) > _longest_field:
                    raise Refusal(413, f"the field {name[:40]!r} is too long")
            fields[name] = value.decode("utf-8", "replace")
        elif file:
            take(file, data, fields)
        else:
            for _ in data:
                pass
    raise Refusal(413, f"the form has more than {_most_parts} parts")
