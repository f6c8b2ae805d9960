# SPDX-License-Identifier: GPL-3.0-or-later

"""The commands `resize` and `resample`: their pictures, against the package's functions."""

import numpy as np
import prefilter
import pytest
from command_files import fails, noise, run, write_picture
from prefilter.workflows import openimageio

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")


@pytest.fixture
def photo(tmp_path):
    return write_picture(tmp_path / "photo.png", noise(30, 40, 4))


def stored(path, kind="uint8"):
    """Returns a picture file's values, row 0 at the bottom, with alpha as it is stored."""
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    spec = reader.spec()
    values = np.asarray(reader.read_image(kind)).reshape(spec.height, spec.width, -1)
    reader.close()
    return np.flipud(values)


def light(pixels):
    """Returns bytes, row 0 at the top, as light with row 0 at the bottom."""
    return prefilter.to_linear(np.flipud(pixels).astype(np.float32) / np.float32(255))


def as_bytes(linear):
    linear[..., 3] = linear[..., 3].clip(0, 1)
    return np.rint(prefilter.to_srgb(linear).clip(0, 1) * 255)


def test_resize(photo, tmp_path, capsys):
    out = tmp_path / "small.png"
    assert run("resize", photo, "-o", out, "--percent", "50", "--filter", "mitchell") == 0
    told = capsys.readouterr().out
    assert "Resized 'photo.png' from 40 x 30 to 20 x 15 pixels with Mitchell" in told
    expected = prefilter.resize(
        light(noise(30, 40, 4)), 20, 15, filter="mitchell", constrained=True, premultiplied=False
    )
    assert np.abs(stored(out) - as_bytes(expected)).max() <= 1


@pytest.mark.parametrize(
    ("flags", "size"),
    [
        (("--width", "10"), (10, 8)),
        (("--height", "15"), (20, 15)),
        (("--width", "10", "--height", "9"), (10, 9)),
    ],
)
def test_sizes(photo, tmp_path, flags, size):
    assert run("resize", photo, "-o", tmp_path / "out.png", *flags) == 0
    assert stored(tmp_path / "out.png").shape[1::-1] == size


def test_data_stay_as_they_are(tmp_path):
    source = write_picture(tmp_path / "rough.png", noise(8, 8))
    more = ("--percent", "50", "--filter", "box", "--data")
    assert run("resize", source, "-o", tmp_path / "out.png", *more) == 0
    mean = np.flipud(noise(8, 8).reshape(4, 2, 4, 2, 3).mean(axis=(1, 3)))
    assert np.abs(stored(tmp_path / "out.png") - mean).max() <= 0.51


def test_words_stay_words_and_floats_floats(tmp_path):
    words = write_picture(tmp_path / "a.png", noise(8, 8).astype(np.uint16) * 257)
    floats = write_picture(tmp_path / "a.exr", noise(8, 8).astype(np.float32) / 64)
    assert run("resize", words, "-o", tmp_path / "b.png", "--percent", "50") == 0
    assert run("resize", floats, "-o", tmp_path / "b.exr", "--percent", "50") == 0
    formats = [oiio.ImageBuf(str(tmp_path / name)).spec().format for name in ("b.png", "b.exr")]
    assert [str(one) for one in formats] == ["uint16", "float"]
    assert stored(tmp_path / "b.exr", "float").max() > 2


def test_resample(photo, tmp_path, capsys):
    out = tmp_path / "turned.png"
    flags = ("--rotate", "90", "--method", "exact", "--filter", "tent")
    assert run("resample", photo, "-o", out, *flags) == 0
    assert "Scaled and rotated 'photo.png' to 30 x 40 pixels" in capsys.readouterr().out
    expected = np.rot90(np.flipud(noise(30, 40, 4)), -1)
    covered = expected[..., 3] > 0
    found = stored(out)
    assert np.abs(found[..., 3].astype(int) - expected[..., 3]).max() <= 1
    assert np.median(np.abs(found[covered].astype(int) - expected[covered])) <= 1


def test_corners(photo, tmp_path):
    corners = ("0.1", "0", "1", "0.1", "0.9", "0.9", "0", "1")
    out = tmp_path / "pinned.exr"
    assert run("resample", photo, "-o", out, "--size", "image", "--corners", *corners) == 0
    assert stored(out, "float").shape == (30, 40, 4)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("resize", "{photo}", "-o", "{out}"), "no size: give --percent, --width or --height"),
        (
            ("resize", "{photo}", "-o", "{out}", "--percent", "5", "--width", "3"),
            "--percent: not",
        ),
        (("resize", "{photo}", "-o", "out.jpg", "--percent", "5"), "OUTPUT: found 'out.jpg'"),
        (
            ("resample", "{photo}", "-o", "{out}", "--pixels"),
            "--pixels: give --corners or --rectify",
        ),
        (
            ("resample", "{photo}", "-o", "{out}", "--table", "t.json"),
            "--table: not allowed without",
        ),
    ],
)
def test_flags_that_do_not_go_together(photo, tmp_path, capsys, arguments, words):
    filled = [one.format(photo=photo, out=tmp_path / "out.png") for one in arguments]
    assert words in fails(capsys, 2, *filled)


def test_failures(photo, tmp_path, capsys):
    out = tmp_path / "out.png"
    told = fails(capsys, 1, "resize", tmp_path / "none.png", "-o", out, "--percent", "50")
    assert "INPUT: there is no file" in told
    told = fails(capsys, 1, "resize", photo, "-o", tmp_path / "none/out.png", "--percent", "50")
    assert "there is no folder" in told
    told = fails(capsys, 1, "resample", photo, "-o", out, "--scale", "0")
    assert "the image would vanish" in told
    assert not out.exists()


@pytest.mark.parametrize("ending", ["png", "jpg", "tif", "exr", "tga"])
def test_pictures_that_are_cut_off(tmp_path, capsys, ending):
    path = write_picture(tmp_path / f"photo.{ending}", noise(64, 64))
    assert run("resize", path, "-o", tmp_path / "small.png", "--width", "8") == 0
    before = (tmp_path / "small.png").read_bytes()
    path.write_bytes(path.read_bytes()[:3000])
    told = fails(capsys, 1, "resize", path, "-o", tmp_path / "small.png", "--width", "8")
    assert f"'{path}' cannot be read as a picture: " in told
    assert (tmp_path / "small.png").read_bytes() == before


def test_a_picture_that_cannot_be_written_is_told_in_one_line(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(write_picture(tmp_path / "whole.png", noise(64, 64)).read_bytes()[:3000])
    with pytest.raises(
        OSError, match=r"'a\.png' was not written as a whole; is the disk full"
    ) as error:
        openimageio.check_whole(path)
    assert "\n" not in str(error.value)


def test_a_picture_may_replace_itself(photo):
    assert run("resize", photo, "-o", photo, "--percent", "50", "--overwrite") == 0
    assert stored(photo).shape == (15, 20, 4)
