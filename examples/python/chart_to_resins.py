#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""From a spectrophotometer's file to a resin set. The instrument wrote a line a patch, in the order of the chart, with its
own column names (SAMPLE_ID;LAB_L;LAB_A;LAB_B); voxtone's form chart.csv knows the mixture of each patch.

    chart_to_resins.py CHART MEASURED.csv OUT.json      CHART is the folder of `voxtone calibrate chart`
"""
import csv
import sys
from pathlib import Path

import voxtone


def read_rows(file):
    """By name; whichever of , ; and tab divides the columns. Lines that begin with # are remarks."""
    text = [line for line in Path(file).read_text(encoding="utf-8-sig").splitlines() if line and not line.startswith("#")]
    return list(csv.DictReader(text, dialect=csv.Sniffer().sniff(text[0], ",;\t")))


def lab_of(row):
    """L, a, b by any of their usual names, with a decimal comma, too."""
    names = {name.strip().lower().removeprefix("lab_").removesuffix("*"): name for name in row if name}
    missing = [wanted for wanted in "lab" if wanted not in names]
    if missing:
        raise SystemExit(f"the measured file has no column {', '.join(missing)}; it has {', '.join(row)}")
    return [row[names[wanted]].replace(",", ".") for wanted in "lab"]


def fill_in(chart, measured, filled):
    form = Path(chart) / "chart.csv"
    lines = form.read_text(encoding="utf-8").splitlines()
    begin = next(i for i, line in enumerate(lines) if line and not line.startswith("#"))
    names = lines[begin].split(",")
    values = [lab_of(row) for row in read_rows(measured)]
    patches = [line for line in lines[begin + 1:] if line and not line.startswith("#")]
    if len(values) != len(patches):
        raise SystemExit(f"{measured} has {len(values)} patches, {form} {len(patches)}; measure every patch once, row by row")
    rows = []
    for line, lab in zip(patches, values):
        cells = dict(zip(names, line.split(",")))
        cells.update(zip("Lab", lab))
        rows.append(",".join(cells.get(name, "") for name in names))
    Path(filled).write_text("\n".join(lines[:begin + 1] + rows) + "\n", encoding="utf-8")


def fit(filled, out, **options):
    job = voxtone.calibrate.fit(filled, out=out, overwrite=True, report=Path(out).with_suffix(".html"), **options)
    for event in job:
        if event["event"] in ("note", "warning"):
            print(event["message"], file=sys.stderr)
    return job.result()


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    table = Path(sys.argv[3]).with_suffix(".csv")
    fill_in(sys.argv[1], sys.argv[2], table)
    fit(table, sys.argv[3])
    print(f"voxtone slice MODEL --resins {sys.argv[3]}")
