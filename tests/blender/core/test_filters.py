# SPDX-License-Identifier: GPL-3.0-or-later

"""The library's filters as choices: all that may be used, under the same labels everywhere."""

import prefilter
import pytest

PLACES = {
    ("shapes.choices", "FILTERS"): "raster",
    ("images.choices", "FILTERS"): "resize",
    ("images.choices", "TABLE_FILTERS"): "sampling",
}


@pytest.mark.parametrize("place", PLACES, ids=".".join)
def test_every_filter_may_be_chosen_and_is_described(addon, place):
    module, name = place
    choices = getattr(addon(module), name)
    expected = {one.name: one.label for one in prefilter.PIXEL_FILTERS if PLACES[place] in one.uses}
    assert {key: choice.label for key, choice in choices.items()} == expected
    assert all(choice.description for choice in choices.values())


def test_levels_have_the_same_labels(addon):
    choices = addon("textures.choices").FILTERS
    for one in prefilter.PIXEL_FILTERS:
        if "mipmap" in one.uses:
            assert choices[one.name].label == one.label
            assert choices[f"{one.name}-covered"].label == f"{one.label}, Covered"


def test_a_filter_without_a_description_is_listed(addon):
    found = addon("core.filters").filters_for("resize", {"tent": "Soft"})
    assert found.keys() == set(prefilter.RESIZE_FILTERS)
    assert next(iter(found)) == "tent"
