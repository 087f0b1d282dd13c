# SPDX-License-Identifier: GPL-3.0-or-later
"""A GCVF, the container that the printer's software takes, as a manifest and layers."""
from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path
from typing import Any, Callable, Dict, List
from xml.etree import ElementTree

from .errors import FileError, InputError


_small = 1 << 20  # bytes of a ConfigFile.xml, and what a PNG has besides pixels


class Container:
    """`manifest` has the keys of a stack's that the container knows: resins have no role there."""

    def __init__(self, file: Path) -> None:
        self._name = str(file)
        try:
            self._zip = zipfile.ZipFile(file)
        except OSError as error:
            raise FileError(f"{file}: {error.strerror}; open a stack's folder, or its .gcvf") from error
        except zipfile.BadZipFile as error:
            raise InputError(f"{file}: is no GCVF, which is a ZIP archive ({error}); open a stack's folder, or its .gcvf"
                             ) from error
        try:
            self.manifest = self._manifest_of(ElementTree.fromstring(self._read("ConfigFile.xml")))
        except ElementTree.ParseError as error:
            raise InputError(f"{file}: its ConfigFile.xml is no XML ({error}); make the container again") from error

    def layer(self, index: int) -> bytes:
        """The PNG of a layer, counted from 0."""
        columns, rows = self.manifest["size_px"]
        return self._read(self.layer_name(index), rows * (8 * columns + 1) + _small)  # no more than uncompressed

    def layer_name(self, index: int) -> str:
        return f"{self._prefix}{self.manifest['first_layer'] + index}.png"

    def _read(self, entry: str, most: int = _small) -> bytes:
        try:
            if self._zip.getinfo(entry).file_size > most:
                raise InputError(f"{self._name}: its {entry} says that it is {self._zip.getinfo(entry).file_size} bytes long, "
                                 f"where {most} are the most that it can be; make the container again")
            return self._zip.read(entry)
        except KeyError as error:
            raise InputError(f"{self._name}: has no {entry}; voxtone.verify names all that is wrong") from error
        except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError) as error:
            raise InputError(f"{self._name}: its {entry} cannot be read ({error}); make the container again") from error

    def _manifest_of(self, root: ElementTree.Element) -> Dict[str, Any]:
        def value(parent: ElementTree.Element, name: str, of: Callable[[str], Any]) -> Any:
            found = parent.find(f".//{name}")
            try:
                if found is not None:
                    return of((found.text or "").strip())
            except ValueError:
                pass
            raise InputError(f"{self._name}: its ConfigFile.xml has no {name} that could be read; make the container again")

        self._prefix = value(root, "ImageFilePrefix", str)
        return {
            "pitch_um": [25400 / value(root, "XDpi", _positive), 25400 / value(root, "YDpi", _positive),
                         value(root, "SliceThicknessNanoMeter", _positive) / 1000],
            "size_px": [value(root, "SliceWidth", _count), value(root, "SliceHeight", _count)],
            "layers": value(root, "NumberOfSlices", _count), "first_layer": value(root, "StartIndex", int),
            "background_rgb": value(root, "BackGroundMaterialRGBA", _rgb),
            "resins": [{"name": value(one, "Name", str), "rgb": value(one, "RGBA", _rgb), "voxels": value(one, "VoxelCount", int)}
                       for one in root.iter("Material")]}


def _positive(text: str) -> float:
    number = float(text)
    if not 0 < number < 1e9:
        raise ValueError(text)
    return number


def _count(text: str) -> int:
    if not 0 < int(text) < 10**6:
        raise ValueError(text)
    return int(text)


def _rgb(text: str) -> List[int]:
    if not re.fullmatch(r"\d{1,3}( \d{1,3}){3}", text):
        raise ValueError(text)
    return [int(word) for word in text.split()[:3]]
