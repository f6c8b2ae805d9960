# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs every operator once on small scenes, which must work in any Blender.

Nothing here needs a window or OpenImageIO's Python module. A new operator needs a test here, named
after it.
"""

from collections.abc import Iterator

import bodies
import bpy
import clouds
import numpy as np
import outlines
import prefilter
import pytest
import scenes

FINISHED = {"FINISHED"}
HAS_CACHE = "use_texture_cache" in bpy.types.RenderSettings.bl_rna.properties
TRIANGLE = '<svg viewBox="0 0 4 4"><path d="M0 0h4L0 4z"/></svg>'


@pytest.fixture
def paint() -> bpy.types.Image:
    """Returns an image that a square shows."""
    made = scenes.image("Paint", scenes.noise(8, 8))
    scenes.textured_quad(made)
    return made


@pytest.fixture(autouse=True)
def _all_is_saved() -> Iterator[None]:
    """Asserts that the operator's results survive saving and opening the file."""
    yield
    kinds = (
        *(bpy.data.images, bpy.data.objects, bpy.data.meshes, bpy.data.texts, bpy.data.volumes),
        bpy.data.pointclouds,
    )
    unused = [block.name for kind in kinds for block in kind if block.users == 0]
    assert not [name for name in unused if name not in {"Render Result", "Viewer Node"}]


def test_every_operator_is_here():
    tested = {name.removeprefix("test_") for name in globals() if name.startswith("test_")}
    missing = set(dir(bpy.ops.prefilter)) - tested
    assert not missing, f"tests/blender/test_smoke.py has no test of {sorted(missing)}"


def test_bake_mipmaps(paint, tmp_path):
    assert bpy.ops.prefilter.bake_mipmaps(image="Paint") == FINISHED
    assert tuple(bpy.data.images["Paint.mip03"].size) == (1, 1)
    for name in ("paint.exr", "paint.dds", "paint.ktx2", "paint.png"):
        options = {"filepath": str(tmp_path / name)}
        assert bpy.ops.prefilter.bake_mipmaps(image="Paint", **options) == FINISHED, name
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"paint.exr", "paint.dds", "paint.ktx2"} | {
        f"paint.{number:02d}.png" for number in range(4)
    }


def test_bake_model(paint, tmp_path):
    options = {"folder": str(tmp_path), "file_format": "dds"}
    assert bpy.ops.prefilter.bake_model(**options) == FINISHED
    assert [path.name for path in tmp_path.iterdir()] == ["Paint.dds"]


def test_export_mipmaps(paint, tmp_path):
    path = str(tmp_path / "paint.dds")
    assert bpy.ops.prefilter.export_mipmaps(image="Paint", filepath=path) == FINISHED
    assert [path.name for path in tmp_path.iterdir()] == ["paint.dds"]


def test_export_model(paint, tmp_path):
    options = {"directory": str(tmp_path), "file_format": "exr"}
    assert bpy.ops.prefilter.export_model(**options) == FINISHED
    assert [path.name for path in tmp_path.iterdir()] == ["Paint.exr"]


def test_bake_texture_cache(paint, tmp_path):
    if not HAS_CACHE:
        assert not bpy.ops.prefilter.bake_texture_cache.poll()
        return
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.context.scene.render.engine = "CYCLES"
    bpy.context.scene.render.use_texture_cache = True
    assert bpy.ops.prefilter.bake_texture_cache(use_unpack=True) == FINISHED
    assert len(list(tmp_path.rglob("*.tx"))) == 1


def test_remove_levels(paint):
    bpy.ops.prefilter.bake_mipmaps(image="Paint")
    bpy.ops.prefilter.bake_mipmaps(image="Paint", result="preview")
    assert bpy.ops.prefilter.remove_levels(image="Paint") == FINISHED
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_plot_error(paint):
    assert bpy.ops.prefilter.plot_error(image="Paint", filters={"box", "pam-box"}) == FINISHED
    assert "Paint.error" in bpy.data.images
    assert "Paint.error.csv" in bpy.data.texts


def test_preview_levels(paint):
    assert bpy.ops.prefilter.preview_levels(image="Paint") == FINISHED


def test_end_preview(paint):
    bpy.ops.prefilter.preview_levels(image="Paint")
    with scenes.image_editor(paint):
        assert bpy.ops.prefilter.end_preview() == FINISHED
        assert not bpy.ops.prefilter.end_preview.poll()


def test_preview_on_model(paint):
    bpy.context.view_layer.objects.active = bpy.data.objects["Quad"]
    assert bpy.ops.prefilter.preview_on_model() == FINISHED


def test_end_model_preview(paint):
    assert not bpy.ops.prefilter.end_model_preview.poll()
    bpy.ops.prefilter.preview_on_model(image="Paint")
    assert bpy.ops.prefilter.end_model_preview() == FINISHED
    assert not bpy.ops.prefilter.end_model_preview.poll()


def test_show_weights(paint):
    assert bpy.ops.prefilter.show_weights(image="Paint") == FINISHED
    assert "Paint.weights" in bpy.data.images


def test_show_source(paint):
    bpy.ops.prefilter.show_weights(image="Paint")
    with scenes.image_editor(bpy.data.images["Paint.weights"]) as editor:
        assert bpy.ops.prefilter.show_source() == FINISHED
        assert editor.image == paint


def test_fill_unused(paint):
    assert bpy.ops.prefilter.fill_unused(image="Paint") == FINISHED
    assert "Paint.filled" in bpy.data.images


def test_resize_image(paint, tmp_path):
    assert bpy.ops.prefilter.resize_image(image="Paint") == FINISHED
    assert len(bpy.data.images) == 2


def test_resample_image(paint):
    assert bpy.ops.prefilter.resample_image(image="Paint") == FINISHED
    assert len(bpy.data.images) == 2


def test_drag_corners(paint):
    assert not bpy.ops.prefilter.drag_corners.poll()
    with scenes.image_editor(paint), pytest.raises(RuntimeError, match="needs a window"):
        bpy.ops.prefilter.drag_corners("INVOKE_DEFAULT")


def test_preview_plane(paint):
    assert bpy.ops.prefilter.preview_plane(image="Paint", filter="box") == FINISHED


def test_end_plane(paint):
    bpy.ops.prefilter.preview_plane(image="Paint", filter="box")
    with scenes.image_editor(paint):
        assert bpy.ops.prefilter.end_plane() == FINISHED
        assert not bpy.ops.prefilter.end_plane.poll()


def test_sampling_table():
    assert bpy.ops.prefilter.sampling_table(filter="tent", texels=6, language="glsl") == FINISHED
    table = prefilter.SamplingTable.standard("tent", 6)
    assert bpy.data.texts["tent-6.glsl"].as_string() == table.glsl()


def test_rasterize():
    outlines.square()
    assert bpy.ops.prefilter.rasterize(width=16, height=16, margin=0) == FINISHED
    assert np.all(scenes.pixels(bpy.data.images[0].name)[..., 3] == 1)


def test_rasterize_svg(tmp_path):
    path = tmp_path / "triangle.svg"
    path.write_text(TRIANGLE)
    options = {"filepath": str(path), "width": 16, "height": 16, "margin": 0}
    assert bpy.ops.prefilter.rasterize_svg(**options) == FINISHED
    assert scenes.pixels(bpy.data.images[0].name)[..., 3].mean() == pytest.approx(0.5, abs=1e-3)


def test_use_as_decal():
    outlines.square()
    bpy.ops.prefilter.rasterize(side=32)
    assert bpy.ops.prefilter.use_as_decal() == FINISHED


def test_update_drawn():
    square = outlines.square()
    bpy.ops.prefilter.rasterize(width=16, height=16, margin=4)
    name = bpy.data.images[0].name
    before = scenes.pixels(name)
    square.scale.x = 0.5
    bpy.context.view_layer.update()
    assert bpy.ops.prefilter.update_drawn(image=name) == FINISHED
    assert np.any(scenes.pixels(name) != before)


def test_voxelize():
    bodies.cube()
    assert bpy.ops.prefilter.voxelize(depth=4) == FINISHED
    found = bpy.context.object
    assert bodies.is_closed(found)
    assert bodies.volume(found) == pytest.approx(8, rel=0.05)


def test_boolean():
    bodies.cube("Tool", location=(1, 0, 0))
    bodies.cube("Base")
    assert bpy.ops.prefilter.boolean(depth=5) == FINISHED
    assert bodies.is_closed(bpy.context.object)


def test_import_points(tmp_path):
    path = clouds.file(tmp_path / "Torus.xyz", *clouds.torus(1_000))
    assert bpy.ops.prefilter.import_points(filepath=str(path)) == FINISHED
    assert "normal" in bpy.data.objects["Torus"].data.attributes


def test_subsample_points():
    scan = clouds.scan(*clouds.torus(5_000))
    assert bpy.ops.prefilter.subsample_points(spacing=0.2) == FINISHED
    assert 50 < len(clouds.points(scan)) < 1_000


def test_remove_outliers():
    scan = clouds.scan(np.concatenate([clouds.torus(5_000)[0], [(0.0, 0.0, 5.0)]]))
    assert bpy.ops.prefilter.remove_outliers() == FINISHED
    assert len(clouds.points(scan)) == 5_000


def test_crop_points():
    scan = clouds.scan(clouds.torus(5_000)[0])
    assert not bpy.ops.prefilter.crop_points.poll()
    bodies.cube(location=(1, 0, 0))
    scan.select_set(True)
    assert bpy.ops.prefilter.crop_points() == FINISHED
    assert clouds.points(scan)[:, 0].min() >= 0


def test_align_scans():
    points = clouds.torus(5_000)[0] * (1, 1.3, 1)
    clouds.scan(points, name="Other", location=(0.03, 0.0, 0.02))
    clouds.scan(clouds.torus(5_000, 2)[0] * (1, 1.3, 1), name="Active")
    bpy.data.objects["Other"].select_set(True)
    assert bpy.ops.prefilter.align_scans() == FINISHED
    assert bpy.data.objects["Other"].location.length < 0.01


def test_paint_texture():
    points, normals = clouds.torus(5_000)
    colors = np.column_stack([normals * 0.5 + 0.5, np.ones(len(points))])
    clouds.scan(points, attributes={"Col": ("FLOAT_COLOR", colors)}, name="Scan")
    mesh = bodies.cube()
    bpy.data.objects["Scan"].select_set(True)
    assert bpy.ops.prefilter.paint_texture(size=64) == FINISHED
    assert mesh.data.uv_layers
    assert tuple(bpy.data.images[f"{mesh.name}.colors"].size) == (64, 64)


def test_drop_points(tmp_path):
    clouds.file(tmp_path / "Torus.xyz", *clouds.torus(1_000))
    named = {"directory": str(tmp_path), "files": [{"name": "Torus.xyz"}]}
    assert bpy.ops.prefilter.drop_points(**named) == FINISHED
    assert "Torus" in bpy.data.objects


def test_select_found():
    assert not bpy.ops.prefilter.select_found.poll()
    cube = bodies.cube()
    bodies.without_faces(cube, 1)
    assert bpy.ops.prefilter.voxelize(depth=4) == FINISHED
    assert [place.kind for place in cube.prefilter_found.places] == ["OPEN"]
    assert bpy.ops.prefilter.select_found(index=0) == FINISHED
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")


def test_update_voxels():
    assert not bpy.ops.prefilter.update_voxels.poll()
    bodies.cube()
    bpy.ops.prefilter.voxelize(depth=4)
    assert bpy.ops.prefilter.update_voxels() == FINISHED


def test_switch_source():
    assert not bpy.ops.prefilter.switch_source.poll()
    cube = bodies.cube()
    bpy.ops.prefilter.voxelize(depth=4)
    assert bpy.ops.prefilter.switch_source() == FINISHED
    assert not cube.visible_get()


def test_forget_source():
    bodies.cube()
    bpy.ops.prefilter.voxelize(depth=4)
    assert bpy.ops.prefilter.forget_source() == FINISHED
    assert not bpy.ops.prefilter.forget_source.poll()


def test_reconstruct():
    clouds.scan(*clouds.torus(5_000))
    assert bpy.ops.prefilter.reconstruct(depth=5) == FINISHED
    assert bodies.is_closed(bpy.data.objects["Scan.surface"])


def test_trim_reconstruction():
    clouds.scan(*clouds.torus(5_000))
    assert not bpy.ops.prefilter.trim_reconstruction.poll()
    bpy.ops.prefilter.reconstruct(depth=5)
    assert bpy.ops.prefilter.trim_reconstruction() == FINISHED
    assert bodies.is_closed(bpy.data.objects["Scan.surface"])


def test_demonstrate():
    assert bpy.ops.prefilter.demonstrate(kind="mipmaps") == FINISHED
    assert "Stone Prefilter.mip04" in bpy.data.images
    bpy.ops.prefilter.end_demonstration()


def test_end_demonstration():
    home = bpy.context.scene
    bpy.ops.prefilter.demonstrate(kind="solid")
    assert bpy.context.scene != home
    assert bpy.ops.prefilter.end_demonstration() == FINISHED
    assert list(bpy.data.scenes) == [home]


def test_dismiss_welcome():
    assert bpy.ops.prefilter.dismiss_welcome() == FINISHED
    assert not bpy.types.PREFILTER_PT_welcome.poll(bpy.context)


def test_add_preset():
    kind = bpy.types.PREFILTER_PT_voxelize_presets.kind
    assert bpy.ops.prefilter.add_preset(name="Smoke", panel=kind.panel) == FINISHED
    assert "Smoke" in kind.files()
    arguments = {"name": "Smoke", "remove_name": True, "panel": kind.panel}
    assert bpy.ops.prefilter.add_preset(**arguments) == FINISHED
    assert "Smoke" not in kind.files()


@pytest.fixture
def panel() -> str:
    """Returns the identifier of a panel of presets."""
    return bpy.types.PREFILTER_PT_voxelize_presets.kind.panel


def test_apply_preset(panel):
    path = next(iter(bpy.types.PREFILTER_PT_voxelize_presets.kind.files().values()))
    options = {"filepath": str(path), "menu_idname": panel}
    assert bpy.ops.prefilter.apply_preset(**options) == FINISHED


def test_reset_settings(panel):
    bpy.context.scene.prefilter_voxelize.depth = 3
    assert bpy.ops.prefilter.reset_settings(panel=panel) == FINISHED
    assert bpy.context.scene.prefilter_voxelize.depth > 3


def test_export_preset(panel, tmp_path):
    path = str(tmp_path / "Smoke.py")
    assert bpy.ops.prefilter.export_preset(panel=panel, filepath=path) == FINISHED
    assert [one.name for one in tmp_path.iterdir()] == ["Smoke.py"]


def test_import_preset(panel, tmp_path):
    path = str(tmp_path / "Smoke.py")
    bpy.ops.prefilter.export_preset(panel=panel, filepath=path)
    assert bpy.ops.prefilter.import_preset(panel=panel, filepath=path) == FINISHED
    arguments = {"name": "Smoke", "remove_name": True, "panel": panel}
    assert bpy.ops.prefilter.add_preset(**arguments) == FINISHED


def test_clear_queue():
    """Needs ended jobs, which exist in windows only."""
    assert not bpy.ops.prefilter.clear_queue.poll()


def test_confirm_cancel():
    """Needs a running operator, which exists in windows only."""
    assert bpy.ops.prefilter.confirm_cancel(key="") == {"CANCELLED"}


def test_assign_shortcut():
    """Keys are in windows only."""
    assert bpy.ops.prefilter.assign_shortcut(operator="prefilter.voxelize") == {"CANCELLED"}


def test_remove_shortcut():
    assert bpy.ops.prefilter.remove_shortcut(operator="prefilter.voxelize") == {"CANCELLED"}
