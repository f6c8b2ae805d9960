# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.import_points`: files of points as objects."""

import os
import re
from pathlib import Path
from types import SimpleNamespace

import bodies
import bpy
import clouds
import numpy as np
import prefilter
import pytest

COUNT = 2_000
SCANS = Path(__file__).resolve().parents[4] / "shared" / "data" / "points"
HAS_CLOUDS = "resize" in bpy.types.PointCloud.bl_rna.functions


@pytest.fixture
def torus(tmp_path):
    """Returns a file of a torus with normals and colors, and these."""
    positions, normals = clouds.torus(COUNT)
    colors = np.round(255 * (positions + 1.5) / 3)
    path = clouds.file(tmp_path / "Torus.xyz", positions, normals, colors)
    return SimpleNamespace(path=path, positions=positions, normals=normals, colors=colors)


def read(*paths, **options):
    """Imports files, and returns the object that is active then."""
    if len(paths) == 1:
        options["filepath"] = str(paths[0])
    else:
        options["directory"] = str(paths[0].parent)
        options["files"] = [{"name": path.name} for path in paths]
    assert bpy.ops.prefilter.import_points(**options) == {"FINISHED"}
    return bpy.context.object


def attribute(obj, name, field, width):
    found = obj.data.attributes[name]
    values = np.empty((len(found.data), width), np.float32)
    found.data.foreach_get(field, values.ravel())
    return values


def test_points_normals_and_colors(torus, capfd):
    obj = read(torus.path)
    assert obj.type == ("POINTCLOUD" if HAS_CLOUDS else "MESH")
    assert (obj.name, bpy.context.selected_objects) == ("Torus", [obj])
    np.testing.assert_allclose(clouds.points(obj), torus.positions, atol=1e-6)
    np.testing.assert_allclose(attribute(obj, "normal", "vector", 3), torus.normals, atol=1e-6)
    found = attribute(obj, "Col", "color_srgb", 4)
    np.testing.assert_allclose(255 * found[:, :3], torus.colors, atol=0.6)
    assert (found[:, 3] == 1).all()
    assert "Imported 2000 points from 'Torus.xyz'" in capfd.readouterr().out


def color_of(material):
    """Returns the attribute that the surface of a material is colored by."""
    nodes = material.node_tree.nodes
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    (link,) = surface.inputs["Base Color"].links
    return link.from_node.attribute_name


def test_a_material_shows_the_colors(torus):
    """Points and surfaces of several files have one."""
    first, second = read(torus.path), read(torus.path)
    bpy.ops.prefilter.reconstruct(depth=5)
    (material,) = bpy.data.materials
    assert color_of(material) == "Col"
    for obj in (first, second, bpy.context.object):
        assert list(obj.data.materials) == [material]
    mesh = bpy.context.object.data
    assert mesh.color_attributes.active_color_name == "Col"


def test_points_without_colors_have_no_material(torus, tmp_path):
    obj = read(clouds.file(tmp_path / "Plain.xyz", torus.positions))
    assert not bpy.data.materials
    assert not obj.modifiers


def test_points_are_rendered_in_their_colors(torus, tmp_path):
    """Cycles renders red rising from left to right, green from front to back."""
    read(torus.path)
    picture = rendered(tmp_path)

    def seen(x, y):
        around = picture[y - 4 : y + 5, x - 4 : x + 5].reshape(-1, 4)
        return around[around[:, 3] > 0.5, :3].mean(axis=0)

    left, right, front, back = seen(11, 32), seen(52, 32), seen(32, 11), seen(32, 52)
    assert right[0] > left[0] + 0.3
    assert back[1] > front[1] + 0.3


def rendered(tmp_path):
    """Renders the square of side 3 around the origin from above, in white light."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 8
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = str(tmp_path / "seen.png")
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.0
    camera.location.z = 5
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 3
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.camera = camera
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(64 * 64 * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(64, 64, 4)


def test_undo_takes_the_object_back(torus):
    bpy.ops.ed.undo_push(message="before")
    read(torus.path)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert not bpy.data.objects


def test_import_and_reconstruct_at_once(torus):
    bpy.context.scene.prefilter_reconstruct.depth = 5
    obj = read(torus.path, use_reconstruct=True)
    assert obj.name == "Torus.surface"
    assert bodies.is_closed(obj)
    assert {"normal", "Col"} & set(obj.data.attributes.keys()) == {"Col"}
    assert bpy.data.objects["Torus"].hide_get()


def test_imported_points_can_be_reconstructed(torus):
    read(torus.path)
    assert bpy.ops.prefilter.reconstruct(depth=5) == {"FINISHED"}
    assert bodies.is_closed(bpy.context.object)


def test_several_files(torus, tmp_path):
    other = clouds.file(tmp_path / "Other.pts", torus.positions + 3)
    read(torus.path, other)
    assert sorted(obj.name for obj in bpy.context.selected_objects) == ["Other", "Torus"]
    assert bpy.context.object.name == "Torus"


PLACE = np.array([4.5e6, -312_000.25, 120.0])


def test_far_from_the_origin(torus, tmp_path, capfd):
    """Large coordinates keep their digits, and files keep their places relative to each other."""
    far = [
        clouds.file(tmp_path / f"{name}.xyz", torus.positions.round(2) + PLACE + shift)
        for name, shift in (("First", 0), ("Second", (0, 0, 5)))
    ]
    one, two = (read(path) for path in far)
    offset = np.array(one["scan_offset"])
    assert list(offset) == list(two["scan_offset"])
    assert np.abs(offset - PLACE).max() < 2
    assert tuple(one.location) == (0, 0, 0)
    found = clouds.points(one) + (offset - PLACE)
    np.testing.assert_allclose(found, torus.positions, atol=0.02)
    shift = clouds.points(two) - clouds.points(one)
    np.testing.assert_allclose(shift, [[0, 0, 5]] * COUNT, atol=0.02)
    out = capfd.readouterr().out
    assert "far from the origin" in out
    assert "scan_offset" in out


def test_offsets_are_round(torus, tmp_path):
    """Offsets are rounded to the extent's digits; points a few hundred extents away are far."""
    wide = clouds.file(tmp_path / "Wide.xyz", 400 * torus.positions + [637_179, 849_497, 431])
    assert list(read(wide)["scan_offset"]) == [637_000, 849_000, 0]
    near = clouds.file(tmp_path / "Near.xyz", torus.positions + np.array([200, 0, 0]))
    assert "scan_offset" not in read(near)


def test_merged_coordinates_are_reported(torus, tmp_path, capfd):
    merged = (torus.positions + PLACE).astype(np.float32)
    read(clouds.file(tmp_path / "Merged.xyz", merged.astype(np.float64)))
    assert "Warning: coordinates were rounded to 50 cm" in capfd.readouterr().out
    read(clouds.file(tmp_path / "Whole.xyz", torus.positions + PLACE))
    assert "rounded" not in capfd.readouterr().out


def test_the_surface_keeps_the_offset(torus, tmp_path):
    path = clouds.file(tmp_path / "Far.xyz", torus.positions + PLACE, torus.normals)
    offset = list(read(path)["scan_offset"])
    bpy.ops.prefilter.reconstruct(depth=5)
    assert list(bpy.context.object["scan_offset"]) == offset


def test_near_the_origin_nothing_moves(torus):
    assert "scan_offset" not in read(torus.path)


PTX = """2
1
{0} 0 0
1 0 0
0 1 0
0 0 1
1 0 0 0
0 1 0 0
0 0 1 0
{0} 0 0 1
1 0 0 0.5
0 1 0 0.5
"""


def test_viewpoints(tmp_path):
    """One place is a property of the object, several are an attribute of the points."""
    one, several = tmp_path / "one.ptx", tmp_path / "several.ptx"
    one.write_text(PTX.format(5) * 2)
    several.write_text(PTX.format(5) + PTX.format(900_007))
    obj = read(one)
    assert attribute(obj, "scan_viewpoint", "vector", 3).tolist() == 4 * [[5, 0, 0]]
    pcd = tmp_path / "seen.pcd"
    head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n"
    pcd.write_text(f"{head}VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\nDATA ascii\n0 0 0\n0 1 0\n")
    assert list(read(pcd)["scan_viewpoint"]) == [1, 2, 3]
    obj = read(several)
    offset = np.array(obj.get("scan_offset", (0, 0, 0)))
    places = attribute(obj, "scan_viewpoint", "vector", 3) + offset
    assert places.tolist() == 2 * [[5, 0, 0]] + 2 * [[900_007, 0, 0]]


def test_thinned(torus, capfd):
    obj = read(torus.path, most_points=COUNT // 3)
    assert len(clouds.points(obj)) == COUNT // 4
    np.testing.assert_allclose(clouds.points(obj), torus.positions[::4], atol=1e-6)
    assert "one of 4 points was kept, as Most Points is 666" in capfd.readouterr().out


def test_points_that_are_not_finite_are_left_out(torus, tmp_path, capfd):
    torus.positions[3] = np.nan
    obj = read(clouds.file(tmp_path / "Holes.xyz", torus.positions))
    assert len(clouds.points(obj)) == COUNT - 1
    assert "no finite position: 1 point" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("none.xyz", None, "none.xyz"),
        ("empty.xyz", "", "empty.xyz"),
        ("nan.xyz", "nan nan nan\n", "'nan.xyz': no points"),
        ("words.xyz", "1 2 3\nnot a point\n", "words.xyz"),
        ("scan.stl", "solid", "unsupported extension '.stl'"),
    ],
)
def test_unreadable_files(tmp_path, name, text, message):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.prefilter.import_points(filepath=str(tmp_path / name))
    assert not bpy.data.objects


def test_no_file_is_given():
    with pytest.raises(RuntimeError, match="no file is given"):
        bpy.ops.prefilter.import_points()


def test_poll(torus):
    bodies.cube()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        bpy.ops.prefilter.import_points(filepath=str(torus.path))


@pytest.mark.parametrize("name", ["kitten.xyz", "bunnyData.pts", "pcl_capture0001.pcd"])
def test_real_scans(name):
    path = SCANS / name
    if not path.exists():
        pytest.skip(f"there is no {path}")
    obj = read(path)
    found = clouds.points(obj)
    assert len(found) > 5_000
    assert np.isfinite(found).all()


def test_all_extensions_are_offered(addon):
    extensions = prefilter.POINT_EXTENSIONS
    pattern = bpy.ops.prefilter.import_points.get_rna_type().properties["filter_glob"].default
    assert pattern.split(";") == [f"*{ending}" for ending in extensions]
    dropped = set(
        addon("points.operators.drop_points").PREFILTER_FH_points.bl_file_extensions.split(";")
    )
    # Blender compares the last extension of a name alone.
    last = {os.path.splitext(f"a{extension}")[1] for extension in extensions}
    assert last - dropped == {".ply", ".txt", ".obj"}
    assert ".gz" in dropped


def test_extensions_in_the_menu_are_read(addon):
    texts = []
    layout = SimpleNamespace(operator=lambda name, text: texts.append(text))
    addon("points.menus")._draw_import(SimpleNamespace(layout=layout), None)
    named = re.findall(r"\.\w+", texts[0])
    assert len(named) == 7
    assert {*named} <= {*prefilter.POINT_EXTENSIONS}
