# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG as arrays: by Pillow where it is installed, else by zlib and numpy (not interlaced, 8 or 16 bits)."""
from __future__ import annotations

import io
import struct
import zlib
from typing import List, Optional, Tuple

import numpy as np

try:
    from PIL import Image  # type: ignore[import]
except ImportError:  # slower in filters that few layers have
    Image = None  # type: ignore[assignment]

_signature = b"\x89PNG\r\n\x1a\n"


def read_png(path: str, shape: Optional[Tuple[int, int]] = None) -> np.ndarray:
    """uint8 [row, column, channel]; the first row is the top one. With `shape` (rows, columns) no other is unpacked."""
    with open(path, "rb") as file:
        return read_png_bytes(file.read(), str(path), shape)


def read_png_bytes(data: bytes, name: str, shape: Optional[Tuple[int, int]] = None) -> np.ndarray:
    """As read_png, of what the file holds. Raises ValueError for what is no PNG."""
    if shape and len(data) >= 24:
        columns, rows = struct.unpack_from(">II", data, 16)
        if data.startswith(_signature) and (rows, columns) != tuple(shape):
            raise ValueError(f"{name}: is {columns} x {rows} px, and its manifest says {shape[1]} x {shape[0]}")
    if Image is None or data[24:25] != b"\x08":
        return decode_png(data, name)
    if data.startswith(_signature):
        _chunks(data, name)  # Pillow takes a last part that is cut off
    try:
        with Image.open(io.BytesIO(data)) as picture:
            mode = "RGBA" if "A" in picture.getbands() or "transparency" in picture.info else "RGB"
            return np.asarray(picture.convert(mode))
    except (OSError, SyntaxError) as error:  # Pillow's words for a file that it cannot read
        raise ValueError(f"{name}: is no PNG that can be read ({error})") from error


def decode_png(data: bytes, name: str = "PNG") -> np.ndarray:
    if not data.startswith(_signature):
        raise ValueError(f"{name}: is no PNG")
    header, palette, compressed = b"", None, []
    for kind, body in _chunks(data, name):
        if kind == b"IHDR":
            header = body
        elif kind == b"PLTE":
            palette = np.frombuffer(body, np.uint8).reshape(-1, 3)
        elif kind == b"IDAT":
            compressed.append(body)
    if len(header) != 13:
        raise ValueError(f"{name}: has no header")
    width, height, bits, colour, _, _, interlaced = struct.unpack(">IIBBBBB", header)
    if bits not in (8, 16) or interlaced or colour not in (0, 2, 3, 4, 6):
        raise ValueError(f"{name}: {bits} bits, colour type {colour}{', interlaced' if interlaced else ''}; "
                         "install Pillow to read it")
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    pixel = channels * bits // 8
    try:
        raw = zlib.decompressobj().decompress(b"".join(compressed), height * (width * pixel + 1) + 1)
    except zlib.error as error:
        raise ValueError(f"{name}: {error}") from error
    if len(raw) != height * (width * pixel + 1):
        raise ValueError(f"{name}: holds {len(raw)} bytes of pixels, which are not {width} x {height}")
    rows = _unfiltered(raw, height, width * pixel, pixel)
    if bits == 16:
        rows = rows[:, ::2]  # the upper byte of each value
    pixels = rows.reshape(height, width, channels)
    if colour == 3:
        if palette is None:
            raise ValueError(f"{name}: has no palette")
        return palette[pixels[:, :, 0]]
    if colour in (0, 4):
        return np.concatenate([np.repeat(pixels[:, :, :1], 3, 2), pixels[:, :, 1:]], 2)
    return pixels


def _chunks(data: bytes, name: str) -> List[Tuple[bytes, bytes]]:
    found, at = [], len(_signature)
    while at + 12 <= len(data):
        size = struct.unpack_from(">I", data, at)[0]
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        check = data[at + 8 + size:at + 12 + size]
        if len(check) < 4 or zlib.crc32(kind + body) != struct.unpack(">I", check)[0]:
            raise ValueError(f"{name}: is cut off or damaged in its part {kind.decode('latin-1')}")
        found.append((kind, body))
        at += 12 + size
        if kind == b"IEND":
            return found
    raise ValueError(f"{name}: is cut off")


def _unfiltered(raw: bytes, height: int, stride: int, pixel: int) -> np.ndarray:
    """The filters of PNG (ISO/IEC 15948, 9.2), row by row."""
    lines = np.frombuffer(raw, np.uint8).reshape(height, stride + 1)
    rows = np.zeros((height + 1, stride), np.uint8)
    for y in range(height):
        kind, line, above = lines[y, 0], lines[y, 1:], rows[y]
        if kind == 0:
            rows[y + 1] = line
        elif kind == 1:
            rows[y + 1] = np.cumsum(line.reshape(-1, pixel), axis=0, dtype=np.uint8).reshape(-1)
        elif kind == 2:
            rows[y + 1] = line + above
        else:
            rows[y + 1] = _by_pixels(bytes(line), bytes(above), pixel, kind == 4)
    return rows[1:]


def _by_pixels(line: bytes, above: bytes, pixel: int, paeth: bool) -> np.ndarray:
    out = bytearray(line)
    for i, value in enumerate(line):
        a = out[i - pixel] if i >= pixel else 0
        b = above[i]
        if paeth:
            c = above[i - pixel] if i >= pixel else 0
            p = a + b - c
            pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
            out[i] = (value + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        else:
            out[i] = (value + (a + b) // 2) & 255
    return np.frombuffer(bytes(out), np.uint8)


def encode_png(pixels: np.ndarray) -> bytes:
    """Of uint8 [row, column, 3 or 4]."""
    pixels = np.ascontiguousarray(pixels)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or 0 in pixels.shape:
        raise ValueError(f"a picture is uint8 [row, column, 3 or 4]; this is {pixels.dtype} {pixels.shape}")
    height, width, channels = pixels.shape
    raw = np.zeros((height, 1 + width * channels), np.uint8)
    raw[:, 1:] = pixels.reshape(height, -1)

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    return (_signature + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw.tobytes(), 6))
            + chunk(b"IEND", b""))
