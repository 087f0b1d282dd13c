#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How large must it be? Slices a model in several sizes, and plots how well each will look and what it takes.

    size_sweep.py MODEL OUT SIZE... [OPTION=VALUE...]      size_sweep.py cow.obj out/sweep 10mm 20mm quality=draft
"""
import sys
from pathlib import Path

import voxtone


def sweep(model, out, sizes, **options):
    """(size in mm, CIEDE2000 as seen, ml of resin, seconds) of each."""
    rows = []
    for size in sizes:
        job = voxtone.slice(model, size=size, out=Path(out) / size, predict="transport", overwrite=True, **options)
        for event in job:
            if event["event"] == "stage" and event["state"] == "begin":
                print(f"{size}: {event['stage']}", file=sys.stderr)
        report = job.result().report
        rows.append((max(report["size_mm"]), report["verdict"]["seen_de2000"]["mean"], report["resin_ml"], report["seconds"]))
    return rows


def plot(rows, file):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, seen = pyplot.subplots(figsize=(6, 4), layout="constrained")
    sizes = [row[0] for row in rows]
    seen.plot(sizes, [row[1] for row in rows], "o-", color="tab:blue")
    seen.axhline(2.5, color="grey", linewidth=0.8)
    seen.annotate("good", (sizes[0], 2.5), textcoords="offset points", xytext=(2, 3), color="grey")
    seen.set(xlabel="largest extent, mm", ylabel="seen difference, CIEDE2000", ylim=(0, None))
    seen.yaxis.label.set_color("tab:blue")
    resin = seen.twinx()
    resin.plot(sizes, [row[2] for row in rows], "s--", color="tab:red")
    resin.set(ylabel="resin, ml", ylim=(0, None))
    resin.yaxis.label.set_color("tab:red")
    figure.savefig(file, dpi=120)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    asked = dict(word.split("=", 1) for word in sys.argv[3:] if "=" in word)
    found = sweep(sys.argv[1], sys.argv[2], [word for word in sys.argv[3:] if "=" not in word], **asked)
    for mm, difference, ml, seconds in found:
        print(f"{mm:6.1f} mm   {difference:5.2f} CIEDE2000   {ml:7.2f} ml   {seconds:5.0f} s")
    plot(found, Path(sys.argv[2]) / "sweep.png")
