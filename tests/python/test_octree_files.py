# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of octrees: they load as they were saved, and damaged ones raise one kind of error."""

import io
import struct
import zipfile

import numpy as np
import prefilter
import pytest
from octrees import octrees_are_same
from solids import crumpled

SOLID = crumpled(1)
BOUNDS = (np.array([-0.1, 0, 0.2]), np.array([1, 1.5, 0.9]))
OCTREE = prefilter.voxelize(SOLID.positions, SOLID.triangles, depth=4, bounds=BOUNDS)


def array_bytes(array):
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def header_bytes(shape, dtype):
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        file, {"descr": dtype, "fortran_order": False, "shape": shape}
    )
    return file.getvalue()


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("octree") / "solid.npz"
    OCTREE.save(path)
    return path.read_bytes()


@pytest.fixture
def load(tmp_path):
    """Loads an octree from the content of a file."""

    def load_content(content):
        path = tmp_path / "other.npz"
        path.write_bytes(content)
        return prefilter.Octree.load(path)

    return load_content


def with_members(saved, **changed):
    """The archive with some members replaced, added, or with None left out."""
    file = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(saved)) as old, zipfile.ZipFile(file, "w") as new:
        members = {name.removesuffix(".npy"): old.read(name) for name in old.namelist()} | changed
        for name, content in members.items():
            if content is not None:
                new.writestr(f"{name}.npy", content)
    return file.getvalue()


def with_header_field(saved, offset, value):
    """The archive with a 16-bit field of every member changed, in both of its headers."""
    damaged = bytearray(saved)
    for signature, shift in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        start = damaged.find(signature)
        while start >= 0:
            struct.pack_into("<H", damaged, start + offset + shift, value)
            start = damaged.find(signature, start + 4)
    return bytes(damaged)


@pytest.mark.parametrize("depth", [1, 6])
def test_what_was_saved_comes_back(depth, tmp_path):
    octree = prefilter.voxelize(SOLID.positions, SOLID.triangles, depth=depth, bounds=BOUNDS)
    octree.save(tmp_path / "solid.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["solid.npz"]
    loaded = prefilter.Octree.load(tmp_path / "solid.npz")
    assert isinstance(loaded, prefilter.Octree)
    assert octrees_are_same(octree, loaded)
    assert loaded.volume == octree.volume
    np.testing.assert_array_equal(loaded.dense(1), octree.dense(1))


def test_an_array_that_is_not_needed_is_not_read(saved, load):
    large = header_bytes((10**9,), "<f8")
    assert octrees_are_same(load(with_members(saved, other=large, values9=large)), OCTREE)


NASTY = {
    "nothing": lambda saved: b"",
    "the start of an archive": lambda saved: b"PK",
    "another file": lambda saved: b"no octree",
    "one array": lambda saved: array_bytes(np.zeros(3)),
    "an archive of nothing": lambda saved: with_members(saved, format=None),
    "another format": lambda saved: with_members(saved, format=array_bytes("prefilter octree 1")),
    "a level left out": lambda saved: with_members(saved, values1=None),
    "the first level left out": lambda saved: with_members(saved, values0=None),
    "fewer levels": lambda saved: with_members(saved, levels=array_bytes(np.array(2))),
    "many levels": lambda saved: with_members(saved, levels=array_bytes(np.array(10**12))),
    "less than no level": lambda saved: with_members(saved, levels=array_bytes(np.array(-1))),
    "a mask left out": lambda saved: with_members(saved, split2=None),
    "a level that claims 7.5 GB": lambda saved: with_members(
        saved, values1=header_bytes((250_000_000, 8), "<f4") + bytes(100)
    ),
    "a level that is 7.5 GB of one block": lambda saved: with_members(
        saved, values0=header_bytes((250_000_000, 8), "<f4") + bytes(32)
    ),
    "a header that nests": lambda saved: with_members(
        saved, root=b"\x93NUMPY\x01\x00\xb6\x00" + b"(" * 182 + bytes(4)
    ),
    "objects": lambda saved: with_members(saved, depth=array_bytes(np.array([None]))),
    "a text for a depth": lambda saved: with_members(saved, depth=array_bytes(np.array("4"))),
    "two depths": lambda saved: with_members(saved, depth=array_bytes(np.array([4, 4]))),
    "a depth too large": lambda saved: with_members(saved, depth=array_bytes(np.array(2**40))),
    "a root of nan": lambda saved: with_members(saved, root=array_bytes(np.float32(np.nan))),
    "no bounds": lambda saved: with_members(saved, bounds=array_bytes(np.zeros((2, 3)))),
    "a password": lambda saved: with_header_field(saved, 6, 1),
    "a compression that is not known": lambda saved: with_header_field(saved, 8, 97),
    "a newer version": lambda saved: with_header_field(saved, 4, 99),
}


@pytest.mark.parametrize("kind", NASTY)
def test_what_is_no_octree_is_told(kind, saved, load):
    with pytest.raises(ValueError, match=r"path: '.*other\.npz' holds no octree: ."):
        load(NASTY[kind](saved))


@pytest.mark.parametrize("path", [3, None, "a\0b"])
def test_what_is_no_path(path):
    with pytest.raises(ValueError, match="path: "):
        prefilter.Octree.load(path)


def test_a_file_that_is_not_there(tmp_path):
    for path in (tmp_path / "absent.npz", tmp_path):
        with pytest.raises(OSError, match=path.name):
            prefilter.Octree.load(path)


def test_random_damage_is_told_or_does_no_harm(saved, load):
    random = np.random.default_rng(0)
    messages = []
    for _ in range(150):
        damaged = bytearray(saved)
        if random.random() < 0.25:
            del damaged[random.integers(len(saved)) :]
        else:
            for place in random.integers(len(saved), size=random.integers(1, 5)):
                damaged[place] = random.integers(256)
        try:
            loaded = load(bytes(damaged))
        except (ValueError, OSError) as error:
            messages.append(str(error))
        else:
            assert octrees_are_same(loaded, OCTREE)
    assert len(messages) > 100
    assert all("other.npz" in message for message in messages)
