# SPDX-License-Identifier: GPL-3.0-or-later

"""Arguments that should be sized containers and are not: refused by name."""

import numpy as np
import prefilter
import pytest

IMAGE = np.zeros((4, 4, 3), np.float32)
LEVELS = [IMAGE, IMAGE[:2, :2], IMAGE[:1, :1]]
MESH = (np.eye(3), [[0, 1, 2]])
SURFACE = prefilter.Surface(*MESH, [[0, 0], [1, 0], [0, 1]])

CALLS = {
    "wrap of mipmaps": ("wrap", lambda odd: prefilter.mipmaps(IMAGE, SURFACE, wrap=odd)),
    "wrap of coarser_levels": (
        "wrap",
        lambda odd: prefilter.coarser_levels(IMAGE, SURFACE, wrap=odd),
    ),
    "wrap of resize": ("wrap", lambda odd: prefilter.resize(IMAGE, 2, 2, wrap=odd)),
    "bounds": ("bounds", lambda odd: prefilter.mipmaps(IMAGE, SURFACE, bounds=odd)),
    "wrap of sample": (
        "wrap",
        lambda odd: prefilter.sample(LEVELS, "trilinear", [[0.5, 0.5]], 1.0, wrap=odd),
    ),
    "sources": (
        "sources",
        lambda odd: prefilter.voxelize(*MESH, depth=3, thickness=0.5).contour(sources=odd),
    ),
    "uvs": ("uvs", lambda odd: prefilter.uv_charts(*MESH, odd)),
    "levels of sample": (
        "levels",
        lambda odd: prefilter.sample(odd, "trilinear", [[0.5, 0.5]], 1.0),
    ),
    "levels of write_exr": ("levels", lambda odd: prefilter.write_exr("a.exr", odd)),
    "format": ("format", lambda odd: prefilter.write_exr("a.exr", LEVELS, format=odd)),
    "format of write_ktx2": (
        "format",
        lambda odd: prefilter.write_ktx2("a.ktx2", LEVELS, format=odd),
    ),
}


@pytest.mark.parametrize("odd", [5, True, np.array(3), object(), [], {}], ids=repr)
@pytest.mark.parametrize("name", CALLS)
def test_it_is_refused_by_the_name_of_the_argument(name, odd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    argument, call = CALLS[name]
    if argument in ("sources", "uvs") and isinstance(odd, list | dict):
        pytest.skip("none is allowed")
    with pytest.raises(ValueError, match=rf"^{argument}\b"):
        call(odd)
