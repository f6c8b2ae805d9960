# SPDX-License-Identifier: GPL-3.0-or-later

"""The command, in a Blender of its own."""

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from command_line import assert_fails, run
from texture_readers import read_ktx2


@pytest.fixture
def blend(tmp_path):
    """Saves a .blend file with one textured square."""
    scenes.textured_quad(scenes.image("Paint", scenes.noise(16, 16)))
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def obj_and_picture(tmp_path):
    """Writes an .obj file without materials, and a picture."""
    (tmp_path / "quad.obj").write_text(
        "o Quad\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    )
    spec = oiio.ImageSpec(16, 8, 3, "uint8")
    writer = oiio.ImageOutput.create(str(tmp_path / "paint.png"))
    assert writer.open(str(tmp_path / "paint.png"), spec)
    assert writer.write_image(scenes.noise(8, 16)[::-1, :, :3].copy())
    writer.close()
    return tmp_path / "quad.obj", tmp_path / "paint.png"


def test_help():
    result = run("bake", "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: blender --background --command prefilter bake")
    for word in ("--object", "--image", "--output", "--save", "pam-bilinear", "lanczos3-covered"):
        assert word in result.stdout
    assert "bake" in run("--help").stdout


def test_blend_saved_in_place(blend):
    result = run("bake", blend, "--save")
    assert result.returncode == 0, result.stderr
    assert "4 level images" in result.stdout
    assert "100 %" in result.stderr
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert tuple(bpy.data.images["Paint.mip01"].size) == (8, 8)


def test_blend_to_file_leaves_the_blend(blend, tmp_path):
    before = blend.read_bytes()
    result = run("bake", blend.name, "--output", "out.tif", "--filter", "box", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert blend.read_bytes() == before
    level = oiio.ImageBuf(str(tmp_path / "out.tif"), 0, 1).get_pixels("float")[::-1]
    linear = scenes.halved(scenes.to_linear(scenes.noise(16, 16)[..., :3]))
    np.testing.assert_allclose(level, scenes.to_srgb(linear), atol=0.51 / 255)


def test_obj_with_a_picture(obj_and_picture, tmp_path):
    obj, picture = obj_and_picture
    result = run("bake", obj, "--image", picture, "--output", tmp_path / "out.exr")
    assert result.returncode == 0, result.stderr
    assert "over 1 object" in result.stdout
    buffer = oiio.ImageBuf(str(tmp_path / "out.exr"), 0, 1)
    assert (buffer.spec().width, buffer.spec().height) == (8, 4)


def test_ply_with_a_picture(obj_and_picture, tmp_path):
    _, picture = obj_and_picture
    path = tmp_path / "quad.ply"
    names = "".join(f"property float {name}\n" for name in "xyzst")
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex 4\n{names}element face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n"
    )
    result = run("bake", path, "--image", picture, "--output", tmp_path / "out.exr")
    assert result.returncode == 0, result.stderr
    assert "over 1 object" in result.stdout


def test_gltf(tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    material = bpy.data.materials["Quad material"]
    nodes = material.node_tree.nodes
    texture = next(node for node in nodes if node.type == "TEX_IMAGE")
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    material.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    path = tmp_path / "quad.glb"
    bpy.ops.export_scene.gltf(filepath=str(path))
    result = run("bake", path, "--output", tmp_path / "out.exr")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out.exr").exists()


def test_more_threads_than_there_are(blend):
    result = run("bake", blend, "--save", "--filter", "box", "--threads", "3000000000")
    assert "Traceback" not in result.stdout + result.stderr
    assert result.returncode == 0, result.stderr


def test_read_only_blend_is_left_alone(blend):
    before = blend.read_bytes()
    blend.chmod(0o444)
    assert_fails(run("bake", blend, "--save"), "scene.blend", "read-only")
    assert blend.read_bytes() == before


def test_frames_importance_and_instances(blend, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    quad = bpy.data.objects["Quad"]
    quad.data.attributes.new("Care", "FLOAT", "POINT").data.foreach_set("value", [1.0] * 4)
    scenes.collection_instance(quad)
    bpy.ops.wm.save_mainfile()
    target = tmp_path / "out.exr"
    options = ["--importance", "Care", "--frames", "1:5:2", "--no-subdivision-limit"]
    result = run("bake", blend, "--output", target, *options)
    assert result.returncode == 0, result.stderr
    assert "over 1 object at 3 frames" in result.stdout
    assert target.exists()
    missing = run("bake", blend, "--output", tmp_path / "no.exr", "--importance", "Other")
    assert_fails(missing, "Importance: found no vertex group or attribute named 'Other'")
    assert not (tmp_path / "no.exr").exists()


@pytest.mark.parametrize("frames", ["5", "1-5", "1:2:3:4", "a:b", ""])
def test_invalid_frames(blend, tmp_path, frames):
    result = run("bake", blend, "--output", tmp_path / "no.exr", f"--frames={frames}")
    assert_fails(result, "--frames", "START:END", status=2)


def test_normal_map_and_roughness_from_picture_files(obj_and_picture, tmp_path):
    obj, picture = obj_and_picture
    rough = tmp_path / "rough.png"
    rough.write_bytes(picture.read_bytes())
    result = run(
        *("bake", obj, "--image", picture, "--content", "normal", "--output", tmp_path / "n.tif"),
        *("--roughness", rough, "--roughness-channel", "green"),
        *("--roughness-output", tmp_path / "r.tif"),
    )
    assert result.returncode == 0, result.stderr
    assert "warning" not in result.stderr
    assert "as Normal Map" in result.stdout
    level = oiio.ImageBuf(str(tmp_path / "n.tif"), 0, 2).get_pixels("float")
    np.testing.assert_allclose(np.linalg.norm(2 * level - 1, axis=2), 1, atol=0.01)
    assert oiio.ImageBuf(str(tmp_path / "r.tif"), 0, 2).spec().width == 4


def test_plot(blend, tmp_path):
    picture, table = tmp_path / "error.png", tmp_path / "error.csv"
    result = run(
        *("plot", blend, "--filters", "box", "pam-box"),
        *("--wrap", "clamp", "--output", picture, "--table", table),
    )
    assert result.returncode == 0, result.stderr
    assert "Error of 'Paint' over all mip values: Box" in result.stdout
    head, *rows = table.read_text().splitlines()
    assert head == "mip value,box,pam-box"
    assert [row.split(",")[0] for row in (rows[0], rows[-2], rows[-1])] == ["0", "4", "all"]
    found = oiio.ImageBuf(str(picture)).get_pixels(oiio.FLOAT)
    assert found.shape[:2] == (800, 1200)
    assert found[..., :3].min() < 0.2
    assert (found[..., :3] == 1).all(axis=-1).mean() > 0.8
    # Row 0 is the title's: there is ink above the axes, in the upper tenth.
    assert found[20:75, 300:900, :3].min() < 0.3
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("error.csv", "error.png", "scene.blend")
    ]


def test_reader(blend, tmp_path):
    """Without --filters, the plot leaves out the filter that does not work with this reader."""
    table, target = tmp_path / "error.csv", tmp_path / "out.tif"
    result = run("plot", blend, "--reader", "srgb-after", "--table", table)
    assert result.returncode == 0, result.stderr
    assert table.read_text().splitlines()[0] == "mip value,pam-bilinear,pam-box,box"
    result = run("bake", blend, "--reader", "srgb-after", "--output", target)
    assert result.returncode == 0, result.stderr
    encoded = oiio.ImageBuf(str(target), 0, 1).get_pixels(oiio.UINT8)
    assert run("bake", blend, "--output", target).returncode == 0
    assert (oiio.ImageBuf(str(target), 0, 1).get_pixels(oiio.UINT8) != encoded).any()


@pytest.mark.parametrize(
    ("arguments", "words", "status"),
    [
        ([], ["nothing to write"], 2),
        (["--reader", "cycles", "--table", "error.csv"], ["'cycles'", "srgb-after"], 2),
        (
            [
                *("--reader", "srgb-after", "--filters", "pam-trilinear"),
                *("--table", "error.csv"),
            ],
            ["reader", "pam-bilinear"],
            1,
        ),
        (["--output", "error.jpg"], ["'.jpg'", ".png"], 1),
        (["--table", "error.png"], ["'.png'", ".csv"], 1),
        (["--output", "nowhere/error.png"], ["there is no folder"], 1),
        (["--image", "Pain", "--output", "error.png"], ["'Pain'", "'Paint'"], 1),
    ],
)
def test_plot_refuses(blend, tmp_path, arguments, words, status):
    assert_fails(run("plot", blend, *arguments, cwd=tmp_path), *words, status=status)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.blend"]


def test_file_for_engines(obj_and_picture, tmp_path):
    obj, picture = obj_and_picture
    arguments = ["bake", obj, "--image", picture, "--output"]
    result = run(*arguments, tmp_path / "out.ktx2", "--texture-format", "bc1")
    assert result.returncode == 0, result.stderr
    file = read_ktx2(tmp_path / "out.ktx2")
    assert (file.format, file.width, file.height) == ("BC1_SRGB", 16, 8)
    assert len(file.levels) == 5
    result = run(*arguments, tmp_path / "out.tif", "--texture-format", "bc1")
    assert_fails(result, "--texture-format", "'bc1'", ".dds", status=2)
    assert_fails(run(*arguments, tmp_path / "out.dds", "--texture-format", "bc2"), "bc2", status=2)
    result = run(*arguments, tmp_path / "out.tif", "--effort", "fast")
    assert_fails(result, "--effort", "'fast'", ".dds", status=2)
    result = run(*arguments, tmp_path / "out.dds", "--supercompression", "zstd")
    assert_fails(result, "--supercompression", "'zstd'", ".ktx2", status=2)
    result = run(*arguments, tmp_path / "out.dds", "--texture-format", "astc-4x4")
    assert_fails(result, "ASTC 4x4 needs a .ktx2 file")
    assert not (tmp_path / "out.tif").exists()
    assert not (tmp_path / "out.dds").exists()


def gltf_of_five(folder, *, colors=1):
    """Writes a glTF file whose materials use three other images beside their base colors."""
    material = bpy.data.materials.new("Metal")
    quad = scenes.quads("Quad", [scenes.UNIT_SQUARE] * colors)
    for index in range(colors):
        material = bpy.data.materials.new(f"Metal {index}")
        scenes.use_nodes(material)
        quad.data.materials.append(material)
        quad.data.polygons[index].material_index = index
        tree = material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        bumps = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(bumps.outputs[0], shader.inputs["Normal"])
        for name, socket in (
            (f"Albedo {index}", shader.inputs["Base Color"]),
            ("Bumps", bumps.inputs["Color"]),
            ("Rough", shader.inputs["Roughness"]),
            ("Glow", shader.inputs["Emission Color"]),
        ):
            image = bpy.data.images.get(name)
            if image is None:
                image = scenes.image(name, scenes.noise(8, 8, seed=len(bpy.data.images)))
            tree.links.new(scenes.image_node(tree, image).outputs["Color"], socket)
        shader.inputs["Emission Strength"].default_value = 1
    path = folder / "model.gltf"
    bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLTF_SEPARATE")
    return path


def test_base_color_of_a_model_with_more_images(tmp_path):
    path = gltf_of_five(tmp_path)
    result = run("bake", path.name, "--output", "texture.exr", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "Without --image: base colors, 'Albedo 0'; not " in result.stdout
    for name in ("Bumps", "Rough", "Glow"):
        assert f"'{name}'" in result.stdout
    assert [path.name for path in tmp_path.glob("*.exr")] == ["texture.exr"]


def test_a_file_a_base_color(tmp_path):
    path = gltf_of_five(tmp_path, colors=2)
    result = run("bake", path.name, "--output", "texture.png", "--filter", "box", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "base colors, 'Albedo 0', 'Albedo 1'; not " in result.stdout
    assert sorted(path.name for path in tmp_path.glob("texture*")) == [
        f"texture.Albedo_{index}.{number:02d}.png" for index in (0, 1) for number in range(4)
    ]
    result = run("bake", path.name, "--output", "o.exr", "--roughness", "Rough", cwd=tmp_path)
    assert_fails(result, "--roughness: give --image too; without it, 2 images are baked")
    assert_fails(
        run("plot", path.name, "--table", "error.csv", cwd=tmp_path),
        "--image: choose one; the meshes use 'Albedo 0', 'Albedo 1'",
    )
    assert not list(tmp_path.glob("o.*"))
    (tmp_path / "Albedo 0.png").unlink()
    result = run("bake", path.name, "--output", "o.exr", "--filter", "box", cwd=tmp_path)
    assert_fails(result, "not baked: 'Albedo 0'")
    assert "warning: image 'Albedo 0': found no pixels" in result.stderr
    assert [path.name for path in tmp_path.glob("o.*")] == ["o.Albedo_1.exr"]


@pytest.fixture
def default_images(addon):
    return addon("textures.default_images")


def test_all_images_where_none_is_a_base_color(default_images):
    first, second = (scenes.image(name, scenes.noise(4, 4)) for name in ("One", "Two"))
    quads = [scenes.textured_quad(image, image.name) for image in (first, second)]
    found, line = default_images.images_to_bake(quads)
    assert found == [first, second]
    assert line == "Without --image: all images, as none is a base color, 'One', 'Two'"
    assert default_images.images_to_bake(quads[:1]) == ([first], "")


def test_files_of_several_images(default_images):
    names = ("Wood", "Wood.png", "Wood oak/ö.tga")
    images = [scenes.image(name, scenes.noise(2, 2)) for name in names]
    assert default_images.output_paths("a/t.exr", images[:1]) == ["a/t.exr"]
    assert default_images.output_paths("", images) == ["", "", ""]
    assert default_images.output_paths("a/t.exr", images) == [
        *("a/t.Wood.exr", "a/t.Wood_2.exr", "a/t.Wood_oak__.exr")
    ]
