# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

import voxtone
from voxtone.mesh import linear_to_srgb, srgb_to_linear

from conftest import box


def test_written_and_read_again(tmp_path):
    mesh = box(colours=np.random.default_rng(1).random((8, 3)))
    mesh.write(tmp_path / "box.glb")
    again = voxtone.read_mesh(tmp_path / "box.glb")
    assert np.allclose(again.vertices, mesh.vertices, atol=1e-6)
    assert (again.faces == mesh.faces).all()
    assert np.allclose(again.colours, mesh.colours, atol=1e-6)


def test_codes_and_linear_values():
    codes = np.arange(256)
    assert (linear_to_srgb(srgb_to_linear(codes)) == codes).all()
    assert srgb_to_linear(188) == pytest.approx(0.5029, abs=1e-4)  # the code of half the light
    assert box(colours=np.full((8, 3), 188, np.uint8)).colours[0, 0] == pytest.approx(0.5029, abs=1e-4)


def test_what_is_no_mesh_is_refused_with_its_reason():
    triangle = np.eye(3)
    for wrong, word in [(dict(vertices=np.zeros((3, 2)), faces=[[0, 1, 2]]), "vertices"),
                        (dict(vertices=triangle, faces=[[0, 1, 3]]), "index 3 is none of 3"),
                        (dict(vertices=triangle, faces=[[0, 1, -1]]), "index -1"),
                        (dict(vertices=triangle, faces=[[0.0, 1.0, 2.0]]), "integers"),
                        (dict(vertices=triangle * np.nan, faces=[[0, 1, 2]]), "finite"),
                        (dict(vertices=triangle, faces=[[0, 1, 2]], colours=np.zeros((2, 3))), "one a vertex"),
                        (dict(vertices=triangle, faces=[[0, 1, 2]], uv=np.zeros((3, 2))), "belong together")]:
        with pytest.raises(ValueError, match=word):
            voxtone.Mesh(**wrong)


def test_what_is_no_file_of_ours_is_refused(tmp_path):
    for name, content in [("a.glb", b"glTF"), ("a.obj", b"v 0 0 0\n"), ("a.ply", b"ply\nformat ascii 1.0\n")]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=name):
            voxtone.read_mesh(tmp_path / name)


def test_the_program_sees_the_texture_as_it_is_laid(tmp_path):
    """One corner of the upper side is red, its neighbour along x green, the others white."""
    texture = np.full((64, 64, 3), 255, np.uint8)
    texture[32:, :32] = [200, 0, 0]  # lower left: u, v small
    texture[32:, 32:] = [0, 160, 0]
    mesh = box()
    mesh = voxtone.Mesh(mesh.vertices, mesh.faces, uv=mesh.vertices[:, :2] / [6, 3], texture=texture)
    stack = voxtone.slice(mesh, out=tmp_path / "textured", quality="draft", predict="none").result()
    top = stack.layer(-1)
    near, far = top[-15:], top[:15]  # rows run along -y: the last are those of small y
    share = lambda part, role: (part == role_of(stack, role)).mean()  # noqa: E731
    half = top.shape[1] // 2
    assert share(near[:, :half - 5], "M") > 5 * share(near[:, half + 5:], "M")
    assert share(near[:, half + 5:], "C") > 5 * share(near[:, :half - 5], "C")
    assert share(far, "W") > 0.8


def role_of(stack, role):
    return 1 + [resin["role"] for resin in stack.resins].index(role)
