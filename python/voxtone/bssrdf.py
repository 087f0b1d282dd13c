# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured heterogeneous scattering as arrays, to the files that `laminate factor` reads (docs/bssrdf.md)."""
from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Optional, Sequence, Tuple, Union

import numpy as np

_MOST_TOTAL = 1.0
_MOST_SIDE, _MOST_RADIUS = 4096, 64
_NAMED = {"rgb": ["R", "G", "B"], "luminance": ["luminance"]}
# One channel that is seen as grey: its weights to XYZ are those of D50 (ASTM E308), as the program has it.
_LUMINANCE = {"kind": "own", "illuminant": "D50", "xyz": [[0.96422, 1.0, 0.82521]]}


def half_window(radius: int) -> Sequence[Tuple[int, int]]:
    """(x, y) of one of each two opposite offsets within a radius, in the order of the file."""
    return [(x, y) for y in range(radius + 1) for x in range(0 if y == 0 else -radius, radius + 1)
            if x * x + y * y <= radius * radius]


def write_bssrdf(path: Union[str, "PathLike[str]"], light: np.ndarray, pitch_mm: float, *,
                 channels: Union[str, Sequence[float]] = "rgb", total: Optional[np.ndarray] = None,
                 noise: Optional[Sequence[float]] = None, asymmetry: float = 0.01, source: str = "") -> None:
    """Writes a data set of R(x_i, x_o), by channel, on a grid of points `pitch_mm` apart.

    light      (channels, height, width, 2 r + 1, 2 r + 1): [c, y, x, r + dy, r + dx] is the light per mm2 that leaves at
               point (x + dx, y + dy) of one unit that entered at (x, y); rows from the top; nothing counts beyond the
               radius r and outside of the grid. Both ways between two points are one value, their mean.
    channels   "rgb", "luminance" (one), or wavelengths in nm
    total      (channels, height, width): what leaves anywhere of one unit; without it what leaves within the window
    noise      by channel: variance of a value / the value, per mm2 (of photon counts: one count); without it 0
    asymmetry  how far the two ways between points may differ in the mean, as a share of the light

    ValueError, in one sentence: light that is not symmetric, negative or not finite, a total above 1, other channels.
    """
    light = np.asarray(light, np.float64)
    if light.ndim != 5 or light.shape[3] != light.shape[4] or light.shape[3] % 2 == 0:
        raise ValueError(f"light: has the shape {light.shape}, expected (channels, height, width, 2 r + 1, 2 r + 1): for "
                         f"each point the window around it")
    count, height, width, side, _ = light.shape
    radius = side // 2
    if isinstance(channels, str) and channels not in _NAMED:
        raise ValueError(f"channels: '{channels}' is neither \"rgb\" nor \"luminance\" nor a list of wavelengths in nm")
    names = _NAMED[channels] if isinstance(channels, str) else [f"{nm:g} nm" for nm in channels]
    if len(names) != count:
        raise ValueError(f"channels: {len(names)} ({', '.join(names)}) for light of {count}; give a wavelength for each")
    if not 1 <= radius <= _MOST_RADIUS or not (1 <= height <= _MOST_SIDE and 1 <= width <= _MOST_SIDE):
        raise ValueError(f"light: {width} x {height} points, radius {radius}; a file has 1 to {_MOST_SIDE} points a side "
                         f"and a radius of 1 to {_MOST_RADIUS}")
    if not (np.isfinite(pitch_mm) and pitch_mm > 0):
        raise ValueError(f"pitch_mm: {pitch_mm} mm between points; it is above 0")
    if not np.isfinite(light).all() or light.min() < 0:
        c, y, x = np.argwhere(~np.isfinite(light) | (light < 0))[0][:3]
        raise ValueError(f"light: of channel {names[c]}, point ({x}, {y}) is negative or not finite; subtract dark frames "
                         f"and set what is below their noise to 0")
    noise = [0.0] * count if noise is None else [float(value) for value in noise]
    if len(noise) != count or min(noise) < 0:
        raise ValueError(f"noise: {noise}, expected a number from 0 for each of {count} channels")

    pairs = np.zeros((count, len(half_window(radius)), height, width))
    within = np.zeros((count, height, width))
    apart, both = np.zeros(count), np.zeros(count)
    for k, (dx, dy) in enumerate(half_window(radius)):
        if dy >= height or abs(dx) >= width:
            continue
        here = np.s_[:, :height - dy, max(0, -dx):width - max(0, dx)]
        there = np.s_[:, dy:, max(0, dx):width - max(0, -dx)]
        forth, back = light[here][..., radius + dy, radius + dx], light[there][..., radius - dy, radius - dx]
        pairs[:, k][here] = (forth + back) / 2
        within[here] += forth
        if k > 0:
            within[there] += back
        apart += abs(forth - back).sum((1, 2))
        both += (forth + back).sum((1, 2))
    share = apart / np.maximum(both, 1e-300)
    if share.max() > asymmetry:
        c = int(share.argmax())
        raise ValueError(f"light: of channel {names[c]} differs by {share[c]:.1%} of itself between the two ways from one "
                         f"point to another, which no material does: check that rows are entries and the window the "
                         f"exits; if it is noise, asymmetry={share[c] * 1.1:.2g} takes the mean of both")
    total = within * pitch_mm ** 2 if total is None else np.asarray(total, np.float64)
    if total.shape != within.shape:
        raise ValueError(f"total: has the shape {total.shape}, expected {within.shape}: one for each channel and point")
    if not (total >= 0).all() or total.max() > _MOST_TOTAL:
        c, y, x = np.argwhere(~(total >= 0) | (total > _MOST_TOTAL))[0]
        raise ValueError(f"light: of channel {names[c]}, point ({x}, {y}) sends back {total[c, y, x]:.3g} of one unit that "
                         f"entered, expected 0 to 1: light is per mm2, and grey card and data belong to one exposure")

    if isinstance(channels, str):
        kept: object = _LUMINANCE if channels == "luminance" else channels
    else:
        kept = [float(nm) for nm in channels]
    header = (json.dumps({"format": "voxtone-bssrdf", "version": 1, "source": source,
                          "channels": kept,
                          "points": [width, height], "pitch_mm": float(pitch_mm), "radius": radius, "noise": noise})
              + "\n").encode()
    with Path(path).open("wb") as file:
        file.write(b"VTBSSRDF" + len(header).to_bytes(4, "little") + header)
        for c in range(count):
            file.write(total[c].astype("<f4").tobytes())
            file.write(pairs[c].astype("<f4").tobytes())
