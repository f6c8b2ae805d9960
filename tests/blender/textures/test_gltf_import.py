# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures in KTX 2 files, imported by Blender's glTF importer."""

import json
import struct
from pathlib import Path

import bpy
import numpy as np
import prefilter
import pytest
import scenes
from test_gltf_export import export, model

SAMPLES = Path(__file__).parents[2] / "python" / "ktx2"


def imported(path):
    """The images by the sockets of the shader to which they lead."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    assert bpy.ops.import_scene.gltf(filepath=str(path)) == {"FINISHED"}
    (material,) = bpy.data.materials
    nodes = [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    return [node.image for node in nodes]


def pixels(image):
    found = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(found)
    return np.rint(255 * found).astype(np.uint8).reshape(image.size[1], image.size[0], 4)


def rewritten(source, target, change):
    """Writes a .glb again, its JSON changed."""
    data = source.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    file = json.loads(data[20 : 20 + length])
    change(file)
    text = json.dumps(file).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4s2I", b"glTF", 2, 20 + len(text) + len(rest))
    target.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + rest)


@pytest.mark.parametrize("kind", ["GLB", "GLTF_SEPARATE"])
def test_exported_files_can_be_imported(tmp_path, kind):
    model()
    path = tmp_path / ("model.glb" if kind == "GLB" else "model.gltf")
    export(path, export_format=kind)
    images = imported(path)
    assert len(images) == 3
    color = next(image for image in images if image.name == "Color")
    assert color.packed_file is not None
    assert color.colorspace_settings.name == "sRGB"
    original = np.rint(255 * scenes.noise(32, 32)).astype(np.uint8)
    prefilter.write_ktx2(tmp_path / "x.ktx2", [original[..., :3]], format="uastc", encoding="srgb")
    (decoded,), _ = prefilter.read_ktx2(tmp_path / "x.ktx2")
    np.testing.assert_array_equal(pixels(color)[..., :3], decoded)
    assert not any(".mip" in image.name for image in bpy.data.images)


def test_a_fallback_is_what_shows(tmp_path):
    model()
    export(tmp_path / "model.glb", fallback="picture", export_format="GLB")
    color = next(image for image in imported(tmp_path / "model.glb") if image.name == "Color")
    original = np.rint(255 * scenes.noise(32, 32)).astype(np.uint8)
    np.testing.assert_array_equal(pixels(color)[..., :3], original[..., :3])


@pytest.mark.parametrize("name", ["basis-lz-rgb", "basis-lz-rgba", "basis-lz-r", "uastc-rg"])
def test_files_of_others(tmp_path, name):
    model()
    export(tmp_path / "model.gltf", export_format="GLTF_SEPARATE")
    file = json.loads((tmp_path / "model.gltf").read_text())
    for image in file["images"]:
        (tmp_path / image["uri"]).write_bytes((SAMPLES / f"{name}.ktx2").read_bytes())
    images = imported(tmp_path / "model.gltf")
    (texels, *_), _ = prefilter.read_ktx2(SAMPLES / f"{name}.ktx2")
    for image in images:
        found = pixels(image)[..., : texels.shape[2]]
        np.testing.assert_array_equal(found, texels)


def test_levels_are_kept_on_wish(tmp_path):
    model()
    export(tmp_path / "model.glb", export_format="GLB")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    bpy.context.scene.prefilter_gltf_import.keep_levels = True
    assert bpy.ops.import_scene.gltf(filepath=str(tmp_path / "model.glb")) == {"FINISHED"}
    names = sorted(image.name for image in bpy.data.images if image.name.startswith("Normal"))
    assert names == ["Normal", *(f"Normal.mip{number:02d}" for number in range(1, 6))]
    level = bpy.data.images["Normal.mip02"]
    assert tuple(level.size) == (8, 8)
    assert level.colorspace_settings.name == "Non-Color"
    assert bpy.data.images["Color.mip02"].colorspace_settings.name == "sRGB"


def test_a_damaged_texture_is_reported(tmp_path, caplog):
    model()
    export(tmp_path / "model.gltf", export_format="GLTF_SEPARATE")
    file = json.loads((tmp_path / "model.gltf").read_text())
    first, *rest = file["images"]
    data = (tmp_path / first["uri"]).read_bytes()
    (tmp_path / first["uri"]).write_bytes(data[:300])
    images = imported(tmp_path / "model.gltf")
    assert len(images) == 1 + len(rest)
    assert sum(tuple(image.size) == (32, 32) for image in images) == len(rest)


def test_other_files_are_left_alone(tmp_path):
    model()
    export(tmp_path / "model.glb", use=False, export_format="GLB")
    images = imported(tmp_path / "model.glb")
    assert {tuple(image.size) for image in images} == {(32, 32)}


def test_an_extension_that_nobody_knows_is_still_refused(tmp_path):
    model()
    export(tmp_path / "model.glb", export_format="GLB")

    def change(file):
        file["extensionsRequired"].append("EXT_unheard_of")
        file["extensionsUsed"].append("EXT_unheard_of")

    rewritten(tmp_path / "model.glb", tmp_path / "other.glb", change)
    with pytest.raises(RuntimeError, match="EXT_unheard_of"):
        bpy.ops.import_scene.gltf(filepath=str(tmp_path / "other.glb"))
