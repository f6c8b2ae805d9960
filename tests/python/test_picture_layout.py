# SPDX-License-Identifier: GPL-3.0-or-later

"""Orientation, channels and sizes of picture files, and that files written hold no date."""

import re

import numpy as np
import pytest
from command_files import fails, noise, run, write_picture, write_quad
from prefilter.commands import program
from prefilter.workflows import memory, openimageio

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

# The upright image of an array by its EXIF orientation: where its first row and column are.
UPRIGHT = {
    1: lambda rows: rows,
    2: lambda rows: rows[:, ::-1],
    3: lambda rows: np.rot90(rows, 2),
    4: lambda rows: rows[::-1],
    5: lambda rows: np.transpose(rows, (1, 0, 2)),
    6: lambda rows: np.rot90(rows, -1),
    7: lambda rows: np.rot90(np.transpose(rows, (1, 0, 2)), 2),
    8: lambda rows: np.rot90(rows, 1),
}
PLAIN = ("--method", "exact", "--filter", "box", "--wrap", "clamp")
SAME_SIZE = ("--percent", "100", "--filter", "box")
CHANNELS = {1: ("Y",), 2: ("Y", "A"), 3: ("R", "G", "B"), 4: ("R", "G", "B", "A")}


def read(path, kind="uint8"):
    """Returns a file's values as they are stored, and its specification."""
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    spec = reader.spec()
    values = np.asarray(reader.read_image(kind)).reshape(spec.height, spec.width, spec.nchannels)
    reader.close()
    return values, spec


def oriented(path, pixels, orientation):
    """Writes a file with an orientation."""
    image = pytest.importorskip("PIL.Image")
    block = image.Exif()
    block[0x112] = orientation
    more = {"lossless": True} if path.suffix == ".webp" else {"quality": 100}
    image.fromarray(pixels).save(path, exif=block, **more)
    return path


@pytest.mark.parametrize("orientation", UPRIGHT)
@pytest.mark.parametrize("ending", ["png", "tif", "webp", "jpg"])
def test_pictures_are_turned_upright(tmp_path, ending, orientation):
    pixels = np.repeat(np.repeat(noise(4, 6), 8, axis=0), 8, axis=1)
    source = oriented(tmp_path / f"in.{ending}", pixels, orientation)
    stored = pixels if ending != "jpg" else read(source)[0]
    expected = UPRIGHT[orientation](stored)
    assert run("resize", source, "-o", tmp_path / "out.png", *SAME_SIZE) == 0
    assert (read(tmp_path / "out.png")[0] == expected).all()
    assert run("resample", source, "-o", tmp_path / "out.png", *PLAIN) == 0
    middle = (slice(2, -2), slice(2, -2))
    assert np.abs(read(tmp_path / "out.png")[0][middle].astype(int) - expected[middle]).max() <= 1
    if orientation in {1, 6}:
        assert run("mipmaps", source, "-o", tmp_path / "out.tif", "--filter", "box") == 0
        assert (read(tmp_path / "out.tif")[0] == expected).all()


def test_textures_on_meshes_stay_as_they_are_stored(tmp_path, capsys):
    pixels = noise(16, 32)
    source = oriented(tmp_path / "in.png", pixels, 6)
    mesh = write_quad(tmp_path / "quad.obj")
    assert run("mipmaps", source, mesh, "-o", tmp_path / "out.tif") == 0
    told = capsys.readouterr().err
    assert "TEXTURE: 'in.png' has the orientation 6 of EXIF, which is left out" in told
    assert (read(tmp_path / "out.tif")[0] == pixels).all()


@pytest.mark.parametrize("command", ["resize", "resample", "mipmaps"])
@pytest.mark.parametrize("channels", CHANNELS)
@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_channels_and_bits_stay(tmp_path, command, channels, kind):
    values = noise(16, 16, channels) // 2 + 64
    pixels = (values.astype(np.float64) * {1: 1, 2: 257, 4: 1 / 255}[kind().itemsize]).astype(kind)
    source = write_picture(tmp_path / f"in.{'exr' if kind is np.float32 else 'png'}", pixels)
    for ending in ("png", "exr"):
        target = tmp_path / f"out.{ending}"
        if command == "mipmaps":
            assert run("mipmaps", source, "-o", target) == 0
        else:
            more = (
                ("--percent", "50")
                if command == "resize"
                else ("--scale", "0.5", "--wrap", "clamp")
            )
            assert run(command, source, "-o", target, *more) == 0
        if command == "mipmaps" and ending == "png":
            target = tmp_path / "out.00.png"
        spec = read(target)[1]
        assert tuple(spec.channelnames) == CHANNELS[channels]
        if ending == "png":
            assert str(spec.format) == ("uint8" if kind is np.uint8 else "uint16")


def test_gray_has_the_values_of_colors(tmp_path):
    gray = noise(32, 32, 2)
    for name, pixels in (("gray", gray), ("colors", gray[..., [0, 0, 0, 1]].copy())):
        source = write_picture(tmp_path / f"{name}.png", pixels)
        assert run("resize", source, "-o", tmp_path / f"{name}-out.png", "--percent", "50") == 0
    made, expected = (read(tmp_path / f"{name}-out.png")[0] for name in ("gray", "colors"))
    assert (made == expected[..., [0, 3]]).all()


def test_levels_of_gray(tmp_path):
    source = write_picture(tmp_path / "gray.png", noise(32, 32, 1))
    for ending in ("tif", "tx", "exr"):
        assert run("mipmaps", source, "-o", tmp_path / f"out.{ending}") == 0
        values, spec = read(tmp_path / f"out.{ending}")
        assert tuple(spec.channelnames) == ("Y",)
        if ending != "exr":
            assert (values == noise(32, 32, 1)).all()


def test_a_gray_roughness_of_which_one_channel_counts(tmp_path):
    normals = np.full((16, 16, 3), (128, 128, 255), np.uint8)
    normals[::2, :, 0] = 180
    source = write_picture(tmp_path / "n.png", normals)
    rough = write_picture(tmp_path / "r.png", np.full((16, 16, 1), 60, np.uint8))
    more = ("--roughness", rough, "--roughness-output", tmp_path / "r.tif")
    more += ("--roughness-channel", "green", "--content", "normal")
    assert run("mipmaps", source, "-o", tmp_path / "n.tif", *more) == 0
    assert tuple(read(tmp_path / "r.tif")[1].channelnames) == CHANNELS[3]


def test_palettes_and_few_bits(tmp_path):
    image = pytest.importorskip("PIL.Image").fromarray(noise(16, 16))
    for mode, channels in (("P", 3), ("1", 1)):
        image.convert(mode).save(tmp_path / "in.png")
        assert run("resize", tmp_path / "in.png", "-o", tmp_path / "out.png", *SAME_SIZE) == 0
        values, spec = read(tmp_path / "out.png")
        assert spec.nchannels == channels
        wanted = np.asarray(image.convert(mode).convert("RGB" if channels == 3 else "L"))
        assert (values.reshape(wanted.shape) == wanted).all()


def test_floats_with_straight_alpha(tmp_path):
    pixels = np.full((8, 8, 4), (0.5, 0.25, 0.125, 0.5), np.float32)
    source = write_picture(tmp_path / "in.tif", pixels)
    assert read(source, "float")[1].get_int_attribute("oiio:UnassociatedAlpha") == 1
    assert run("resize", source, "-o", tmp_path / "out.exr", "--percent", "50") == 0
    made = read(tmp_path / "out.exr", "float")[0]
    assert np.abs(made - (0.25, 0.125, 0.0625, 0.5)).max() < 1e-6


@pytest.mark.parametrize("command", ["resize", "resample", "mipmaps"])
def test_pictures_larger_than_memory(tmp_path, capsys, monkeypatch, command):
    source = write_picture(tmp_path / "in.png", noise(500, 2000))
    # Bytes, and the same again in another order.
    needed = 2 * 500 * 2000 * 3
    more = {"resize": ("--percent", "1"), "resample": ("--scale", "0.01"), "mipmaps": ()}[command]
    out = ("-o", tmp_path / "out.exr") if command == "mipmaps" else (tmp_path / "out.exr",)
    monkeypatch.setattr(openimageio, "free_memory", lambda: (needed - 1, "little is free"))
    monkeypatch.setattr(oiio, "ImageInput", WithoutPixels)
    told = fails(capsys, 1, command, source, *out, *more)
    assert "a picture of 2000 x 500 pixels needs about 0.006 GB of memory; little is free" in told


class WithoutPixels:
    """Opens files, whose pixels are not to be read."""

    def __init__(self, reader):
        self._reader = reader

    @staticmethod
    def open(*arguments):
        return WithoutPixels(REAL_INPUT.open(*arguments))

    def __getattr__(self, name):
        assert "read" not in name
        return getattr(self._reader, name)


REAL_INPUT = oiio.ImageInput


def test_the_memory_that_is_free_counts():
    assert openimageio.free_memory is memory.free_memory


DATE = re.compile(rb"\d{4}[:-]\d\d[:-]\d\d[ T]\d\d:\d\d")


@pytest.mark.parametrize("ending", ["tif", "tiff", "tx", "exr", "png", "dds", "ktx2"])
@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_levels_have_no_date(tmp_path, ending, kind):
    name = "in.exr" if kind is np.float32 else "in.png"
    source = write_picture(tmp_path / name, noise(128, 64, 4).astype(kind))
    assert run("mipmaps", source, "-o", tmp_path / f"out.{ending}") == 0
    for path in tmp_path.glob("out*"):
        assert DATE.search(path.read_bytes()) is None


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_pictures_have_no_date(tmp_path, ending):
    source = write_picture(tmp_path / "in.png", noise(16, 16))
    drawing = tmp_path / "in.svg"
    drawing.write_text("<svg xmlns='http://www.w3.org/2000/svg'><rect width='9' height='9'/></svg>")
    target = tmp_path / f"out.{ending}"
    for command in (
        ("resize", source, "-o", target, "--percent", "50"),
        ("resample", source, "-o", target, "--scale", "0.5"),
        ("rasterize", drawing, "-o", target, "--side", "32"),
    ):
        assert run(*command) == 0
        assert DATE.search(target.read_bytes()) is None
        spec = read(target)[1]
        assert all(spec.getattribute(name) is None for name in ("DateTime", "capDate"))


def test_drawings_name_their_color_space(tmp_path):
    drawing = tmp_path / "in.svg"
    rect = "<rect width='99' height='99' fill='#bc8040'/>"
    drawing.write_text(
        f"<svg xmlns='http://www.w3.org/2000/svg' width='99' height='99'>{rect}</svg>"
    )
    assert run("rasterize", drawing, "-o", tmp_path / "out.exr", "--side", "32") == 0
    values, spec = read(tmp_path / "out.exr", "float")
    assert spec.getattribute("colorInteropID") == "lin_rec709_scene"
    stored = np.array([0xBC, 0x80, 0x40]) / 255
    assert np.abs(values[8, 8, :3] - ((stored + 0.055) / 1.055) ** 2.4).max() < 1 / 1024


@pytest.mark.parametrize("ending", ["exr", "png"])
def test_channels_that_are_not_read_are_named(tmp_path, capsys, ending):
    spec = oiio.ImageSpec(8, 8, 5, "half")
    spec.channelnames = ("R", "G", "B", "Z", "mask")
    output = oiio.ImageOutput.create(str(tmp_path / "deep.exr"))
    assert output.open(str(tmp_path / "deep.exr"), spec)
    assert output.write_image(np.full((8, 8, 5), 0.25, np.float32))
    output.close()
    del output
    target = tmp_path / f"small.{ending}"
    arguments = ["resize", str(tmp_path / "deep.exr"), str(target), "--percent", "50"]
    assert program.main(arguments) == 0
    assert "'deep.exr' also has the channels 'Z', 'mask': not read" in capsys.readouterr().err
    levels = ["mipmaps", str(tmp_path / "deep.exr"), "-o", str(tmp_path / "levels.exr")]
    assert program.main(levels) == 0
    assert "the channels 'Z', 'mask'" in capsys.readouterr().err


def test_further_images_of_a_file_are_named(tmp_path, capsys):
    pages, small, smaller = (str(tmp_path / name) for name in ("pages.tif", "1.png", "2.png"))
    spec = oiio.ImageSpec(8, 8, 3, "uint8")
    output = oiio.ImageOutput.create(pages)
    for mode in ("Create", "AppendSubimage"):
        assert output.open(pages, spec, mode)
        assert output.write_image(np.full((8, 8, 3), 90, np.uint8))
    output.close()
    assert program.main(["resize", pages, small, "--percent", "50"]) == 0
    assert "'pages.tif' also has further images: not read" in capsys.readouterr().err
    assert program.main(["resize", small, smaller, "--percent", "50"]) == 0
    assert "also has" not in capsys.readouterr().err
