#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An order sheet becomes one print. The sheet, CSV or XLSX (with openpyxl), has the columns model, size, copies, name; models
are looked for beside it, and each copy carries its name and number.

    tray_from_table.py ORDERS.csv OUT [OPTION=VALUE...]
"""
import csv
import json
import sys
from pathlib import Path

import voxtone


def read_orders(sheet):
    sheet = Path(sheet)
    if sheet.suffix.lower() == ".xlsx":
        import openpyxl
        rows = openpyxl.load_workbook(sheet, read_only=True).active.values
        names = [str(name or "").strip().lower() for name in next(rows)]
        return [dict(zip(names, row)) for row in rows if any(row)]
    with open(sheet, encoding="utf-8-sig", newline="") as file:
        return [{name.strip().lower(): value for name, value in row.items()} for row in csv.DictReader(file)]


def plan_of(orders, folder):
    parts = []
    for number, order in enumerate(orders, 2):  # as the sheet counts its lines
        if not order.get("model"):
            raise SystemExit(f"line {number} names no model")
        part = {"model": str((Path(folder) / str(order["model"])).resolve())}
        if order.get("name"):
            part["name"] = str(order["name"])
        if order.get("size"):
            part["size"] = str(order["size"])
        copies = int(order.get("copies") or 1)
        if copies > 1:
            part["copies"] = copies
        parts.append(part)
    return {"format": "voxtone-tray", "version": 1, "parts": parts}


def make(sheet, out, **options):
    out = Path(out)
    out.parent.mkdir(parents=True, exist_ok=True)
    plan = out.parent / f"{out.name}-plan.json"
    plan.write_text(json.dumps(plan_of(read_orders(sheet), Path(sheet).parent), indent=1), encoding="utf-8")
    return voxtone.tray(plan, out=out, overwrite=True, **options).result()


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    stack = make(sys.argv[1], sys.argv[2], **dict(word.split("=", 1) for word in sys.argv[3:]))
    print(f"{stack.path}: {stack.shape[0]} layers, {stack.report['resin_ml']:.1f} ml")
