# SPDX-License-Identifier: GPL-3.0-or-later
"""A stack of layers that voxtone made, as arrays."""
from __future__ import annotations

import functools
import json
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from .errors import FileError, InputError
from .gcvf import Container
from .mesh import Mesh, read_mesh
from .png import read_png, read_png_bytes

if TYPE_CHECKING:
    from .job import Job

Window = Sequence[Union[slice, range, int]]


class Print:
    """The output folder of `voxtone slice` or `tray`, or a GCVF, ours or anyone's, which has layers alone.

    Arrays are indexed as the bitmaps are: [layer, row, column], layer 0 at the bottom, columns along +x, rows along -y;
    a value is a resin of `resins`, counted from 1, and 0 is nothing."""

    def __init__(self, path: Union[str, "PathLike[str]"], result: Optional[Dict[str, Any]] = None) -> None:
        self.path = Path(path)
        self._result = result
        self._container = Container(self.path) if self.path.is_file() else None
        if self._container:
            self.manifest: Dict[str, Any] = self._container.manifest
            return
        file = self.path / "manifest.json"
        try:
            self.manifest = json.loads(file.read_text(encoding="utf-8"))
        except OSError as error:
            raise FileError(f"{file}: {error.strerror}; a stack has its manifest only when it is whole") from error
        except ValueError as error:
            raise InputError(f"{file}: is no JSON ({error}); make the stack again") from error
        if not isinstance(self.manifest, dict) or self.manifest.get("format") != "voxtone-layers":
            raise InputError(f"{file}: is no manifest of a stack of layers; voxtone.slice writes one")

    def __repr__(self) -> str:
        return f"<voxtone print {self.path}, {' x '.join(map(str, self.shape))} voxels>"

    @property
    def shape(self) -> Tuple[int, int, int]:
        """Layers, rows, columns."""
        width, height = self.manifest["size_px"]
        return self.manifest["layers"], height, width

    @property
    def pitch_mm(self) -> Tuple[float, float, float]:
        """Along layers, rows, columns."""
        x, y, z = self.manifest["pitch_um"]
        return z / 1000, y / 1000, x / 1000

    @property
    def resins(self) -> List[Dict[str, Any]]:
        """Value m of an array is resins[m - 1]."""
        return self.manifest["resins"]

    def layer(self, index: int) -> np.ndarray:
        """uint8 [row, column]."""
        count = self.manifest["layers"]
        if not -count <= index < count:
            raise IndexError(f"layer {index} of {count}")
        name, pixels = self._pixels(index % count)
        return self._resins_of(pixels, name)

    def _pixels(self, index: int) -> Tuple[str, np.ndarray]:
        try:
            if self._container:
                name = f"{self.path}: {self._container.layer_name(index)}"
                return name, read_png_bytes(self._container.layer(index), name, self.shape[1:])
            file = self.path / (self.manifest["pattern"] % (self.manifest["first_layer"] + index))
            return str(file), read_png(str(file), self.shape[1:])
        except OSError as error:
            raise FileError(f"{error.filename}: {error.strerror}; the stack is not whole: voxtone.verify names what is wrong"
                            ) from error
        except ValueError as error:
            raise InputError(f"{error}; voxtone.verify names what is wrong with the stack") from error

    def _resins_of(self, pixels: np.ndarray, name: str) -> np.ndarray:
        codes = pixels[:, :, 0].astype(np.uint32) << 16 | pixels[:, :, 1].astype(np.uint32) << 8 | pixels[:, :, 2]
        solid = codes != _code(self.manifest["background_rgb"])
        if pixels.shape[2] == 4:
            solid &= pixels[:, :, 3] > 0
        layer = np.zeros(codes.shape, np.uint8)
        for index, resin in enumerate(self.resins):
            layer[solid & (codes == _code(resin["rgb"]))] = index + 1
        if (solid & (layer == 0)).any():
            row, column = np.argwhere(solid & (layer == 0))[0]
            raise InputError(f"{name}: pixel ({column}, {row}) has the colour {tuple(pixels[row, column, :3].tolist())}, "
                             "which is no resin's of the manifest")
        return layer

    def volume(self, window: Optional[Window] = None) -> np.ndarray:
        """uint8 [layer, row, column] of a window: up to three slices, ranges or numbers, `np.s_[100:200, :, 50]`.
        All of it without one: see `shape` for how many bytes that is."""
        parts = list(window) if isinstance(window, (tuple, list)) else [] if window is None else [window]
        if len(parts) > 3:
            raise IndexError(f"a window is layers, rows, columns; {len(parts)} were given")
        kept = [slice(part.start, part.stop, part.step) if isinstance(part, range) else part for part in parts]
        kept += [slice(None)] * (3 - len(kept))
        if isinstance(kept[0], slice):
            layers = range(*kept[0].indices(self.shape[0]))
            if not layers:
                return np.zeros((0, *self.shape[1:]), np.uint8)[(slice(None), *kept[1:])]
            return np.stack([self.layer(i)[tuple(kept[1:])] for i in layers])
        return self.layer(kept[0])[tuple(kept[1:])]

    @functools.cached_property
    def report(self) -> Dict[str, Any]:
        """report.json: size, resins, warnings, times."""
        if self._result is not None and self._result.get("format") == "voxtone-report":
            return self._result
        file = self._file("report.json")
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except OSError as error:
            raise FileError(f"{file}: {error.strerror}; slice the stack again, which writes it") from error

    @property
    def verdict(self) -> Optional[Dict[str, Any]]:
        """Will it look as asked: level, sentence, seen_de2000; nothing where nobody looked."""
        return self.report.get("verdict")

    @property
    def predicted(self) -> Union[Mesh, np.ndarray]:
        """What the job saw of the print: of a body a Mesh with colours (linear sRGB), of a picture uint8 [row, column,
        3], sRGB codes. `predict()` looks again, and better; errors are of what it writes as PLY by Monte Carlo alone."""
        return self._seen("predicted")

    @property
    def target(self) -> Union[Mesh, np.ndarray]:
        """What was asked for, in the same form."""
        return self._seen("target")

    @property
    def pictures(self) -> Dict[str, Tuple[str, bytes]]:
        """Of the report's first view: "target", "predicted" -> (its media type, its bytes)."""
        found = {name: ("image/webp", file.read_bytes()) for name, file in
                 (("target", self._file("preview-target.webp")), ("predicted", self._file("preview.webp"))) if file.exists()}
        if not found:
            raise FileError(f"{self.path}: the job left no preview.webp; report=False leaves it out")
        return found

    def _file(self, name: str) -> Path:
        """Beside the layers of a folder."""
        if self._container:
            raise FileError(f"{self.path}: a GCVF has layers and no {name}; open the folder of its stack, or let "
                            "voxtone.predict look at it")
        return self.path / name

    def _seen(self, name: str) -> Union[Mesh, np.ndarray]:
        if self._file(f"{name}.glb").exists():
            return read_mesh(self._file(f"{name}.glb"))
        if self._file(f"{name}.png").exists():
            return read_png(str(self._file(f"{name}.png")))[:, :, :3]
        raise FileError(f"{self.path}: the job made no {name}.glb or {name}.png; voxtone.predict makes a prediction, and "
                        "report=False, quality='draft' or size leave it out")

    def verify(self, **options: Any) -> "Job":
        from .verbs import verify
        return verify(self, **options)

    def predict(self, out: Any, **options: Any) -> "Job":
        from .verbs import predict
        return predict(self, out=out, **options)

    def proof(self, out: Any, **options: Any) -> "Job":
        from .verbs import proof
        return proof(self, out=out, **options)


def _code(rgb: Sequence[int]) -> int:
    return rgb[0] << 16 | rgb[1] << 8 | rgb[2]


def open_print(path: Union[str, "PathLike[str]"]) -> Print:
    """The stack in this folder, or in this GCVF. Raises FileError where there is none."""
    return Print(path)
