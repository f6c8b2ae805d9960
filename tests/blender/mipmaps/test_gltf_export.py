# SPDX-License-Identifier: GPL-3.0-or-later

"""What Blender's glTF exporter writes with fitted mipmaps, read back by its parts."""

import json
import struct
import sys

import bpy
import numpy as np
import prefilter
import pytest
import scenes
from conftest import PACKAGE

TYPES = {5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def read_glb(path):
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def view(file, buffer, number):
    found = file["bufferViews"][number]
    start = found.get("byteOffset", 0)
    return buffer[start : start + found["byteLength"]]


def values(file, buffer, number):
    accessor = file["accessors"][number]
    data = view(file, buffer, accessor["bufferView"])
    found = np.frombuffer(data, TYPES[accessor["componentType"]])
    return found.reshape(accessor["count"], WIDTHS[accessor["type"]])


def model(*, mask=False):
    """Makes a cube with a color, normals, and roughness and metallic of two images."""
    cube = scenes.cube(scenes.image("Color", scenes.noise(32, 32, alpha=mask)))
    tree = cube.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    color = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(color.outputs[0], shader.inputs["Base Color"])
    for name, seed in (("Roughness", 2), ("Metallic", 3)):
        data = scenes.image(name, scenes.noise(32, 32, seed=seed), colorspace="Non-Color")
        node = scenes.image_node(tree, data)
        tree.links.new(node.outputs[0], shader.inputs[name])
    normals = scenes.image("Normal", scenes.noise(32, 32, seed=4), colorspace="Non-Color")
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(scenes.image_node(tree, normals).outputs[0], node.inputs["Color"])
    tree.links.new(node.outputs[0], shader.inputs["Normal"])
    return cube


def export(path, *, use=True, fallback="none", **options):
    settings = bpy.context.scene.prefilter_gltf
    settings.use_mipmaps, settings.fallback = use, fallback
    assert bpy.ops.export_scene.gltf(filepath=str(path), **options) == {"FINISHED"}


def surface_of(file, buffer):
    (primitive,) = file["meshes"][0]["primitives"]
    uvs = values(file, buffer, primitive["attributes"]["TEXCOORD_0"]).astype(float)
    return prefilter.Surface(
        values(file, buffer, primitive["attributes"]["POSITION"]),
        values(file, buffer, primitive["indices"]).reshape(-1, 3).astype(int),
        np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1),
    )


def ktx2_of(file, buffer, info):
    texture = file["textures"][info["index"]]
    image = file["images"][texture["extensions"]["KHR_texture_basisu"]["source"]]
    assert image["mimeType"] == "image/ktx2"
    return view(file, buffer, image["bufferView"])


def test_levels_are_those_of_the_surface(tmp_path):
    model()
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    assert file["extensionsRequired"] == file["extensionsUsed"] == ["KHR_texture_basisu"]
    assert len(file["images"]) == 3
    assert all("source" not in texture for texture in file["textures"])
    (material,) = file["materials"]
    metal = material["pbrMetallicRoughness"]
    surface = surface_of(file, buffer)
    packed = scenes.noise(32, 32, seed=2)
    packed[..., 0] = 1
    packed[..., 2] = scenes.noise(32, 32, seed=3)[..., 2]
    normals = scenes.noise(32, 32, seed=4)
    cases = [
        (metal["baseColorTexture"], scenes.noise(32, 32), "srgb"),
        (metal["metallicRoughnessTexture"], packed, "linear"),
        (material["normalTexture"], normals, "normal"),
    ]
    for info, pixels, kind in cases:
        texels = np.rint(pixels[..., :3] * 255).astype(np.uint8)
        encoding = "srgb" if kind == "srgb" else "linear"
        if kind == "normal":
            made = prefilter.normal_mipmaps(
                pixels[..., :3].copy(), [surface], footprint=1.0, wrap="repeat"
            )
        else:
            made = prefilter.mipmaps(
                texels, [surface], encoding=encoding, footprint=1.0, wrap="repeat"
            )
        levels = [texels, *made[1:]]
        if kind == "normal":
            levels[1:] = [(np.clip(one, 0, 1) * 255 + 0.5).astype(np.uint8) for one in made[1:]]
        path = tmp_path / f"{kind}.ktx2"
        prefilter.write_ktx2(
            path, levels, format="uastc", encoding=encoding, supercompression="zstd"
        )
        assert ktx2_of(file, buffer, info) == path.read_bytes(), kind


def test_files_by_themselves_with_a_fallback(tmp_path):
    model()
    export(tmp_path / "model.gltf", fallback="picture", export_format="GLTF_SEPARATE")
    file = json.loads((tmp_path / "model.gltf").read_text())
    assert file["extensionsUsed"] == ["KHR_texture_basisu"]
    assert "extensionsRequired" not in file
    for texture in file["textures"]:
        picture = file["images"][texture["source"]]
        assert (tmp_path / picture["uri"]).read_bytes().startswith(b"\x89PNG")
        image = file["images"][texture["extensions"]["KHR_texture_basisu"]["source"]]
        assert image["uri"].endswith(".ktx2")
        assert (tmp_path / image["uri"]).read_bytes().startswith(b"\xabKTX 20")


@pytest.mark.parametrize("kind", ["GLB", "GLTF_SEPARATE"])
def test_off_changes_nothing(tmp_path, kind, addon):
    model()
    ending = ".glb" if kind == "GLB" else ".gltf"
    (tmp_path / "off").mkdir()
    export(tmp_path / "off" / f"model{ending}", use=False, export_format=kind)
    top = addon("mipmaps.gltf.hooks")
    module = sys.modules[PACKAGE]
    kept = {
        name: module.__dict__.pop(name)
        for name in ("glTF2ExportUserExtension", "glTF2_pre_export_callback")
    }
    assert kept["glTF2ExportUserExtension"] is top.glTF2ExportUserExtension
    (tmp_path / "without").mkdir()
    try:
        export(tmp_path / "without" / f"model{ending}", use=False, export_format=kind)
    finally:
        module.__dict__.update(kept)
    made = {path.name: path.read_bytes() for path in (tmp_path / "off").iterdir()}
    assert made == {path.name: path.read_bytes() for path in (tmp_path / "without").iterdir()}


def test_sides_that_are_no_multiples_of_4_stay_pictures(tmp_path):
    cube = scenes.cube(scenes.image("Odd", scenes.noise(30, 30)))
    tree = cube.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    color = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(color.outputs[0], shader.inputs["Base Color"])
    export(tmp_path / "model.glb", export_format="GLB")
    file, _ = read_glb(tmp_path / "model.glb")
    assert [image["mimeType"] for image in file["images"]] == ["image/png"]
    assert "extensionsUsed" not in file


def principled(tree):
    return next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def test_alpha_is_straight_and_uvs_are_under_a_transform(tmp_path):
    """Colors are weighted by alpha, and the levels are those of the transformed UVs."""
    cube = model(mask=True)
    tree = cube.active_material.node_tree
    nodes = [node for node in tree.nodes if node.type == "TEX_IMAGE"]
    color = next(node for node in nodes if node.image.name == "Color")
    tree.links.new(color.outputs["Alpha"], principled(tree).inputs["Alpha"])
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value[2] = 0.3
    mapping.inputs["Scale"].default_value = (2.0, 3.0, 1.0)
    tree.links.new(tree.nodes.new("ShaderNodeUVMap").outputs[0], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], color.inputs[0])
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    info = file["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    assert "KHR_texture_transform" in info["extensions"]
    uvs = np.empty(2 * len(cube.data.loops), np.float32)
    cube.data.uv_layers.active.data.foreach_get("uv", uvs)
    u, v = uvs.reshape(-1, 2).T * np.array([[2.0], [3.0]])
    cos, sin = np.cos(0.3), np.sin(0.3)
    placed = np.stack([cos * u - sin * v, sin * u + cos * v], axis=1).reshape(-1, 4, 2)
    corners = np.array([cube.data.vertices[loop.vertex_index].co for loop in cube.data.loops])
    order = [0, 1, 2, 0, 2, 3]
    surface = prefilter.Surface(
        corners,
        np.arange(24).reshape(-1, 4)[:, order].reshape(-1, 3),
        placed[:, order].reshape(-1, 3, 2),
    )
    texels = np.rint(scenes.noise(32, 32, alpha=True) * 255).astype(np.uint8)
    made = prefilter.mipmaps(
        texels, [surface], encoding="srgb", footprint=1.0, wrap="repeat", premultiplied=False
    )
    path = tmp_path / "color.ktx2"
    options = {"format": "uastc", "encoding": "srgb", "alpha": "straight"}
    prefilter.write_ktx2(path, made, **options, supercompression="zstd")
    assert ktx2_of(file, buffer, info) == path.read_bytes()
