# SPDX-License-Identifier: GPL-3.0-or-later

"""Bakes over the frames of an animation."""

import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def pulse():
    """Two squares, left and right; the right one's side is 1 at frame 1, and 3 at frame 3."""
    values = np.zeros((4, 4, 4), np.float32)
    values[:, :2] = 1
    values[..., 3] = 1
    picture = scenes.image("Paint", values, colorspace="Non-Color")
    left = scenes.quads("Left", [((0, 0), (0.5, 0), (0.5, 1), (0, 1))])
    right = scenes.quads("Right", [((0.5, 0), (1, 0), (1, 1), (0.5, 1))])
    paint = scenes.material("Paint", picture)
    for obj in (left, right):
        obj.data.materials.append(paint)
    for frame, size in ((1, 1.0), (3, 3.0)):
        right.scale = (size, size, 1)
        right.keyframe_insert("scale", frame=frame)
    for curve in scenes.fcurves(right):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    bpy.context.scene.frame_set(1)
    return picture, [left, right]


def last_texel():
    return scenes.pixels("Paint.mip02")[0, 0, 0]


def test_frames_are_averaged(bake, pulse):
    settings = {"filter": "pam-box", "use_frames": True, "frame_start": 1, "frame_end": 3}
    outcome = bake(*pulse, **settings)
    assert "over 2 objects at 3 frames" in outcome.summary
    assert last_texel() == pytest.approx(3 / (3 + 1 + 4 + 9), abs=1 / 255)
    bake(*pulse, **settings, frame_step=2)
    assert last_texel() == pytest.approx(2 / (2 + 1 + 9), abs=1 / 255)
    bake(*pulse, filter="pam-box")
    assert last_texel() == pytest.approx(1 / 2, abs=1 / 255)


def test_scene_is_back_at_its_frame(bake, pulse):
    scene = bpy.context.scene
    scene.frame_set(7, subframe=0.25)
    bake(*pulse, use_frames=True, frame_start=1, frame_end=3)
    assert (scene.frame_current, scene.frame_subframe) == (7, 0.25)
    pulse[1][0].data.vertices[0].co.x = float("nan")
    with pytest.raises(ValueError, match="object 'Left': positions"):
        bake(*pulse, use_frames=True, frame_start=1, frame_end=3)
    assert (scene.frame_current, scene.frame_subframe) == (7, 0.25)
    assert pulse[1][1].matrix_world.to_scale().x == pytest.approx(3)


def test_closing_the_reading_restores_the_frame(addon, pulse):
    settings = addon("textures.choices").Settings(use_frames=True, frame_start=2, frame_end=9)
    module = addon("textures.bake_inputs")
    reading = module.read_steps(module.Request(*pulse, settings, scenes.depsgraph()))
    # The images come before the frames.
    assert next(share for share in reading if share > 0.0) == pytest.approx(1 / 8)
    assert bpy.context.scene.frame_current == 2
    reading.close()
    assert bpy.context.scene.frame_current == 1


def test_poses_are_joined(addon, pulse):
    settings = addon("textures.choices").Settings(use_frames=True, frame_start=1, frame_end=50)
    module = addon("textures.bake_inputs")
    read = module.read(module.Request(*pulse, settings, scenes.depsgraph()))
    assert [round(s.area, 3) for s in read.source.surfaces] == [50, 1 + 4 + 48 * 9]


def test_faces_that_come_and_go(bake, pulse):
    picture, (left, right) = pulse
    for frame, count in ((1, 1), (2, 4)):
        array = left.modifiers.get("Array") or left.modifiers.new("Array", "ARRAY")
        array.count = count
        array.keyframe_insert("count", frame=frame)
    right.animation_data_clear()
    right.scale = (1, 1, 1)
    bake(picture, [left, right], filter="pam-box", use_frames=True, frame_end=2)
    assert last_texel() == pytest.approx(5 / 7, abs=1 / 255)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"frame_start": 5, "frame_end": 4}, "End: 4 is before Start, 5"),
        ({"frame_step": 0}, "Step: found 0; allowed: 1 and up"),
    ],
)
def test_no_frames(bake, pulse, settings, message):
    with pytest.raises(ValueError, match=message):
        bake(*pulse, use_frames=True, **settings)
