# SPDX-License-Identifier: GPL-3.0-or-later

"""Images that are no color: normal maps and their roughness, cut-outs, masks."""

import bpy
import numpy as np
import OpenImageIO as oiio
import prefilter
import pytest
import scenes
from texture_readers import read_ktx2


def bumps(height, width, seed=1):
    """RGBA of an encoded normal map, in values that bytes hold."""
    slopes = np.random.default_rng(seed).normal(0, 0.4, (height, width, 2))
    vectors = np.concatenate([slopes, np.ones((height, width, 1))], axis=2)
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    values = np.ones((height, width, 4), np.float32)
    values[..., :3] = np.round((vectors + 1) / 2 * 255) / 255
    return values


def vectors_of(name):
    return 2 * scenes.pixels(name)[..., :3].astype(np.float64) - 1


def gray(height, width, seed=2):
    values = np.repeat(scenes.noise(height, width, seed=seed)[..., :1], 4, axis=2)
    values[..., 3] = 1
    return values


def leaves(size=32):
    """Straight RGBA, thin green lines of alpha 1 in red of alpha 0."""
    values = np.zeros((size, size, 4), np.float32)
    values[...] = (1, 0, 0, 0)
    values[3 :: size // 4, :] = (0, 0.5, 0, 1)
    return values


def kept(values, threshold=0.5):
    """The share of the image where bilinear lookups reach the threshold, by a fine grid."""
    alpha = np.pad(values, 1, mode="edge")
    height, width = values.shape
    y, x = ((np.arange(512) + 0.5) / 512 * side + 0.5 for side in (height, width))
    j, i = np.floor(y).astype(int)[:, None], np.floor(x).astype(int)[None]
    v, u = y[:, None] - j, x[None] - i
    lower = alpha[j, i] * (1 - u) + alpha[j, i + 1] * u
    upper = alpha[j + 1, i] * (1 - u) + alpha[j + 1, i + 1] * u
    return (lower * (1 - v) + upper * v >= threshold).mean()


def normal_map_material(picture):
    """Makes a material whose Normal Map node reads the image."""
    made = scenes.material("Bumpy", picture)
    tree = made.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    return made


def test_normal_levels_have_the_length_1(bake):
    values = bumps(16, 16)
    image = scenes.image("Bumps", values, colorspace="Non-Color")
    outcome = bake(image, [scenes.textured_quad(image)], content="normal", wrap="clamp")
    assert "as Normal Map" in outcome.summary
    quad = prefilter.Surface(
        np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float),
        np.array([(0, 1, 2), (0, 2, 3)]),
        np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], float),
    )
    expected = prefilter.normal_mipmaps(np.ascontiguousarray(values[..., :3]), quad)
    for number, level in enumerate(expected[1:], start=1):
        found = scenes.pixels(f"Bumps.mip{number:02d}")
        np.testing.assert_allclose(found[..., :3], level, atol=0.6 / 255)
        lengths = np.linalg.norm(vectors_of(f"Bumps.mip{number:02d}"), axis=2)
        np.testing.assert_allclose(lengths, 1, atol=0.01)
        assert bpy.data.images[f"Bumps.mip{number:02d}"].colorspace_settings.name == "Non-Color"


def test_data_shortens_normals(bake):
    """Unlike the content "normal", plain data loses length in the same map."""
    image = scenes.image("Bumps", bumps(16, 16), colorspace="Non-Color")
    bake(image, [scenes.textured_quad(image)], content="data")
    assert np.linalg.norm(vectors_of("Bumps.mip04")) < 0.95


def test_box_levels_of_normals_are_means_of_vectors(bake):
    values = bumps(8, 8)
    bake(scenes.image("Bumps", values, colorspace="Non-Color"), filter="box", content="normal")
    vectors = 2 * values[..., :3].astype(np.float64) - 1
    vectors /= np.linalg.norm(vectors, axis=2, keepdims=True)
    mean = scenes.halved(vectors)
    mean /= np.linalg.norm(mean, axis=2, keepdims=True)
    np.testing.assert_allclose(vectors_of("Bumps.mip01"), mean, atol=1.1 / 255)


def test_use_in_a_normal_map_node_is_found(bake):
    image = scenes.image("Bumps", bumps(8, 8), colorspace="Non-Color")
    quad = scenes.quads("Quad")
    quad.data.materials.append(normal_map_material(image))
    assert "as Normal Map" in bake(image, [quad]).summary


@pytest.mark.parametrize("way", ["direct", "reroute", "turned", "group", "in group", "factor"])
def test_how_a_normal_map_node_gets_its_color(addon, way):
    plan = addon("textures.model.plan")
    image = scenes.image("Bumps", bumps(8, 8), colorspace="Non-Color")
    other = scenes.image("Other", bumps(8, 8), colorspace="Non-Color")
    material = bpy.data.materials.new("Bumpy")
    scenes.use_nodes(material)
    tree = material.node_tree
    texture = scenes.image_node(tree, image)
    node = tree.nodes.new("ShaderNodeNormalMap")
    color = texture.outputs["Color"]

    def feeds(material, image):
        return plan.describe_image(image, [material]).content == "normal"

    if way == "reroute":
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(color, reroute.inputs[0])
        color = reroute.outputs[0]
    elif way == "turned":
        apart = tree.nodes.new("ShaderNodeSeparateColor")
        invert = tree.nodes.new("ShaderNodeMath")
        together = tree.nodes.new("ShaderNodeCombineColor")
        tree.links.new(color, apart.inputs["Color"])
        tree.links.new(apart.outputs["Green"], invert.inputs[1])
        tree.links.new(invert.outputs[0], together.inputs["Green"])
        color = together.outputs["Color"]
    elif way in {"group", "in group"}:
        inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
        inner.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketColor")
        inner.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
        start = inner.nodes.new("NodeGroupInput")
        end = inner.nodes.new("NodeGroupOutput")
        group = tree.nodes.new("ShaderNodeGroup")
        group.node_tree = inner
        tree.links.new(color, group.inputs["In"])
        if way == "group":
            inner.links.new(start.outputs["In"], end.inputs["Out"])
            color = group.outputs["Out"]
        else:
            tree.nodes.remove(node)
            node = inner.nodes.new("ShaderNodeNormalMap")
            inner.links.new(start.outputs["In"], node.inputs["Color"])
            assert feeds(material, image)
            return
    elif way == "factor":
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        tree.links.new(color, mix.inputs["Factor"])
        tree.links.new(scenes.image_node(tree, other).outputs["Color"], mix.inputs[6])
        color = mix.outputs[2]
    assert not feeds(material, image)
    tree.links.new(color, node.inputs["Color"])
    assert feeds(material, image) is (way != "factor")
    assert feeds(material, other) is (way == "factor")
    node.mute = True
    assert not feeds(material, image)


def test_color_space_of_a_normal_map_is_warned_of(bake):
    image = scenes.image("Bumps", bumps(8, 8))
    outcome = bake(image, filter="box", content="normal")
    assert any("color space sRGB" in warning for warning in outcome.warnings)
    # The values are normals as they are stored, all the same.
    np.testing.assert_allclose(np.linalg.norm(vectors_of("Bumps.mip01"), axis=2), 1, atol=0.01)


@pytest.mark.parametrize("is_float", [False, True])
def test_roughness_compensates_for_normals(bake, is_float):
    values, rough = bumps(16, 16), gray(16, 16) * np.float32((0.5, 0.5, 0.5, 1))
    rough = np.round(rough * 255).astype(np.float32) / 255
    image = scenes.image("Bumps", values, colorspace="Non-Color", is_float=is_float)
    scenes.image("Rough", rough, colorspace="Non-Color", is_float=is_float)
    outcome = bake(
        image, [scenes.textured_quad(image)], content="normal", roughness="Rough", filter="box",
        wrap="clamp",
    )  # fmt: skip
    assert outcome.images == [
        f"{name}.mip{i:02d}" for name in ("Bumps", "Rough") for i in (1, 2, 3, 4)
    ]
    _, expected = prefilter.normal_mipmaps(
        np.ascontiguousarray(values[..., :3]),
        filter="box",
        roughness=np.ascontiguousarray(rough[..., :1]),
    )
    plain = scenes.halved(rough[..., :3] ** 4) ** 0.25
    found = scenes.pixels("Rough.mip01")[..., :3]
    assert (found > plain - 0.03).mean() > 0.95
    assert found.mean() > plain.mean() + 0.02
    for number, level in enumerate(expected[1:], start=1):
        found = scenes.pixels(f"Rough.mip{number:02d}")
        np.testing.assert_allclose(found[..., :3], np.repeat(level, 3, 2), atol=0.6 / 255)
        np.testing.assert_array_equal(found[..., 3], 1)


def test_packed_roughness_leaves_the_other_channels_data(bake):
    values, packed = bumps(8, 8), scenes.noise(8, 8, seed=5)
    image = scenes.image("Bumps", values, colorspace="Non-Color")
    scenes.image("Packed", packed, colorspace="Non-Color")
    bake(image, filter="box", content="normal", roughness="Packed", roughness_channel="green")
    found = scenes.pixels("Packed.mip01")
    plain = scenes.halved(packed)
    np.testing.assert_allclose(found[..., [0, 2]], plain[..., [0, 2]], atol=0.51 / 255)
    _, expected = prefilter.normal_mipmaps(
        np.ascontiguousarray(values[..., :3]),
        filter="box",
        wrap="repeat",
        roughness=np.ascontiguousarray(packed[..., 1:2]),
    )
    np.testing.assert_allclose(found[..., 1:2], expected[1], atol=0.51 / 255)


def test_fourth_channel_of_a_normal_map_is_data(bake):
    values = bumps(8, 8)
    values[..., 3] = scenes.noise(8, 8, seed=6)[..., 0]
    image = scenes.image("Bumps", values, colorspace="Non-Color", alpha_mode="CHANNEL_PACKED")
    bake(image, filter="box", content="normal")
    found = scenes.pixels("Bumps.mip01")
    np.testing.assert_allclose(found[..., 3], scenes.halved(values[..., 3]), atol=0.51 / 255)
    np.testing.assert_allclose(np.linalg.norm(vectors_of("Bumps.mip01"), axis=2), 1, atol=0.01)


def test_roughness_to_a_file(bake, tmp_path):
    image = scenes.image("Bumps", bumps(16, 16), colorspace="Non-Color")
    scenes.image("Rough", gray(16, 16), colorspace="Non-Color")
    outcome = bake(
        image,
        filter="box",
        content="normal",
        roughness="Rough",
        use_images=False,
        filepath=str(tmp_path / "bumps.tif"),
        roughness_filepath=str(tmp_path / "rough.tif"),
    )
    assert "rough.tif" in outcome.summary
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bumps.tif", "rough.tif"]
    rough = oiio.ImageBuf(str(tmp_path / "rough.tif"), 0, 4).get_pixels("float")
    bake(image, filter="box", content="normal", roughness="Rough")
    np.testing.assert_allclose(
        rough[0, 0, 0], scenes.pixels("Rough.mip04")[0, 0, 0], atol=0.6 / 255
    )


def test_failure_writes_neither_image_nor_file(bake, addon, tmp_path, monkeypatch):
    image = scenes.image("Bumps", bumps(8, 8), colorspace="Non-Color")
    scenes.image("Rough", gray(8, 8), colorspace="Non-Color")
    before = sorted(other.name for other in bpy.data.images)
    original = addon("textures.bake").stage_levels

    def stage(picture, levels):
        if picture.name == "Rough":
            raise MemoryError("no room")
        return original(picture, levels)

    monkeypatch.setattr(addon("textures.bake"), "stage_levels", stage)
    with pytest.raises(MemoryError, match="no room"):
        bake(
            image,
            filter="box",
            content="normal",
            roughness="Rough",
            filepath=str(tmp_path / "bumps.exr"),
            roughness_filepath=str(tmp_path / "rough.exr"),
        )
    assert sorted(other.name for other in bpy.data.images) == before
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("stop_at", [0.0, 0.3, 0.6, 0.95, 1.0])
def test_cancel_leaves_nothing(bake, tmp_path, stop_at):
    image = scenes.image("Bumps", bumps(64, 64), colorspace="Non-Color")
    scenes.image("Rough", gray(64, 64), colorspace="Non-Color")
    before = sorted(other.name for other in bpy.data.images)
    with pytest.raises(prefilter.Cancelled):
        bake(
            image,
            filter="box",
            content="normal",
            roughness="Rough",
            filepath=str(tmp_path / "bumps.exr"),
            roughness_filepath=str(tmp_path / "rough.exr"),
            progress=lambda done: done < stop_at,
        )
    assert sorted(other.name for other in bpy.data.images) == before
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", ["normal", "cutout"])
def test_progress_rises_to_one(bake, content):
    told = []
    image = scenes.image("Leaf", leaves(64))
    scenes.image("Rough", gray(64, 64), colorspace="Non-Color")
    bake(
        image,
        [scenes.textured_quad(image)],
        content=content,
        roughness="Rough" if content == "normal" else "",
        progress=lambda done: told.append(done) or True,
    )
    assert told == sorted(told)
    assert told[-1] == 1


@pytest.mark.parametrize("is_float", [False, True])
def test_cutout_keeps_its_coverage(bake, is_float):
    """Lines that ordinary levels lose; straight alpha in bytes, associated in floats."""
    values = leaves()
    if is_float:
        values[..., :3] *= values[..., 3:]
    image = scenes.image("Leaf", values, colorspace=None if is_float else "Linear Rec.709",
                         is_float=is_float)  # fmt: skip
    wanted = kept(values[..., 3])
    bake(image, filter="box", content="color", wrap="clamp")
    assert kept(scenes.pixels("Leaf.mip02")[..., 3]) < 0.1 * wanted
    bake(image, filter="box", content="cutout", wrap="clamp")
    for number in (1, 2):
        found = scenes.pixels(f"Leaf.mip{number:02d}")
        assert kept(found[..., 3]) == pytest.approx(wanted, abs=0.02)
        shown = found[found[..., 3] > 0.1]
        straight = shown[:, :3] / shown[:, 3:] if is_float else shown[:, :3]
        assert len(shown) > 0
        green = np.broadcast_to(np.float32((0, 0.5, 0)), straight.shape)
        np.testing.assert_allclose(straight, green, atol=0.01)


def test_threshold_counts(bake):
    values = leaves()
    values[..., 3] = np.linspace(0, 1, 32) ** 3
    image = scenes.image("Leaf", values)
    for threshold in (0.2, 0.8):
        bake(image, filter="box", content="cutout", threshold=threshold, wrap="clamp")
        wanted = kept(values[..., 3], threshold)
        for number in (1, 2):
            found = kept(scenes.pixels(f"Leaf.mip{number:02d}")[..., 3], threshold)
            assert found == pytest.approx(wanted, abs=0.02)


def test_gray_image_is_a_mask_to_cut_out(bake):
    values = np.repeat(leaves()[..., 3:], 4, axis=2)
    values[..., 3] = 1
    image = scenes.image("Mask", values, colorspace="Non-Color")
    bake(image, filter="box", content="cutout", wrap="clamp")
    found = scenes.pixels("Mask.mip02")
    assert kept(found[..., 0]) == pytest.approx(kept(values[..., 0]), abs=0.02)
    np.testing.assert_array_equal(found[..., :1], found[..., 1:2])
    np.testing.assert_array_equal(found[..., 3], 1)


def test_data_of_an_srgb_image_stays_as_stored(bake):
    values = scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Mask", values), filter="box", content="data")
    np.testing.assert_allclose(scenes.pixels("Mask.mip01"), scenes.halved(values), atol=0.51 / 255)
    assert bpy.data.images["Mask.mip01"].colorspace_settings.name == "sRGB"


def test_color_of_a_data_image_is_light_with_coverage(bake):
    values = scenes.noise(8, 8, alpha=True)
    bake(scenes.image("Leaf", values, colorspace="Non-Color"), filter="box", content="color")
    alpha = scenes.halved(values[..., 3:])
    color = scenes.halved(scenes.to_linear(values[..., :3]) * values[..., 3:]) / alpha
    found = scenes.pixels("Leaf.mip01")[..., :3]
    np.testing.assert_allclose(found, scenes.to_srgb(color), atol=0.51 / 255)
    assert bpy.data.images["Leaf.mip01"].colorspace_settings.name == "Non-Color"


def shader_of(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


@pytest.mark.parametrize("way", ["tinted", "alone", "ramp", "over another"])
def test_color_and_data_at_once_is_color(bake, addon, way):
    """As in glTF files, whose importer leaves such an image Non-Color."""
    values = scenes.noise(8, 8)
    image = scenes.image("Both", values, colorspace="Non-Color")
    quad = scenes.textured_quad(image)
    tree, shader = quad.active_material.node_tree, shader_of(quad.active_material)
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    color = texture.outputs["Color"]
    if way == "ramp":
        ramp = tree.nodes.new("ShaderNodeValToRGB")
        tree.links.new(color, ramp.inputs[0])
        color = ramp.outputs["Color"]
    elif way != "alone":
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
        tree.links.new(color, mix.inputs[6])
        if way == "over another":
            base = scenes.image_node(tree, scenes.image("Base", scenes.noise(8, 8)))
            tree.links.new(base.outputs["Color"], mix.inputs[7])
        color = mix.outputs[2]
    tree.links.new(color, shader.inputs["Base Color"])
    if way != "alone":
        apart = tree.nodes.new("ShaderNodeSeparateColor")
        tree.links.new(texture.outputs["Color"], apart.inputs["Color"])
        tree.links.new(apart.outputs["Green"], shader.inputs["Roughness"])
    content = "color" if way == "tinted" else "data"
    depsgraph = scenes.depsgraph()
    planned = addon("textures.model.plan").plan(depsgraph.view_layer, depsgraph)
    assert {item.image: item.content for item in planned.items}["Both"] == content
    bake(image, [quad], filter="box")
    colors = values[..., :3]
    expected = scenes.halved(colors)
    if content == "color":
        expected = scenes.to_srgb(scenes.halved(scenes.to_linear(colors)))
    found = scenes.pixels("Both.mip01")[..., :3]
    np.testing.assert_allclose(found, expected, atol=0.51 / 255)


def test_color_that_is_data_too_is_written_as_color(bake, tmp_path):
    image = scenes.image("Both", scenes.noise(8, 8), colorspace="Non-Color")
    path = tmp_path / "both.ktx2"
    bake(image, content="color", filter="box", filepath=str(path), texture_format="bc7")
    assert read_ktx2(path).format == "BC7_SRGB"


@pytest.mark.parametrize("alpha_mode", ["CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("filter", ["box", "pam-bilinear"])
def test_packed_channels_are_independent(bake, alpha_mode, filter):
    """The fourth channel does not change the colors."""
    values = scenes.noise(8, 8, alpha=True)
    other = values.copy()
    other[..., 3] = scenes.noise(8, 8, seed=9)[..., 0]
    found = []
    for name, pixels in (("A", values), ("B", other)):
        image = scenes.image(name, pixels, alpha_mode=alpha_mode)
        quad = scenes.textured_quad(image, f"Quad {name}")
        bake(image, [quad], filter=filter)
        found.append(scenes.pixels(f"{name}.mip01"))
    np.testing.assert_allclose(found[0][..., :3], found[1][..., :3], atol=1.01 / 255)
    assert np.abs(found[0][..., 3] - found[1][..., 3]).max() > 0.1


LEAF = np.float32((40, 110, 20)) / 255


def gltf_leaf(is_float=False):
    """A Channel Packed image, as Blender's glTF importer makes: a leaf where alpha is, and white.

    Texels with an alpha of 0 are white. A 16-bit file gives floats that are straight, too.
    """
    values = leaves()
    shown = values[..., 3:] > 0
    color = scenes.to_linear(LEAF) if is_float else LEAF
    values[..., :3] = np.where(shown, color, np.float32(1))
    return scenes.image("Leaf", values, alpha_mode="CHANNEL_PACKED", is_float=is_float)


def drive_alpha(material, way):
    """Lets the alpha of a material's image say how much of the surface it shows; returns how."""
    tree = material.node_tree
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    alpha = texture.outputs["Alpha"]
    if way in {"mask", "mix"}:
        math = tree.nodes.new("ShaderNodeMath")
        math.operation = "GREATER_THAN"
        tree.links.new(alpha, math.inputs[0])
        alpha = math.outputs[0]
    if way != "mix":
        tree.links.new(alpha, shader.inputs["Roughness" if way == "data" else "Alpha"])
        return
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(alpha, mix.inputs[0])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(shader.outputs[0], mix.inputs[2])


def colors_shown(is_float):
    """The sRGB colors of level 5's texels, which are straight."""
    found = scenes.pixels("Leaf.mip05")[..., :3]
    return scenes.to_srgb(found) if is_float else found


@pytest.mark.parametrize("is_float", [False, True])
@pytest.mark.parametrize("filter", ["box", "pam-bilinear"])
def test_hidden_colors_stay_out_of_a_cutout_whatever_the_alpha_mode(bake, filter, is_float):
    image = gltf_leaf(is_float)
    quad = scenes.textured_quad(image)
    bake(image, [quad], filter=filter, content="cutout", wrap="clamp")
    found = colors_shown(is_float)
    np.testing.assert_allclose(found, np.broadcast_to(LEAF, found.shape), atol=1.5 / 255)
    assert bpy.data.images["Leaf.mip05"].alpha_mode == "CHANNEL_PACKED"


@pytest.mark.parametrize(
    ("way", "covers"), [("direct", True), ("mask", True), ("mix", True), ("data", False)]
)
def test_alpha_that_a_material_shows_by_is_coverage(bake, way, covers):
    image = gltf_leaf()
    quad = scenes.textured_quad(image)
    drive_alpha(quad.active_material, way)
    bake(image, [quad], filter="box", wrap="clamp")
    assert (np.abs(colors_shown(False) - LEAF).max() < 1.5 / 255) == covers
    bake(image, [quad], filter="box", wrap="clamp", content="data")
    plain = leaves()[..., 3].mean() * LEAF[0] + (1 - leaves()[..., 3].mean())
    assert colors_shown(False)[0, 0, 0] == pytest.approx(plain, abs=1.1 / 255)


@pytest.mark.parametrize("way", ["mask", "mix"])
def test_an_alpha_test_is_found(bake, way):
    """Its threshold, too, whatever the settings say."""
    image = gltf_leaf()
    quad = scenes.textured_quad(image)
    drive_alpha(quad.active_material, way)
    tree = quad.active_material.node_tree
    next(node for node in tree.nodes if node.type == "MATH").inputs[1].default_value = 0.25
    outcome = bake(image, [quad], wrap="clamp", threshold=0.75)
    assert "as Cut-Out" in outcome.summary
    found = scenes.pixels("Leaf.mip02")
    bake(image, [quad], wrap="clamp", content="cutout", threshold=0.25)
    np.testing.assert_array_equal(found, scenes.pixels("Leaf.mip02"))


def test_an_alpha_test_of_an_opaque_image(bake):
    image = scenes.image("Leaf", scenes.noise(8, 8))
    quad = scenes.textured_quad(image)
    drive_alpha(quad.active_material, "mask")
    outcome = bake(image, [quad])
    assert outcome.warnings == ["image 'Leaf' is opaque, so its alpha test is left out"]
    assert "as Cut-Out" not in outcome.summary


def test_alpha_of_an_instanced_collection_is_coverage(bake):
    image = gltf_leaf()
    quad = scenes.textured_quad(image)
    drive_alpha(quad.active_material, "direct")
    bake(image, [scenes.collection_instance(quad)], wrap="clamp")
    assert np.abs(colors_shown(False) - LEAF).max() < 1.5 / 255


def test_bc1_keeps_the_alpha_of_a_cutout(bake, tmp_path):
    """Punch-through blocks, read by OpenImageIO, are opaque exactly where the cut-out is."""
    path = tmp_path / "leaf.dds"
    image = gltf_leaf()
    quad = scenes.textured_quad(image)
    options = {"filepath": str(path), "texture_format": "bc1", "use_images": False}
    bake(image, [quad], content="cutout", wrap="clamp", **options)
    found = oiio.ImageBuf(str(path)).get_pixels("float")[::-1]
    np.testing.assert_array_equal(found[..., 3], leaves()[..., 3])
    seen = found[found[..., 3] > 0][:, :3]
    np.testing.assert_allclose(seen, np.broadcast_to(LEAF, seen.shape), atol=6 / 255)


def test_light_may_pass_one(bake):
    """HDR, by the surface error: levels go where the light is, and not below zero."""
    values = np.zeros((16, 16, 4), np.float32)
    values[..., 3] = 1
    values[5:7, 5:7, :3] = 4000
    image = scenes.image("Lamp", values, is_float=True)
    bake(image, [scenes.textured_quad(image)], wrap="clamp")
    found = scenes.pixels("Lamp.mip01")[..., :3]
    assert found.max() > 1000
    assert found.min() >= 0


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"content": "cutout"}, "'Paint': has no alpha, and is not a grayscale mask"),
        (
            {"content": "color", "roughness": "Rough"},
            "Roughness: 'Rough' needs a normal map, and the content is",
        ),
        ({"content": "normal", "roughness": "Gone"}, "found no image named 'Gone'"),
        ({"content": "normal", "roughness": "Paint"}, "'Paint' is the normal map itself"),
        (
            {"content": "normal", "roughness": "Small"},
            "'Small' has 4 x 4 texels, and 'Paint' has 8 x 8",
        ),
        ({"content": "normal", "roughness_filepath": "/r.exr"}, "Roughness File: choose"),
        ({"content": "cutout", "threshold": 0.0}, "Threshold: found 0; allowed: above 0, up to 1"),
    ],
)
def test_files_that_cannot_store_the_image_are_refused(bake, settings, message):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.image("Rough", gray(8, 8), colorspace="Non-Color")
    scenes.image("Small", gray(4, 4), colorspace="Non-Color")
    with pytest.raises(ValueError, match=message):
        bake(image, filter="box", **settings)
    assert len(bpy.data.images) == 3


def test_roughness_needs_somewhere_to_go(bake, tmp_path):
    image = scenes.image("Bumps", bumps(8, 8), colorspace="Non-Color")
    scenes.image("Rough", gray(8, 8), colorspace="Non-Color")
    path = str(tmp_path / "bumps.exr")
    common = {"filter": "box", "content": "normal", "roughness": "Rough", "filepath": path}
    with pytest.raises(ValueError, match="nothing to write the roughness to"):
        bake(image, use_images=False, **common)
    with pytest.raises(ValueError, match="is the file of the normal map"):
        bake(image, roughness_filepath=path, **common)
    assert list(tmp_path.iterdir()) == []


def test_ignored_roughness_is_reported(bake):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.image("Rough", gray(8, 8), colorspace="Non-Color")
    outcome = bake(image, filter="box", roughness="Rough")
    assert any("'Rough' is not used" in warning for warning in outcome.warnings)
    assert outcome.images == ["Paint.mip01", "Paint.mip02", "Paint.mip03"]


def test_operator_has_the_settings():
    image = scenes.image("Leaf", leaves())
    scenes.textured_quad(image)
    assert bpy.ops.prefilter.bake_mipmaps(
        image="Leaf", content="cutout", threshold=0.4, filter="box", wrap="clamp"
    ) == {"FINISHED"}
    found = scenes.pixels("Leaf.mip02")[..., 3]
    assert kept(found, 0.4) == pytest.approx(kept(leaves()[..., 3], 0.4), abs=0.02)


def test_operator_gives_roughness_to_normal_maps_only(capfd):
    image = scenes.image("Bumps", bumps(8, 8), colorspace="Non-Color")
    scenes.image("Rough", gray(8, 8), colorspace="Non-Color")
    scenes.quads("Quad").data.materials.append(normal_map_material(image))
    # Set for a normal map before, and not shown in the panel for other contents.
    options = {"image": "Bumps", "roughness": "Rough"}
    assert bpy.ops.prefilter.bake_mipmaps(content="data", **options) == {"FINISHED"}
    assert "Rough.mip01" not in bpy.data.images
    assert "Warning" not in capfd.readouterr().out
    assert bpy.ops.prefilter.bake_mipmaps(**options) == {"FINISHED"}
    assert "Rough.mip01" in bpy.data.images
