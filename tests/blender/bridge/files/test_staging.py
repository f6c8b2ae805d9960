# SPDX-License-Identifier: GPL-3.0-or-later

"""Staged files: permitted replacements, and sets that are written as a whole."""

import os
import stat

import numpy as np
import pytest
import scenes
from prefilter.workflows.files import target_files


def make_pipe(path):
    os.mkfifo(path)


def make_device(path):
    """A device node that discards all data; not the system's own node."""
    try:
        os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 3))
    except PermissionError:
        pytest.skip("only root makes devices")


@pytest.mark.parametrize("make", [make_pipe, make_device])
@pytest.mark.parametrize(
    ("module", "check", "name"),
    [
        (target_files, "check_target", "out.exr"),
        (target_files, "check_target", "out.dds"),
        (None, "check_output", "out.blend"),
        (None, "check_plain_target", "out.csv"),
    ],
)
def test_only_regular_files_are_replaced(addon, tmp_path, make, module, check, name):
    path = tmp_path / name
    make(path)
    before = path.stat().st_mode
    ending = [path.suffix] if check == "check_plain_target" else []
    with pytest.raises(OSError, match=rf"'.*{name}' is a (device|pipe); a regular file"):
        getattr(module or addon("bridge.files.staging"), check)(str(path), *ending)
    assert path.stat().st_mode == before


def test_a_bake_leaves_a_pipe(bake, tmp_path):
    path = tmp_path / "out.01.png"
    os.mkfifo(path)
    image = scenes.image("Paint", scenes.noise(4, 4))
    with pytest.raises(OSError, match=r"out\.01\.png' is a pipe"):
        bake(image, filter="box", filepath=str(tmp_path / "out.png"))
    assert stat.S_ISFIFO(path.stat().st_mode)
    assert os.listdir(tmp_path) == ["out.01.png"]


@pytest.mark.parametrize("name", ["out.dds", "out.exr"])
def test_a_texture_is_staged_once(bake, tmp_path, monkeypatch, name):
    original, renamed = os.replace, []

    def replace(source, target):
        renamed.append(os.path.basename(target))
        original(source, target)

    monkeypatch.setattr(os, "replace", replace)
    bake(scenes.image("Paint", scenes.noise(4, 4)), filter="box", filepath=str(tmp_path / name))
    assert renamed == [name]


def fail_at(monkeypatch, staging, count, *, for_good=False):
    """Lets one renaming fail, or all that follow, too."""
    original, calls = os.replace, []

    def replace(source, target):
        calls.append(target)
        if len(calls) == count or (for_good and len(calls) > count):
            raise PermissionError(f"no rename of '{target}'")
        original(source, target)

    monkeypatch.setattr(staging.os, "replace", replace)
    return calls


def staged(addon, folder, count):
    """Stages files of which every other one is there already."""
    staging = addon("bridge.files.staging")
    files = []
    for number in range(count):
        target = folder / f"{number}.txt"
        if number % 2:
            target.write_text("old")
        files.append(staging.stage_with(target, lambda path: path.write_text("new")))
    return staging, files


def texts(folder):
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_all_files_of_a_set(addon, tmp_path):
    staging, files = staged(addon, tmp_path, 5)
    (tmp_path / "3.txt").chmod(0o640)
    staging.commit_all(files)
    assert texts(tmp_path) == {f"{number}.txt": "new" for number in range(5)}
    assert (tmp_path / "3.txt").stat().st_mode & 0o777 == 0o640


def no_link(source, target):
    raise OSError("this file system has no links")


@pytest.mark.parametrize("count", [1, 2, 4, 5])
@pytest.mark.parametrize("has_links", [True, False])
def test_no_file_of_a_set_where_one_fails(addon, tmp_path, monkeypatch, count, has_links):
    staging, files = staged(addon, tmp_path, 5)
    if not has_links:
        monkeypatch.setattr(staging.os, "link", no_link)
    fail_at(monkeypatch, staging, count)
    with pytest.raises(OSError, match=rf"no rename of '.*{count - 1}\.txt'$"):
        staging.commit_all(files)
    for file in files:
        file.discard()
    assert texts(tmp_path) == {"1.txt": "old", "3.txt": "old"}


def test_files_that_cannot_be_restored_are_named(addon, tmp_path, monkeypatch):
    staging, files = staged(addon, tmp_path, 5)
    fail_at(monkeypatch, staging, 5, for_good=True)
    with pytest.raises(OSError, match=r"no rename") as caught:
        staging.commit_all(files)
    message = str(caught.value)
    for number in (1, 3):
        assert f"{number}.txt' was written, which cannot be undone" in message
        assert (tmp_path / f"{number}.txt").read_text() == "new"
    assert "/0.txt" not in message
    assert not (tmp_path / "0.txt").exists()
    kept = [path for path in tmp_path.glob(".prefilter-*") if path.read_text() == "old"]
    assert len(kept) == 2
    assert all(str(path) in message for path in kept)


def test_pngs_of_a_bake_are_all_written_or_none(bake, addon, tmp_path, monkeypatch):
    image = scenes.image("Paint", scenes.noise(8, 8))
    options = {"filter": "box", "filepath": str(tmp_path / "out.png")}
    bake(image, **options)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    level = scenes.pixels("Paint.mip01")
    image.pixels.foreach_set(scenes.noise(8, 8, seed=9).ravel())
    fail_at(monkeypatch, addon("bridge.files.staging"), 3)
    with pytest.raises(OSError, match="no rename"):
        bake(image, **options)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    np.testing.assert_array_equal(scenes.pixels("Paint.mip01"), level)


def test_a_normal_map_without_its_roughness_is_not_written(bake, addon, tmp_path, monkeypatch):
    image = scenes.image("Bumps", scenes.noise(8, 8), colorspace="Non-Color")
    scenes.image("Rough", scenes.noise(8, 8, seed=2), colorspace="Non-Color")
    fail_at(monkeypatch, addon("bridge.files.staging"), 2)
    with pytest.raises(OSError, match="no rename"):
        bake(
            image,
            filter="box",
            content="normal",
            roughness="Rough",
            filepath=str(tmp_path / "bumps.exr"),
            roughness_filepath=str(tmp_path / "rough.exr"),
        )
    assert list(tmp_path.iterdir()) == []
