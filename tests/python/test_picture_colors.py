# SPDX-License-Identifier: GPL-3.0-or-later

"""The color spaces of picture files, through all commands that read and write pictures."""

import io
import os
import struct
import subprocess
import sys
import zlib

import numpy as np
import prefilter
import pytest
from command_files import fails, noise, run, write_picture

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
# Matrices to Rec. 709, as published by ACES and SMPTE.
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
"""A color inside sRGB's gamut and all others."""
OUTSIDE = (0.1, 0.9, 0.2)


def srgb_light(values):
    """Decodes sRGB to linear light, by its definition."""
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


ENDINGS = {"mipmaps": ("exr", "png", "tif", "tx")}
"""Extensions that a command can write, besides OpenEXR and PNG."""


@pytest.mark.parametrize(
    ("command", "ending"),
    [(name, one) for name in COMMANDS for one in ENDINGS.get(name, ("exr", "png"))],
)
@pytest.mark.parametrize("kind", KINDS)
def test_colors_are_those_of_the_input(tmp_path, kind, command, ending):
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


@pytest.mark.parametrize("kind", KINDS)
def test_colors_under_a_configuration_of_aces(tmp_path, kind):
    attributes, matrix = KINDS[kind]
    source = flat_exr(tmp_path / "in.exr", INSIDE, attributes)
    settings = {"OCIO": "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"}
    for ending in ("exr", "png"):
        target = tmp_path / f"out.{ending}"
        command = [
            sys.executable,
            "-m",
            "prefilter",
            "resize",
            source,
            "-o",
            target,
            "--percent",
            "50",
        ]
        subprocess.run(command, check=True, env=os.environ | settings)
        color, is_data = light_of(target)
        assert is_data == (kind == "raw")
        assert np.abs(color - matrix @ INSIDE).max() < 1 / 1024


def test_levels_for_engines(tmp_path):
    source = flat_exr(tmp_path / "in.exr", INSIDE, {"colorInteropID": "lin_ap1_scene"})
    assert run("mipmaps", source, "-o", tmp_path / "out.ktx2") == 0
    levels, *_ = prefilter.read_ktx2(tmp_path / "out.ktx2")
    assert np.abs(levels[0][0, 0, :3] - FROM_AP1 @ INSIDE).max() < 1 / 1024


def test_the_color_space_can_be_said(tmp_path, capsys):
    source = flat_exr(tmp_path / "in.exr", INSIDE, {"colorInteropID": "lin_p3d65_scene"})
    target = tmp_path / "out.exr"
    for name, matrix in (("ACEScg", FROM_AP1), ("lin_rec709_scene", np.eye(3)), ("raw", np.eye(3))):
        assert run("resize", source, "-o", target, "--percent", "50", "--colorspace", name) == 0
        color, is_data = light_of(target)
        assert is_data == (name == "raw")
        assert np.abs(color - matrix @ INSIDE).max() < 1 / 1024
    told = fails(
        capsys, 2, "resize", source, "-o", target, "--percent", "50", "--colorspace", "srbg"
    )
    assert "--colorspace: found 'srbg'; auto, sRGB" in told


def test_files_that_contradict_themselves(tmp_path, capsys):
    both = {"colorInteropID": "lin_rec709_scene", "chromaticities": AP1}
    source = flat_exr(tmp_path / "in.exr", INSIDE, both)
    told = fails(capsys, 1, "resize", source, "-o", tmp_path / "out.exr", "--percent", "50")
    assert "colorInteropID 'lin_rec709_scene' and its chromaticities are different" in told
    more = ("--percent", "50", "--colorspace", "ACEScg")
    assert run("resize", source, "-o", tmp_path / "out.exr", *more) == 0
    unknown = flat_exr(tmp_path / "b.exr", INSIDE, {"colorInteropID": "pq_rec2020_display"})
    told = fails(capsys, 1, "resize", unknown, "-o", tmp_path / "out.exr", "--percent", "50")
    assert "colorInteropID 'pq_rec2020_display': is not known; --colorspace" in told


GAMMA = struct.pack(">I", 45455)
P3_POINTS = struct.pack(">8I", 31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000)


@pytest.mark.parametrize(
    ("chunks", "light", "matrix"),
    [
        ([], srgb_light, np.eye(3)),
        ([(b"gAMA", GAMMA)], lambda values: values**2.2, np.eye(3)),
        ([(b"gAMA", struct.pack(">I", 100000))], lambda values: values, np.eye(3)),
        ([(b"cHRM", P3_POINTS), (b"gAMA", GAMMA)], lambda values: values**2.2, FROM_P3),
        ([(b"cICP", bytes([12, 13, 0, 1]))], srgb_light, FROM_P3),
        ([(b"sRGB", b"\0"), (b"gAMA", struct.pack(">I", 90000))], srgb_light, np.eye(3)),
    ],
)
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_colors_of_png_files(tmp_path, chunks, light, matrix, kind):
    most = np.iinfo(kind).max
    color = np.array([150, 120, 90]) / 255
    values = np.rint(color * most).astype(kind)
    source = png_file(tmp_path / "in.png", np.full((16, 16, 3), values), *chunks)
    expected = matrix @ light(values / most)
    assert run("resize", source, "-o", tmp_path / "out.exr", "--percent", "50") == 0
    assert np.abs(light_of(tmp_path / "out.exr")[0] - expected).max() < 1 / 1024
    assert run("mipmaps", source, "-o", tmp_path / "levels.png") == 0
    step = 0.51 / most * 2.4 + 1 / 4096
    assert np.abs(light_of(tmp_path / "levels.00.png")[0] - expected).max() < step
    # A PNG file keeps both the numbers and their color space.
    assert run("resize", source, "-o", tmp_path / "out.png", "--percent", "50") == 0
    made = chunks_of(tmp_path / "out.png")
    said = [one for one in chunks if one[0] != b"gAMA" or (b"sRGB", b"\0") not in chunks]
    assert all(made[name] == content for name, content in said)
    buffer = oiio.ImageBuf(str(tmp_path / "out.png"))
    assert (np.rint(buffer.get_pixels(oiio.FLOAT)[4, 4] * most) == values).all()


def icc_profile(matrix, curves, kind=b"RGB "):
    """Returns an ICC profile: colorants as columns of XYZ (D50), and tags of curves."""
    names = [b"rTRC", b"gTRC", b"bTRC"] if kind == b"RGB " else [b"kTRC"]
    tags = {b"desc": b"desc" + bytes(4) + struct.pack(">I", 5) + b"Test\0" + bytes(78)}
    tags[b"wtpt"] = b"XYZ " + bytes(4) + struct.pack(">3i", 63190, 65536, 54061)
    tags[b"cprt"] = b"text" + bytes(4) + b"none\0"
    for name, curve in zip(names, curves, strict=True):
        tags[name] = curve
    if matrix is not None:
        for name, column in zip((b"rXYZ", b"gXYZ", b"bXYZ"), np.array(matrix).T, strict=True):
            tags[name] = (
                b"XYZ " + bytes(4) + struct.pack(">3i", *np.rint(column * 65536).astype(int))
            )
    table, data, start = b"", b"", 132 + 12 * len(tags)
    for name, content in tags.items():
        table += struct.pack(">4sII", name, start + len(data), len(content))
        data += content + bytes(-len(content) % 4)
    size = start + len(data)
    head = struct.pack(
        ">I4sI4s4s4s12s4s", size, bytes(4), 0x02400000, b"mntr", kind, b"XYZ ", bytes(12), b"acsp"
    )
    head += bytes(28) + struct.pack(">3i", 63190, 65536, 54061)
    return head.ljust(128, b"\0") + struct.pack(">I", len(tags)) + table + data


ADOBE_RGB = [[0.60974, 0.20528, 0.14919], [0.31111, 0.62567, 0.06322], [0.01947, 0.06087, 0.74457]]
"""The matrix that Adobe publishes, for D50."""
POWER = b"curv" + bytes(4) + struct.pack(">IH", 1, 563)
SRGB_PARAMETERS = [
    round(one * 65536) for one in (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
]
SRGB_CURVE = b"para" + bytes(4) + struct.pack(">HH5i", 3, 0, *SRGB_PARAMETERS)
SAMPLES = np.rint((np.arange(64) / 63) ** 1.8 * 65535).astype(">u2")
TABLE = b"curv" + bytes(4) + struct.pack(">I", 64) + SAMPLES.tobytes()


def by_icc(pixels, profile):
    """Converts bytes to sRGB by another library."""
    cms = pytest.importorskip("PIL.ImageCms")
    image = pytest.importorskip("PIL.Image").fromarray(pixels)
    source = cms.ImageCmsProfile(io.BytesIO(profile))
    made = cms.profileToProfile(image, source, cms.createProfile("sRGB"), outputMode="RGB")
    return np.asarray(made)


def with_profile(path, pixels, profile):
    """Writes a picture file that embeds a profile."""
    if path.suffix == ".png":
        return png_file(path, pixels, (b"iCCP", b"it\0\0" + zlib.compress(profile)))
    image = pytest.importorskip("PIL.Image").fromarray(
        pixels[..., 0] if pixels.shape[2] == 1 else pixels
    )
    more = {"quality": 100, "subsampling": 0} if path.suffix == ".jpg" else {}
    image.save(path, icc_profile=profile, **more)
    return path


@pytest.mark.parametrize("curve", [POWER, SRGB_CURVE, TABLE], ids=["gamma", "parametric", "table"])
@pytest.mark.parametrize("ending", ["png", "jpg", "tif"])
def test_icc_profiles(tmp_path, ending, curve):
    profile = icc_profile(ADOBE_RGB, [curve] * 3)
    pixels = np.full((16, 16, 3), (130, 120, 90), np.uint8)
    source = with_profile(tmp_path / f"in.{ending}", pixels, profile)
    # OpenEXR files get other numbers for the same color; one step of 8 bits is lost on the way.
    assert run("resize", source, "-o", tmp_path / "out.exr", "--percent", "50") == 0
    made = light_of(tmp_path / "out.exr")[0]
    expected = by_icc(pixels, profile)[4, 4]
    assert np.abs(made - srgb_light(expected / 255.0)).max() < 1 / 200
    # PNG files keep the profile with the numbers.
    assert run("resize", source, "-o", tmp_path / "out.png", "--percent", "50") == 0
    kept = chunks_of(tmp_path / "out.png")
    assert zlib.decompress(kept[b"iCCP"].partition(b"\0\0")[2]) == profile
    assert b"sRGB" not in kept
    buffer = oiio.ImageBuf(str(tmp_path / "out.png"))
    read = oiio.ImageBuf(str(source)).get_pixels(oiio.FLOAT)[4, 4]
    assert np.abs(buffer.get_pixels(oiio.FLOAT)[4, 4] - read).max() * 255 < 0.01
    # Levels hold bytes of sRGB.
    assert run("mipmaps", source, "-o", tmp_path / "levels.png") == 0
    buffer = oiio.ImageBuf(str(tmp_path / "levels.00.png"))
    assert np.abs(buffer.get_pixels(oiio.FLOAT)[4, 4] * 255 - expected).max() < 1.6


def test_hidden_colors_stay(tmp_path):
    pixels = np.full((16, 16, 4), (150, 120, 90, 0), np.uint8)
    pixels[::2, :, 3] = 255
    # Display P3's green, where nothing shows it.
    pixels[1, :, :3] = (0, 255, 0)
    source = png_file(tmp_path / "in.png", pixels, (b"cICP", bytes([12, 13, 0, 1])))
    assert run("mipmaps", source, "-o", tmp_path / "out.png") == 0
    made = read_straight(tmp_path / "out.00.png")
    light = (FROM_P3 @ srgb_light(np.array([150, 120, 90]) / 255)).clip(0, 1)
    assert np.abs(srgb_light(made[3, 4, :3]) - light).max() < 1 / 200
    assert (made[..., 3] * 255 == pixels[..., 3]).all()


def read_straight(path):
    """Returns the values of a file as they are stored, with straight alpha."""
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    return oiio.ImageBuf(str(path), 0, 0, config).get_pixels(oiio.FLOAT)


def test_gray_with_alpha_and_a_profile(tmp_path):
    profile = icc_profile(None, [POWER], b"GRAY")
    pixels = np.full((16, 16, 2), (100, 128), np.uint8)
    source = with_profile(tmp_path / "in.png", pixels, profile)
    assert run("resample", source, tmp_path / "out.png", "--scale", "0.5") == 0
    made = read_straight(tmp_path / "out.png")
    assert made.shape[2] == 2
    assert np.abs(made[4, 4] * 255 - (100, 128)).max() < 0.01
    assert b"iCCP" in chunks_of(tmp_path / "out.png")


def test_light_is_averaged_in_the_curve_of_a_profile(tmp_path):
    profile = icc_profile(ADOBE_RGB, [POWER] * 3)
    pixels = np.zeros((16, 16, 3), np.uint8)
    pixels[:, ::2] = 255
    source = with_profile(tmp_path / "in.png", pixels, profile)
    more = ("--width", "8", "--height", "16", "--filter", "box")
    assert run("resize", source, "-o", tmp_path / "out.png", *more) == 0
    made = oiio.ImageBuf(str(tmp_path / "out.png")).get_pixels(oiio.FLOAT)
    assert np.abs(made[8, 4] - 0.5 ** (256 / 563)).max() < 0.51 / 255


def test_gray_profiles(tmp_path):
    profile = icc_profile(None, [POWER], b"GRAY")
    pixels = np.full((16, 16, 1), 100, np.uint8)
    source = with_profile(tmp_path / "in.png", pixels, profile)
    assert run("resize", source, "-o", tmp_path / "out.png", "--percent", "50") == 0
    kept = chunks_of(tmp_path / "out.png")
    assert kept[b"IHDR"][8:10] == bytes([8, 0])
    assert zlib.decompress(kept[b"iCCP"].partition(b"\0\0")[2]) == profile
    assert run("resize", source, "-o", tmp_path / "out.exr", "--percent", "50") == 0
    buffer = oiio.ImageBuf(str(tmp_path / "out.exr"))
    assert buffer.spec().channelnames == ("Y",)
    expected = (100 / 255) ** (563 / 256)
    assert abs(buffer.get_pixels(oiio.FLOAT)[4, 4, 0] - expected) < 1 / 1024


def test_a_profile_of_srgb_is_srgb(tmp_path):
    srgb = [[0.43607, 0.38515, 0.14307], [0.22249, 0.71687, 0.06061], [0.01392, 0.09708, 0.71410]]
    profile = icc_profile(srgb, [SRGB_CURVE] * 3)
    source = with_profile(tmp_path / "in.png", noise(16, 16), profile)
    plain = png_file(tmp_path / "plain.png", noise(16, 16))
    for name in (source, plain):
        assert run("resize", name, "-o", tmp_path / f"{name.stem}-out.png", "--percent", "50") == 0
    made, expected = ((tmp_path / f"{one}-out.png").read_bytes() for one in ("in", "plain"))
    assert made == expected


def test_profiles_that_cannot_be_converted(tmp_path, capsys):
    plain = icc_profile(ADOBE_RGB, [POWER] * 3)
    tables = plain.replace(b"cprt", b"A2B0")
    falling = icc_profile(ADOBE_RGB, [b"curv" + bytes(4) + struct.pack(">I2H", 2, 9, 3)] * 3)
    cases = {
        "tables": (tables, "the ICC profile 'Test', which has tables and not only a matrix"),
        "falling": (falling, "an ICC profile whose curve falls"),
        "cut off": (plain[:300], "an ICC profile that is cut off"),
        "gray": (icc_profile(None, [POWER], b"GRAY"), "its ICC profile is for gray values"),
        "cmyk": (plain.replace(b"RGB XYZ ", b"CMYKXYZ "), "which is for CMYK values"),
    }
    for profile, words in cases.values():
        source = with_profile(tmp_path / "in.png", noise(16, 16), profile)
        told = fails(capsys, 1, "resize", source, "-o", tmp_path / "out.png", "--percent", "50")
        assert words in told
        assert "--colorspace" in told
        assert not (tmp_path / "out.png").exists()
    more = ("--percent", "50", "--colorspace", "sRGB")
    assert run("resize", source, "-o", tmp_path / "out.png", *more) == 0
    assert b"iCCP" not in chunks_of(tmp_path / "out.png")


@pytest.mark.parametrize("ending", ["ppm", "tga", "bmp", "dpx", "sgi", "hdr", "pfm", "tif", "webp"])
def test_files_that_say_nothing(tmp_path, ending):
    is_float = ending in {"hdr", "pfm"}
    source = write_picture(
        tmp_path / f"in.{ending}",
        np.full((16, 16, 3), (150, 120, 90), np.uint8).astype(np.float32 if is_float else np.uint8),
    )
    assert run("resize", source, tmp_path / "out.exr", "--percent", "50") == 0
    stored = np.array([150, 120, 90]) / (1 if is_float else 255)
    made = light_of(tmp_path / "out.exr")[0]
    assert np.abs(made / (stored if is_float else srgb_light(stored)) - 1).max() < 0.03


def test_cmyk_is_refused(tmp_path, capsys):
    image = pytest.importorskip("PIL.Image").fromarray(noise(16, 16))
    for name in ("in.jpg", "in.tif"):
        image.convert("CMYK").save(tmp_path / name)
        told = fails(
            capsys, 1, "resize", tmp_path / name, "-o", tmp_path / "out.png", "--percent", "50"
        )
        assert "its colors are CMYK, which cannot be converted" in told


def test_adobe_rgb_by_exif(tmp_path):
    image = pytest.importorskip("PIL.Image")
    pixels = np.full((16, 16, 3), (130, 120, 90), np.uint8)
    block = image.Exif()
    block.get_ifd(0x8769)[0xA001] = 0xFFFF
    block.get_ifd(0x8769)[0xA005] = {1: "R03"}
    image.fromarray(pixels).save(tmp_path / "in.jpg", exif=block, quality=100, subsampling=0)
    assert run("resize", tmp_path / "in.jpg", "-o", tmp_path / "out.exr", "--percent", "50") == 0
    read = oiio.ImageBuf(str(tmp_path / "in.jpg")).get_pixels(oiio.FLOAT)[4, 4]
    to_rec709 = np.array([[1.39836, -0.39836, 0.0], [0.0, 1.0, 0.0], [0.0, -0.04293, 1.04293]])
    expected = to_rec709 @ (read**2.2)
    assert np.abs(light_of(tmp_path / "out.exr")[0] - expected).max() < 1 / 512
