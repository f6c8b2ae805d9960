# SPDX-License-Identifier: GPL-3.0-or-later

"""The operator on all images, as scripts call it."""

import bpy
import pytest
import scenes
from texture_readers import read_dds


def bake(**options):
    return bpy.ops.prefilter.bake_model(**options)


@pytest.fixture
def saved(tmp_path):
    """Saves a file with two squares, of an image each."""
    for name in ("Left", "Right"):
        scenes.textured_quad(scenes.image(name, scenes.noise(8, 8)), name, select=name == "Left")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return tmp_path


def files(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.*"))


def test_the_scene_into_a_folder_beside_the_file(saved, capfd):
    assert bake(objects="scene") == {"FINISHED"}
    assert files(saved) == ["mipmaps/Left.ktx2", "mipmaps/Right.ktx2", "scene.blend"]
    assert "Baked 2 images into 2 files in" in capfd.readouterr().out
    assert sorted(image.name for image in bpy.data.images) == ["Left", "Right"]


def test_the_selection_if_there_is_one(saved):
    assert bake() == {"FINISHED"}
    assert files(saved) == ["mipmaps/Left.ktx2", "scene.blend"]
    bpy.data.objects["Left"].select_set(False)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    camera.select_set(True)
    assert bake() == {"FINISHED"}
    assert files(saved) == ["mipmaps/Left.ktx2", "mipmaps/Right.ktx2", "scene.blend"]


def test_only_selected_objects(saved):
    assert bake(objects="selected", file_format="dds", texture_format="rgba8") == {"FINISHED"}
    assert files(saved) == ["mipmaps/Left.dds", "scene.blend"]
    assert read_dds(saved / "mipmaps" / "Left.dds").width == 8


def test_level_images_without_files(saved):
    assert bake(result="images", objects="scene") == {"FINISHED"}
    assert files(saved) == ["scene.blend"]
    assert {f"{name}.mip{i:02d}" for name in ("Left", "Right") for i in (1, 2, 3)} < {
        image.name for image in bpy.data.images
    }


def test_a_material(saved, capfd):
    with pytest.raises(RuntimeError, match="Material: there is no 'Gone' in this file"):
        bake(material="Gone")
    # Another material shows the image, too: its surface counts, its other images are not baked.
    other = scenes.textured_quad(bpy.data.images["Right"], "Other")
    scenes.image_node(other.active_material.node_tree, scenes.image("More", scenes.noise(8, 8)))
    material = bpy.data.objects["Right"].active_material
    assert bake(material=material.name) == {"FINISHED"}
    assert files(saved) == ["mipmaps/Right.ktx2", "scene.blend"]
    assert "Baked 1 image into 1 file" in capfd.readouterr().out


def test_a_failed_image_does_not_stop_the_others(saved, capfd):
    image = bpy.data.images["Left"]
    image.unpack(method="REMOVE")
    image.source, image.filepath = "FILE", "//gone.png"
    image.reload()
    assert bake(objects="scene") == {"FINISHED"}
    assert files(saved) == ["mipmaps/Right.ktx2", "scene.blend"]
    said = capfd.readouterr().out
    assert "Warning: image 'Left' is not baked: found no pixels" in said
    assert "Baked 1 of 2 images" in said
    assert "not baked: 'Left'" in said


def test_nothing_is_left_where_all_fails(saved):
    for obj in bpy.data.objects:
        obj.data.uv_layers.remove(obj.data.uv_layers[0])
        obj.data.update()
    with pytest.raises(RuntimeError, match=r"(?s)no image was baked.*'Left' is not baked"):
        bake(folder="//deep/folder")
    assert files(saved) == ["scene.blend"]
    assert not (saved / "deep").exists()


def test_reasons_not_to_start(tmp_path):
    assert not bpy.ops.prefilter.bake_model.poll()
    with pytest.raises(RuntimeError, match="There is no image in this file"):
        bake()
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    assert bpy.ops.prefilter.bake_model.poll()
    with pytest.raises(RuntimeError, match=r"Folder: '//mipmaps/' is beside the \.blend file"):
        bake()
    with pytest.raises(RuntimeError, match="Folder: found none"):
        bake(folder="")
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="as none of these objects shows it: 'Paint'"):
        bake(folder=str(tmp_path), objects="selected")


def test_the_panel_lists_images_to_bake(addon):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image, "Quad", select=False)
    scenes.depsgraph()
    candidates = addon("textures.model.candidates")
    found = candidates.candidates(bpy.context, "scene")
    assert [(one.image, one.content, one.partner) for one in found] == [("Paint", "color", "")]
    assert candidates.missing_reason(bpy.context, "scene") == ""
    material = bpy.data.objects["Quad"].active_material.name
    assert len(candidates.candidates(bpy.context, "scene", material)) == 1
    assert candidates.candidates(bpy.context, "scene", "Gone") == []
    assert (
        candidates.missing_reason(bpy.context, "scene", "Gone")
        == "No visible mesh shows an image of 'Gone'"
    )
    assert candidates.candidates(bpy.context, "auto") == found
    assert candidates.candidates(bpy.context, "selected") == []
    assert candidates.missing_reason(bpy.context, "selected") == "No selected mesh shows an image"
