# SPDX-License-Identifier: GPL-3.0-or-later

"""Every writer of files, on full disks and when killed: a part of bench/reliability.

The programs there try 30 sizes of disks, and 200 kills.
"""

import errno
import os
import random
import sys
from pathlib import Path

import numpy as np
import pytest
from command_files import write_picture
from prefilter.files import staging
from prefilter.workflows import openimageio

pytest.importorskip("resource", reason="Windows has no such limits")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.reliability import disk_full, kills, writers

WRITERS = writers.of_kind("package", "command")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    writers.make_sources(folder)
    return folder


@pytest.fixture
def trial(request, sources, quick_path):
    if request.param.kind == "command":
        for name in ("OpenImageIO", "trimesh"):
            pytest.importorskip(name, reason="scripts/decoders.txt is not installed")
    return disk_full.Trial(request.param, sources, quick_path)


def each(chosen):
    return pytest.mark.parametrize(
        "trial", chosen, indirect=True, ids=lambda one: f"{one.kind} {one.name}"
    )


@each(WRITERS)
def test_files_that_cannot_be_written(trial, quick_path):
    found, _ = disk_full.on_full_disks(trial, quick_path, 4)
    assert set(found) <= {"old", "new"}
    assert found[0] == "old"
    assert found[-1] == "new"
    assert disk_full.read_only(trial, quick_path) == "old"
    assert disk_full.vanishing(trial, quick_path) in ("old", "new")


def test_limits_of_files_are_full_disks_for_others_than_root(sources, quick_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    trial = disk_full.Trial(writers.named("package", "write_ktx2"), sources, quick_path)
    found, are_disks = disk_full.on_full_disks(trial, quick_path, 5)
    assert not are_disks
    assert found == ["old"] * 4 + ["new"]


@each([writers.named("package", name) for name in ("write_exr", "reconstruct_file")])
def test_kills_at_random_moments(trial, quick_path):
    found = kills.at_random(trial, quick_path, 5, random.Random(7))
    assert found.others == []
    assert found.count == 5


@each([writers.named("command", "mipmaps to .png")])
def test_a_command_that_is_killed(trial, quick_path):
    found = kills.at_random(trial, quick_path, 5, random.Random(8))
    assert found.others == []


@pytest.mark.parametrize("ending", [".exr", ".tif"])
def test_pictures_that_are_cut_anywhere_are_found(tmp_path, ending):
    """OpenImageIO's writers report success even on a full disk, so files are checked."""
    pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")
    path = tmp_path / f"a{ending}"
    levels = [np.random.default_rng(i).random((64 >> i, 64 >> i, 3), np.float32) for i in range(7)]
    if ending == ".exr":
        write_picture(path, levels[0])
    else:
        shared = {"color_space": "scene_linear", "wrap_modes": "black,black", "has_alpha": False}
        openimageio.write_texture(path, levels, pixel_type="float", check=lambda: None, **shared)
    contents = path.read_bytes()
    count = 1 if ending == ".exr" else len(levels)
    openimageio.check_whole(path, count)
    # The directories of the last levels of a TIFF file are at its very end.
    near_end = range(len(contents) - 1000, len(contents) - 2, 50)
    for cut in (0, 1, 100, *range(4096, len(contents), 4096), *near_end):
        path.write_bytes(contents[:cut])
        with pytest.raises(OSError, match=rf"'a{ending}' was not written as a whole"):
            openimageio.check_whole(path, count)


def test_what_is_neither_old_nor_new_is_told(sources, quick_path):
    """The check must be able to fail."""
    trial = disk_full.Trial(writers.named("package", "write_ktx2"), sources, quick_path)
    assert trial.state(trial.earlier()) == "old"
    assert trial.state(trial.new) == "new"
    cut = {name: data[:-1] for name, data in trial.new.items()}
    for other in (cut, {}, {**trial.new, "left": b""}):
        assert trial.state(other).startswith("neither")
    assert disk_full.outcome("old", 1) == "old"
    assert disk_full.outcome("new", 0) == "new"
    assert disk_full.outcome("old", 0) == "old, status 0"
    assert disk_full.outcome("new", 1) == "new, status 1"


def test_a_full_disk_is_told_by_the_name_that_was_given(quick_path, monkeypatch):
    target = quick_path / "out.bin"

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    def text_of(path):
        raise OSError(f"cannot write '{path}': {path.name} is broken")

    with pytest.raises(OSError, match=r"out\.bin'$") as caught:
        staging.stage_bytes(target, full)
    assert caught.value.errno == errno.ENOSPC
    assert caught.value.filename == str(target)
    with pytest.raises(OSError, match=r"out\.bin'$"):
        staging.stage_with(target, lambda path: os.truncate(path, 0))
    with pytest.raises(OSError, match=r"^cannot write '.*out\.bin': out\.bin is broken$"):
        staging.stage_with(target, text_of)
    with pytest.raises(OSError, match=r"missing'$"):
        staging.stage_with(target, lambda _: (quick_path / "missing").read_bytes())
    with pytest.raises(
        OSError, match=r"^cannot write '[^']*/out\.bin': out\.bin is broken$"
    ) as caught:
        staging.stage_folder(target, text_of)
    assert ".prefilter" not in str(caught.value)
    staged = staging.stage_data(target, b"data")
    monkeypatch.setattr(staging, "rename", full)
    with pytest.raises(OSError, match=r"out\.bin'$"):
        staged.commit()
    staged.discard()
    assert not list(quick_path.iterdir())
