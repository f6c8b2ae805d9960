# SPDX-License-Identifier: GPL-3.0-or-later

"""Unusual input that is allowed; test_bad_inputs.py has the input that is refused."""

import numpy as np
import prefilter
import pytest
from scenes import random_image, random_soup, soup, square

IMAGE = random_image(0, 16, 16, 3)
MESH = square()


def test_repeated_tiles_are_limited():
    far = soup([[(0, 0), (1e9, 0), (0, 1e9)], [(0, 0), (3000, 0), (0, 3000)]])
    with pytest.raises(ValueError, match=r"surface 0, uvs: triangle 0 spans u from 0 to 1e"):
        prefilter.mipmaps(IMAGE, far.surface, wrap="repeat")
    for wrap in ("clamp", "border"):
        assert len(prefilter.mipmaps(IMAGE, far.surface, wrap=wrap)) == 5


def test_float32_and_strided_arrays_are_accepted():
    strided = np.repeat(IMAGE, 2, axis=1)[:, ::2]
    mesh = random_soup(1, 4)
    surface = prefilter.Surface(
        mesh.positions.astype(np.float32), mesh.triangles.astype(np.uint32), mesh.uvs
    )
    found = prefilter.mipmaps(strided, surface)
    expected = prefilter.mipmaps(IMAGE, surface)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_more_threads_than_there_are_is_no_error():
    for threads in (50, 2**31, 2**70):
        assert len(prefilter.mipmaps(IMAGE, MESH.surface, threads=threads)) == 5


def test_inputs_are_left_alone():
    image = random_image(3, 16, 16, 4)
    copy = image.copy()
    levels = prefilter.mipmaps(image, MESH.surface)
    levels[0][:] = 7
    assert np.array_equal(image, copy)
