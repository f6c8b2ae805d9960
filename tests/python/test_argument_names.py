# SPDX-License-Identifier: GPL-3.0-or-later

"""Literal types of arguments list the names that the functions accept."""

import io
import re
from typing import get_args

import numpy as np
import prefilter
import pytest
from prefilter import mipmaps, reconstruct, resize
from prefilter._border import names

BYTES = np.zeros((2, 2), np.uint8)
LEVELS = [BYTES, BYTES[:1, :1]]
POINTS = np.random.default_rng(1).normal(size=(500, 3))
POINTS /= np.linalg.norm(POINTS, axis=1, keepdims=True)
SCAN = prefilter.ScanPoints(POINTS, POINTS)
UNKNOWN = r"is not one of|'other'"


def names_of(alias):
    """The names of a type, which may be a union of literals."""
    found = set()
    for each in get_args(alias):
        found |= {each} if isinstance(each, str) else names_of(each)
    return found


def test_names_are_those_that_the_library_has():
    assert names_of(names.MipmapFilterName) == {each.name for each in prefilter.MIPMAP_FILTERS}
    assert names_of(names.ResizeFilter) == set(prefilter.RESIZE_FILTERS)
    assert names_of(names.RasterFilter) == set(prefilter.RASTER_FILTERS)
    assert names_of(names.Kernel) == set(prefilter.SAMPLING_FILTERS)
    assert names_of(names.Ktx2Format) == set(prefilter.TEXEL_FORMATS)
    in_dds = {name for name, each in prefilter.TEXEL_FORMATS.items() if each.is_in_dds}
    assert names_of(names.DdsFormat) == in_dds


@pytest.mark.parametrize(
    ("alias", "use"),
    [
        (names.WrapMode, lambda name: mipmaps(BYTES, filter="box", wrap=name)),
        (names.Reader, lambda name: mipmaps(BYTES, filter="ls-bilinear", reader=name)),
        (names.Encoding, lambda name: mipmaps(BYTES, filter="box", encoding=name)),
        (names.Ringing, lambda name: resize(BYTES, 1, 1, ringing=name)),
        (names.Alpha, lambda name: prefilter.write_dds(io.BytesIO(), [BYTES], alpha=name)),
        (names.Effort, lambda name: prefilter.write_dds(io.BytesIO(), [BYTES], effort=name)),
        (names.Header, lambda name: prefilter.write_dds(io.BytesIO(), [BYTES], header=name)),
        (
            names.Supercompression,
            lambda name: prefilter.write_ktx2(io.BytesIO(), [BYTES], supercompression=name),
        ),
        (names.ExrFormat, lambda name: prefilter.write_exr(io.BytesIO(), LEVELS, format=name)),
        (names.Upward, lambda name: prefilter.estimate_normals(POINTS, direction=name)),
        (names.Direction, lambda name: reconstruct(POINTS, depth=3, direction=name)),
        (names.Against, lambda name: prefilter.align_scans([SCAN, SCAN], against=name)),
        (names.Wavelet, lambda name: reconstruct(POINTS, POINTS, depth=3, wavelet=name)),
        (names.Returns, lambda name: prefilter.choose_points(SCAN, returns=name)),
    ],
)
def test_each_name_is_taken_and_no_other(alias, use):
    for name in names_of(alias):
        refused = ""
        try:
            use(name)
        except ValueError as error:
            refused = str(error)
        assert not re.search(UNKNOWN, refused)
    with pytest.raises(ValueError, match=UNKNOWN):
        use("other")
