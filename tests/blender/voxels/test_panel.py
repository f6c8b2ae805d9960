# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels, menus and modal operators of voxels, in a window that nobody sees."""

from pathlib import Path

import bpy

SESSION = Path(__file__).with_name("voxel_session.py")


def test_panels_and_modal_operators(found):
    vertices = 642
    assert found["tab_of_a_text"] == "Prefilter"
    assert found["started"] == ["RUNNING_MODAL"]
    assert not found["polls_alone"]
    assert found["closed"]
    assert found["after"] != vertices
    assert found["undone"] == vertices
    assert found["cancelled"] == vertices
    assert found["without_operand"] == vertices
    assert found["polls_in_next_file"]
    assert found["in_next_file"] == {"Next": 8}


def test_booleans_have_the_settings_of_voxelizing():
    """The scene stores shared settings once: a change in one group shows in the other."""
    scene = bpy.context.scene
    scene.prefilter_voxelize.depth = 5
    scene.prefilter_voxelize.interpolant = "linear"
    settings = scene.prefilter_boolean.to_settings()
    assert (settings.depth, settings.interpolant) == (5, "linear")
    scene.prefilter_boolean.holes = "fan"
    assert scene.prefilter_voxelize.to_settings().holes == "fan"
    assert scene.prefilter_voxelize.is_property_set("holes")
