# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of Blender's glTF exporter with fitted mipmaps, read back by their parts."""

import io
import json
import struct
import sys
from pathlib import Path

import bpy
import numpy as np
import prefilter
import pytest
import scenes
from command_line import assert_fails, run
from conftest import PACKAGE
from gltf_trees import read_tree

sys.path.append(str(Path(__file__).resolve().parents[3] / "docs" / "pictures" / "windows"))

import drawn

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


def test_etc1s_is_for_all_but_normal_maps(tmp_path):
    model()
    settings = bpy.context.scene.prefilter_gltf
    export(tmp_path / "fine.glb", export_format="GLB")
    settings.texture_format = "etc1s"
    try:
        export(tmp_path / "small.glb", export_format="GLB")
    finally:
        settings.property_unset("texture_format")
    file, buffer = read_glb(tmp_path / "small.glb")
    (material,) = file["materials"]
    metal = material["pbrMetallicRoughness"]
    found = {
        kind: ktx2_of(file, buffer, info)
        for kind, info in (
            ("color", metal["baseColorTexture"]),
            ("data", metal["metallicRoughnessTexture"]),
            ("normal", material["normalTexture"]),
        )
    }
    formats = {kind: prefilter.read_ktx2(io.BytesIO(data))[1] for kind, data in found.items()}
    assert [formats[kind].format for kind in ("color", "data", "normal")] == [
        *("etc1s", "etc1s", "uastc")
    ]
    assert [formats[kind].supercompression for kind in ("color", "data", "normal")] == [
        *("basislz", "basislz", "zstd")
    ]
    # The levels are those of UASTC: the codecs are all that differs.
    fine_file, fine_buffer = read_glb(tmp_path / "fine.glb")
    fine_metal = fine_file["materials"][0]["pbrMetallicRoughness"]
    fine = ktx2_of(fine_file, fine_buffer, fine_metal["baseColorTexture"])
    levels = [prefilter.read_ktx2(io.BytesIO(data))[0] for data in (found["color"], fine)]
    assert [one.shape for one in levels[0]] == [one.shape for one in levels[1]]
    for one, other in zip(*levels, strict=True):
        assert abs(one.astype(float).mean() - other.mean()) < 6
    assert len(found["color"]) < len(fine)


def test_the_quality_of_etc1s_is_that_of_the_dialog(tmp_path):
    painted("Paint", scenes.noise(64, 64))
    settings = bpy.context.scene.prefilter_gltf
    settings.texture_format = "etc1s"
    sizes = {}
    for quality in (192, 64, 8):
        settings.quality = quality
        export(tmp_path / f"{quality}.glb", export_format="GLB")
        file, buffer = read_glb(tmp_path / f"{quality}.glb")
        data = ktx2_of(file, buffer, base_color(file, 0))
        texels = as_bytes(scenes.noise(64, 64)[..., :3])
        made = prefilter.mipmaps(
            texels, [surface_of(file, buffer)], encoding="srgb", footprint=1.0, wrap="repeat"
        )
        path = tmp_path / "alone.ktx2"
        prefilter.write_ktx2(path, made, format="etc1s", encoding="srgb", quality=quality)
        assert data == path.read_bytes()
        sizes[quality] = len(data)
    assert sizes[8] < sizes[64] < sizes[192]


def test_the_dialog_shows_the_quality_for_etc1s_only(addon):
    panel = addon("textures.gltf.panel")
    settings = bpy.context.scene.prefilter_gltf
    settings.use_mipmaps = True
    shown = {}
    for texture_format in ("uastc", "etc1s"):
        settings.texture_format = texture_format
        rows = []
        panel.draw_export(bpy.context, drawn.Layout(rows))
        shown[texture_format] = [row[2] for row in rows if row[0] == "setting"]
    assert shown["uastc"] == [
        *("Prefilter Mipmaps", "Lookups", "Format", "Effort", "Compression", "Fallback", "Filter")
    ]
    assert shown["etc1s"] == [*shown["uastc"][:4], "ETC1S Quality", *shown["uastc"][4:]]


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
    top = addon("textures.gltf.hooks")
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


def principled(tree):
    return next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def painted(name, pixels):
    """Makes a cube with an image as its base color."""
    cube = scenes.cube(scenes.image(name, pixels))
    tree = cube.active_material.node_tree
    color = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(color.outputs[0], principled(tree).inputs["Base Color"])
    return cube


def as_bytes(values):
    return (np.clip(values, 0, 1) * 255 + 0.5).astype(np.uint8)


def test_sides_become_multiples_of_4(tmp_path):
    pixels = scenes.noise(30, 21)
    painted("Odd", pixels)
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    light = prefilter.to_linear(np.rint(pixels[..., :3] * 255).astype(np.float32) / 255)
    wide = prefilter.resize(light, 24, 32, wrap="repeat")
    texels = as_bytes(prefilter.to_srgb(np.clip(wide, light.min((0, 1)), light.max((0, 1)))))
    options = {"encoding": "srgb", "footprint": 1.0, "wrap": "repeat"}
    levels = prefilter.mipmaps(texels, [surface_of(file, buffer)], **options)
    path = tmp_path / "odd.ktx2"
    prefilter.write_ktx2(path, levels, format="uastc", encoding="srgb", supercompression="zstd")
    info = file["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    assert ktx2_of(file, buffer, info) == path.read_bytes()


def test_alpha_is_straight_and_uvs_are_under_a_transform(tmp_path):
    """Colors are weighted by alpha, and the levels follow the transformed UVs."""
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


@pytest.mark.parametrize("ending", ["glb", "gltf"])
def test_the_command_exports_as_the_dialog_does(tmp_path, ending):
    cube = model()
    cube.rotation_euler = (0.1, 0.2, 0.3)
    source = tmp_path / "in" / "model.blend"
    for folder in ("in", "dialog", "command"):
        (tmp_path / folder).mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    kind = {"glb": "GLB", "gltf": "GLTF_SEPARATE"}[ending]
    export(tmp_path / "dialog" / f"out.{ending}", export_format=kind)
    target = tmp_path / "command" / f"out.{ending}"
    result = run("bake", source, "--all", "--output", target)
    assert result.returncode == 0, result.stderr
    assert f"Baked 3 images into '{target}'" in result.stdout
    made = {path.name: path.read_bytes() for path in target.parent.iterdir()}
    assert made == {path.name: path.read_bytes() for path in (tmp_path / "dialog").iterdir()}


def test_the_command_has_options(tmp_path):
    model()
    scenes.textured_quad(scenes.image("Odd", scenes.noise(30, 30)), "Other")
    source, target = tmp_path / "model.blend", tmp_path / "out" / "out.gltf"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    target.parent.mkdir()
    options = ("--fallback", "picture", "--supercompression", "none", "--filter", "box")
    result = run("bake", source, "--all", "--object", "Cube", "--output", target, *options)
    assert result.returncode == 0, result.stderr
    file = json.loads(target.read_text())
    assert [mesh["name"] for mesh in file["meshes"]] == ["Cube"]
    assert "extensionsRequired" not in file
    assert len(file["images"]) == 6
    ktx2 = [image["uri"] for image in file["images"] if image["mimeType"] == "image/ktx2"]
    schemes = [struct.unpack_from("<I", (target.parent / name).read_bytes(), 44) for name in ktx2]
    assert schemes == [(0,)] * 3


def test_the_command_has_effort(tmp_path):
    painted("Paint", scenes.noise(128, 128))
    source = tmp_path / "model.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    files = []
    for more in ((), ("--effort", "fast")):
        target = tmp_path / f"{len(files)}.glb"
        result = run("bake", source, "--all", "--output", target, *more)
        assert result.returncode == 0, result.stderr
        files.append(target.read_bytes())
    assert files[0] != files[1]


def test_the_command_has_etc1s(tmp_path):
    painted("Even", scenes.noise(32, 32))
    source, target = tmp_path / "model.blend", tmp_path / "out.glb"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    options = ("--texture-format", "etc1s")
    result = run("bake", source, "--all", "--output", target, *options)
    assert result.returncode == 0, result.stderr
    file, buffer = read_glb(target)
    (image,) = file["images"]
    _, info = prefilter.read_ktx2(io.BytesIO(view(file, buffer, image["bufferView"])))
    assert info.format == "etc1s"
    result = run("bake", source, "--all", "--output", target, "--texture-format", "bc7")
    assert_fails(result, "--texture-format: found 'bc7'", "uastc or etc1s is needed", status=2)


def test_the_command_leaves_its_sources(tmp_path):
    model()
    source = tmp_path / "model.glb"
    export(source, use=False, export_format="GLB")
    before = source.read_bytes()
    for target in (source, tmp_path / "other.gltf"):
        result = run("bake", source, "--all", "--output", target)
        assert_fails(result, "--output", "among the files of the model")
    assert source.read_bytes() == before
    assert list(tmp_path.iterdir()) == [source]


def test_the_command_reports_images_that_stay(tmp_path):
    painted("Odd", scenes.noise(30, 30))
    source, target = tmp_path / "model.blend", tmp_path / "out.glb"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    result = run("bake", source, "--all", "--output", target)
    assert "'Odd' is stretched from 30 x 30 to 32 x 32" in result.stdout
    assert result.returncode == 0


def uastc(path, levels, encoding, **options):
    """Returns the bytes of an exported file."""
    more = {"encoding": encoding, "supercompression": "zstd", **options}
    prefilter.write_ktx2(path, levels, format="uastc", **more)
    return path.read_bytes()


def color_levels(pixels, surface):
    texels = np.rint(pixels[..., :3] * 255).astype(np.uint8)
    return prefilter.mipmaps(texels, [surface], encoding="srgb", footprint=1.0, wrap="repeat")


def base_color(file, number=0):
    return file["materials"][number]["pbrMetallicRoughness"]["baseColorTexture"]


def test_cutouts_keep_their_coverage(tmp_path):
    pixels = scenes.noise(32, 32, alpha=True)
    cube = painted("Leaf", pixels)
    tree = cube.active_material.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    below, rest = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    below.operation, rest.operation = "LESS_THAN", "SUBTRACT"
    below.inputs[1].default_value, rest.inputs[0].default_value = 0.3, 1.0
    tree.links.new(texture.outputs["Alpha"], below.inputs[0])
    tree.links.new(below.outputs[0], rest.inputs[1])
    tree.links.new(rest.outputs[0], principled(tree).inputs["Alpha"])
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    assert file["materials"][0]["alphaMode"] == "MASK"
    assert file["materials"][0]["alphaCutoff"] == pytest.approx(0.3)
    surface = surface_of(file, buffer)
    texels = np.rint(pixels * 255).astype(np.uint8)
    light = texels.astype(np.float32) / 255
    light[..., :3] = prefilter.to_linear(light[..., :3])
    options = {"wrap": "repeat", "premultiplied": False}
    made = prefilter.mipmaps(light, [surface], footprint=1.0, **options)
    threshold = float(np.float32(0.3))
    kept = prefilter.keep_coverage(made, [surface], threshold=threshold, **options)
    plain, kept = (
        [np.dstack([prefilter.to_srgb(one[..., :3]), one[..., 3]]) for one in levels[1:]]
        for levels in (made, kept)
    )
    path = tmp_path / "leaf.ktx2"
    expected = uastc(path, [texels, *map(as_bytes, kept)], "srgb", alpha="straight")
    found = ktx2_of(file, buffer, base_color(file))
    assert found == expected
    assert found != uastc(path, [texels, *map(as_bytes, plain)], "srgb", alpha="straight")


def test_color_and_occlusion_at_once_are_two_textures(tmp_path):
    pixels = scenes.noise(32, 32)
    cube = painted("Both", pixels)
    tree = cube.active_material.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    kept = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    kept.interface.new_socket("Occlusion", in_out="INPUT", socket_type="NodeSocketFloat")
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = kept
    apart = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(texture.outputs["Color"], apart.inputs[0])
    tree.links.new(apart.outputs["Red"], group.inputs["Occlusion"])
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    info = file["materials"][0]["occlusionTexture"]
    surface = surface_of(file, buffer)
    colors = uastc(tmp_path / "color.ktx2", color_levels(pixels, surface), "srgb")
    texels = as_bytes(pixels[..., :3])
    made = prefilter.mipmaps(texels, [surface], footprint=1.0, wrap="repeat")
    data = uastc(tmp_path / "data.ktx2", [texels, *made[1:]], "linear")
    assert ktx2_of(file, buffer, base_color(file)) == colors
    assert ktx2_of(file, buffer, info) == data
    assert sorted(image["name"] for image in file["images"]) == ["Both_color", "Both_data"]


@pytest.mark.parametrize("ending", [".glb", ".gltf"])
def test_a_color_that_is_a_normal_map_too_is_two_textures(tmp_path, ending):
    """Each equals the result for an image with that role alone."""
    pixels = scenes.noise(32, 32)
    cube = painted("Both", pixels)
    tree = cube.active_material.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    tree.links.new(node.outputs["Normal"], principled(tree).inputs["Normal"])
    path = tmp_path / f"model{ending}"
    kind = {".glb": "GLB", ".gltf": "GLTF_SEPARATE"}[ending]
    export(path, export_format=kind, fallback="picture")
    tree_ = read_tree(path)
    (material,) = tree_["materials"]
    infos = [material["pbrMetallicRoughness"]["baseColorTexture"], material["normalTexture"]]
    textures = [tree_["textures"][info["index"]] for info in infos]
    sources = [one["extensions"]["KHR_texture_basisu"]["source"] for one in textures]
    assert [tree_["images"][source]["name"] for source in sources] == ["Both_color", "Both_normal"]
    assert all("source" in one for one in textures)
    if ending == ".gltf":
        names = [tree_["images"][source]["uri"] for source in sources]
        assert names == ["Both_color.ktx2", "Both_normal.ktx2"]
        found = [(tmp_path / name).read_bytes() for name in names]
    else:
        file, buffer = read_glb(path)
        found = [ktx2_of(file, buffer, info) for info in infos]
        surface = surface_of(file, buffer)
        levels = color_levels(pixels, surface)
        assert found[0] == uastc(tmp_path / "color.ktx2", levels, "srgb")
    encodings = [prefilter.read_ktx2(io.BytesIO(data))[1] for data in found]
    assert encodings[0] != encodings[1]


def test_one_image_with_and_without_alpha_is_two_textures(tmp_path):
    """If alpha is ignored, the colors of transparent texels are visible."""
    pixels = scenes.noise(32, 32, alpha=True)
    first = painted("Leaf", pixels)
    second = scenes.cube(bpy.data.images["Leaf"])
    for cube, covers in ((first, True), (second, False)):
        tree = cube.active_material.node_tree
        texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
        tree.links.new(texture.outputs["Color"], principled(tree).inputs["Base Color"])
        if covers:
            tree.links.new(texture.outputs["Alpha"], principled(tree).inputs["Alpha"])
    export(tmp_path / "model.glb", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    data = {
        material.get("alphaMode", "OPAQUE"): ktx2_of(
            file, buffer, material["pbrMetallicRoughness"]["baseColorTexture"]
        )
        for material in file["materials"]
    }
    assert data.pop("OPAQUE") != next(iter(data.values()))


def test_the_fallback_of_a_jpeg_file_is_that_file(tmp_path):
    source = tmp_path / "in" / "photo.jpg"
    source.parent.mkdir()
    bpy.context.scene.render.image_settings.file_format = "JPEG"
    made = scenes.image("Made", scenes.noise(32, 32))
    made.filepath_raw, made.file_format = str(source), "JPEG"
    made.save()
    photo = bpy.data.images.load(str(source))
    cube = scenes.cube(photo)
    tree = cube.active_material.node_tree
    color = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(color.outputs[0], principled(tree).inputs["Base Color"])
    export(tmp_path / "model.glb", fallback="picture", export_format="GLB")
    file, buffer = read_glb(tmp_path / "model.glb")
    picture = file["images"][file["textures"][0]["source"]]
    assert picture["mimeType"] == "image/jpeg"
    assert view(file, buffer, picture["bufferView"]) == source.read_bytes()
    levels = color_levels(scenes.pixels("photo.jpg"), surface_of(file, buffer))
    expected = uastc(tmp_path / "photo.ktx2", levels, "srgb")
    assert ktx2_of(file, buffer, base_color(file)) == expected


def test_draco_compresses_the_mesh_alone(tmp_path):
    model()
    export(tmp_path / "plain.glb", export_format="GLB")
    options = {"export_draco_mesh_compression_enable": True}
    try:
        export(tmp_path / "draco.glb", export_format="GLB", **options)
    except (RuntimeError, TypeError):
        pytest.skip("this Blender has no Draco")
    file, buffer = read_glb(tmp_path / "draco.glb")
    if "KHR_draco_mesh_compression" not in file["extensionsUsed"]:
        pytest.skip("this Blender has no Draco")
    plain, others = read_glb(tmp_path / "plain.glb")
    for info, same in zip(textures_of(file), textures_of(plain), strict=True):
        assert ktx2_of(file, buffer, info) == ktx2_of(plain, others, same)


def textures_of(file):
    (material,) = file["materials"]
    metal = material["pbrMetallicRoughness"]
    return [
        metal["baseColorTexture"],
        metal["metallicRoughnessTexture"],
        material["normalTexture"],
    ]


def test_textures_of_variants_are_fitted(tmp_path):
    preferences = bpy.context.preferences.addons["io_scene_gltf2"].preferences
    preferences.KHR_materials_variants_ui = True
    try:
        cube = painted("First", scenes.noise(32, 32))
        second = painted("Second", scenes.noise(32, 32, seed=9))
        material = second.active_material
        bpy.data.objects.remove(second)
        scene = bpy.context.scene
        variant = scene.gltf2_KHR_materials_variants_variants.add()
        variant.variant_idx, variant.name = 0, "Other"
        data = cube.data.gltf2_variant_mesh_data.add()
        data.material_slot_index, data.material = 0, material
        data.variants.add().variant.variant_idx = 0
        export(tmp_path / "model.glb", export_format="GLB")
    finally:
        preferences.KHR_materials_variants_ui = False
    file, buffer = read_glb(tmp_path / "model.glb")
    assert "KHR_materials_variants" in file["extensionsUsed"]
    surface = surface_of(file, buffer)
    found = {
        file["materials"][number]["name"]: ktx2_of(file, buffer, base_color(file, number))
        for number in (0, 1)
    }
    for name, seed in (("Cube material", 1), ("Cube material.001", 9)):
        levels = color_levels(scenes.noise(32, 32, seed=seed), surface)
        assert found[name] == uastc(tmp_path / "one.ktx2", levels, "srgb"), name
