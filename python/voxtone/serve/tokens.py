# SPDX-License-Identifier: GPL-3.0-or-later
"""The one secret: 128 random bits in the address that the service prints, then a cookie made of them."""
from __future__ import annotations

import hashlib
import hmac
import os
import secrets
from pathlib import Path


class Token:
    def __init__(self, file: Path) -> None:
        """The shop's own, so that addresses hold after a restart. Remove the file to shut everybody out."""
        try:
            made = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(made, "w", encoding="ascii") as out:
                out.write(secrets.token_hex(16) + "\n")
        except FileExistsError:
            os.chmod(file, 0o600)
        self.text = file.read_text(encoding="ascii").strip()
        if len(self.text) < 32:
            raise ValueError(f"{file} holds no token of 128 bits; remove it, and a new one is made")

    def is_token(self, said: str) -> bool:
        return hmac.compare_digest(said.encode(), self.text.encode())

    def _derived(self, use: str) -> str:
        return hmac.new(self.text.encode(), use.encode(), hashlib.sha256).hexdigest()[:32]

    @property
    def cookie(self) -> str:
        return self._derived("cookie")

    def is_cookie(self, said: str) -> bool:
        return hmac.compare_digest(said.encode(), self.cookie.encode())

    @property
    def form(self) -> str:
        """In the forms that pages without script send."""
        return self._derived("form")

    def is_form(self, said: str) -> bool:
        return hmac.compare_digest(said.encode(), self.form.encode())
