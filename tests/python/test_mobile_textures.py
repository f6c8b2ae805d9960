# SPDX-License-Identifier: GPL-3.0-or-later

"""Formats of mobile devices and zstd in KTX 2, decoded by independent programs.

scripts/decoders.txt lists those: texture2ddecoder, opengl-basisu (Basis Universal's transcoder) and
zstandard.
"""

import itertools
import shutil
import subprocess
from pathlib import Path

import numpy as np
import prefilter
import pytest
from texture_readers import FORMATS, File, read_ktx2

pytestmark = pytest.mark.once
decoders = pytest.importorskip("texture2ddecoder", reason="scripts/decoders.txt is not installed")
basisu = pytest.importorskip("opengl_basisu", reason="scripts/decoders.txt is not installed")
zstandard = pytest.importorskip("zstandard", reason="scripts/decoders.txt is not installed")

NAMES = {
    "etc2-rgb": ("ETC2_R8G8B8_UNORM", "ETC2_R8G8B8_SRGB"),
    "etc2-rgba": ("ETC2_R8G8B8A8_UNORM", "ETC2_R8G8B8A8_SRGB"),
    "eac-r11": ("EAC_R11_UNORM", None),
    "eac-rg11": ("EAC_R11G11_UNORM", None),
    "astc-4x4": ("ASTC_4x4_UNORM", "ASTC_4x4_SRGB"),
    "astc-6x6": ("ASTC_6x6_UNORM", "ASTC_6x6_SRGB"),
    "astc-8x8": ("ASTC_8x8_UNORM", "ASTC_8x8_SRGB"),
    "astc-4x4-hdr": ("ASTC_4x4_SFLOAT", None),
    "astc-6x6-hdr": ("ASTC_6x6_SFLOAT", None),
    "uastc": ("UASTC_UNORM", "UASTC_SRGB"),
}
CHANNELS = {name: FORMATS[pair[0]][2] for name, pair in NAMES.items()}
ENCODED = [(name, srgb) for name, pair in NAMES.items() for srgb in (False, True) if pair[srgb]]
SIZES = [(1, 1), (5, 7), (13, 37), (64, 2), (48, 24)]
SAMPLES = {
    "etc2-rgb": [((0, 64), 2)],
    "etc2-rgba": [((0, 64), 15), ((64, 64), 2)],
    "eac-r11": [((0, 64), 0)],
    "eac-rg11": [((0, 64), 0), ((64, 64), 1)],
    "uastc": [((0, 128), 3)],
}


def waves(height: int, width: int, channels: int = 4) -> list:
    """Levels in bytes that resemble a photograph: light and shadow, two colors, and an edge."""
    levels = []
    strengths = np.array([80, 60, 45, 25])[:channels]
    while True:
        y, x = np.meshgrid(np.arange(height), np.arange(width), indexing="ij")
        light = np.sin(x / 7 + y / 11) + 0.7 * (x > 2 * y)
        tint = 12 * np.stack([np.sin(y / 9 + c) for c in range(channels)], axis=2)
        levels.append(np.rint(100 + strengths * light[..., None] + tint).astype(np.uint8))
        if height == width == 1:
            return levels
        height, width = max(1, height // 2), max(1, width // 2)


def as_given(levels: list, format: str) -> list:
    """Levels in the type that suits the format: floats for formats of floats."""
    return [level / np.float32(255) for level in levels] if format.endswith("hdr") else levels


def written(path: Path, levels: list, format: str, **options) -> File:
    prefilter.write_ktx2(path, as_given(levels, format), format=format, **options)
    return read_ktx2(path)


def decoded(path: Path, file: File, format: str, number: int = 0) -> np.ndarray:
    """A level in bytes, the bottom row first, as an independent decoder reads it."""
    width, height = max(1, file.width >> number), max(1, file.height >> number)
    data = file.level_data[number]
    if format == "uastc":
        texels = basisu.open(path).transcode("rgba8", level=number).data
        texels = texels.reshape(height, width, 4)
    else:
        if format.startswith("astc"):
            texels = decoders.decode_astc(data, width, height, int(format[5]), int(format[7]))
        else:
            decode = {
                "etc2-rgb": decoders.decode_etc2,
                "etc2-rgba": decoders.decode_etc2a8,
                "eac-r11": decoders.decode_eacr,
                "eac-rg11": decoders.decode_eacrg,
            }[format]
            texels = decode(data, width, height)
        texels = np.frombuffer(texels, np.uint8).reshape(height, width, 4)[..., [2, 1, 0, 3]]
    return texels[::-1, :, : CHANNELS[format]].astype(float)


def signal_to_noise(found: np.ndarray, wanted: np.ndarray) -> float:
    """Peak signal-to-noise ratio in decibels; both images in bytes."""
    error = np.mean((found - wanted.astype(float)) ** 2)
    return 10 * np.log10(255**2 / max(error, 1e-3))


@pytest.mark.parametrize(("format", "srgb"), ENCODED)
@pytest.mark.parametrize(
    ("size", "supercompression"), [*((size, "none") for size in SIZES), (SIZES[1], "zstd")]
)
def test_files_are_described(tmp_path, format, srgb, size, supercompression):
    # Reading checks sizes, alignment and order of the levels, and the descriptor.
    options = {"encoding": "srgb" if srgb else "linear", "supercompression": supercompression}
    file = written(tmp_path / "file.ktx2", waves(*size), format, **options)
    assert file.format == NAMES[format][srgb]
    assert (file.height, file.width) == size
    found = [(sample["bits"], sample["channel"]) for sample in file.samples]
    assert found == SAMPLES.get(format, [((0, 128), 0)])
    for sample in file.samples:
        if format.endswith("hdr"):
            assert sample["qualifiers"] == 0xC0
            assert sample["range"] == (0xBF800000, 0x3F800000)  # -1 and 1
        else:
            is_linear = srgb and sample["channel"] == 15
            assert sample["qualifiers"] == (0x10 if is_linear else 0)
            assert sample["range"] == (0, 0xFFFFFFFF)


# In decibels, at every level of any size: 2 less than the worst of these. A level that is upside
# down or whose channels are swapped is below 20.
LEAST = {
    "etc2-rgb": 28,
    "etc2-rgba": 29,
    "eac-r11": 36,
    "eac-rg11": 37,
    "astc-4x4": 42,
    "astc-6x6": 33,
    "astc-8x8": 28,
    "astc-4x4-hdr": 34,
    "astc-6x6-hdr": 28,
    "uastc": 41,
}


@pytest.mark.parametrize(("format", "srgb"), ENCODED)
@pytest.mark.parametrize("size", SIZES)
def test_others_decode_what_was_written(tmp_path, format, srgb, size):
    path = tmp_path / "file.ktx2"
    levels = waves(*size)
    file = written(path, levels, format, encoding="srgb" if srgb else "linear")
    for number, level in enumerate(levels):
        found = decoded(path, file, format, number)
        assert signal_to_noise(found, level[..., : CHANNELS[format]]) >= LEAST[format]


@pytest.mark.parametrize(("format", "srgb"), [one for one in ENCODED if "hdr" not in one[0]])
@pytest.mark.parametrize("size", SIZES)
def test_files_are_read_as_others_decode_them(tmp_path, format, srgb, size):
    path = tmp_path / "file.ktx2"
    file = written(path, waves(*size), format, encoding="srgb" if srgb else "linear")
    found, _ = prefilter.read_ktx2(path)
    # EAC has 11 bits, and ASTC 16, which some round and some cut; of sRGB colors others.
    tolerance = 1 if format.startswith(("eac", "astc")) else 0
    for number, level in enumerate(found):
        assert np.abs(level - decoded(path, file, format, number)).max() <= tolerance


@pytest.mark.parametrize("format", NAMES)
@pytest.mark.parametrize("alpha", [0, 1, 128, 255])
def test_flat_levels_stay_flat(tmp_path, format, alpha):
    values = np.array([37, 200, 90, alpha], np.uint8)
    levels = [np.broadcast_to(values, level.shape) for level in waves(11, 7)]
    path = tmp_path / "file.ktx2"
    file = written(path, levels, format)
    for number in range(len(levels)):
        found = decoded(path, file, format, number)
        assert np.ptp(found, axis=(0, 1)).max() == 0
        near = 2 if format.startswith("etc2") else 1
        assert np.abs(found[0, 0] - values[: CHANNELS[format]]).max() <= near
        if CHANNELS[format] == 4 and alpha in (0, 255):
            assert found[0, 0, 3] == alpha


@pytest.mark.parametrize("format", [name for name in NAMES if CHANNELS[name] == 4])
@pytest.mark.parametrize("size", [(5, 7), (24, 26)])
def test_cut_outs_keep_their_alpha(tmp_path, format, size):
    path = tmp_path / "file.ktx2"
    (level, *_) = waves(*size)
    level[..., 3] = np.where(np.arange(size[1]) > 2.5 * np.arange(size[0])[:, None], 255, 0)
    file = written(path, [level], format, encoding="linear")
    found = decoded(path, file, format)[..., 3]
    assert np.mean((found < 128) != (level[..., 3] < 128)) <= 0.02


@pytest.mark.parametrize("format", ["astc-4x4", "astc-6x6", "astc-8x8"])
def test_hidden_colors_count_little(tmp_path, format):
    path = tmp_path / "file.ktx2"
    random = np.random.default_rng(4)
    level = random.integers(0, 256, (48, 48, 4), np.uint8)
    shown = np.kron(random.integers(0, 2, (6, 6)), np.ones((8, 8))).astype(bool)
    level[..., 3] = np.where(shown, 255, 3)
    errors = {}
    for alpha in ("straight", "premultiplied"):
        file = written(path, [level], format, alpha=alpha)
        found = decoded(path, file, format)
        errors[alpha] = np.mean((found - level)[shown][:, :3] ** 2)
    # Blocks of ASTC weigh by the largest alpha that they have.
    assert errors["straight"] <= errors["premultiplied"]


def test_finer_formats_leave_less_error(tmp_path):
    path = tmp_path / "file.ktx2"
    random = np.random.default_rng(5)
    (level, *_) = waves(96, 96, 3)
    level = np.clip(level + random.normal(0, 2, level.shape), 0, 255).astype(np.uint8)
    found = {}
    for format in NAMES:
        if CHANNELS[format] >= 3:
            file = written(path, [level], format, encoding="linear")
            found[format] = signal_to_noise(decoded(path, file, format)[..., :3], level)
    assert found["astc-4x4"] > found["astc-6x6"] + 1 > found["astc-8x8"] + 2
    assert found["astc-4x4"] > found["etc2-rgb"] + 5
    assert found["uastc"] > found["etc2-rgb"] + 5
    assert found["astc-4x4-hdr"] > found["astc-6x6-hdr"]
    assert abs(found["etc2-rgba"] - found["etc2-rgb"]) < 1


@pytest.mark.parametrize("format", [*NAMES, "rgba8", "bc1", "rgba16f"])
def test_zstd_keeps_every_byte(tmp_path, format):
    levels = waves(100, 60)
    plain = written(tmp_path / "plain.ktx2", levels, format)
    packed = written(tmp_path / "packed.ktx2", levels, format, supercompression="zstd")
    assert packed.level_data == plain.level_data
    sizes = [(tmp_path / name).stat().st_size for name in ("packed.ktx2", "plain.ktx2")]
    assert sizes[0] < sizes[1]


def test_zstd_is_undone_by_the_loader_of_basis_universal(tmp_path):
    path = tmp_path / "file.ktx2"
    levels = waves(37, 50)
    texels = {}
    for supercompression in ("none", "zstd"):
        prefilter.write_ktx2(path, levels, format="uastc", supercompression=supercompression)
        texture = basisu.open(path)
        images = [texture.transcode("rgba8", level=number).data for number in range(len(levels))]
        texels[supercompression] = np.concatenate([image.reshape(-1) for image in images])
    np.testing.assert_array_equal(texels["none"], texels["zstd"])


@pytest.mark.parametrize(("channels", "srgb"), itertools.product((3, 4), (False, True)))
def test_uastc_says_whether_it_has_alpha(tmp_path, channels, srgb):
    path = tmp_path / "file.ktx2"
    file = written(path, waves(9, 9, channels), "uastc", encoding="srgb" if srgb else "linear")
    assert [sample["channel"] for sample in file.samples] == [0 if channels == 3 else 3]
    texture = basisu.open(path)
    assert (texture.has_alpha, texture.srgb) == (channels == 4, srgb)


@pytest.mark.parametrize("format", NAMES)
def test_file_is_the_same_for_any_thread_count(tmp_path, format):
    levels = as_given(waves(61, 87), format)
    contents = set()
    for threads in (1, 2, 5):
        path = tmp_path / f"{threads}.ktx2"
        prefilter.write_ktx2(path, levels, format=format, supercompression="zstd", threads=threads)
        contents.add(path.read_bytes())
    assert len(contents) == 1


@pytest.mark.parametrize("format", NAMES)
def test_blocks_do_not_depend_on_others(tmp_path, format):
    path = tmp_path / "file.ktx2"
    (level, *_) = waves(96, 600)
    whole = written(path, [level], format).level_data[0]
    # More than 64 x 64 texels, which get the effort of the whole.
    part = written(path, [level[24:, 480:576]], format).level_data[0]
    side = int(format[5]) if format.startswith("astc") else 4
    unit = len(whole) // (96 // side * 600 // side)
    # Files store the top row first, but rows are counted from the bottom.
    rows = np.frombuffer(whole, np.uint8).reshape(96 // side, 600 // side, unit)
    wanted = rows[: 72 // side, 480 // side : 576 // side]
    np.testing.assert_array_equal(
        np.frombuffer(part, np.uint8).reshape(72 // side, 96 // side, unit), wanted
    )


@pytest.mark.parametrize("format", ["astc-4x4-hdr", "astc-6x6-hdr"])
def test_values_that_hdr_cannot_hold_are_cut(tmp_path, format):
    path = tmp_path / "file.ktx2"
    level = np.zeros((12, 12, 4), np.float32)
    level[..., :3] = [-5, 0.25, 300]
    level[..., 3] = 7
    prefilter.write_ktx2(path, [level], format=format)
    found = decoded(path, read_ktx2(path), format)
    # The decoder clips to bytes.
    assert np.abs(found - [0, 63.75, 255, 255]).max() <= 1


GOOD = waves(8, 8)


@pytest.mark.parametrize("format", NAMES)
def test_dds_files_have_no_formats_of_mobile_devices(tmp_path, format):
    with pytest.raises(ValueError, match=f"format: DDS files have no '{format}'"):
        prefilter.write_dds(tmp_path / "file.dds", GOOD, format=format)


@pytest.mark.parametrize("format", ["eac-r11", "eac-rg11"])
def test_eac_has_no_srgb_form(tmp_path, format):
    with pytest.raises(ValueError, match=f"'srgb' with the format '{format}'"):
        prefilter.write_ktx2(tmp_path / "file.ktx2", GOOD, format=format, encoding="srgb")


@pytest.mark.parametrize(
    ("levels", "options", "words"),
    [
        (GOOD, {"supercompression": "zlib"}, "supercompression: 'zlib' is not one of none, zstd"),
        (GOOD, {"supercompression": None}, "supercompression: None is not one of none, zstd"),
        ([GOOD[0][..., :1]], {"format": "eac-rg11"}, "format: 'eac-rg11' needs 2 channels"),
        (
            [np.full((4, 4, 3), 7e4, np.float32)],
            {"format": "astc-6x6-hdr"},
            "hold 70000.*of format 'astc-6x6-hdr'",
        ),
        ([np.full((4, 4, 3), np.nan)], {"format": "uastc"}, "level 0: the texel in row 0, .* nan"),
    ],
)
def test_refusals(tmp_path, levels, options, words):
    with pytest.raises(ValueError, match=words):
        prefilter.write_ktx2(tmp_path / "file.ktx2", levels, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("format", ["astc-8x8", "uastc", "rgba8"])
def test_canceling_writes_nothing(tmp_path, format):
    fractions: list[float] = []

    def stop(fraction: float) -> bool:
        fractions.append(fraction)
        return fraction < 0.6

    levels = waves(512, 512)
    options = {"format": format, "supercompression": "zstd"}
    with pytest.raises(prefilter.Cancelled):
        prefilter.write_ktx2(tmp_path / "file.ktx2", levels, progress=stop, **options)
    assert not list(tmp_path.iterdir())
    assert fractions == sorted(fractions)
    assert fractions[-1] < 0.9


@pytest.mark.skipif(shutil.which("ktx") is None, reason="Khronos' ktx is not installed")
@pytest.mark.parametrize("supercompression", ["none", "zstd"])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_khronos_accepts_what_gltf_files_hold(tmp_path, channels, encoding, supercompression):
    levels = [np.full((side, side, channels), 90, np.uint8) for side in (8, 4, 2, 1)]
    path = tmp_path / "texture.ktx2"
    prefilter.write_ktx2(
        path, levels, format="uastc", encoding=encoding, supercompression=supercompression
    )
    command = ["ktx", "validate", "--gltf-basisu", "--warnings-as-errors", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
