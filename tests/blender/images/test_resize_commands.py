# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resize`."""

import struct
import zlib

import numpy as np
import prefilter
import pytest
import scenes
from command_line import assert_fails, run
from picture_files import content, write


@pytest.fixture
def paint(tmp_path):
    """Writes a picture of bytes and returns its path and its values."""
    pixels = scenes.noise(8, 12)[..., :3]
    write(tmp_path / "paint.png", pixels, "uint8")
    return tmp_path / "paint.png", pixels


def test_help():
    result = run("resize", "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage: blender --background --command prefilter resize")
    for word in ("--width", "--height", "--percent", "--data", "lanczos3", "least-squares"):
        assert word in result.stdout


def test_bytes(paint, tmp_path):
    path, pixels = paint
    result = run("resize", path, "-o", tmp_path / "small.png", "--percent", 50, "--filter", "box")
    assert result.returncode == 0, result.stderr
    assert "from 12 x 8 to 6 x 4 pixels with Box" in result.stdout
    found, kind = content(tmp_path / "small.png")
    assert kind == "uint8"
    expected = scenes.to_srgb(scenes.halved(scenes.to_linear(pixels)))
    np.testing.assert_allclose(found, expected, atol=0.5 / 255 + 1e-5)


def chunked(path, pixels, *chunks):
    """Writes a PNG file of bytes, rows from the top, with more chunks."""
    height, width, channels = pixels.shape
    kind = {1: 0, 2: 4, 3: 2}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    rows = zlib.compress(b"".join(b"\0" + row.tobytes() for row in pixels))
    parts = [(b"IHDR", header), *chunks, (b"IDAT", rows), (b"IEND", b"")]
    made = (
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(made))
    return path


SAME_SIZE = ("--percent", 100, "--filter", "box")


def test_pictures_are_turned_upright(tmp_path):
    pixels = (scenes.noise(8, 12)[..., :3] * 255).astype(np.uint8)
    turn = b"MM\0\x2a\0\0\0\x08\0\x01" + struct.pack(">HHIHHI", 0x112, 3, 1, 6, 0, 0)
    source = chunked(tmp_path / "in.png", pixels, (b"eXIf", turn))
    result = run("resize", source, "-o", tmp_path / "out.png", *SAME_SIZE)
    assert result.returncode == 0, result.stderr
    found, _ = content(tmp_path / "out.png")
    np.testing.assert_array_equal(np.rint(found[::-1] * 255), np.rot90(pixels, -1))


@pytest.mark.parametrize("channels", [1, 2])
def test_gray_stays_gray(tmp_path, channels):
    pixels = (scenes.noise(8, 12)[..., :channels] * 255).astype(np.uint8)
    source = chunked(tmp_path / "in.png", pixels)
    result = run("resize", source, "-o", tmp_path / "out.png", *SAME_SIZE)
    assert result.returncode == 0, result.stderr
    found, _ = content(tmp_path / "out.png")
    np.testing.assert_array_equal(np.rint(found[::-1] * 255), pixels)


def test_colors_of_other_spaces(tmp_path):
    pixels = np.full((8, 8, 3), (150, 120, 90), np.uint8)
    source = chunked(tmp_path / "in.png", pixels, (b"cICP", bytes([12, 13, 0, 1])))
    result = run("resize", source, "-o", tmp_path / "out.exr", "--percent", 50)
    assert result.returncode == 0, result.stderr
    found, _ = content(tmp_path / "out.exr")
    # The matrix published by SMPTE, from Display P3 to Rec. 709.
    matrix = [[1.22494, -0.22494, 0.0], [-0.04206, 1.04206, 0.0], [-0.01964, -0.07864, 1.09828]]
    expected = np.array(matrix) @ scenes.to_linear(pixels[0, 0] / 255)
    assert np.abs(found[2, 2] - expected).max() < 1 / 1024
    result = run("resize", source, "-o", tmp_path / "out.png", "--percent", 50)
    assert result.returncode == 0, result.stderr
    assert b"cICP\x0c\x0d\0\1" in (tmp_path / "out.png").read_bytes()


def test_the_color_space_can_be_said(tmp_path):
    source = chunked(tmp_path / "in.png", np.full((8, 8, 3), (150, 120, 90), np.uint8))
    more = ("--percent", 50, "--colorspace", "lin_rec709_scene")
    result = run("resize", source, "-o", tmp_path / "out.exr", *more)
    assert result.returncode == 0, result.stderr
    found, _ = content(tmp_path / "out.exr")
    assert np.abs(found[2, 2] - np.array([150, 120, 90]) / 255).max() < 1 / 1024


def test_data(paint, tmp_path):
    path, pixels = paint
    run("resize", path, "-o", tmp_path / "small.png", "--percent", 50, "--filter", "box", "--data")
    found, _ = content(tmp_path / "small.png")
    np.testing.assert_allclose(found, scenes.halved(pixels), atol=0.5 / 255 + 1e-6)


@pytest.mark.parametrize(
    ("arguments", "size"),
    [
        (("--width", 6), (6, 4)),
        (("--height", 16), (24, 16)),
        (("--width", 5, "--height", 3), (5, 3)),
        (("--percent", 0.01), (1, 1)),
    ],
)
def test_sizes(paint, tmp_path, arguments, size):
    result = run("resize", paint[0], "-o", tmp_path / "new.png", *arguments)
    assert result.returncode == 0, result.stderr
    assert content(tmp_path / "new.png")[0].shape[1::-1] == size


def test_sixteen_bits_stay(tmp_path):
    pixels = np.random.default_rng(4).random((8, 8, 3)).astype(np.float32)
    write(tmp_path / "deep.png", pixels, "uint16")
    run(
        "resize",
        tmp_path / "deep.png",
        "-o",
        tmp_path / "small.png",
        "--percent",
        50,
        "--filter",
        "box",
    )
    found, kind = content(tmp_path / "small.png")
    assert kind == "uint16"
    expected = scenes.to_srgb(scenes.halved(scenes.to_linear(pixels)))
    np.testing.assert_allclose(found, expected, atol=2e-4)


def test_floats_stay(tmp_path):
    pixels = 9 * np.random.default_rng(5).random((9, 6, 3)).astype(np.float32)
    write(tmp_path / "sky.exr", pixels, "float")
    result = run("resize", tmp_path / "sky.exr", "-o", tmp_path / "large.exr", "--percent", 200)
    assert result.returncode == 0, result.stderr
    found, kind = content(tmp_path / "large.exr")
    assert kind == "float"
    np.testing.assert_allclose(found, prefilter.resize(pixels, 12, 18), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("target", ["small.png", "small.exr"])
def test_alpha(tmp_path, target):
    pixels = np.ones((8, 8, 4), np.float32) * (1, 0, 1, 0)
    pixels[:, :3] = (0, 0.6, 0, 1)
    write(tmp_path / "leaf.png", pixels, "uint8")
    run(
        "resize", tmp_path / "leaf.png", "-o", tmp_path / target, "--percent", 50, "--filter", "box"
    )
    found, kind = content(tmp_path / target)
    linear = float(scenes.to_linear(np.float32(0.6)))
    expected = [(0, 0.6, 0, 1), (0, 0.6, 0, 0.5)]
    if target == "small.exr":
        assert kind == "half"
        expected = [(0, linear, 0, 1), (0, linear / 2, 0, 0.5)]
    np.testing.assert_allclose(found[0, :2], expected, atol=0.5 / 255 + 1e-4)


def test_alpha_of_floats(tmp_path):
    pixels = np.full((8, 8, 4), 0.25, np.float32)
    pixels[..., 3] = 0.5
    write(tmp_path / "glass.exr", pixels, "float", straight=False)
    run("resize", tmp_path / "glass.exr", "-o", tmp_path / "glass.png", "--percent", 50)
    found, _ = content(tmp_path / "glass.png")
    expected = scenes.to_srgb(np.float32([0.5, 0.5, 0.5]))
    np.testing.assert_allclose(found[..., :3], np.broadcast_to(expected, (4, 4, 3)), atol=1e-4)
    np.testing.assert_allclose(found[..., 3], 0.5, atol=1e-4)


def test_threads_make_no_difference(paint, tmp_path):
    for threads in (1, 3):
        run(
            *("resize", paint[0], "-o", tmp_path / f"{threads}.png", "--percent", 300),
            *("--threads", threads, "--filter", "least-squares", "--constrained"),
        )
    assert (tmp_path / "1.png").read_bytes() == (tmp_path / "3.png").read_bytes()


def test_wrong_arguments(paint, tmp_path):
    path, target = paint[0], tmp_path / "new.png"
    for arguments, words in (
        ((path, target), ("no size", "--percent, --width or --height")),
        ((path, target, "--percent", 5, "--width", 5), ("--percent: not allowed with",)),
        ((path, target, "--filter", "cubic"), ("--filter", "'cubic'", "least-squares")),
        ((path, tmp_path / "new.jpg", "--width", 5), ("OUTPUT", "new.jpg", ".png, .exr")),
    ):
        assert_fails(run("resize", *arguments), *words, status=2)
    assert not target.exists()


def test_failures(paint, tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    (tmp_path / "kept.png").write_bytes(b"kept")
    (tmp_path / "kept.png").chmod(0o444)
    size = ("--width", 5)
    for arguments, words in (
        ((tmp_path / "none.png", tmp_path / "new.png", *size), ("INPUT", "none.png")),
        ((tmp_path / "text.png", tmp_path / "new.png", *size), ("text.png", "no pixels")),
        ((paint[0], tmp_path / "none" / "new.png", *size), ("there is no folder",)),
        ((paint[0], "-o", tmp_path / "kept.png", *size), ("kept.png", "read-only")),
        (
            (paint[0], tmp_path / "new.png", "--width", 2**20, "--height", 2**20),
            ("1048576 x 1048576", "are free"),
        ),
    ):
        assert_fails(run("resize", *arguments), *words)
    assert (tmp_path / "kept.png").read_bytes() == b"kept"
    assert not (tmp_path / "new.png").exists()
