# SPDX-License-Identifier: GPL-3.0-or-later
"""examples/python, run as its pages say."""
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import voxtone
from voxtone.png import read_png

examples = Path(__file__).resolve().parents[2] / "examples"


def run(script, *words):
    return subprocess.run([sys.executable, str(examples / "python" / script), *map(str, words)], capture_output=True,
                          text=True, env={**os.environ, "MPLCONFIGDIR": "/tmp"}, check=False)


def test_a_size_sweep(tmp_path):
    pytest.importorskip("matplotlib", reason="the plot wants matplotlib")
    done = run("size_sweep.py", examples / "models/pyramid.ply", tmp_path, "4mm", "8mm", "quality=draft")
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    assert [float(row[0]) for row in rows] == pytest.approx([4, 8], abs=0.1)
    assert float(rows[1][4]) > 6 * float(rows[0][4])  # eight times the volume
    picture = read_png(str(tmp_path / "sweep.png"))
    assert picture.shape[:2] == (480, 720) and picture[:, :, :3].std() > 10


def test_a_chart_of_a_spectrophotometer(tmp_path):
    chart = tmp_path / "chart"
    voxtone.calibrate.chart(printer="stratasys-j750-hm", resins="C,M,Y,K,W", patches=40, square="3mm", out=chart).result()
    voxtone.calibrate.simulate(chart / "target.json", resins=examples / "12-inks.json", out=tmp_path / "measured.csv").result()
    # As an instrument writes it: names of its own, semicolons, decimal commas.
    lines = [line for line in (tmp_path / "measured.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    instrument = tmp_path / "instrument.txt"
    instrument.write_text("SAMPLE_ID;LAB_L;LAB_A;LAB_B\n" + "".join(
        f"{i};" + ";".join(row[name].replace(".", ",") for name in "Lab") + "\n" for i, row in enumerate(rows, 1)))
    done = run("chart_to_resins.py", chart, instrument, tmp_path / "mine.json")
    assert done.returncode == 0, done.stderr
    resins = json.loads((tmp_path / "mine.json").read_text())
    assert len(resins["resins"]) == 5 and (tmp_path / "mine.html").exists()
    seen = voxtone.calibrate.check(tmp_path / "mine.json", tmp_path / "measured.csv").result()
    assert seen["patches"]["mean_de2000"] < 3
    instrument.write_text("\n".join(instrument.read_text().splitlines()[:-3]) + "\n")
    short = run("chart_to_resins.py", chart, instrument, tmp_path / "mine.json")
    assert short.returncode == 1 and f"has {len(rows) - 3} patches" in short.stderr


def test_a_tray_of_a_table(tmp_path):
    done = run("tray_from_table.py", examples / "python/orders.csv", tmp_path / "tray", "quality=draft", "predict=none")
    assert done.returncode == 0, done.stderr
    stack = voxtone.open(tmp_path / "tray")
    assert stack.verify().result()["passed"]
    parts = json.loads((tmp_path / "tray/tray.json").read_text())["parts"]
    assert {part["name"]: len(part["at_mm"]) for part in parts} == {"stone": 2, "prism": 1, "cow": 1}
    (tmp_path / "bad.csv").write_text("model,size\n,6mm\n")
    refused = run("tray_from_table.py", tmp_path / "bad.csv", tmp_path / "bad")
    assert refused.returncode == 1 and "line 2 names no model" in refused.stderr
