# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as arrays, to and from the files that the program reads and writes (GLB; PLY of predictions)."""
from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np

from .png import encode_png


def srgb_to_linear(codes: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, of codes 0 to 255."""
    v = np.asarray(codes, float) / 255
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(values: np.ndarray) -> np.ndarray:
    """The codes of linear values, uint8."""
    v = np.clip(values, 0, 1)
    return np.round(255 * np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)).astype(np.uint8)


@dataclass
class Mesh:
    """Triangles with colours of vertices, or with a texture. z is up, lengths are in mm.

    vertices  (n, 3) mm
    faces     (m, 3) indices, counter-clockwise from outside
    colours   (n, 3): floats are linear sRGB in [0, 1], uint8 are sRGB codes
    uv        (n, 2) of vertices or (m, 3, 2) of corners; (0, 0) is the lower left of the texture
    texture   uint8 (rows, columns, 3 or 4), sRGB codes, the top row first
    errors    (n, channels) standard errors of what a prediction by Monte Carlo says, one a channel of its resins
    """
    vertices: np.ndarray
    faces: np.ndarray
    colours: Optional[np.ndarray] = None
    uv: Optional[np.ndarray] = None
    texture: Optional[np.ndarray] = None
    errors: Optional[np.ndarray] = None

    def __post_init__(self) -> None:
        self.vertices = np.asarray(self.vertices, float)
        self.faces = np.asarray(self.faces)
        n = len(self.vertices)
        _check(self.vertices.ndim == 2 and self.vertices.shape[1:] == (3,) and n > 0, "vertices", "(n, 3)", self.vertices)
        _check(bool(np.isfinite(self.vertices).all()), "vertices", "finite", self.vertices)
        _check(self.faces.ndim == 2 and self.faces.shape[1:] == (3,) and len(self.faces) > 0
               and np.issubdtype(self.faces.dtype, np.integer), "faces", "integers (m, 3)", self.faces)
        if self.faces.min() < 0 or self.faces.max() >= n:
            raise ValueError(f"faces: index {self.faces.max() if self.faces.max() >= n else self.faces.min()} "
                             f"is none of {n} vertices; they are counted from 0")
        if self.colours is not None:
            self.colours = np.asarray(self.colours)
            if self.colours.dtype == np.uint8:
                self.colours = srgb_to_linear(self.colours)
            _check(self.colours.shape == (n, 3), "colours", f"({n}, 3), one a vertex", self.colours)
        if self.uv is not None:
            self.uv = np.asarray(self.uv, float)
            _check(self.uv.shape in ((n, 2), (len(self.faces), 3, 2)), "uv",
                   f"({n}, 2) of vertices or ({len(self.faces)}, 3, 2) of corners", self.uv)
        if (self.uv is None) != (self.texture is None):
            raise ValueError("uv and texture belong together; give both or neither")

    def write(self, path: Union[str, "PathLike[str]"]) -> None:
        """As GLB, whose y is up and whose unit is the metre."""
        mesh = self._with_corners_apart()
        x, y, z = (mesh.vertices / 1000).T
        arrays: List[Tuple[np.ndarray, str]] = [(np.stack([x, z, -y], 1).astype(np.float32), "VEC3")]
        attributes = {"POSITION": 0}
        if mesh.colours is not None:
            attributes["COLOR_0"] = len(arrays)
            arrays.append((np.clip(mesh.colours, 0, 1).astype(np.float32), "VEC3"))
        material: Dict[str, Any] = {"pbrMetallicRoughness": {"metallicFactor": 0}}
        images: List[bytes] = []
        if mesh.uv is not None and mesh.texture is not None:
            attributes["TEXCOORD_0"] = len(arrays)
            arrays.append((np.stack([mesh.uv[:, 0], 1 - mesh.uv[:, 1]], 1).astype(np.float32), "VEC2"))
            material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
            images.append(encode_png(np.asarray(mesh.texture)))
        arrays.append((mesh.faces.astype(np.uint32).reshape(-1), "SCALAR"))
        Path(path).write_bytes(_glb(arrays, attributes, material, images))

    def _with_corners_apart(self) -> "Mesh":
        """One vertex for each corner where corners have coordinates of their own."""
        if self.uv is None or self.uv.ndim == 2:
            return self
        at = self.faces.reshape(-1)
        return Mesh(self.vertices[at], np.arange(len(at)).reshape(-1, 3),
                    None if self.colours is None else self.colours[at], self.uv.reshape(-1, 2), self.texture)


def _check(good: bool, what: str, wanted: str, got: np.ndarray) -> None:
    if not good:
        raise ValueError(f"{what}: want {wanted}; these are {got.dtype} {got.shape}")


def _glb(arrays: List[Tuple[np.ndarray, str]], attributes: Dict[str, int], material: Dict[str, Any],
         images: List[bytes]) -> bytes:
    body, views, accessors = b"", [], []
    for values, shape in arrays:
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": values.nbytes})
        accessors.append({"bufferView": len(views) - 1, "count": len(values), "type": shape,
                          "componentType": 5126 if values.dtype == np.float32 else 5125})
        if shape == "VEC3":
            accessors[-1].update(min=values.min(0).tolist(), max=values.max(0).tolist())
        body += values.tobytes()
    told: Dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "voxtone (Python)"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "materials": [material], "accessors": accessors,
        "meshes": [{"primitives": [{"attributes": attributes, "indices": len(arrays) - 1, "material": 0}]}]}
    for image in images:
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(image)})
        told.update(images=[{"bufferView": len(views) - 1, "mimeType": "image/png"}], textures=[{"source": 0}])
        body += image + b"\0" * (-len(image) % 4)
    told.update(bufferViews=views, buffers=[{"byteLength": len(body)}])
    text = json.dumps(told, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body)) + struct.pack("<I4s", len(text), b"JSON") + text
            + struct.pack("<I4s", len(body), b"BIN\0") + body)


_types: Dict[int, Any] = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read_mesh(path: Union[str, "PathLike[str]"]) -> Mesh:
    """A GLB or PLY that voxtone wrote (one mesh, colours of vertices), or that Mesh.write wrote without its texture."""
    data = Path(path).read_bytes()
    if data.startswith(b"ply"):
        return _read_ply(data, str(path))
    if data[:4] != b"glTF" or len(data) < 28:
        raise ValueError(f"{path}: is no GLB and no PLY; meshes of other formats go to voxtone.slice as files")
    size = struct.unpack_from("<I", data, 12)[0]
    told, body = json.loads(data[20:20 + size]), data[28 + size:]

    def values(index: int) -> np.ndarray:
        accessor = told["accessors"][index]
        view = told["bufferViews"][accessor["bufferView"]]
        kind, width = _types[accessor["componentType"]], _widths[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        array = np.frombuffer(body, kind, accessor["count"] * width, start).reshape(-1, width)
        return array / np.iinfo(kind).max if accessor.get("normalized") else array

    part = told["meshes"][0]["primitives"][0]
    x, y, z = values(part["attributes"]["POSITION"]).astype(float).T * 1000
    colours = part["attributes"].get("COLOR_0")
    return Mesh(np.stack([x, -z, y], 1), values(part["indices"]).reshape(-1, 3).astype(np.int64),
                None if colours is None else np.asarray(values(colours)[:, :3], float))


def _read_ply(data: bytes, name: str) -> Mesh:
    """Binary, little-endian: vertices of numbers, then faces as lists of three indices."""
    end = data.find(b"end_header\n")
    header = data[:end].decode("ascii", "replace").split("\n")
    if end < 0 or "format binary_little_endian 1.0" not in header:
        raise ValueError(f"{name}: is no binary PLY as voxtone predict writes it")
    kinds = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "uint": "<u4", "int": "<i4"}
    counts, fields, element = {}, [], ""
    for line in header:
        words = line.split()
        if words[:1] == ["element"]:
            element = words[1]
            counts[element] = int(words[2])
        elif words[:1] == ["property"] and element == "vertex":
            fields.append((words[2], kinds[words[1]]))
    start = end + len(b"end_header\n")
    vertex = np.frombuffer(data, np.dtype(fields), counts["vertex"], start)
    face = np.frombuffer(data, np.dtype([("n", "u1"), ("at", "<u4", 3)]), counts["face"], start + vertex.nbytes)

    def columns(*names: str) -> Optional[np.ndarray]:
        return np.stack([vertex[n] for n in names], 1) if set(names) <= set(vertex.dtype.names or ()) else None

    positions = columns("x", "y", "z")
    if positions is None or (face["n"] != 3).any():
        raise ValueError(f"{name}: has no positions, or faces that are no triangles")
    errors = [n for n in vertex.dtype.names or () if n.startswith("error_")]
    return Mesh(positions, face["at"].astype(np.int64), columns("red", "green", "blue"),
                errors=columns(*errors) if errors else None)
