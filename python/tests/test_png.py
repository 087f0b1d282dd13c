# SPDX-License-Identifier: GPL-3.0-or-later
import struct
import zlib

import numpy as np
import pytest

from voxtone.png import decode_png, encode_png, read_png_bytes


def filtered(pixels, kinds):
    """A PNG whose rows have these filters, by their definition, byte by byte."""
    height, width, channels = pixels.shape
    rows, raw = pixels.reshape(height, -1).astype(int), b""
    for y in range(height):
        kind, line = kinds[y % len(kinds)], bytearray()
        for i, value in enumerate(rows[y]):
            a = rows[y][i - channels] if i >= channels else 0
            b = rows[y - 1][i] if y else 0
            c = rows[y - 1][i - channels] if y and i >= channels else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line.append((value - [0, a, b, (a + b) // 2, paeth][kind]) % 256)
        raw += bytes([kind]) + bytes(line)
    whole = encode_png(pixels)
    at = whole.index(b"IDAT") - 4
    body = zlib.compress(raw)
    chunk = struct.pack(">I", len(body)) + b"IDAT" + body + struct.pack(">I", zlib.crc32(b"IDAT" + body))
    return whole[:at] + chunk + whole[-12:]


@pytest.mark.parametrize("kinds", [(0,), (1,), (2,), (3,), (4,), (4, 0, 3, 1, 2)])
@pytest.mark.parametrize("channels", [3, 4])
def test_every_filter_is_undone(kinds, channels):
    pixels = np.random.default_rng(7).integers(0, 256, (9, 11, channels), dtype=np.uint8)
    assert (decode_png(filtered(pixels, kinds)) == pixels).all()


def test_a_second_opinion():
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
    import io
    pixels = np.random.default_rng(8).integers(0, 256, (20, 13, 4), dtype=np.uint8)
    assert (np.asarray(image.open(io.BytesIO(encode_png(pixels)))) == pixels).all()
    for mode in ("L", "LA", "RGB", "P"):
        file = io.BytesIO()
        image.fromarray(pixels, "RGBA").convert(mode).save(file, "PNG")
        seen = np.asarray(image.open(file).convert("RGBA" if mode == "LA" else "RGB"))
        assert (decode_png(file.getvalue()) == seen).all(), mode


def test_cut_off_at_every_byte():
    whole = encode_png(np.zeros((3, 4, 3), np.uint8))
    for size in range(len(whole)):
        with pytest.raises(ValueError):
            decode_png(whole[:size])
        with pytest.raises(ValueError, match="a.png"):
            read_png_bytes(whole[:size], "a.png")
    with pytest.raises(ValueError, match="damaged"):
        decode_png(whole.replace(b"IDATx", b"IDATy"))
    with pytest.raises(ValueError, match="uint8"):
        encode_png(np.zeros((3, 4)))
