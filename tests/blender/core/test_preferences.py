# SPDX-License-Identifier: GPL-3.0-or-later

"""The preferences are the defaults until a user sets an option."""

from dataclasses import asdict
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

import bodies
import bpy
import clouds
import prefilter
import pytest
import scenes
from command_line import run
from conftest import PACKAGE


@pytest.fixture
def preferences():
    """Returns the preferences, which the next test finds as they were."""
    found = bpy.context.preferences.addons[PACKAGE].preferences
    yield found
    for name in ("threads", "memory_limit", "file_format"):
        found.property_unset(name)


@pytest.fixture
def told(monkeypatch):
    """Returns a function that has one of the package's note its arguments in a list."""

    def listen(name):
        calls, function = [], getattr(prefilter, name)

        def call(*arguments, **named):
            calls.append(named)
            return function(*arguments, **named)

        monkeypatch.setattr(prefilter, name, call)
        return calls

    return listen


def saved_scan(tmp_path):
    clouds.scan(*clouds.torus(2000))
    path = tmp_path / "scan.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_factory_settings_are_the_defaults(addon, preferences):
    for where in ("preferences", "textures.choices"):
        for name, default in asdict(addon(where).Preferences()).items():
            assert getattr(preferences, name) == default
    assert bpy.context.scene.prefilter_reconstruct.memory_limit == 0
    assert bpy.context.scene.prefilter_model.file_format == "ktx2"


def test_operators_follow(preferences, told):
    calls = told("reconstruct")
    preferences.threads, preferences.memory_limit = 1, 200
    points = clouds.scan(*clouds.torus(2000))
    bpy.ops.prefilter.reconstruct(depth=4, points="keep")
    bpy.context.view_layer.objects.active = points
    points.select_set(True)
    bpy.ops.prefilter.reconstruct(depth=4, memory_limit=0)
    assert [call["threads"] for call in calls] == [1, 1]
    assert [call["memory_limit"] for call in calls] == [200, None]


def test_looks_at_images_follow(preferences, told):
    """Whatever measures, shows or fills texels has the threads of the preferences."""
    image = scenes.image("Paint", scenes.noise(16, 16))
    scenes.textured_quad(image)
    names = ("mipmap_error", "texel_weights", "fill_unused", "sampling_levels", "mipmaps")
    calls = {name: told(name) for name in names}
    preferences.threads = 1
    operators = bpy.ops.prefilter
    operators.plot_error(image="Paint", filters={"box"})
    operators.show_weights(image="Paint")
    operators.fill_unused(image="Paint")
    operators.preview_plane(image="Paint")
    for name in names:
        assert calls[name], name
        assert all(call["threads"] == 1 for call in calls[name]), name


def test_commands_follow(preferences, told, tmp_path):
    calls = told("reconstruct")
    preferences.threads, preferences.memory_limit = 1, 1024
    path, target = saved_scan(tmp_path), tmp_path / "surface.ply"
    arguments = ("reconstruct", path, "-o", target, "--depth", 4)
    for more in ((), ("--threads", 2, "--memory-limit", 0)):
        assert run(*arguments, *more).returncode == 0
    assert [call["threads"] for call in calls] == [1, 2]
    assert [call["memory_limit"] for call in calls] == [1024, None]


def test_panels_show_the_effective_values(preferences):
    """Until a user sets it; then it stays, whatever the preferences say."""
    shown = bpy.context.scene.prefilter_model
    for choice in ("dds", "exr"):
        preferences.file_format = choice
        assert shown.file_format == choice
        assert shown.to_settings()[0].file_format == choice
    shown.file_format = "png"
    preferences.file_format = "dds"
    assert shown.file_format == "png"
    preferences.memory_limit = 2048
    assert bpy.context.scene.prefilter_reconstruct.memory_limit == 2048
    bpy.context.scene.prefilter_reconstruct.memory_limit = 0
    assert bpy.context.scene.prefilter_reconstruct.to_settings().memory_limit == 0


def test_files_have_the_default_format(preferences, tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(16, 16)))
    preferences.file_format = "dds"
    bpy.ops.prefilter.bake_model(folder=str(tmp_path))
    assert (tmp_path / "Paint.dds").exists()
    bpy.ops.prefilter.bake_model(folder=str(tmp_path), file_format="tif")
    assert (tmp_path / "Paint.tif").exists()
    assert len(list(tmp_path.iterdir())) == 2


def test_commands_have_the_default_format(preferences, tmp_path):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(16, 16)))
    path, folder = tmp_path / "scene.blend", tmp_path / "out"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    preferences.file_format = "dds"
    for more in ((), ("--format", "tif")):
        result = run("bake", path, "--all", "--output", folder, *more)
        assert result.returncode == 0, result.stderr
    assert {file.name for file in folder.iterdir()} == {"Paint.dds", "Paint.tif"}


def test_work_beyond_the_memory_limit_is_refused(preferences):
    box = bodies.cube()
    preferences.memory_limit = 64
    with pytest.raises(RuntimeError, match=r"GB of memory.*the preferences allow 64 MiB"):
        bpy.ops.prefilter.voxelize(depth=9)
    assert len(box.data.vertices) == 8
    preferences.memory_limit = 0
    assert bpy.ops.prefilter.voxelize(depth=5) == {"FINISHED"}


def test_manual(addon):
    """The button opens the manual that comes along."""
    first = local_file(addon("manual").page())
    assert first.name == "README.html"
    assert 'href="bake.html"' in first.read_text(encoding="utf-8")


def test_without_a_manual(addon, monkeypatch, tmp_path):
    monkeypatch.setattr(addon("manual"), "FOLDER", tmp_path / "none")
    assert addon("manual").page().startswith("https://")
    assert addon("manual").Manual([]).pages() == ("", ())


def test_context_menus_open_the_page():
    """Every operator and every setting of a panel has a page, like Blender's own."""
    find = bpy.types.WM_OT_doc_view_manual._lookup_rna_url
    for name in dir(bpy.ops.prefilter):
        assert local_file(find(f"bpy.ops.prefilter.{name}", verbose=False)).exists(), name
    groups = [name for name in dir(bpy.types.Scene) if name.startswith("prefilter_")]
    assert len(groups) > 5
    for name in groups:
        group = type(getattr(bpy.context.scene, name))
        for key in group.__annotations__:
            found = find(f"bpy.types.{group.__name__}.{key}", verbose=False)
            assert local_file(found).exists(), key
    assert "shapes.html" in find("bpy.ops.prefilter.rasterize", verbose=False)
    assert "docs.blender.org" in find("bpy.ops.object.voxel_remesh", verbose=False)


def local_file(address):
    parts = urlparse(address)
    assert parts.scheme == "file"
    return Path(url2pathname(parts.path))
