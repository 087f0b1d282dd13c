# SPDX-License-Identifier: GPL-3.0-or-later
"""A request that is not granted."""
from __future__ import annotations


class Refusal(Exception):
    """Ends a request: `status` is a 4xx, or 503 or 507 where it may be granted another time."""

    def __init__(self, status: int, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status
        self.sentence = sentence
