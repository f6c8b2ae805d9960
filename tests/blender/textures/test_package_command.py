# SPDX-License-Identifier: GPL-3.0-or-later

"""The package's command `mipmaps` writes the same bytes as the command `bake`."""

import numpy as np
import OpenImageIO as oiio
import pytest
from command_line import run
from prefilter.commands import program
from prefilter.workflows import mesh_files, picture_files

BAKE = ("--wrap", "repeat")
"""The wrap mode that OpenImageIO writes into TIFF files."""


@pytest.fixture
def quad(tmp_path, monkeypatch):
    """Writes a quad as an .obj file; Blender has no trimesh, which would read it as this."""
    path = tmp_path / "quad.obj"
    path.write_text(
        "o Quad\nv 0 0 0\nv 3 0 0\nv 3 1 0\nv 0 1 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    )
    positions = np.array([[0, 0, 0], [3, 0, 0], [3, 0, 1], [0, 0, 1]], float)
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    part = mesh_files.NamedMesh("Quad", positions, np.array([[0, 1, 2], [0, 2, 3]]), uvs)
    monkeypatch.setattr(mesh_files, "read", lambda _, paths: [part] if paths else [])
    return path


def write(path, pixels, *, is_straight=True):
    """Writes pixels, rows from the bottom, just as they are."""
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], str(pixels.dtype))
    if is_straight:
        spec.attribute("oiio:UnassociatedAlpha", 1)
    writer = oiio.ImageOutput.create(str(path))
    assert writer.open(str(path), spec)
    assert writer.write_image(np.ascontiguousarray(pixels[::-1]))
    writer.close()
    return path


def picture(folder, kind):
    """Writes a picture of a kind: the type of its numbers, and its channels."""
    name, channels = kind.split("-")
    values = np.random.default_rng(7).random((12, 16, int(channels)), np.float32)
    if name == "float":
        values = values * np.float32(3)
        if channels == "4":
            values[..., 3] /= np.float32(3)
        return write(folder / "paint.exr", values.astype(np.float32))
    most = {"uint8": 255, "uint16": 65535}[name]
    return write(folder / "paint.png", np.rint(values * most).astype(name))


@pytest.mark.parametrize("kind", ["uint8-1", "uint8-3", "uint8-4", "float-3", "float-4"])
@pytest.mark.parametrize("ending", ["dds", "ktx2", "exr", "tif", "png"])
def test_same_bytes(quad, tmp_path, kind, ending):
    source = picture(tmp_path, kind)
    assert same(quad, source, tmp_path, ending)


@pytest.mark.parametrize(
    "options",
    [
        ("--content", "normal"),
        ("--content", "data", "--texture-format", "blocks"),
        ("--content", "cutout", "--threshold", "0.4"),
        ("--filter", "lanczos3", "--wrap-v", "clamp"),
        ("--lookups", "views"),
        ("--texture-format", "bc7", "--supercompression", "zstd"),
    ],
    ids=" ".join,
)
def test_same_bytes_with_options(quad, tmp_path, options):
    assert same(quad, picture(tmp_path, "uint8-4"), tmp_path, "ktx2", *options)


def same(quad, source, folder, ending, *options):
    """Bakes with both commands; tells whether their files are the same."""
    ours, blenders = folder / "ours", folder / "blenders"
    for target in (ours, blenders):
        target.mkdir()
    made = program.main(
        ["mipmaps", str(source), str(quad), "-o", str(ours / f"out.{ending}"), *options]
    )
    assert made == 0
    out = blenders / f"out.{ending}"
    result = run("bake", quad, "--image", source, "--output", out, *BAKE, *options)
    assert result.returncode == 0, result.stderr
    files = [{path.name: path.read_bytes() for path in one.iterdir()} for one in (ours, blenders)]
    assert files[0].keys() == files[1].keys()
    return files[0] == files[1]


@pytest.mark.parametrize("kind", ["uint8-4", "uint16-3", "uint16-4", "float-4"])
@pytest.mark.parametrize("is_data", [False, True])
def test_pictures_are_read_as_blender_reads_them(addon, tmp_path, kind, is_data):
    if is_data and kind.endswith("4"):
        pytest.skip("Blender multiplies colors by an alpha that is none")
    path = picture(tmp_path, kind)
    images = addon("bridge.images")
    theirs = images.read(images.load("it", str(path), is_data=is_data))
    ours = picture_files.read("it", str(path), is_data=is_data)
    for name in ("is_float", "is_integer", "encoding", "is_data", "alpha_is_coverage"):
        assert getattr(ours, name) == getattr(theirs, name), name
    if ours.is_float:
        np.testing.assert_allclose(ours.texels, theirs.texels, rtol=2e-4, atol=2e-5)
    else:
        np.testing.assert_array_equal(ours.texels, theirs.texels)
