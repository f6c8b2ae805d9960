# SPDX-License-Identifier: GPL-3.0-or-later

"""Writing over files: regular files are replaced, through links; anything else is left alone."""

import io
import os
import re
import stat

import numpy as np
import prefilter
import pytest

LEVELS = [np.full((2, 2, 4), 0.5, np.float32)]
OCTREE = prefilter.voxelize(
    np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]), np.array([(0, 1, 2)]), depth=1
)
WRITERS = {
    "Octree.save": OCTREE.save,
    "write_dds": lambda path: prefilter.write_dds(path, LEVELS),
    "write_exr": lambda path: prefilter.write_exr(path, [LEVELS[0][:1, :1]]),
    "write_ktx2": lambda path: prefilter.write_ktx2(path, LEVELS),
}


@pytest.fixture(params=WRITERS)
def write(request):
    return WRITERS[request.param]


def make_pipe(path):
    if not hasattr(os, "mkfifo"):
        pytest.skip("there are no pipes among files")
    os.mkfifo(path)
    return "pipe"


def make_device(path):
    """The same device as /dev/full, in a folder of the test's."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 7))
    except (AttributeError, PermissionError):
        pytest.skip("devices are made by root only, and not on Windows")
    return "device"


def make_folder(path):
    path.mkdir()
    return "folder"


def link_to(place, link):
    try:
        link.symlink_to(place)
    except (NotImplementedError, OSError) as error:
        pytest.skip(f"there are no symbolic links: {error}")
    if not link.is_symlink():
        pytest.skip("there are no symbolic links")


@pytest.mark.parametrize("make", [make_pipe, make_device, make_folder])
@pytest.mark.parametrize("is_linked", [False, True])
def test_what_is_no_regular_file_stays(write, make, is_linked, tmp_path):
    place = tmp_path / "out"
    kind = make(place)
    before = os.lstat(place)
    given = tmp_path / "link" if is_linked else place
    if is_linked:
        link_to(place, given)
    message = f"path: '{given}' is a {kind}; a regular file"
    with pytest.raises(OSError, match=re.escape(message)):
        write(given)
    after = os.lstat(place)
    assert (after.st_ino, after.st_mode) == (before.st_ino, before.st_mode)
    assert {path.name for path in tmp_path.iterdir()} == {"out", given.name}


def test_a_device_that_takes_the_place_meanwhile_stays(tmp_path):
    path = tmp_path / "out.dds"

    def take_the_place(fraction):
        if not path.exists():
            make_pipe(path)

    with pytest.raises(OSError, match="is a pipe"):
        prefilter.write_dds(path, LEVELS, progress=take_the_place)
    assert [path.name for path in tmp_path.iterdir()] == ["out.dds"]
    assert path.is_fifo()


@pytest.mark.parametrize("name", ["write_dds", "write_exr", "write_ktx2"])
def test_an_open_file_gets_the_same_bytes(name, tmp_path):
    write = WRITERS[name]
    write(tmp_path / "out")
    opened = io.BytesIO()
    write(opened)
    assert opened.getvalue() == (tmp_path / "out").read_bytes()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("is_there", [True, False])
def test_what_a_link_leads_to_is_replaced(write, is_there, tmp_path):
    folder = tmp_path / "other"
    folder.mkdir()
    target, link = folder / "out", tmp_path / "link"
    if is_there:
        target.write_bytes(b"before")
        target.chmod(0o640)
    link_to(target, link)
    write(link)
    assert link.is_symlink()
    assert len(target.read_bytes()) > 6
    assert [path.name for path in folder.iterdir()] == ["out"]
    if is_there and os.name != "nt":
        assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_link_to_itself_is_told(write, tmp_path):
    link = tmp_path / "link"
    link_to(link, link)
    with pytest.raises(OSError, match="link"):
        write(link)


def test_names_in_any_language(write, tmp_path):
    target = tmp_path / "Größe 大小 📐" / "läuft.out"
    target.parent.mkdir()
    write(target)
    write(str(target))
    assert [path.name for path in target.parent.iterdir()] == [target.name]


@pytest.mark.skipif(os.name != "nt", reason="elsewhere files that are open can be replaced")
def test_a_target_that_is_open_is_told(write, tmp_path):
    target = tmp_path / "out"
    target.write_bytes(b"before")
    message = f"'{target}' cannot be replaced: another program has it open"
    with target.open("rb"), pytest.raises(OSError, match=re.escape(message)):
        write(target)
    assert target.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
