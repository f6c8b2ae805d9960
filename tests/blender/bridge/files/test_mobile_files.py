# SPDX-License-Identifier: GPL-3.0-or-later

"""Formats of mobile devices and supercompression in KTX 2; the package's tests decode them."""

import os
import struct

import numpy as np
import pytest
import scenes
from texture_readers import read_ktx2

COLORS = {
    "etc2-rgb": "ETC2_R8G8B8_SRGB",
    "etc2-rgba": "ETC2_R8G8B8A8_SRGB",
    "astc-4x4": "ASTC_4x4_SRGB",
    "astc-6x6": "ASTC_6x6_SRGB",
    "astc-8x8": "ASTC_8x8_SRGB",
    "uastc": "UASTC_SRGB",
}
DATA = {"eac-r11": "EAC_R11_UNORM", "eac-rg11": "EAC_R11G11_UNORM", "astc-4x4": "ASTC_4x4_UNORM"}


@pytest.fixture
def bake(bake, tmp_path):
    """Returns a function that bakes a box over no surface, and gives the outcome."""

    def run(image, name, **settings):
        options = {"filter": "box", "use_images": False, "filepath": str(tmp_path / name)}
        return bake(image, **(options | settings))

    return run


@pytest.mark.parametrize("texture_format", COLORS)
def test_colors(bake, tmp_path, texture_format):
    image = scenes.image("Paint", scenes.noise(10, 14))
    size = (16, 12) if texture_format == "uastc" else (14, 10)
    outcome = bake(image, "out.ktx2", texture_format=texture_format)
    assert outcome.warnings == []
    file = read_ktx2(tmp_path / "out.ktx2")
    size = (16, 12) if texture_format == "uastc" else (14, 10)
    assert (file.format, file.width, file.height) == (COLORS[texture_format], *size)
    assert len(file.level_data) == max(size).bit_length()


@pytest.mark.parametrize("texture_format", DATA)
def test_data(bake, tmp_path, texture_format):
    image = scenes.image("Mask", scenes.noise(8, 8), colorspace="Non-Color")
    outcome = bake(image, "out.ktx2", texture_format=texture_format)
    if texture_format.startswith("eac"):
        assert "only" in outcome.warnings[0]
    assert read_ktx2(tmp_path / "out.ktx2").format == DATA[texture_format]


@pytest.mark.parametrize("texture_format", ["astc-4x4-hdr", "astc-6x6-hdr"])
def test_values_of_high_dynamic_range(bake, tmp_path, texture_format):
    label = texture_format.upper().replace("-", " ").replace("X", "x")
    values = scenes.noise(8, 8) * 20
    image = scenes.image("Light", values, is_float=True)
    assert bake(image, "out.ktx2", texture_format=texture_format).warnings == []
    assert read_ktx2(tmp_path / "out.ktx2").format.endswith("SFLOAT")
    dark = scenes.image("Dark", values - 10, is_float=True)
    (told,) = bake(dark, "out.ktx2", texture_format=texture_format).warnings
    assert told == f"Texture Format: {label} clips values of 'Dark' below 0"
    (told,) = bake(
        scenes.image("Paint", scenes.noise(8, 8)), "out.ktx2", texture_format=texture_format
    ).warnings
    assert told == f"Texture Format: {label} is for float images; ASTC is closer to 'Paint'"


def test_alpha_dropped_by_etc2_is_reported(bake):
    image = scenes.image("Paint", scenes.noise(8, 8, alpha=True))
    outcome = bake(image, "out.ktx2", texture_format="etc2-rgb")
    assert outcome.warnings == ["Texture Format: ETC2 RGB drops the fourth channel of 'Paint'"]


@pytest.mark.parametrize("texture_format", ["eac-r11", "eac-rg11"])
def test_colors_in_eac_are_refused(bake, tmp_path, texture_format):
    image = scenes.image("Paint", scenes.noise(8, 8))
    with pytest.raises(ValueError, match=r"EAC RG?11 has no sRGB variant.*'Paint'.*Non-Color"):
        bake(image, "out.ktx2", texture_format=texture_format)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("texture_format", "label"),
    [("astc-6x6", "ASTC 6x6"), ("etc2-rgba", "ETC2 RGBA"), ("uastc", "UASTC")],
)
def test_dds_files_are_refused(bake, tmp_path, texture_format, label):
    image = scenes.image("Paint", scenes.noise(8, 8))
    with pytest.raises(ValueError, match=rf"{label} needs a \.ktx2 file; found 'out\.dds'"):
        bake(image, "out.dds", texture_format=texture_format)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["out.ktx2", "out.dds"])
def test_effort(bake, tmp_path, name):
    image = scenes.image("Paint", scenes.noise(128, 128))
    files = []
    for effort in ("fast", "normal", "best"):
        bake(image, name, texture_format="bc7", effort=effort)
        files.append((tmp_path / name).read_bytes())
    assert len(set(files)) == 3
    assert len(set(map(len, files))) == 1


def test_supercompression(bake, tmp_path):
    image = scenes.image("Paint", np.full((64, 64, 4), 0.5, np.float32))
    sizes = []
    for supercompression in ("none", "zstd"):
        name = f"{supercompression}.ktx2"
        bake(image, name, texture_format="rgba8", supercompression=supercompression)
        data = (tmp_path / name).read_bytes()
        (scheme,) = struct.unpack_from("<I", data, 44)
        assert scheme == {"none": 0, "zstd": 2}[supercompression]
        sizes.append(len(data))
    assert sizes[1] < 0.1 * sizes[0]
    # DDS knows none.
    bake(image, "out.dds", supercompression="zstd")
    assert (tmp_path / "out.dds").stat().st_size > sizes[1]


@pytest.mark.parametrize(
    ("texture_format", "channel", "expected"),
    [
        ("eac-rg11", "all", "EAC_R11_UNORM"),
        ("eac-rg11", "green", "ETC2_R8G8B8_UNORM"),
        ("astc-6x6", "green", "ASTC_6x6_UNORM"),
    ],
)
def test_roughness_beside_a_normal_map(bake, tmp_path, texture_format, channel, expected):
    normals = np.full((8, 8, 4), (0.5, 0.5, 1, 1), np.float32)
    rough = scenes.image("Rough", np.full((8, 8, 4), 0.5, np.float32), colorspace="Non-Color")
    bake(
        scenes.image("Normals", normals, colorspace="Non-Color"),
        "out.ktx2",
        content="normal",
        roughness=rough.name,
        roughness_channel=channel,
        roughness_filepath=str(tmp_path / "rough.ktx2"),
        texture_format=texture_format,
    )
    found = read_ktx2(tmp_path / "rough.ktx2").format
    assert found in {expected, expected.replace("R8G8B8", "R8G8B8A8")}
