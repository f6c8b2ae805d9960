# SPDX-License-Identifier: GPL-3.0-or-later

"""Which values of a mesh its triangles have."""

import numpy as np
import pytest

VERTICES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


@pytest.mark.parametrize(
    ("corners", "faces", "domain", "expected"),
    [
        (None, None, "POINT", VERTICES),
        (None, None, "CORNER", [[0, 1, 2], [3, 4, 5]]),
        (None, None, "FACE", [[0], [1]]),
        # Both are of one face with four corners.
        ([[0, 1, 2], [0, 2, 3]], [0, 0], "POINT", VERTICES),
        ([[0, 1, 2], [0, 2, 3]], [0, 0], "CORNER", [[0, 1, 2], [0, 2, 3]]),
        ([[0, 1, 2], [0, 2, 3]], [0, 0], "FACE", [[0], [0]]),
    ],
)
def test_indices_of_triangles_in_each_domain(addon, corners, faces, domain, expected):
    made = addon("bridge.layers").Triangles(
        VERTICES,
        None if corners is None else np.array(corners, np.int32),
        None if faces is None else np.array(faces, np.int32),
    )
    np.testing.assert_array_equal(made.indices(domain), expected)
