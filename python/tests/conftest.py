# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

import voxtone


def box(size=(6, 3, 1.5), **parts):
    """Corners in the order of binary numbers, x first."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * size
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return voxtone.Mesh(corners, np.array(faces), **parts)


@pytest.fixture(scope="session")
def stack(tmp_path_factory):
    """A box that is yellow where x is large, magenta where y is large, blue elsewhere."""
    mesh = box()
    colours = np.tile([0.0, 0.0, 0.6], (8, 1))
    colours[mesh.vertices[:, 0] > 3] = [0.8, 0.7, 0]
    mesh.colours = colours
    return voxtone.slice(mesh, out=tmp_path_factory.mktemp("stack") / "box", quality="draft", formats="png,gcvf",
                         predict="transport").result()
