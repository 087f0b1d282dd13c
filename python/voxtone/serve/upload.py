# SPDX-License-Identifier: GPL-3.0-or-later
"""What is handed in: a folder of files for each upload, under limits, which jobs take as links."""
from __future__ import annotations

import os
import re
import secrets
import shutil
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, List

from .files import checked_path
from .limits import Limits, bytes_text, want_room
from .refusal import Refusal

is_id = re.compile(r"[0-9a-f]{32}\Z").match
#: What is offered as a model among the files of an upload; what it is, the program finds out.
model_kinds = (".obj", ".ply", ".stl", ".glb", ".gltf", ".3mf", ".fbx", ".wrl", ".vrml", ".wrz", ".zip", ".png", ".jpg", ".jpeg",
               ".webp", ".tif", ".tiff", ".exr", ".bmp", ".svg", ".gcvf")
_pictures = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".exr", ".bmp", ".svg")


def new_id() -> str:
    return secrets.token_hex(16)


class Uploads:
    def __init__(self, folder: Path, limits: Limits) -> None:
        self.folder, self._limits = folder, limits
        self._lock = threading.Lock()
        folder.mkdir(exist_ok=True)

    def begin(self) -> str:
        with self._lock:
            self._sweep()
            if sum(1 for _ in self.folder.iterdir()) >= self._limits.uploads:
                raise Refusal(429, f"{self._limits.uploads} uploads wait to be used already; slice them, or wait: unused ones go "
                                   f"after {self._limits.upload_hours:g} h")
            upload = new_id()
            (self.folder / upload).mkdir()
            return upload

    def path(self, upload: str) -> Path:
        folder = self.folder / upload
        if not is_id(upload) or not folder.is_dir():
            raise Refusal(404, "there is no such upload; unused ones go after "
                               f"{self._limits.upload_hours:g} h: hand the files in again")
        return folder

    def add(self, upload: str, name: str, size: int, write: Callable[[Any], None]) -> Path:
        """`write` is given the open file. A file is there whole or not at all."""
        folder, name = self.path(upload), checked_path(name)
        self._check_room(folder, name, size)
        target = folder / name
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            beside = target.with_name(f".{secrets.token_hex(8)}.part")
            try:
                with open(beside, "xb") as out:
                    write(out)
                os.replace(beside, target)
            finally:
                beside.unlink(missing_ok=True)
        except (NotADirectoryError, FileExistsError, IsADirectoryError) as error:
            raise Refusal(409, f"{name[:80]!r} is a file and a folder at once in this upload; begin a new one") from error
        os.utime(folder)
        return target

    def _check_room(self, folder: Path, name: str, size: int) -> None:
        if size > self._limits.file_bytes:
            raise Refusal(413, f"{name[:80]!r} has {bytes_text(size)}, and files of up to {bytes_text(self._limits.file_bytes)} are "
                               "taken; slice it at the console")
        there = [os.lstat(os.path.join(below, file)).st_size for below, _, names in os.walk(folder) for file in names]
        if len(there) >= self._limits.upload_files:
            raise Refusal(413, f"an upload has {self._limits.upload_files} files at most; hand in what one model needs")
        if sum(there) + size > self._limits.upload_bytes:
            raise Refusal(413, f"an upload has {bytes_text(self._limits.upload_bytes)} at most; hand in what one model needs")
        want_room(folder, size, self._limits)

    def files(self, upload: str) -> List[Dict[str, Any]]:
        """By name, without those that are arriving."""
        return files_of(self.path(upload))

    def _sweep(self) -> None:
        for folder in self.folder.iterdir():
            try:
                if time.time() - folder.stat().st_mtime > self._limits.upload_hours * 3600:
                    shutil.rmtree(folder, ignore_errors=True)
            except OSError:
                continue


def files_of(root: Path) -> List[Dict[str, Any]]:
    found: List[Dict[str, Any]] = []
    for below, folders, names in os.walk(root):
        folders.sort()
        for name in names:
            if not name.startswith("."):
                path = Path(below) / name
                found.append({"name": path.relative_to(root).as_posix(), "bytes": path.lstat().st_size,
                              "model": name.lower().endswith(model_kinds), "picture": name.lower().endswith(_pictures)})
    return sorted(found, key=lambda file: str(file["name"]))


def likely_models(files: List[Dict[str, Any]]) -> List[str]:
    """Which of the files are meant: meshes and archives where there are any, whose textures the pictures then are."""
    models = [file for file in files if file["model"]]
    bodies = [file for file in models if not file["picture"]]
    return [file["name"] for file in bodies or models]
