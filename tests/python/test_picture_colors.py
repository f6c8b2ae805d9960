# SPDX-License-Identifier: GPL-3.0-or-later

"""The color spaces of picture files, through all commands that read and write pictures."""

import struct
import zlib

import numpy as np
import pytest
from command_files import fails, run

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
# As ACES and SMPTE publish them, to Rec. 709.
FROM_AP1 = np.array(
    [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]]
)
FROM_P3 = np.array(
    [[1.22494, -0.22494, 0.0], [-0.04206, 1.04206, 0.0], [-0.01964, -0.07864, 1.09828]]
)
KINDS = {
    "none": ({}, np.eye(3)),
    "rec709": ({"colorInteropID": "lin_rec709_scene"}, np.eye(3)),
    "ap1": ({"colorInteropID": "lin_ap1_scene"}, FROM_AP1),
    "ap1 by chromaticities": ({"chromaticities": AP1}, FROM_AP1),
    "p3": ({"colorInteropID": "lin_p3d65_scene"}, FROM_P3),
    "raw": ({"colorInteropID": "data"}, np.eye(3)),
}
COMMANDS = {
    "resize": ("resize", "{source}", "{target}", "--percent", "50"),
    "resample": ("resample", "{source}", "{target}", "--scale", "0.5", "--wrap", "clamp"),
    "mipmaps": ("mipmaps", "{source}", "-o", "{target}"),
}
INSIDE = (0.5, 0.4, 0.25)
"""A color that all spaces have within those of sRGB."""
OUTSIDE = (0.1, 0.9, 0.2)


def srgb_light(values):
    """Returns light of sRGB, by its definition."""
    values = np.asarray(values, np.float64)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def flat_exr(path, color, attributes, size=16):
    """Writes an OpenEXR file of one color."""
    spec = oiio.ImageSpec(size, size, 3, "float")
    for name, value in attributes.items():
        if isinstance(value, tuple):
            spec.attribute(name, oiio.TypeDesc("float[8]"), value)
        else:
            spec.attribute(name, value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    output.write_image(np.full((size, size, 3), color, np.float32))
    output.close()
    return path


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_file(path, pixels, *chunks):
    """Writes a PNG file of bytes or of 16 bits, rows from the top, with more chunks."""
    height, width, channels = pixels.shape
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8 * pixels.itemsize, kind, 0, 0, 0)
    values = pixels.astype(pixels.dtype.newbyteorder(">"))
    rows = b"".join(b"\0" + row.tobytes() for row in values)
    parts = [chunk(b"IHDR", header), *(chunk(*one) for one in chunks)]
    parts += [chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    return path


def chunks_of(path):
    """Returns the chunks of a PNG file, by their kinds."""
    data, at, found = path.read_bytes(), 8, {}
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        found[kind] = data[at + 8 : at + 8 + size]
        at += 12 + size
    return found


def light_of(path):
    """Returns the color in the middle of a file as light in Rec. 709, and whether it is data."""
    buffer = oiio.ImageBuf(str(path))
    spec = buffer.spec()
    pixels = buffer.get_pixels(oiio.FLOAT)
    color = pixels[pixels.shape[0] // 2, pixels.shape[1] // 2, :3]
    if path.suffix in {".exr"}:
        name = spec.getattribute("colorInteropID")
        assert name in {"lin_rec709_scene", "data"}
        if name == "lin_rec709_scene":
            assert np.allclose(spec.getattribute("chromaticities"), REC709, atol=1e-6)
            if oiio.VERSION >= 30100:
                same = oiio.ImageBufAlgo.colorconvert(buffer, "", "lin_rec709_scene")
                assert np.allclose(same.get_pixels(oiio.FLOAT), pixels, atol=1e-5)
        return color, name == "data"
    if path.suffix == ".png":
        chunks = chunks_of(path)
        assert not {b"iCCP", b"cICP", b"gAMA"} & set(chunks)
        return (srgb_light(color), False) if b"sRGB" in chunks else (color, True)
    return color, False


@pytest.mark.parametrize("ending", ["exr", "png", "tif", "tx"])
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", KINDS)
def test_colors_are_those_of_the_input(tmp_path, kind, command, ending):
    if ending in {"tif", "tx"} and command != "mipmaps":
        pytest.skip("no such files")
    attributes, matrix = KINDS[kind]
    source = flat_exr(tmp_path / "in.exr", INSIDE, attributes)
    target = tmp_path / f"out.{ending}"
    arguments = [one.format(source=source, target=target) for one in COMMANDS[command]]
    assert run(*arguments) == 0
    if command == "mipmaps" and ending == "png":
        target = tmp_path / "out.00.png"
    color, is_data = light_of(target)
    if ending in {"exr", "png"}:
        assert is_data == (kind == "raw")
    assert np.abs(color - matrix @ INSIDE).max() < 1 / 1024


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", ["ap1", "p3"])
def test_colors_outside_of_srgb(tmp_path, capsys, kind, command):
    attributes, matrix = KINDS[kind]
    source = flat_exr(tmp_path / "in.exr", OUTSIDE, attributes)
    for ending in ("exr", "png"):
        target = tmp_path / f"out.{ending}"
        arguments = [one.format(source=source, target=target) for one in COMMANDS[command]]
        if ending == "exr":
            assert run(*arguments) == 0
            assert np.abs(light_of(target)[0] - matrix @ OUTSIDE).max() < 1 / 1024
            continue
        told = fails(capsys, 1, *arguments)
        assert "100 % of the pixels of 'in.exr' have colors outside of sRGB" in told
        assert run(*arguments, "--clip") == 0
        written = tmp_path / ("out.00.png" if command == "mipmaps" else "out.png")
        clipped = (matrix @ OUTSIDE).clip(0, 1)
        assert np.abs(light_of(written)[0] - clipped).max() < 1 / 1024
