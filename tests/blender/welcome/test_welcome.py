# SPDX-License-Identifier: GPL-3.0-or-later

"""The welcome in an invisible window: its contents, and that the user's data do not change."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import PACKAGE

SESSION = Path(__file__).with_name("welcome_session.py")


def test_mipmaps_of_two_filters(found):
    images = found["mipmaps"]["images"]
    assert sorted(images) == ["Stone", "Stone Box.mip04", "Stone Prefilter.mip04"]


def test_a_solid_beside_its_source(found):
    assert found["solid"]["closed"] == ["Solid"]


def test_a_surface_beside_its_points(found):
    assert found["surface"]["closed"] == ["Surface.surface"]


@pytest.mark.parametrize("kind", ["mipmaps", "solid", "surface"])
def test_a_scene_of_its_own(found, kind):
    assert found[kind]["scene"].startswith("Prefilter Demonstration")


def test_undo_and_redo(found):
    """The last demonstration is two undo steps: the initial scene, and the surface."""
    assert "Solid" in found["undo"]
    assert "Surface.surface" in found["redo"]


def test_nothing_is_left(found):
    # A material for scans in color is shared, and stays.
    found["after"]["materials"] = [one for one in found["after"]["materials"] if "Color" not in one]
    assert found["after"] == found["before"]
    assert found["view_after"] == found["view"]


def test_dismissal_is_permanent(found):
    assert not found["is_shown"]
    assert found["is_remembered"]


def test_the_preferences_bring_it_back():
    preferences = bpy.context.preferences.addons[PACKAGE].preferences
    assert bpy.types.PREFILTER_PT_welcome.poll(bpy.context)
    bpy.ops.prefilter.dismiss_welcome()
    assert not preferences.show_welcome
    assert not bpy.types.PREFILTER_PT_welcome.poll(bpy.context)
    preferences.show_welcome = True
    assert bpy.types.PREFILTER_PT_welcome.poll(bpy.context)


def test_in_another_mode_it_says_why_not():
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.types.PREFILTER_PT_welcome.poll(bpy.context)
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        bpy.ops.prefilter.demonstrate(kind="solid")


def test_one_after_another(addon):
    choices = addon("welcome.choices")
    home = bpy.context.scene
    for kind in ("surface", "surface"):
        bpy.ops.prefilter.demonstrate(kind=kind)
        assert sum(choices.is_demonstration(one) for one in bpy.data.scenes) == 1
    bpy.ops.prefilter.end_demonstration()
    assert bpy.context.scene == home
    with pytest.raises(RuntimeError, match="no scene of a demonstration"):
        bpy.ops.prefilter.end_demonstration()


def test_the_models(addon):
    """The stone is closed and its charts are apart; the broken one is open; normals are units."""
    models = addon("welcome.models")
    stone = models.stone()
    edges = np.stack([stone.quads, np.roll(stone.quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    there = {(a, b) for a, b in edges.tolist()}
    assert len(there) == len(edges)
    assert all((b, a) in there for a, b in there)
    assert 0.0 < stone.uvs.min() < stone.uvs.max() < 1.0
    charts = stone.uvs.reshape(6, -1, 2)
    for i in range(6):
        for j in range(i):
            low = np.maximum(charts[i].min(0), charts[j].min(0))
            assert np.any(np.minimum(charts[i].max(0), charts[j].max(0)) < low - 4 / 512)
    broken = models.broken_stone()
    assert broken.quads.max() < len(broken.points)
    _, normals, colors = models.knot(1000)
    assert np.allclose(np.linalg.norm(normals, axis=-1), 1.0)
    assert 0.0 <= colors.min() < colors.max() <= 1.0
