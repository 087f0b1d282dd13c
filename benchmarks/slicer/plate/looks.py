#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What trays look like, from meshes that `voxtone predict --view body -o FILE.ply` writes.

looks.py copies TRAY_FOLDER SEEN.ply   mean colours of the first part's copies, and how far patches of 0.6 mm differ
looks.py joint SEEN.ply MONTE_CARLO.ply X_MM   strips of 0.25 mm of the top, 2.5 mm on either side of x
"""
import json
import math
import struct
import sys


def cells(file):
    """x, y, z in mm and three linear values for each cell."""
    data = open(file, "rb").read()
    begin = data.index(b"end_header\n") + 11
    head = data[:begin].decode()
    count = int(head.split("element vertex ")[1].split()[0])
    names = [line.split() for line in head.split("element face")[0].splitlines() if line.startswith("property")]
    size = sum(4 if kind == "float" else 1 for _, kind, _ in names)
    return [struct.unpack_from("<3f3B3f", data, begin + size * n) for n in range(count)]


def lab(rgb):
    r, g, b = (max(0.0, v) for v in rgb)
    x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505
    y = 0.2126 * r + 0.7152 * g + 0.0722 * b
    z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089
    x, y, z = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in (x, y, z))
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def mean(values):
    return [sum(v[k] for v in values) / len(values) for k in range(3)]


def copies(folder, seen):
    part = json.load(open(folder + "/tray.json"))["parts"][0]
    pitch = (25.4 / 600, 25.4 / 300)
    patches = []
    for at in part["at_mm"]:
        here = {}
        for cell in seen:
            place = [cell[k] - at[k] for k in range(3)]
            if all(-0.05 <= place[k] <= part["size_px"][k] * pitch[k] + 0.05 for k in (0, 1)):
                here.setdefault(tuple(int(v // 0.6) for v in place), []).append(cell[6:9])
        patches.append(here)
        print("copy at", at, "mean", ["%.4f" % v for v in mean([c for patch in here.values() for c in patch])])
    for other in patches[1:]:
        apart = sorted(
            math.dist(lab(mean(patch)), lab(mean(other[key])))
            for key, patch in patches[0].items()
            if len(patch) >= 30 and len(other.get(key, [])) >= 30
        )
        print("%d patches: CIE 1976 mean %.2f, median %.2f, 95 %% %.2f" % (
            len(apart), sum(apart) / len(apart), apart[len(apart) // 2], apart[int(0.95 * len(apart))]))


def joint(seen, traced, x_mm):
    top = max(cell[2] for cell in seen) - 0.1
    low, high = min(c[1] for c in seen) + 1, max(c[1] for c in seen) - 1
    strip = lambda all_cells, x: [c[6:9] for c in all_cells if c[2] > top and low < c[1] < high and x <= c[0] < x + 0.25]
    for n in range(-10, 10):
        x = x_mm + 0.25 * n
        a, b = mean(strip(seen, x)), mean(strip(traced, x))
        print("x %.2f" % x, ["%.3f" % v for v in a], "Monte Carlo", ["%.3f" % v for v in b],
              "CIE 1976 %.2f" % math.dist(lab(a), lab(b)))


if len(sys.argv) == 4 and sys.argv[1] == "copies":
    copies(sys.argv[2], cells(sys.argv[3]))
elif len(sys.argv) == 5 and sys.argv[1] == "joint":
    joint(cells(sys.argv[2]), cells(sys.argv[3]), float(sys.argv[4]))
else:
    sys.exit(__doc__)
