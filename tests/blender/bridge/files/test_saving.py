# SPDX-License-Identifier: GPL-3.0-or-later

"""The .blend file that is open, saved by a command."""

import os
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest


@pytest.mark.parametrize("versions", [0, 1, 2])
def test_earlier_versions_are_kept_as_blender_keeps_them(addon, tmp_path, versions):
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.context.preferences.filepaths.save_version = versions
    saved = [path.read_bytes()]
    for number in range(3):
        bpy.data.texts.new(f"text {number}")
        addon("bridge.files.scenes").save_open(str(path))
        saved.insert(0, path.read_bytes())
        kept = {f"scene.blend{i or ''}": data for i, data in enumerate(saved[: versions + 1])}
        assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == kept
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert {f"text {number}" for number in range(3)} <= {text.name for text in bpy.data.texts}


def test_a_file_that_cannot_be_replaced_stays(addon, tmp_path, monkeypatch):
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    before = path.read_bytes()

    def no_rename(source, target):
        raise PermissionError("no rename")

    monkeypatch.setattr(addon("bridge.files.staging").os, "replace", no_rename)
    with pytest.raises(OSError, match="no rename"):
        addon("bridge.files.scenes").save_open(str(path))
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == {path.name: before}


@pytest.mark.parametrize("number", [1, 2, 3])
def test_versions_stay_where_the_file_cannot_be_replaced(addon, tmp_path, monkeypatch, number):
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.context.preferences.filepaths.save_version = 2
    scenes = addon("bridge.files.scenes")
    for text in ("one", "two"):
        bpy.data.texts.new(text)
        scenes.save_open(str(path))
    before = {one.name: one.read_bytes() for one in tmp_path.iterdir()}
    assert len(before) == 3
    bpy.data.texts.new("three")
    replace, calls = os.replace, []

    def fail_once(source, target):
        calls.append(target)
        if len(calls) == number:
            raise PermissionError("no rename")
        replace(source, target)

    monkeypatch.setattr(os, "replace", fail_once)
    with pytest.raises(OSError, match=r"^--save: cannot write '.*scene\.blend': no rename"):
        scenes.save_open(str(path))
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == before


def test_files_that_blender_cannot_rename_are_removed(addon, tmp_path, monkeypatch):
    def save(filepath, **_):
        Path(f"{filepath}@").write_bytes(b"whole")
        raise RuntimeError("Error: Cannot change old file (file saved with @)")

    scenes = addon("bridge.files.scenes")
    monkeypatch.setattr(scenes, "bpy", SimpleNamespace(ops=SimpleNamespace(wm=SimpleNamespace())))
    scenes.bpy.ops.wm.save_as_mainfile = save
    with pytest.raises(RuntimeError, match="saved with @"):
        scenes._write_blend(tmp_path / "scene.blend")
    assert not list(tmp_path.iterdir())


def test_relative_paths_stay(addon, tmp_path):
    path = tmp_path / "scene.blend"
    image = bpy.data.images.new("Paint", 4, 4)
    image.filepath_raw = str(tmp_path / "paint.png")
    image.file_format = "PNG"
    image.save()
    image.source = "FILE"
    image.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    image.filepath = "//paint.png"
    addon("bridge.files.scenes").save_open(str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert bpy.data.images["Paint"].filepath == "//paint.png"
