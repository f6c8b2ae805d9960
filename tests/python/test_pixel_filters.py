# SPDX-License-Identifier: GPL-3.0-or-later

"""A filter that the library's table has is wherever it may be used, and nowhere else."""

from typing import get_args

import kernels
import numpy as np
import prefilter
import pytest
from prefilter._border import names as types

USES = {"raster", "resize", "mipmap", "sampling"}


def square() -> prefilter.Shape:
    shape = prefilter.Shape()
    shape.add_polygon([[2.0, 2.0], [6.0, 2.0], [6.0, 6.0], [2.0, 6.0]])
    return shape


def step() -> np.ndarray:
    return np.kron([[0.0, 1.0], [1.0, 0.0]], np.ones((4, 4))).astype(np.float32)


RUNS = {
    "raster": lambda name: prefilter.rasterize([square()], 8, 8, filter=name),
    "resize": lambda name: prefilter.resize(step(), 5, 3, filter=name),
    "mipmap": lambda name: prefilter.mipmaps(step(), filter=name)[1],
    "sampling": lambda name: prefilter.sample_exact(step(), [[0.3, 0.4]], [1.0], filter=name),
}


def test_names_and_labels_are_unique():
    for field in ("name", "label"):
        found = [getattr(one, field) for one in prefilter.PIXEL_FILTERS]
        assert len(set(found)) == len(found)
    assert {use for one in prefilter.PIXEL_FILTERS for use in one.uses} == USES


@pytest.mark.parametrize("use", sorted(USES))
@pytest.mark.parametrize("filter", prefilter.PIXEL_FILTERS, ids=lambda one: one.name)
def test_a_filter_is_where_its_uses_say(filter, use):
    if use in filter.uses:
        assert np.isfinite(RUNS[use](filter.name)).all()
    else:
        with pytest.raises(ValueError, match=f"filter: '{filter.name}' is not one of"):
            RUNS[use](filter.name)


def test_every_filter_has_an_oracle():
    names = {one.name for one in prefilter.PIXEL_FILTERS}
    assert names == {*kernels.FILTERS, *kernels.RADIAL, "least-squares"}


def test_lists_of_names_are_those_of_the_table():
    def names(use):
        return tuple(one.name for one in prefilter.PIXEL_FILTERS if use in one.uses)

    assert names("raster") == prefilter.RASTER_FILTERS
    assert names("resize") == prefilter.RESIZE_FILTERS
    assert names("sampling") == prefilter.SAMPLING_FILTERS
    in_texture = {one.name for one in prefilter.MIPMAP_FILTERS}
    assert in_texture >= {f"{name}{end}" for name in names("mipmap") for end in ("", "-covered")}


def test_types_of_names_are_those_of_the_tables():
    def values(alias):
        members = get_args(alias)
        return {alias} if not members else set().union(*map(values, members))

    def names(use):
        return {each.name for each in prefilter.PIXEL_FILTERS if use in each.uses}

    assert values(types.Kernel) == names("sampling")
    assert values(types.RasterFilter) == names("raster")
    assert values(types.ResizeFilter) == names("resize")
    assert values(types.MipmapFilterName) == {each.name for each in prefilter.MIPMAP_FILTERS}
    assert values(types.Covered) == {f"{name}-covered" for name in names("mipmap")}
    formats = prefilter.TEXEL_FORMATS.values()
    assert values(types.Ktx2Format) == {each.name for each in formats}
    assert values(types.DdsFormat) == {each.name for each in formats if each.is_in_dds}


@pytest.mark.parametrize("filter", prefilter.RASTER_FILTERS)
def test_the_radius_is_where_an_image_ends(filter):
    (one,) = (found for found in prefilter.PIXEL_FILTERS if found.name == filter)
    shape = prefilter.Shape()
    shape.add_polygon([[7.0, 7.0], [8.0, 7.0], [8.0, 8.0], [7.0, 8.0]])
    image = prefilter.rasterize([shape], 15, 15, filter=filter)[..., 0]
    rows, columns = np.nonzero(np.abs(image) > 1e-7)
    # A pixel's center is at most half a pixel and the radius from a square of one pixel.
    reach = int(np.ceil(one.radius + 0.5)) - 1
    assert {int(np.ptp(rows)), int(np.ptp(columns))} == {2 * reach}
