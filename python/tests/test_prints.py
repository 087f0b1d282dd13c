# SPDX-License-Identifier: GPL-3.0-or-later
import shutil
import struct
import zipfile

import numpy as np
import pytest

import voxtone
from voxtone.png import encode_png


def test_voxels_are_as_many_as_the_manifest_says(stack):
    volume = stack.volume()
    assert volume.shape == stack.shape
    counts = np.bincount(volume.reshape(-1), minlength=len(stack.resins) + 1)
    assert counts[1:].tolist() == [resin["voxels"] for resin in stack.resins]


def test_axes(stack):
    """Yellow is where x is large: in the last columns."""
    yellow = 1 + [resin["role"] for resin in stack.resins].index("Y")
    top = stack.layer(-1)
    assert (top[:, -20:] == yellow).mean() > 0.1 > 0.02 > (top[:, :20] == yellow).mean()
    layer, row, column = stack.pitch_mm
    assert stack.shape[0] * layer == pytest.approx(1.5, abs=layer)
    assert stack.shape[1] * row == pytest.approx(3, abs=2 * row)
    assert stack.shape[2] * column == pytest.approx(6, abs=2 * column)


def test_windows_are_parts_of_the_whole(stack):
    whole = stack.volume()
    for window in (np.s_[3:9, 5:20, 10:90], np.s_[-4:], np.s_[7, :, 50], [range(0, 20, 5)], np.s_[:0], 2):
        index = tuple(window) if isinstance(window, (tuple, list)) else window
        if isinstance(window, list):
            index = np.s_[0:20:5]
        assert (stack.volume(window) == whole[index]).all()
    assert (stack.layer(11) == whole[11]).all()
    for wrong in (len(whole), -len(whole) - 1):
        with pytest.raises(IndexError, match="of"):
            stack.layer(wrong)
    with pytest.raises(IndexError, match="4 were given"):
        stack.volume(np.s_[0, 0, 0, 0])


def test_report_and_prediction(stack):
    assert stack.report["layers"] == stack.shape[0]
    assert stack.verdict["level"] in ("good", "fair", "bad")
    seen, wanted = stack.predicted, stack.target
    assert seen.errors is None  # computed without chance
    assert np.allclose(seen.vertices.max(0), [6, 3, 1.5], atol=0.1)
    right, left = seen.vertices[:, 0] > 5.5, seen.vertices[:, 0] < 0.5
    assert seen.colours[right, 0].mean() > 3 * seen.colours[left, 0].mean()
    assert wanted.colours.max() <= 1 and len(wanted.faces) >= 12


def test_errors_of_a_prediction_by_monte_carlo(stack, tmp_path):
    stack.predict(tmp_path / "seen.ply", predict="monte-carlo", spp=4, cell="1mm", view="body").result()
    seen = voxtone.read_mesh(tmp_path / "seen.ply")
    assert seen.errors.shape[0] == len(seen.vertices)
    assert (seen.errors >= 0).all() and 0 < seen.errors.mean() < 0.2


def test_a_gcvf_is_the_same_voxels(stack):
    container = voxtone.open(stack.path / "stack.gcvf")
    assert container.shape == stack.shape and container.pitch_mm == pytest.approx(stack.pitch_mm)
    assert (container.volume() == stack.volume()).all()
    assert [(r["rgb"], r["voxels"]) for r in container.resins] == [(r["rgb"], r["voxels"]) for r in stack.resins]
    assert container.verify().result()["passed"]
    for asked in (lambda: container.report, lambda: container.predicted, lambda: container.pictures):
        with pytest.raises(voxtone.FileError, match="a GCVF has layers"):
            asked()


def test_a_gcvf_that_is_not_whole(stack, tmp_path):
    whole = (stack.path / "stack.gcvf").read_bytes()
    broken = tmp_path / "broken.gcvf"
    for size in range(0, len(whole), 397):
        broken.write_bytes(whole[:size])
        with pytest.raises(voxtone.InputError, match="broken.gcvf"):
            voxtone.open(broken)

    def changed(entry, change):
        with zipfile.ZipFile(stack.path / "stack.gcvf") as old, zipfile.ZipFile(broken, "w") as new:
            for name in old.namelist():
                data = change(old.read(name)) if name == entry else old.read(name)
                if data is not None:
                    new.writestr(name, data)
        return broken

    config = "ConfigFile.xml"
    for entry, change, word in [(config, lambda _: None, "has no ConfigFile.xml"),
                                (config, lambda _: b"<GCVF>", "no XML"),
                                (config, lambda text: text.replace(b"SliceWidth", b"Width"), "no SliceWidth"),
                                (config, lambda text: text.replace(b"<XDpi>600", b"<XDpi>0"), "no XDpi"),
                                (config, lambda text: text.replace(b"<RGBA>0 150", b"<RGBA>150"), "no RGBA"),
                                ("layer_5.png", lambda _: None, "no layer_5.png"),
                                ("layer_5.png", lambda _: b"no picture", "layer_5.png: is no PNG"),
                                ("layer_5.png", lambda png: png[:-20], "layer_5.png"),
                                ("layer_5.png", lambda _: encode_png(np.zeros((2, 2, 4), np.uint8)), "2 x 2 px"),
                                # What unpacks to more than a layer can be is not unpacked.
                                ("layer_5.png", lambda _: bytes(1 << 26), "says that it is 67108864 bytes long"),
                                (config, lambda _: bytes(1 << 26), "says that it is 67108864 bytes long"),
                                ("layer_5.png", lambda png: png[:16] + struct.pack(">II", 60000, 60000) + png[24:], "60000 x 60000")]:
        with pytest.raises(voxtone.InputError, match=word):
            voxtone.open(changed(entry, change)).layer(5)


def test_verify(stack):
    assert stack.verify().result()["passed"]


def test_a_stack_that_is_not_whole(stack, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(stack.path, folder)
    broken = voxtone.open(folder)
    file = sorted((folder / "layers").iterdir())[5]
    height, width = broken.shape[1:]
    file.write_bytes(encode_png(np.full((height, width, 4), [1, 2, 3, 255], np.uint8)))
    with pytest.raises(voxtone.InputError, match="no resin's"):
        broken.layer(5)
    file.write_bytes(encode_png(np.zeros((2, 2, 4), np.uint8)))
    with pytest.raises(voxtone.InputError, match="2 x 2 px"):
        broken.layer(5)
    with pytest.raises(voxtone.CheckFailed, match=file.name) as caught:
        broken.verify().result()
    assert caught.value.result["passed"] is False
    file.unlink()
    with pytest.raises(voxtone.FileError, match="not whole"):
        broken.layer(5)
    (folder / "manifest.json").write_text("{")
    with pytest.raises(voxtone.InputError, match="manifest.json"):
        voxtone.open(folder)
    for text in ("{}", "[1]"):
        (folder / "manifest.json").write_text(text)
        with pytest.raises(voxtone.InputError, match="no manifest"):
            voxtone.open(folder)
    with pytest.raises(voxtone.FileError, match="whole"):
        voxtone.open(tmp_path / "nowhere")
