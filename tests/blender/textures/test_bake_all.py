# SPDX-License-Identifier: GPL-3.0-or-later

"""`bake --all`: every image of a model by its content, compared to bakes of single images."""

import json

import bpy
import gltf_files
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from command_line import assert_fails, run
from texture_readers import read_ktx2

CUTOFF = 0.3


def bumps(side):
    values = scenes.noise(side, side, seed=7)[..., :3]
    return (127 + np.round((values - 0.5) * 100) + [0, 0, 90]).clip(0, 255) / 255


def leaf(side):
    values = scenes.noise(side, side, alpha=True, seed=9)
    values[: side // 2, :, 3] *= 0.4
    return np.round(values * 255) / 255


PICTURES = {
    "albedo.png": lambda: scenes.noise(16, 16)[..., :3],
    "orm.png": lambda: scenes.noise(16, 16, seed=2)[..., :3],
    "normal.png": lambda: bumps(16),
    "glow.png": lambda: scenes.noise(8, 8, seed=3)[..., :3],
    "leaf.png": lambda: leaf(16),
}


def reference(index):
    return {"index": index}


@pytest.fixture
def model(tmp_path):
    """Writes a model with a packed roughness, and one with a cut-out."""
    for name, pixels in PICTURES.items():
        gltf_files.write_png(tmp_path / name, pixels())
    materials = [
        {
            "pbrMetallicRoughness": {
                "baseColorTexture": reference(0),
                "metallicRoughnessTexture": reference(1),
                "roughnessFactor": 0.5,
            },
            "normalTexture": reference(2),
            "occlusionTexture": reference(1),
            "emissiveTexture": reference(3),
            "emissiveFactor": [1, 1, 1],
        },
        {
            "pbrMetallicRoughness": {"baseColorTexture": reference(4)},
            "alphaMode": "MASK",
            "alphaCutoff": CUTOFF,
        },
    ]
    gltf_files.write(tmp_path / "model.gltf", materials, list(PICTURES))
    return tmp_path / "model.gltf"


def levels(path):
    """Returns the levels of a TIFF file, which has the time in it, as bytes."""
    file, found = oiio.ImageInput.open(str(path)), []
    while file.seek_subimage(0, len(found)):
        found.append(file.read_image(0, len(found), 0, 4, oiio.UINT8).tobytes())
    assert found
    return found


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_the_list_describes_the_bake(model, tmp_path):
    before = names(tmp_path)
    result = run("bake", model, "--all", "--list", "--output", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert names(tmp_path) == before
    lines = result.stdout.splitlines()
    rows = {line.split()[0]: line for line in lines if ".png" in line.split("  ")[0]}
    assert rows.keys() == PICTURES.keys()
    for name, words in {
        "albedo.png": ("16 x 16", "Square 0", "Color", "PAM Bilinear", "albedo.ktx2"),
        "orm.png": ("16 x 16", "Data", "orm.ktx2"),
        "normal.png": ("Normal Map", "BC5", "normal.ktx2"),
        "glow.png": ("8 x 8", "Color"),
        "leaf.png": ("Square 1", "Cut-Out", "leaf.ktx2"),
    }.items():
        for word in words:
            assert word in rows[name], (name, word)
    after = {
        lines[i].split()[0]: lines[i + 1] for i in range(len(lines)) if lines[i] in rows.values()
    }
    for word in ("Roughness (green)", "Metallic (blue)", "Occlusion (red)"):
        assert word in after["orm.png"]
    assert "Emission Color" in after["glow.png"]
    assert "Alpha (alpha)" in after["leaf.png"]
    assert "its levels compensate for detail lost in the levels of 'normal.png'" in result.stdout


def test_a_file_for_each_image(model, tmp_path):
    out = tmp_path / "made" / "textures"
    result = run("bake", model, "--all", "--output", out)
    assert result.returncode == 0, result.stderr
    assert "Baked 5 images into 5 files" in result.stdout
    assert names(out) == [f"{name.removesuffix('.png')}.ktx2" for name in sorted(PICTURES)]
    formats = {path.stem: read_ktx2(path).format for path in out.iterdir()}
    assert formats == {
        **dict.fromkeys(("albedo", "glow", "leaf"), "BC7_SRGB"),
        **{"normal": "BC5_UNORM", "orm": "BC7_UNORM"},
    }


def test_files_appear_only_together(addon, model, tmp_path, monkeypatch):
    """What ends the command, at any point of its work, leaves the files of earlier bakes."""
    out = tmp_path / "out"
    out.mkdir()
    (out / "albedo.ktx2").write_bytes(b"earlier")
    bakes = addon("textures.bake").Bake
    compute, seen = bakes.compute, []

    def watched(self, progress):
        compute(self, progress)
        seen.append([name for name in names(out) if not name.startswith(".")])

    monkeypatch.setattr(bakes, "compute", watched)
    result = run("bake", model, "--all", "--output", out)
    assert result.returncode == 0, result.stderr
    assert seen == [["albedo.ktx2"]] * 4  # The normal map and the roughness are one bake.
    assert len(names(out)) == 5
    assert (out / "albedo.ktx2").read_bytes() != b"earlier"


def test_all_files_or_none(addon, model, tmp_path, monkeypatch):
    put = addon("bridge.files.staging").StagedFile.put

    def fails(self):
        if self.target.name == "leaf.ktx2":
            raise OSError("there is no more room")
        put(self)

    monkeypatch.setattr(addon("bridge.files.staging").StagedFile, "put", fails)
    result = run("bake", model, "--all", "--output", tmp_path / "out")
    assert result.returncode == 1
    assert "error: no image was baked" in result.stderr
    assert result.stderr.count("there is no more room") >= len(PICTURES)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("socket", "colorspace", "is_float", "pixels", "expected"),
    [
        ("Base Color", "sRGB", False, lambda: scenes.noise(4, 4), "bc7"),
        ("Base Color", "sRGB", False, lambda: np.ones((4, 4, 4), np.float32), "bc7"),
        ("Roughness", "Non-Color", False, lambda: scenes.noise(4, 4), "bc7"),
        ("Roughness", "Non-Color", False, lambda: np.full((4, 4, 4), (0.2, 0.2, 0.2, 1)), "bc4"),
        ("Roughness", "sRGB", False, lambda: np.full((4, 4, 4), (0.2, 0.2, 0.2, 1)), "bc7"),
        ("Base Color", "Linear Rec.709", True, lambda: scenes.noise(4, 4) * (4, 4, 4, 1), "bc6h"),
        (
            "Base Color",
            "Linear Rec.709",
            True,
            lambda: scenes.noise(4, 4) * (-1, 1, 1, 1),
            "rgba16f",
        ),
        ("Base Color", "Linear Rec.709", True, lambda: scenes.noise(4, 4, alpha=True), "rgba16f"),
    ],
)
def test_formats_by_content(addon, tmp_path, socket, colorspace, is_float, pixels, expected):
    image = scenes.image("Paint", pixels(), is_float=is_float, colorspace=colorspace)
    quad = scenes.textured_quad(image)
    tree = quad.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(texture.outputs[0], shader.inputs[socket])
    view_layer, depsgraph = bpy.context.view_layer, scenes.depsgraph()
    (item,) = addon("textures.model.plan").plan(view_layer, depsgraph).items
    decisions = addon("textures.model.decisions")
    picture = addon("bridge.images").read(image)
    for ending, chosen in ((".dds", expected), (".ktx2", expected), (".exr", "auto")):
        target = tmp_path / f"paint{ending}"
        assert decisions.texture_format(item, picture, item.content, target) == chosen


def test_the_files_are_those_of_single_bakes(model, tmp_path):
    result = run("bake", model, "--all", "--format", "tif", "--output", tmp_path / "all")
    assert result.returncode == 0, result.stderr
    one = tmp_path / "one"
    one.mkdir()
    for arguments in (
        ("--image", "albedo.png", "--output", one / "albedo.tif"),
        ("--image", "glow.png", "--output", one / "glow.tif"),
        (
            *("--image", "normal.png", "--content", "normal", "--roughness", "orm.png"),
            *("--roughness-channel", "green", "--output", one / "normal.tif"),
            *("--roughness-output", one / "orm.tif"),
        ),
        ("--image", "leaf.png", "--output", one / "leaf.tif"),
    ):
        assert run("bake", model, *arguments).returncode == 0
    assert names(tmp_path / "all") == names(one)
    for path in one.iterdir():
        assert levels(path) == levels(tmp_path / "all" / path.name), path.name


def test_an_image_that_is_missing_stops_no_other(model, tmp_path):
    (tmp_path / "normal.png").unlink()
    (tmp_path / "glow.png").write_text("no picture")
    for extra in (["--list"], []):
        result = run("bake", model, "--all", "--output", tmp_path / "out", *extra)
        assert_fails(result, "'normal.png'", "'glow.png'")
        assert "image 'normal.png' " in result.stderr
        assert "is its file missing?" in result.stderr
        assert "cannot be read as a picture" in result.stderr
        assert "does not compensate for 'normal.png', which has no pixels" in result.stderr
        assert (tmp_path / "out").exists() == (not extra)
    assert "Baked 3 of 5 images into 3 files" in result.stdout
    assert names(tmp_path / "out") == ["albedo.ktx2", "leaf.ktx2", "orm.ktx2"]


def test_roughness_of_another_size_is_baked_by_itself(model, tmp_path):
    gltf_files.write_png(tmp_path / "orm.png", scenes.noise(8, 8, seed=2)[..., :3])
    result = run("bake", model, "--all", "--format", "tif", "--output", tmp_path / "all")
    assert result.returncode == 0, result.stderr
    assert "whose size is 16 x 16, and its own 8 x 8" in result.stderr
    plain = run("bake", model, "--image", "orm.png", "--output", tmp_path / "orm.tif")
    assert plain.returncode == 0
    assert levels(tmp_path / "orm.tif") == levels(tmp_path / "all" / "orm.tif")


def test_sources_are_never_written(model, tmp_path):
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    bpy.ops.wm.read_homefile(use_empty=True)
    result = run("bake", model, "--all", "--format", "png", "--filter", "box", "--output", tmp_path)
    assert result.returncode == 0, result.stderr
    assert {name: (tmp_path / name).read_bytes() for name in before} == before
    assert (tmp_path / "leaf.04.png").exists()


def test_a_source_with_the_name_of_a_file(tmp_path, addon):
    """The names of levels, of images and of tiles meet in one folder."""
    files = addon("textures.file_names")
    (tmp_path / "Wood.exr").write_bytes(b"source")
    sources = []
    for name in ("Wood.exr", "wood.png", "WOOD", "Wood_2"):
        image = bpy.data.images.new(name, 4, 4)
        sources.append(image)
    sources[0].source, sources[0].filepath = "FILE", str(tmp_path / "Wood.exr")
    pattern = files.Pattern.of(str(tmp_path), ".exr")
    found = files.paths(pattern, sources)
    stems = [path.removeprefix(f"{tmp_path}/").removesuffix(".exr") for path in found]
    assert stems == ["Wood_2", "wood_3", "WOOD_4", "Wood_2_2"]
    assert len({stem.casefold() for stem in stems}) == 4
    link = tmp_path / "link"
    link.symlink_to(tmp_path)
    assert files.paths(files.Pattern.of(str(link), ".exr"), sources[:1]) == [f"{link}/Wood_2.exr"]
    more = files.paths(
        files.Pattern.of(str(tmp_path), ".dds"), sources[:1], [tmp_path / "Wood.dds"]
    )
    assert more == [f"{tmp_path}/Wood_2.dds"]


@pytest.mark.parametrize(
    ("output", "expected"),
    [
        ("", ""),
        ("out", "out/{name}.ktx2"),
        ("out/", "out/{name}.ktx2"),
        ("v1.5", "v1.5/{name}.ktx2"),
        ("out/a.exr", "out/a.{name}.exr"),
        ("out/{name}", "out/{name}.ktx2"),
        ("out/{name}/mips.DDS", "out/{name}/mips.DDS"),
    ],
)
def test_patterns_of_output(addon, output, expected):
    assert addon("textures.file_names").Pattern.of(output, ".ktx2").text == expected


def test_a_manifest_of_the_files(model, tmp_path):
    """Reported sizes match the files, which are stretched where blocks need it."""
    gltf_files.write_png(tmp_path / "albedo.png", scenes.noise(10, 18)[..., :3])
    listing = tmp_path / "out" / "textures.json"
    result = run("bake", model, "--all", "--output", tmp_path / "out" / "t", "--manifest", listing)
    assert result.returncode == 0, result.stderr
    assert f"Listed 5 images in '{listing}'" in result.stdout
    found = {one["image"]: one for one in json.loads(listing.read_text())["images"]}
    assert {name: one["role"] for name, one in found.items()} == {
        "albedo.png": "color",
        "orm.png": "data",
        "normal.png": "normal",
        "glow.png": "color",
        "leaf.png": "cutout",
    }
    for one in found.values():
        assert [one["file"]] == one["files"]
        file = read_ktx2(tmp_path / "out" / one["file"])
        assert one["size"] == [file.width, file.height]
        assert file.format.startswith(one["format"])
    assert found["albedo.png"]["size"] == [20, 12]
    assert found["orm.png"]["uses"] == ["Metallic (blue)", "Roughness (green)", "Occlusion (red)"]


def test_a_manifest_lists_all_levels_and_only_what_is_baked(model, tmp_path):
    (tmp_path / "glow.png").unlink()
    listing = tmp_path / "textures.json"
    out = ("--output", tmp_path / "out", "--format", "png", "--manifest", listing)
    assert run("bake", model, "--all", *out).returncode == 1
    found = {one["image"]: one for one in json.loads(listing.read_text())["images"]}
    assert "glow.png" not in found
    assert found["leaf.png"]["files"] == [f"out/leaf.{number:02d}.png" for number in range(5)]


def test_a_manifest_that_cannot_be_written_stops_all(model, tmp_path):
    listing = tmp_path / "textures.json"
    listing.mkdir()
    before = names(tmp_path)
    result = run("bake", model, "--all", "--output", tmp_path / "out", "--manifest", listing)
    assert_fails(result, "textures.json")
    assert names(tmp_path) == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--all"], ["nothing to write"]),
        (["--all", "--list", "--manifest", "m.json"], ["--manifest", "--output"]),
        (["--output", "o.exr", "--manifest", "m.json"], ["--manifest", "--all"]),
        (["--all", "--output", "o", "--fallback", "picture"], ["--fallback", ".glb"]),
        (["--all", "--output", "o.glb", "--fallback", "gif"], ["--fallback", "picture"]),
        (["--all", "--output", "o.glb", "--list"], ["--list", ".glb"]),
        (["--all", "--output", "o.glb", "--texture-format", "bc7"], ["--texture-format", ".glb"]),
        (["--all", "--output", "o.glb", "--wrap", "clamp"], ["--wrap", ".glb"]),
        (["--all", "--output", "o.glb", "--manifest", "m.json"], ["--manifest", ".glb"]),
        (["--all", "--output", "o.glb", "--format", "dds"], ["--format", ".glb"]),
        (["--all", "--list", "--image", "Wood"], ["--image", "--list"]),
        (["--all", "--output", "o", "--image", "Wood", "--task", "1/2"], ["--image", "--task"]),
        (["--all", "--output", "o", "--task", "1/2", "--manifest", "m.json"], ["--manifest"]),
        (["--all", "--output", "o", "--task", "3/2"], ["--task", "K/N"]),
        (["--all", "--output", "o.glb", "--task", "1/2"], ["--task", ".glb"]),
        (["--task", "1/2", "--output", "o.exr"], ["--task", "--all"]),
        (["--output", "{name}.ktx2"], ["--output", "{name}", "--all"]),
        (["--all", "--list", "--content", "data"], ["--content", "--all"]),
        (["--all", "--list", "--roughness-output", "o.exr"], ["--roughness-output", "--all"]),
        (["--all", "--output", "o.exr", "--format", "dds"], ["--format", "'o.exr'"]),
        (["--all", "--output", "o", "--format", "jpg"], ["--format", "ktx2"]),
        (["--all", "--output", "o", "--format", "exr", "--texture-format", "bc1"], ["'bc1'"]),
        (["--all", "--output", "o", "--format", "exr", "--effort", "best"], ["--effort", "'best'"]),
        (["--all", "--output", "o", "--format", "dds", "--supercompression", "zstd"], ["'zstd'"]),
        (["--all", "--output", "o", "--save"], ["--save", ".blend"]),
        (["--material", "Wood", "--output", "o.exr"], ["--material", "--all"]),
        (["--list", "--output", "o.exr"], ["--list", "--all"]),
        (["--format", "dds", "--output", "o.exr"], ["--format", "--all"]),
    ],
)
def test_wrong_arguments(model, tmp_path, arguments, words):
    before = names(tmp_path)
    assert_fails(run("bake", model, *arguments, cwd=tmp_path), *words, status=2)
    assert names(tmp_path) == before


def test_unknown_material(model):
    assert_fails(run("bake", model, "--all", "--list", "--material", "Gone"), "no 'Gone'")


def normal_mapped(name, normal_map, rough, **more):
    """Makes a square with a normal map and a roughness image."""
    quad = scenes.quads(name)
    material = bpy.data.materials.new(name)
    scenes.use_nodes(material)
    quad.data.materials.append(material)
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(scenes.image_node(tree, normal_map).outputs[0], node.inputs["Color"])
    tree.links.new(node.outputs[0], shader.inputs["Normal"])
    tree.links.new(scenes.image_node(tree, rough).outputs[0], shader.inputs["Roughness"])
    return quad


def data(name, pixels):
    alpha = np.ones((*pixels.shape[:2], 1))
    rgba = np.concatenate([pixels[..., :3], alpha], axis=2).astype(np.float32)
    return scenes.image(name, rgba, colorspace="Non-Color")


def test_a_normal_map_with_two_roughness_images(tmp_path):
    """Each compensates for normals on its own surfaces; the normal map has one file."""
    shared = data("Bumps", bumps(8))
    roughs = [data(name, scenes.noise(8, 8, seed=i)) for i, name in enumerate(("Left", "Right"))]
    quads = [normal_mapped(rough.name, shared, rough) for rough in roughs]
    quads[1].scale = (1, 3, 1)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    result = run("bake", path, "--all", "--format", "tif", "--output", tmp_path / "all")
    assert result.returncode == 0, result.stderr
    assert names(tmp_path / "all") == ["Bumps.tif", "Left.tif", "Right.tif"]
    for name in ("Left", "Right"):
        single = run(
            *("bake", path, "--image", "Bumps", "--object", name, "--roughness", name),
            *("--roughness-output", tmp_path / "single.tif", "--output", tmp_path / "n.tif"),
        )
        assert single.returncode == 0, single.stderr
        assert levels(tmp_path / "single.tif") == levels(tmp_path / "all" / f"{name}.tif")
    assert run("bake", path, "--image", "Bumps", "--output", tmp_path / "n.tif").returncode == 0
    assert levels(tmp_path / "n.tif") == levels(tmp_path / "all" / "Bumps.tif")


def test_a_roughness_image_with_two_normal_maps(tmp_path):
    rough = data("Rough", scenes.noise(8, 8))
    for name in ("Left", "Right"):
        normal_mapped(name, data(f"{name} bumps", bumps(8)), rough)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    result = run("bake", path, "--all", "--list")
    assert result.returncode == 0, result.stderr
    assert "shaders combine it with 'Left bumps', 'Right bumps'" in result.stderr
    assert "compensate for detail" not in result.stdout


def test_images_that_are_left_out(tmp_path):
    shown, hidden = (
        scenes.image("Shown", scenes.noise(8, 8)),
        scenes.image("Hidden", scenes.noise(8, 8)),
    )
    scenes.textured_quad(shown, "Seen")
    scenes.textured_quad(hidden, "Unseen").hide_set(True)
    twin = scenes.textured_quad(shown, "Twin")
    twin.hide_viewport = True
    scenes.image("Unused", scenes.noise(8, 8)).use_fake_user = True
    generated = scenes.image("Boxed", scenes.noise(8, 8))
    boxed = scenes.textured_quad(generated, "Box")
    node = next(n for n in boxed.active_material.node_tree.nodes if n.type == "TEX_IMAGE")
    node.projection = "BOX"
    slot = scenes.image("Slot only", scenes.noise(8, 8))
    bpy.data.objects["Seen"].data.materials.append(scenes.material("No face", slot))
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    result = run("bake", path, "--all", "--output", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert names(tmp_path / "out") == ["Shown.ktx2"]
    assert "Left out, as only hidden objects show it, 'Unseen': 'Hidden'" in result.stdout
    assert "Left out, as no mesh shows it: 'Unused'" in result.stdout
    assert "projection BOX" in result.stdout
    assert "no material on a face of a mesh uses it" in result.stdout
    assert (
        "image 'Shown' is shown by hidden objects too, which do not count: 'Twin'" in result.stderr
    )
    chosen = run("bake", path, "--all", "--list", "--object", "Unseen")
    assert chosen.returncode == 0, chosen.stderr
    assert "Hidden.ktx2" in chosen.stdout
    assert "Left out, as none of these objects shows it" in chosen.stdout


def test_levels_saved_in_the_blend(tmp_path):
    image = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(image)
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    for _ in range(2):  # Level images are none of the model's.
        result = run("bake", path, "--all", "--save")
        assert result.returncode == 0, result.stderr
        assert "Baked 1 image into 3 level images" in result.stdout
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert sorted(image.name for image in bpy.data.images) == [
        *("Paint", "Paint.mip01", "Paint.mip02", "Paint.mip03")
    ]


def test_tiles(tmp_path):
    for number in (1001, 1002):
        gltf_files.write_png(tmp_path / f"skin.{number}.png", scenes.noise(8, 8)[..., :3])
    image = bpy.data.images.load(str(tmp_path / "skin.1001.png"))
    image.source = "TILED"
    image.filepath = str(tmp_path / "skin.<UDIM>.png")
    image.tiles.new(tile_number=1002)
    image.name = "skin.<UDIM>.png"
    right = [(u + 1, v) for u, v in scenes.UNIT_SQUARE]
    quad = scenes.quads("Quad", [scenes.UNIT_SQUARE, right])
    quad.data.materials.append(scenes.material("Skin", image))
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    listed = run("bake", path, "--all", "--list")
    assert "2 tiles, 8 x 8" in listed.stdout, listed.stderr
    result = run("bake", path, "--all", "--output", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert names(tmp_path / "out") == ["skin.1001.ktx2", "skin.1002.ktx2"]


def test_instances_and_several_uv_maps(tmp_path):
    image = scenes.image("Paint", scenes.noise(8, 8))
    quad = scenes.textured_quad(image)
    scenes.add_uv_map(quad.data, "Second", [scenes.UNIT_SQUARE])
    tree = quad.active_material.node_tree
    second = tree.nodes.new("ShaderNodeUVMap")
    second.uv_map = "Second"
    tree.links.new(second.outputs[0], scenes.image_node(tree, image).inputs[0])
    scenes.collection_instance(quad, "Copies")
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    result = run("bake", path, "--all", "--list")
    assert result.returncode == 0, result.stderr
    assert "Copies" in result.stdout
    assert (
        "is shown by several UV maps, which all count: 'the active one', 'Second'" in result.stderr
    )


@pytest.mark.parametrize("ending", [".obj", ".fbx", ".glb", ".usdc", ".usda", ".usdz"])
def test_formats_of_models(tmp_path, ending):
    """Every importer finds the images of Blender's exports."""
    if ending.startswith(".usd") and not bpy.app.build_options.usd:
        pytest.skip("this Blender was built without USD")
    gltf_files.write_png(tmp_path / "paint.png", scenes.noise(8, 8)[..., :3])
    image = bpy.data.images.load(str(tmp_path / "paint.png"))
    quad = scenes.textured_quad(image)
    tree = quad.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(texture.outputs[0], shader.inputs["Base Color"])
    path = tmp_path / f"model{ending}"
    if ending == ".obj":
        bpy.ops.wm.obj_export(filepath=str(path))
    elif ending == ".fbx":
        bpy.ops.export_scene.fbx(filepath=str(path))
    elif ending == ".glb":
        bpy.ops.export_scene.gltf(filepath=str(path))
    else:
        bpy.ops.wm.usd_export(filepath=str(path))
    result = run("bake", path, "--all", "--output", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    (made,) = (tmp_path / "out").iterdir()
    assert read_ktx2(made).width == 8


def test_usd_that_this_blender_cannot_read(tmp_path):
    if bpy.app.build_options.usd:
        pytest.skip("this Blender can")
    (tmp_path / "model.usda").write_text("#usda 1.0\n")
    result = run("bake", tmp_path / "model.usda", "--all", "--list")
    assert_fails(result, "model.usda", "built without USD")


def test_a_model_without_images(tmp_path):
    (tmp_path / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    assert_fails(run("bake", tmp_path / "quad.obj", "--all", "--list"), "no image to bake")
    result = run("bake", tmp_path / "quad.obj", "--all", "--output", tmp_path / "out")
    assert_fails(result, "no image")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "name",
    [
        *("Duck/Duck.gltf", "DamagedHelmet/DamagedHelmet.gltf"),
        "IridescenceLamp/IridescenceLamp.gltf",
    ],
)
def test_gathered_models(textured, tmp_path, name):
    """Existing pictures are baked, and missing ones are named."""
    folder = (textured / name).parent
    there = {path.stem for path in folder.iterdir() if path.suffix in {".png", ".jpg"}}
    result = run(
        *("bake", textured / name, "--all", "--filter", "box", "--format", "tif"),
        *("--output", tmp_path / "out"),
    )
    made = {path.stem for path in (tmp_path / "out").iterdir()}
    # Blender 5 imports iridescence, Blender 4 does not.
    iridescence = {"IridescenceLamp_Iridescence"}
    assert made | iridescence == there | iridescence
    assert result.returncode == (1 if "is its file missing?" in result.stderr else 0)
