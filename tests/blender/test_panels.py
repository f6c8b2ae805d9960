# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels begin with the button that makes something, and have the rest in parts that are closed."""

import sys
from pathlib import Path

import bpy
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "docs" / "pictures" / "windows"))

import drawn

SUBJECTS = {
    "PREFILTER_PT_model": "Make Mipmaps",
    "PREFILTER_PT_bake": "Make Mipmaps",
    "PREFILTER_PT_texture_cache": "Make Texture Cache",
    "PREFILTER_PT_texture_cache_sidebar": "Make Texture Cache",
    "PREFILTER_PT_voxelize_sidebar": "Make Solid",
    "PREFILTER_PT_voxelize_sculpt": "Make Solid",
    "PREFILTER_PT_reconstruct": "Make Surface",
    "PREFILTER_PT_rasterize": "Make Image",
    "PREFILTER_PT_shapes": "Make Image of SVG...",
    "PREFILTER_PT_resample": "Make Image",
    "PREFILTER_PT_sampling_table": "Make Table",
}
"""The panels of the tab that no other panel of the add-on has in it, and their first buttons."""


def of_the_tab():
    """Returns the panels of the tab that always are the same."""
    names = ("nothing", "drawn", "voxel_result", "welcome", "before_after", "queue", "voxel_report")
    names += ("queue_of_images",)
    others = {f"PREFILTER_PT_{name}" for name in names}
    return [
        panel
        for panel in drawn.registered_panels()
        if getattr(panel, "bl_category", "") == "Prefilter" and panel.__name__ not in others
    ]


def is_within(panel):
    return getattr(panel, "bl_parent_id", "").startswith("PREFILTER_")


def is_closed(panel):
    return "DEFAULT_CLOSED" in getattr(panel, "bl_options", ())


def test_subjects_have_one_open_panel_each():
    open_ones = {panel.__name__ for panel in of_the_tab() if not is_within(panel)}
    has_cache = hasattr(bpy.types, "PREFILTER_PT_texture_cache")
    expected = set(SUBJECTS) - {"PREFILTER_PT_texture_cache"}
    assert open_ones == expected - (set() if has_cache else {"PREFILTER_PT_texture_cache_sidebar"})
    assert not [one.__name__ for one in of_the_tab() if is_closed(one) != is_within(one)]


@pytest.mark.parametrize("name", SUBJECTS)
def test_the_first_thing_is_the_button(name):
    if not hasattr(bpy.types, name):
        pytest.skip("this Blender has no texture cache")
    rows = drawn.drawn([name])[0]["rows"]
    first = next(row for row in rows if row[0] == "button")
    assert first[2] == SUBJECTS[name]
    # Above the first closed subpanel are only buttons and summaries, no settings.
    above = rows[: next(i for i, row in enumerate(rows) if row[0] == "panel")]
    assert not [row for row in above if row[0] == "setting"]
    assert all(row[2] == "closed" for row in rows if row[0] == "panel")
