# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy as np
import pytest

import voxtone
from voxtone.bssrdf import half_window

RADIUS, PITCH = 4, 0.5


def window(width_mm, height=24, width=30, channels=3):
    """Light that falls off by exp(-r / width) and is 0.5 in all, the left half of the surface half as bright."""
    at = np.arange(-RADIUS, RADIUS + 1) * PITCH
    r = np.hypot(*np.meshgrid(at, at))
    one = np.where(r <= RADIUS * PITCH + 1e-9, np.exp(-r / width_mm), 0)
    one *= 0.5 / (one.sum() * PITCH ** 2)
    root = np.sqrt(np.where(np.arange(width) < width // 2, 0.5, 1.0))
    padded = np.pad(root, RADIUS, constant_values=1)
    light = np.zeros((channels, height, width, 2 * RADIUS + 1, 2 * RADIUS + 1))
    for x in range(width):
        light[:, :, x] = one * root[x] * padded[x:x + 2 * RADIUS + 1]
    return light


def test_the_file_is_the_format(tmp_path):
    light = window(0.6, height=6, width=7)
    voxtone.write_bssrdf(tmp_path / "a.bssrdf", light, PITCH, source="here", noise=[1, 2, 3])
    data = (tmp_path / "a.bssrdf").read_bytes()
    size = int.from_bytes(data[8:12], "little")
    header = json.loads(data[12:12 + size])
    assert data[:8] == b"VTBSSRDF" and header["points"] == [7, 6] and header["noise"] == [1, 2, 3]
    values = np.frombuffer(data[12 + size:], "<f4").reshape(3, 1 + len(half_window(RADIUS)), 6, 7)
    for k, (dx, dy) in enumerate(half_window(RADIUS)):
        for y in range(6):
            for x in range(7):
                inside = 0 <= x + dx < 7 and y + dy < 6
                wanted = light[1, y, x, RADIUS + dy, RADIUS + dx] if inside else 0
                assert values[1, 1 + k, y, x] == pytest.approx(wanted, rel=1e-6)
    # A corner sees a quarter of its window.
    seen = light[0, 0, 0, RADIUS:, RADIUS:][:6, :7].sum() * PITCH ** 2
    assert values[0, 0, 0, 0] == pytest.approx(seen, rel=1e-5)


def test_the_program_finds_the_profile_that_was_written(tmp_path):
    voxtone.write_bssrdf(tmp_path / "a.bssrdf", window(0.6), PITCH)
    voxtone.laminate.factor(tmp_path / "a.bssrdf", clusters=2, out=tmp_path / "a.json").result()
    made = json.loads((tmp_path / "a.json").read_text())
    profiles = np.array(made["clusters"])[:, 0]
    assert made["spacing_mm"] == PITCH
    dark, bright = sorted(profiles, key=lambda p: p[1])
    assert bright[1] / dark[1] == pytest.approx(2, rel=0.1)
    slope = np.log(bright[1] / bright[3]) / (2 * PITCH)
    assert slope == pytest.approx(1 / 0.6, rel=0.05)


def test_one_channel_is_luminance(tmp_path):
    light = window(0.6, height=6, width=7, channels=1)
    voxtone.write_bssrdf(tmp_path / "a.bssrdf", light, PITCH, channels="luminance")
    voxtone.laminate.factor(tmp_path / "a.bssrdf", clusters=1, out=tmp_path / "a.json").result()
    made = json.loads((tmp_path / "a.json").read_text())
    assert made["channels"]["kind"] == "own" and len(made["clusters"][0]) == 1
    with pytest.raises(ValueError, match="for light of 3"):
        voxtone.write_bssrdf(tmp_path / "b.bssrdf", window(0.6), PITCH, channels="luminance")


def test_what_cannot_be_is_refused_in_a_sentence(tmp_path):
    good = window(0.6, height=6, width=7)
    turned = np.array(good)
    turned[:, :, :3] *= 3
    negative = np.array(good)
    negative[1, 2, 3, 0, 4] = -1
    for light, more, word in [(turned, {}, "two ways"), (good * 3, {}, "sends back 1"), (negative, {}, r"G, point \(3, 2\)"),
                              (good * np.nan, {}, "not finite"), (good, dict(channels=[450, 550]), "for light of 3"),
                              (good, dict(channels="xyz"), "neither"), (good[0], {}, "shape"),
                              (good, dict(total=np.full((3, 6, 7), 1.3)), "sends back 1.3"), (good, dict(noise=[1]), "noise"),
                              (good, dict(total=np.zeros((2, 2))), "total: has the shape")]:
        with pytest.raises(ValueError, match=word) as refused:
            voxtone.write_bssrdf(tmp_path / "x.bssrdf", light, PITCH, **more)
        assert "\n" not in str(refused.value)
        assert not (tmp_path / "x.bssrdf").exists()
    with pytest.raises(ValueError, match="above 0"):
        voxtone.write_bssrdf(tmp_path / "x.bssrdf", good, 0)
    voxtone.write_bssrdf(tmp_path / "x.bssrdf", turned / 3, PITCH, asymmetry=1)
