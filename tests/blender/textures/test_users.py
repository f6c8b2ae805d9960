# SPDX-License-Identifier: GPL-3.0-or-later

"""The objects that a bake uses: all that show the image, or the selected ones."""

import bpy
import numpy as np
import pytest
import scenes

LEFT = ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0))
RIGHT = ((0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0))


@pytest.fixture
def pair():
    """An image, red on the left and blue on the right, and an object on each half of it."""
    values = np.zeros((4, 4, 4), np.float32)
    values[:, :2] = (1, 0, 0, 1)
    values[:, 2:] = (0, 0, 1, 1)
    image = scenes.image("Flag", values, colorspace="Non-Color")
    material = scenes.material("Cloth", image)
    objects = [scenes.quads(name, [uvs]) for name, uvs in (("Left", LEFT), ("Right", RIGHT))]
    for obj in objects:
        obj.data.materials.append(material)
    objects[1].select_set(False)
    scenes.quads("Bare")
    bpy.context.view_layer.update()
    return image, *objects


def mean():
    return scenes.pixels("Flag.mip02")[0, 0]


def bake(**options):
    return bpy.ops.prefilter.bake_mipmaps(image="Flag", filter="pam-box", wrap="clamp", **options)


def test_all_users_count_whatever_is_selected(pair, capfd):
    assert bake() == {"FINISHED"}
    np.testing.assert_allclose(mean(), (0.5, 0, 0.5, 1), atol=0.003)
    assert "over 2 objects" in capfd.readouterr().out
    assert bake(objects="selected") == {"FINISHED"}
    np.testing.assert_allclose(mean(), (1, 0, 0, 1), atol=0.003)
    assert "over 1 object " in capfd.readouterr().out


@pytest.mark.parametrize("operator", ["preview_levels", "plot_error", "show_weights"])
def test_other_operators_use_the_setting_of_the_panel(pair, addon, monkeypatch, operator):
    read = []
    bake_inputs = addon("textures.bake_inputs")
    original = bake_inputs.read_steps

    def caught(request):
        read.append([obj.name for obj in request.objects])
        return original(request)

    monkeypatch.setattr(bake_inputs, "read_steps", caught)
    for choice in ("all", "selected"):
        bpy.context.scene.prefilter_bake.objects = choice
        assert getattr(bpy.ops.prefilter, operator)(image="Flag") == {"FINISHED"}
    assert sorted(read[0]) == ["Left", "Right"]
    assert "Left" in read[1]
    assert "Right" not in read[1]


def test_hidden_users_are_excluded_with_a_warning(pair, capfd):
    _, _, right = pair
    right.hide_set(True)
    assert bake() == {"FINISHED"}
    np.testing.assert_allclose(mean(), (1, 0, 0, 1), atol=0.003)
    assert "Warning: image 'Flag': left out, as they are hidden: 'Right'" in capfd.readouterr().out


def test_instances_count_as_their_instancer(pair, addon):
    image, left, right = pair
    scenes.collection_instance(left)
    scenes.scatter(scenes.quads("Ground"), right)
    users, _ = addon("textures.users").users_of(image, bpy.context)
    assert sorted(obj.name for obj in users) == ["Ground", "Instancer", "Right"]


def test_a_material_of_geometry_nodes_counts(pair, addon):
    image, _, _ = pair
    bare = bpy.data.objects["Bare"]
    modifier = scenes.scatter(bare)
    group = modifier.node_group
    group.nodes.clear()
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    paint = group.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = bpy.data.materials["Cloth"]
    group.links.new(start.outputs[0], paint.inputs[0])
    group.links.new(paint.outputs[0], end.inputs[0])
    users, _ = addon("textures.users").users_of(image, bpy.context)
    assert sorted(obj.name for obj in users) == ["Bare", "Left", "Right"]


@pytest.fixture
def panel(addon):
    """Returns functions that give the panel's summary of an image, and why a button is disabled."""
    users = addon("textures.users")

    def text(image, choice="all", filters=("pam-bilinear",)):
        scenes.depsgraph()
        return users.describe_inputs(bpy.context, image, choice, filters)

    def reason(image, choice="all"):
        scenes.depsgraph()
        return users.missing_reason(bpy.context, image, choice)

    return text, reason


def test_the_panel_summarizes_the_inputs(pair, panel, addon, monkeypatch):
    image, left, right = pair
    text, reason = panel
    monkeypatch.setattr(addon("core.scene_cache"), "SHARE_OF_TIME", 1e9)
    assert text(image) == "2 objects, 4 x 4"
    assert text(image, "selected") == "1 object, 4 x 4"
    assert text(image, filters=["box"]) == "4 x 4"
    assert reason(image) == reason(image, "selected") == ""
    left.select_set(False)
    assert reason(image, "selected") == "No selected object uses 'Flag'"
    right.hide_set(True)
    assert text(image) == "1 object, 4 x 4"
    left.active_material = None
    assert text(image) == "0 objects, 4 x 4"
    assert reason(image) == "No visible object uses 'Flag'"


def test_the_panel_updates_only_after_a_change(pair, panel, addon, monkeypatch):
    image, left, _ = pair
    text, _ = panel
    module = addon("textures.users")
    looks = []
    original = module.users.shown_images
    monkeypatch.setattr(
        module.users, "shown_images", lambda graph: looks.append(graph) or original(graph)
    )
    monkeypatch.setattr(addon("core.scene_cache"), "SHARE_OF_TIME", 1e9)
    for _ in range(3):
        assert text(image) == "2 objects, 4 x 4"
    assert len(looks) == 1
    left.hide_set(True)
    for _ in range(3):
        assert text(image) == "1 object, 4 x 4"
    assert len(looks) == 2
    monkeypatch.setattr(addon("core.scene_cache"), "SHARE_OF_TIME", 1e-9)
    left.hide_set(False)
    assert text(image) == "2 objects, 4 x 4"
    left.hide_set(True)
    assert text(image) == "2 objects, 4 x 4"
