# SPDX-License-Identifier: GPL-3.0-or-later

"""Presets: the built-in ones set existing settings, and do what their names promise."""

import struct
from pathlib import Path

import bodies
import bpy
import clouds
import gltf_files
import numpy as np
import OpenImageIO as oiio
import pytest
import scenes
from command_line import assert_fails, run
from texture_readers import read_dds, read_ktx2

KINDS = {
    "bake": "textures.properties.BAKE",
    "model": "textures.properties.MODEL",
    "voxelize": "voxels.properties.VOXELIZE",
    "reconstruct": "points.properties.RECONSTRUCT",
    "rasterize": "shapes.properties.RASTERIZE",
    "resize": "images.properties.RESIZE",
    "resample": "images.properties.RESAMPLE",
}
FOLDER = Path(__file__).parents[3] / "addon/presets/prefilter"
ZSTANDARD, UASTC = (
    2,
    166,
)  # As the specifications of KTX 2 and of Khronos' data formats number them.
SHIPPED = sorted((path.parent.name, path.stem) for path in FOLDER.glob("*/*.py"))
SHIPPED += [("model", stem) for name, stem in SHIPPED if name == "bake"]


@pytest.fixture
def kind(addon):
    """Returns a function that gives a kind of presets by its name."""

    def find(name):
        module, _, constant = KINDS[name].rpartition(".")
        return getattr(addon(module), constant)

    return find


def apply(kind, path):
    return bpy.ops.prefilter.apply_preset(filepath=str(path), menu_idname=kind.panel)


def shown(kind):
    return getattr(bpy.context.scene, kind.group)


def size(obj):
    return len(obj.data.polygons)


def test_every_kind_has_presets(kind):
    assert {name for name, _ in SHIPPED} == set(KINDS)
    for name in KINDS:
        stems = {path.stem for path in kind(name).files().values()}
        assert stems == {stem for other, stem in SHIPPED if other == name}


@pytest.mark.parametrize(("name", "stem"), SHIPPED)
def test_a_preset_sets_the_values_of_its_file(kind, name, stem, capfd):
    """Chosen from the menu, every setting has the value of the file."""
    found = kind(name)
    path = found.files()[stem.replace("_", " ")]
    assert path.stem == stem
    assert apply(found, path) == {"FINISHED"}
    assert "Error" not in capfd.readouterr().err
    for key, value in found.values(stem).items():
        assert getattr(shown(found), key) == pytest.approx(value)


@pytest.mark.parametrize("name", KINDS)
def test_users_add_and_remove_presets(kind, name):
    found = kind(name)
    before = set(found.files())
    options = {key: option for key, _, option in found.options()}
    key = next(key for key in options if options[key].choices)
    default, other = getattr(shown(found), key), list(options[key].choices)[-1]
    setattr(shown(found), key, other)
    bpy.ops.prefilter.add_preset(name="My own", panel=found.panel)
    try:
        assert set(found.files()) == {*before, "My own"}
        assert found.values("my OWN")[key] == other
        setattr(shown(found), key, default)
        apply(found, found.files()["My own"])
        assert getattr(shown(found), key) == other
    finally:
        bpy.ops.prefilter.add_preset(name="My own", remove_name=True, panel=found.panel)
    assert set(found.files()) == before


def test_built_in_presets_cannot_be_removed(kind):
    found = kind("voxelize")
    before = found.files()
    bpy.ops.prefilter.add_preset(name="Preview", remove_name=True, panel=found.panel)
    assert found.files() == before


def test_presets_exclude_files_and_machine_settings(kind):
    """Names, files, frames and memory belong to a scene or a machine."""
    for name in KINDS:
        options = {key for key, _, _ in kind(name).options()}
        assert not options & {"filepath", "folder", "importance", "roughness", "frame_start"}
        assert not options & {"memory_limit", "threads"}


@pytest.mark.parametrize(("name", "stem"), SHIPPED)
def test_no_preset_drops_mesh_data(kind, name, stem):
    carried = {"use_materials", "use_uv_maps", "use_colors", "use_attributes"}
    found = kind(name).values(stem)
    assert all(found[key] for key in carried & set(found))


def test_a_preset_is_a_step_to_undo(kind):
    """Undoing the run after it leaves the settings of the preset."""
    found = kind("voxelize")
    bodies.cube()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.prefilter.apply_preset(
        "EXEC_DEFAULT", True, filepath=str(found.files()["Preview"]), menu_idname=found.panel
    )
    bpy.ops.prefilter.voxelize("EXEC_DEFAULT", True, depth=4)
    bpy.ops.ed.undo()
    assert shown(found).depth == 6
    bpy.ops.ed.undo()
    assert shown(found).depth == 8


@pytest.mark.parametrize("name", KINDS)
def test_reset(kind, name):
    found = kind(name)
    group = shown(found)
    defaults = {key: getattr(group, key) for key, _, _ in found.options()}
    for path in found.files().values():
        apply(found, path)
    bpy.ops.prefilter.reset_settings(panel=found.panel)
    assert {key: getattr(group, key) for key in defaults} == defaults


def test_presets_are_shared_as_files(kind, tmp_path):
    found = kind("voxelize")
    shown(found).depth = 5
    bpy.ops.prefilter.export_preset(panel=found.panel, filepath=str(tmp_path / "From_a_friend"))
    bpy.ops.prefilter.reset_settings(panel=found.panel)
    path = str(tmp_path / "From_a_friend.py")
    bpy.ops.prefilter.import_preset(panel=found.panel, filepath=path)
    try:
        assert found.values("From a friend")["depth"] == 5
        assert shown(found).depth == 8
        with pytest.raises(RuntimeError, match="there is a preset 'From a friend' already"):
            bpy.ops.prefilter.import_preset(panel=found.panel, filepath=path)
    finally:
        bpy.ops.prefilter.add_preset(name="From a friend", remove_name=True, panel=found.panel)
    Path(path).write_text("import os\nos.abort()\n")
    before = found.files()
    with pytest.raises(RuntimeError, match="preset 'From a friend'"):
        bpy.ops.prefilter.import_preset(panel=found.panel, filepath=path)
    with pytest.raises(RuntimeError, match="No such file"):
        bpy.ops.prefilter.import_preset(panel=found.panel, filepath=str(tmp_path / "none.py"))
    assert found.files() == before


def test_bad_presets(kind, tmp_path, monkeypatch):
    found = kind("voxelize")
    paths = bpy.utils.preset_paths
    monkeypatch.setattr(bpy.utils, "preset_paths", lambda sub: [*paths(sub), str(tmp_path)])
    for text, message in [
        ("settings.color = 1", "'color' is not a setting"),
        ("settings.depth = 99", "Depth: found 99; allowed: 1 to 12"),
        ("settings.depth = '9'", "Depth: found '9'"),
        ("settings.depth = True", "Depth: found True"),
        ("settings.holes = 'square'", "Holes: found 'square'"),
        ("settings.depth = max(1, 2)", "malformed"),
        ("settings.depth =", "invalid syntax"),
    ]:
        (tmp_path / "Odd.py").write_text(f"import bpy\nsettings = 0\n{text}\n")
        with pytest.raises(ValueError, match=message):
            found.values("Odd")


def test_scripts_name_a_preset():
    """Arguments of the caller take precedence."""
    ball = bodies.sphere()
    ball.data.materials.append(bpy.data.materials.new("Paint"))
    bpy.ops.prefilter.voxelize(preset="print-ready solid", depth=4)
    assert bodies.is_closed(ball)
    assert ball.data.materials[0].name.startswith("Paint")
    operator = bpy.context.window_manager.operators
    assert not operator or operator[-1].properties.depth == 4
    with pytest.raises(RuntimeError, match="found no preset named 'Fast'; there are 'Game asset'"):
        bpy.ops.prefilter.voxelize(preset="Fast")


def test_print_ready_solid():
    """A leaky box with a flap becomes closed, with its corners and few triangles."""
    box = bodies.cube()
    bodies.without_faces(box, 1)
    bpy.ops.prefilter.voxelize(preset="Print-ready solid", depth=6)
    assert bodies.is_closed(box)
    assert bodies.volume(box) == pytest.approx(8.0, rel=1e-3)
    corners = vertices(box)
    for sign in np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T:
        assert np.linalg.norm(corners - sign, axis=1).min() < 1e-3
    assert size(box) < 500


def test_preview_is_coarse(tmp_path):
    """A fraction of the triangles of a depth more, as there are points for; and the points stay."""
    points = clouds.scan(*clouds.torus(200_000))
    bpy.ops.prefilter.reconstruct(preset="Preview scan")
    coarse = bpy.context.active_object
    assert points.visible_get()
    assert np.abs(clouds.torus_distance(vertices(coarse))).max() < 0.05
    coarse.select_set(False)
    points.select_set(True)
    bpy.context.view_layer.objects.active = points
    bpy.ops.prefilter.reconstruct(preset="Print-ready solid", depth=8)
    assert size(bpy.context.active_object) > 3 * size(coarse)
    assert bodies.is_closed(bpy.context.active_object)


def vertices(obj):
    return np.array([vertex.co[:] for vertex in obj.data.vertices])


@pytest.fixture
def model(tmp_path):
    """A model with a color, a normal map and gray roughness; returns its file."""
    noise = scenes.noise(16, 16)[..., :3]
    bumps = (127 + np.round((noise - 0.5) * 100) + [0, 0, 90]).clip(0, 255) / 255
    pictures = {"color.png": noise, "normal.png": bumps}
    for name, pixels in pictures.items():
        gltf_files.write_png(tmp_path / name, pixels)
    material = {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "normalTexture": {"index": 1},
    }
    gltf_files.write(tmp_path / "model.gltf", [material], list(pictures))
    return tmp_path / "model.gltf"


def test_game_asset(model, tmp_path):
    """DDS with all levels, in blocks by content, fitted to one lookup a pixel."""
    result = run("bake", model, "--all", "--output", tmp_path / "out", "--preset", "Game asset")
    assert result.returncode == 0, result.stderr
    assert "for one lookup per pixel" in result.stdout
    found = {path.name: read_dds(path) for path in (tmp_path / "out").iterdir()}
    assert {name: file.format for name, file in found.items()} == {
        "color.dds": "BC7_SRGB",
        "normal.dds": "BC5_UNORM",
    }
    assert all(len(file.level_data) == 5 for file in found.values())


def test_one_image_of_a_game_asset(model, tmp_path):
    for name, expected in (("color", "BC7_SRGB"), ("normal", "BC5_UNORM")):
        target = tmp_path / f"{name}.dds"
        arguments = ("--image", f"{name}.png", "--output", target, "--preset", "game_asset")
        result = run("bake", model, *arguments)
        assert result.returncode == 0, result.stderr
        assert read_dds(target).format == expected


def test_web_viewer(model, tmp_path):
    result = run("bake", model, "--all", "--output", tmp_path / "out", "--preset", "Web viewer")
    assert result.returncode == 0, result.stderr
    for name in ("color", "normal"):
        data = (tmp_path / "out" / f"{name}.ktx2").read_bytes()
        scheme, descriptor = struct.unpack_from("<II", data, 44)
        assert (scheme, data[descriptor + 12]) == (ZSTANDARD, UASTC)


def test_cycles_cache(model, tmp_path):
    """Tiled TIFF with the bytes of the image, its levels fitted to readers of encoded texels."""
    target = tmp_path / "out" / "color.tx"
    result = run("bake", model, "--all", "--output", target.parent, "--preset", "Cycles cache")
    assert result.returncode == 0, result.stderr
    spec = oiio.ImageBuf(str(target)).spec()
    assert spec.tile_width > 0
    assert str(spec.format) == "uint8"
    expected = tmp_path / "expected.tx"
    more = ("--image", "color.png", "--output", expected, "--reader", "srgb-after")
    assert run("bake", model, *more).returncode == 0
    for level in range(5):
        assert oiio.ImageBuf(str(target), 0, level).spec().width == 16 >> level
        np.testing.assert_array_equal(
            *(oiio.ImageBuf(str(path), 0, level).get_pixels("uint8") for path in (target, expected))
        )


def test_flags_take_precedence(model, tmp_path):
    arguments = ("bake", model, "--all", "--output", tmp_path / "out", "--preset", "Game asset")
    assert run(*arguments, "--format", "ktx2", "--texture-format", "bc3").returncode == 0
    assert read_ktx2(tmp_path / "out/color.ktx2").format == "BC3_SRGB"


def test_flags_turn_on_what_a_preset_turns_off(addon):
    """The preset Preview has no clean-up; other settings have their defaults."""
    presets, voxels = addon("core.presets"), addon("voxels.choices")
    parser = addon("commands").Commands(["voxels"]).parser()
    kind = addon("voxels.properties").VOXELIZE
    for flags, expected in (([], False), (["--cleanup"], True), (["--no-cleanup"], False)):
        options = parser.parse_args(
            ["voxelize", "a.ply", "-o", "b.ply", "--preset", "Preview", *flags]
        )
        found = presets.settings_given(options, kind, voxels.VoxelizeSettings)
        assert (found.use_cleanup, found.use_colors, found.depth) == (expected, True, 6)


def test_settings_of_other_formats_are_ignored(model, tmp_path):
    """The preset is for DDS, but the user asks for a TIFF file."""
    target = tmp_path / "color.tif"
    more = ("--image", "color.png", "--output", target, "--preset", "Game asset")
    assert run("bake", model, *more).returncode == 0
    assert target.exists()


def pixels(path):
    return oiio.ImageBuf(str(path)).get_pixels("uint8")


def test_tiled_texture(model, tmp_path):
    """Edges are filtered with the opposite side, and the size is the caller's."""
    picture = model.parent / "color.png"
    shrink = ["resize", picture, "-o", tmp_path / "a.png"]
    assert_fails(run(*shrink, "--preset", "Tiled texture"), "no size", status=2)
    assert run(*shrink, "--percent", "50", "--preset", "Tiled texture").returncode == 0
    plain = ["resize", picture, "-o", tmp_path / "b.png", "--percent", "50", "--wrap"]
    assert run(*plain, "repeat").returncode == 0
    np.testing.assert_array_equal(pixels(tmp_path / "a.png"), pixels(tmp_path / "b.png"))
    assert run(*plain, "clamp").returncode == 0
    assert np.any(pixels(tmp_path / "a.png") != pixels(tmp_path / "b.png"))


def test_sizes_of_a_preset(kind, model, tmp_path, monkeypatch):
    """A size that is given stands for one of another kind that the preset sets."""
    paths = bpy.utils.preset_paths
    monkeypatch.setattr(bpy.utils, "preset_paths", lambda sub: [*paths(sub), str(tmp_path)])
    (tmp_path / "Small.py").write_text("settings.size = 'pixels'\nsettings.width = 6\n")
    picture, target = model.parent / "color.png", tmp_path / "out.png"
    for more, size in (([], 6), (["--percent", "25"], 4), (["--height", "5"], 5)):
        assert run("resize", picture, "-o", target, "--preset", "small", *more).returncode == 0
        assert pixels(target).shape[:2] == (size, size)
    (tmp_path / "Small.py").write_text("settings.warp = 'corners'\nsettings.size = 'image'\n")
    more = ("--rotate", "90", "--preset", "Small")
    assert run("resample", picture, "-o", target, *more).returncode == 0
    np.testing.assert_array_equal(pixels(target)[..., :3], np.rot90(pixels(picture))[..., :3])


def test_mask(tmp_path):
    """White on black without alpha; a size goes before a density."""
    drawing, target = tmp_path / "drawing.svg", tmp_path / "out.png"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><path d="M0 0H4V4H0Z" '
        'fill="red"/></svg>'
    )
    size = ("--width", "8", "--height", "8", "--margin", "2")
    result = run("rasterize", drawing, "-o", target, *size, "--preset", "Mask")
    assert result.returncode == 0, result.stderr
    found = pixels(target)
    assert found.shape[:2] == (8, 8)
    assert (found[2:6, 2:6, 0] == 255).all()
    assert (found[0] == found[0, 0]).all()
    assert found[0, 0, 0] == 0


def test_operators_of_images_take_presets():
    image = bpy.data.images.new("Noise", 8, 8)
    bpy.ops.prefilter.resize_image(image="Noise", preset="tiled texture")
    bpy.ops.prefilter.resample_image(image="Noise", preset="tiled texture", rotation=0.5)
    assert len(bpy.data.images) == 3
    with pytest.raises(RuntimeError, match="found no preset named 'Fast'; there are 'Tiled"):
        bpy.ops.prefilter.resize_image(image=image.name, preset="Fast")


def test_unknown_names(model, tmp_path):
    result = run("bake", model, "--all", "--output", tmp_path, "--preset", "Fast")
    assert_fails(result, "--preset", "'Fast'", "'Game asset'", "'Cycles cache'", status=2)
