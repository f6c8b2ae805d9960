# SPDX-License-Identifier: GPL-3.0-or-later

"""DDS and KTX 2 files, read back by readers of their own and by other programs."""

import itertools
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import prefilter
import pytest
from prefilter.options.textures import TEXTURE_FORMATS
from prefilter.textures.ktx2_metadata import read_metadata
from texture_readers import FORMATS, read_dds, read_ktx2

WRITERS = {"dds": (prefilter.write_dds, read_dds), "ktx2": (prefilter.write_ktx2, read_ktx2)}
SIZES = [(1, 1), (1, 7), (5, 1), (4, 4), (12, 20), (13, 37), (64, 2)]
NAMES = {
    "r8": ("R8_UNORM", "R8_SRGB"),
    "rg8": ("R8G8_UNORM", "R8G8_SRGB"),
    "rgba8": ("R8G8B8A8_UNORM", "R8G8B8A8_SRGB"),
    "rgba16f": ("R16G16B16A16_SFLOAT", "R16G16B16A16_SFLOAT"),
    "rgba32f": ("R32G32B32A32_SFLOAT", "R32G32B32A32_SFLOAT"),
    "bc1": ("BC1_UNORM", "BC1_SRGB"),
    "bc1-rgb": ("BC1_RGB_UNORM", "BC1_RGB_SRGB"),
    "bc3": ("BC3_UNORM", "BC3_SRGB"),
    "bc4": ("BC4_UNORM", None),
    "bc5": ("BC5_UNORM", None),
    "bc6h": ("BC6H_UFLOAT", "BC6H_UFLOAT"),
    "bc7": ("BC7_UNORM", "BC7_SRGB"),
}
BLOCKS = {"bc1": 3, "bc1-rgb": 3, "bc3": 4, "bc4": 1, "bc5": 2, "bc7": 4}


def chain(height: int, width: int, channels: int, *, floats: bool = False, seed: int = 0) -> list:
    """Levels of random values, so that no two rows, channels or levels are alike."""
    random = np.random.default_rng(seed)
    levels = []
    while True:
        shape = (height, width, channels)
        if floats:
            levels.append(random.random(shape, np.float32))
        else:
            levels.append(random.integers(0, 256, shape, np.uint8))
        if height == width == 1:
            return levels
        height, width = max(1, height // 2), max(1, width // 2)


def written(tmp_path: Path, kind: str, levels: list, **options):
    """Writes levels to a file and returns them as read back."""
    write, read = WRITERS[kind]
    path = tmp_path / f"levels.{kind}"
    write(path, levels, **options)
    assert os.listdir(tmp_path) == [path.name]
    return read(path)


@pytest.fixture(params=WRITERS)
def kind(request):
    return request.param


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_bytes_are_kept(tmp_path, kind, size, channels, encoding):
    levels = chain(*size, channels)
    file = written(tmp_path, kind, levels, encoding=encoding)
    assert (file.height, file.width) == size
    assert file.is_srgb == (encoding == "srgb")
    expected = {1: "R8_UNORM", 2: "R8G8_UNORM"}.get(channels, "R8G8B8A8_UNORM")
    if encoding == "srgb":
        expected = "R8G8B8A8_SRGB"
    assert file.format == expected
    for level, found in zip(levels, file.levels, strict=True):
        if channels == 1 and encoding == "srgb":
            level = np.repeat(level, 3, axis=2)
        count = level.shape[2]
        np.testing.assert_array_equal(found[..., :count], level)
        if found.shape[2] == 4 and count < 4:
            assert np.all(found[..., 3] == 255)
            assert np.all(found[..., count:3] == 0)


@pytest.mark.parametrize("format", ["rgba16f", "rgba32f", "auto"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_floats_are_kept(tmp_path, kind, format, channels):
    levels = [9 * level - 3 for level in chain(9, 14, channels, floats=True)]
    file = written(tmp_path, kind, levels, format=format, encoding="srgb")
    assert not file.is_srgb
    exact = np.float32 if format == "rgba32f" else np.float16
    for level, found in zip(levels, file.levels, strict=True):
        assert found.dtype == exact
        count = 3 if channels == 1 else channels
        np.testing.assert_array_equal(
            found[..., :count], np.broadcast_to(level.astype(exact), (*level.shape[:2], count))
        )
        if channels < 4:
            assert np.all(found[..., 3] == 1)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_floats_become_the_nearest_bytes(tmp_path, kind, channels, encoding):
    levels = [1.4 * level - 0.2 for level in chain(8, 6, channels, floats=True)]
    file = written(tmp_path, kind, levels, format="rgba8", encoding=encoding)
    for level, found in zip(levels, file.levels, strict=True):
        wanted = np.clip(level, 0, 1)
        if encoding == "srgb":
            low = wanted <= 0.0031308
            curve = np.where(low, 12.92 * wanted, 1.055 * wanted ** (1 / 2.4) - 0.055)
            wanted = np.concatenate([curve[..., :3], wanted[..., 3:]], axis=2)
        if channels == 1:
            wanted = np.repeat(wanted, 3, axis=2)
        # A value in the middle between two bytes may go either way.
        count = wanted.shape[2]
        assert np.abs(found[..., :count] - 255.0 * wanted).max() <= 0.5 + 1e-3


def test_bytes_are_decoded_for_formats_of_floats(tmp_path, kind):
    levels = chain(4, 4, 4)
    file = written(tmp_path, kind, levels, format="rgba32f", encoding="srgb")
    values = levels[0] / 255.0
    curve = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(file.levels[0][..., :3], curve[..., :3], atol=1e-6)
    np.testing.assert_allclose(file.levels[0][..., 3], values[..., 3], atol=1e-6)


@pytest.mark.parametrize("format", ["r8", "rg8"])
def test_first_channels_are_taken(tmp_path, kind, format):
    levels = chain(6, 5, 4)
    file = written(tmp_path, kind, levels, format=format)
    count = {"r8": 1, "rg8": 2}[format]
    for level, found in zip(levels, file.levels, strict=True):
        np.testing.assert_array_equal(found, level[..., :count])


# The samples of a block in KTX 2: (first bit, number of bits) and channel.
SAMPLES = {
    "BC1": [((0, 64), 1)],  # Color with a cut-out.
    "BC3": [((0, 64), 15), ((64, 64), 0)],
    "BC4": [((0, 64), 0)],
    "BC5": [((0, 64), 0), ((64, 64), 1)],
    "BC1_RGB": [((0, 64), 0)],
    "BC6H": [((0, 128), 0)],
    "BC7": [((0, 128), 0)],
}


@pytest.mark.parametrize(
    ("format", "srgb"),
    [(name, srgb) for name, pair in NAMES.items() for srgb in (False, True) if pair[srgb]],
)
def test_ktx2_describes_its_samples(tmp_path, format, srgb):
    encoding = "srgb" if srgb else "linear"
    file = written(tmp_path, "ktx2", chain(4, 4, 4), format=format, encoding=encoding)
    assert file.format == NAMES[format][srgb]
    assert file.metadata["KTXorientation"] == "rd"
    assert file.metadata["KTXwriter"] == f"prefilter {prefilter.__version__}"
    channels = FORMATS[file.format][2]
    found = [(sample["bits"], sample["channel"]) for sample in file.samples]
    if format in (*BLOCKS, "bc6h"):
        assert found == SAMPLES[file.format.rsplit("_", 1)[0]]
    else:
        assert [channel for _, channel in found] == [0, 1, 2, 15][:channels]
    for sample in file.samples:
        if format.endswith("f"):
            assert sample["qualifiers"] == 0xC0
            assert sample["range"] == (0xBF800000, 0x3F800000)  # -1 and 1
        elif format == "bc6h":
            assert sample["qualifiers"] == 0x80
            assert sample["range"] == (0, 0x3F800000)
        else:
            is_linear = srgb and sample["channel"] == 15
            assert sample["qualifiers"] == (0x10 if is_linear else 0)
            assert sample["range"] == (0, 0xFFFFFFFF if format in BLOCKS else 255)


@pytest.mark.parametrize("alpha", ["straight", "premultiplied", "independent"])
@pytest.mark.parametrize("format", ["rgba8", "bc3", "bc7"])
def test_alpha_is_described(tmp_path, kind, alpha, format):
    levels = chain(4, 4, 4)
    file = written(tmp_path, kind, levels, alpha=alpha, format=format)
    known = {"dds": {"independent": "custom"}, "ktx2": {"independent": "straight"}}
    assert file.alpha == known[kind].get(alpha, alpha)
    if format == "rgba8":
        np.testing.assert_array_equal(file.levels[0], levels[0])
    opaque = written(tmp_path, kind, chain(4, 4, 3), alpha=alpha, format=format)
    assert opaque.alpha == ("opaque" if kind == "dds" else "straight")


def test_ktx2_keeps_metadata(tmp_path):
    given = {"Zoo": "ä", "Animal": "", "KUX": "b"}
    for format in ("rgba8", "etc1s"):
        path = tmp_path / "levels.ktx2"
        prefilter.write_ktx2(path, chain(8, 4, 3), format=format, metadata=given)
        _, info = prefilter.read_ktx2(path)
        own = {name: info.metadata[name] for name in ("KTXorientation", "KTXwriter")}
        assert info.metadata == {**own, **given}
        assert list(info.metadata) == ["Animal", "KTXorientation", "KTXwriter", "KUX", "Zoo"]
        assert read_metadata(path) == info.metadata
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(ValueError, match="is damaged"):
        read_metadata(path)


@pytest.mark.parametrize(
    "metadata", [3, {"KTXwriter": "x"}, {"": "x"}, {"a\0": "x"}, {"a": "\0"}, {"a": 1}, {1: "a"}]
)
def test_metadata_that_cannot_be_kept(tmp_path, metadata):
    with pytest.raises(ValueError, match=r"metadata: .* (is|are) needed"):
        prefilter.write_ktx2(tmp_path / "levels", GOOD, metadata=metadata)
    assert os.listdir(tmp_path) == []


LEGACY = {"r8", "rgba8", "bc1", "bc1-rgb", "bc3", "bc4", "bc5"}
"""The formats that the header of Direct3D 9 describes whole, where they are linear."""


@pytest.mark.parametrize("format", [name for name in NAMES if NAMES[name][0]])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("alpha", [None, "straight", "premultiplied", "independent"])
def test_dds_has_the_legacy_header_where_it_loses_nothing(tmp_path, format, encoding, alpha):
    if encoding == "srgb" and (NAMES[format][1] is None or format in {"r8", "rg8"}):
        pytest.skip("there is no such file")
    levels = chain(8, 12, 3 if alpha is None else 4)
    options = {"format": format, "encoding": encoding, "alpha": alpha or "straight"}
    files = {
        header: written(tmp_path, "dds", levels, header=header, **options)
        for header in ("auto", "dx10", *(["legacy"] if format in LEGACY else []))
    }
    assert files["dx10"].has_dx10
    has_alpha = FORMATS[files["dx10"].format][2] == 4 and format != "bc1-rgb"
    is_plain = not has_alpha or alpha in {None, "straight"}
    # Luminance is not quite the red of "r8".
    has_whole_legacy = format in LEGACY - {"r8"}
    assert files["auto"].has_dx10 == (not has_whole_legacy or encoding == "srgb" or not is_plain)
    for file in files.values():
        assert file.level_data == files["dx10"].level_data
        assert (file.width, file.height) == (12, 8)
    if not files["auto"].has_dx10:
        assert files["auto"] == files["legacy"]
        assert files["auto"].alpha == files["dx10"].alpha
        assert files["auto"].format == files["dx10"].format


@pytest.mark.parametrize("format", ["rgba16f", "rgba32f"])
def test_floats_have_a_legacy_header_on_wish(tmp_path, format):
    levels = chain(3, 5, 4, floats=True)
    files = [
        written(tmp_path, "dds", levels, format=format, header=header)
        for header in ("auto", "legacy")
    ]
    assert [file.has_dx10 for file in files] == [True, False]
    assert files[0].format == files[1].format
    assert files[0].level_data == files[1].level_data


@pytest.mark.parametrize("format", ["rg8", "bc6h", "bc7"])
def test_formats_that_have_no_legacy_header(tmp_path, format):
    with pytest.raises(ValueError, match=f"format: legacy DDS files have no '{format}'"):
        prefilter.write_dds(tmp_path / "levels", GOOD, format=format, header="legacy")
    with pytest.raises(ValueError, match="header: 'dx9' is not one of"):
        prefilter.write_dds(tmp_path / "levels", GOOD, header="dx9")
    assert os.listdir(tmp_path) == []


def smooth_chain(height: int, width: int, channels: int) -> list:
    """Levels that vary slowly, in bytes."""
    levels = []
    while True:
        y, x = np.meshgrid(np.linspace(0, 3, height), np.linspace(0, 2, width), indexing="ij")
        waves = [np.sin(x + (1 + c / 3) * y + c) for c in range(channels)]
        levels.append(np.rint(110 + 100 * np.stack(waves, axis=2)).astype(np.uint8))
        if height == width == 1:
            return levels
        height, width = max(1, height // 2), max(1, width // 2)


def simple_error(block: np.ndarray) -> float:
    """The squared error of a block of a simple compressor: ends at the extremes of the main axis.

    One channel has eight steps. Colors have four, and ends of 5, 6 and 5 bits.
    """
    texels = block.reshape(-1, block.shape[2]).astype(float)
    if texels.shape[1] == 1:
        palette = np.linspace(texels.min(), texels.max(), 8)[:, None].round()
    else:
        mean = texels.mean(axis=0)
        axis = np.linalg.svd(texels - mean)[2][0]
        along = (texels - mean) @ axis
        steps = np.array([31, 63, 31]) / 255
        ends = mean + np.array([along.min(), along.max()])[:, None] * axis
        first, second = np.clip(np.rint(ends * steps), 0, 255 * steps) / steps
        palette = first + (second - first) * np.linspace(0, 1, 4)[:, None]
    distances = ((texels[:, None] - palette) ** 2).sum(axis=2)
    return distances.min(axis=1).sum()


@pytest.mark.parametrize(
    ("format", "size"),
    [*itertools.product(BLOCKS, [(96, 64)]), *itertools.product(["bc1", "bc3", "bc7"], [(37, 51)])],
)
@pytest.mark.parametrize("make", [smooth_chain, chain])
def test_blocks_are_nearer_than_those_of_a_simple_compressor(tmp_path, kind, format, size, make):
    levels = [level | np.array([0, 0, 0, 255], np.uint8) for level in make(*size, 4)]
    count = BLOCKS[format]
    file = written(tmp_path, kind, levels, format=format)
    parts = [slice(0, 3)] if count > 2 else [slice(c, c + 1) for c in range(count)]
    error = reference = 0.0
    for level, found in zip(levels, file.levels, strict=True):
        rows = level[::-1]
        for top, left in itertools.product(
            range(0, level.shape[0], 4), range(0, level.shape[1], 4)
        ):
            block = rows[top : top + 4, left : left + 4]
            reference += sum(simple_error(block[..., part]) for part in parts)
        error += ((found[..., :count] - level[..., :count]) ** 2).sum()
        if count > 2:
            assert np.all(found[..., 3:] == 255)
    assert error <= reference


@pytest.mark.parametrize("format", BLOCKS)
def test_flat_levels_stay_flat(tmp_path, kind, format):
    values = np.array([37, 200, 90, 255], np.uint8)
    levels = [np.broadcast_to(values, level.shape) for level in chain(11, 6, 4)]
    file = written(tmp_path, kind, levels, format=format)
    count = BLOCKS[format]
    for found in file.levels:
        assert np.ptp(found, axis=(0, 1)).max() == 0
        near = 1.5 if count > 2 else 0.5
        assert np.abs(found[0, 0, :count] - values[:count]).max() <= near


def test_bc1_cuts_out_what_is_less_than_half_opaque(tmp_path, kind):
    levels = chain(13, 10, 4)
    file = written(tmp_path, kind, levels, format="bc1")
    for level, found in zip(levels, file.levels, strict=True):
        np.testing.assert_array_equal(found[..., 3], np.where(level[..., 3] < 128, 0, 255))
        assert np.all(found[found[..., 3] == 0] == 0)


def test_blocks_hide_the_error_under_straight_alpha(tmp_path, kind):
    levels = chain(16, 16, 4)
    levels[0][..., 3] = np.where(levels[0][..., 3] < 200, 0, 255)
    seen = levels[0][..., 3] == 255
    errors = {}
    for alpha in ("straight", "premultiplied"):
        found = written(tmp_path, kind, levels, format="bc3", alpha=alpha).levels[0]
        errors[alpha] = np.mean((found[seen] - levels[0][seen]) ** 2)
    assert errors["straight"] < 0.7 * errors["premultiplied"]


@pytest.mark.parametrize("format", ["bc1", "bc3", "bc7"])
def test_floats_are_encoded_before_they_are_compressed(tmp_path, kind, format):
    levels = [level / np.float32(255) for level in smooth_chain(24, 16, 3)]
    coded = [np.rint(255 * prefilter.to_srgb(level)).astype(np.uint8) for level in levels]
    of_floats = written(tmp_path, kind, levels, format=format, encoding="srgb")
    of_bytes = written(tmp_path, kind, coded, format=format, encoding="srgb")
    assert of_floats.is_srgb
    assert of_floats.level_data == of_bytes.level_data


@pytest.mark.parametrize(("size", "near"), [((1, 1), 0.02), ((5, 7), 1.0), ((75, 103), 0.1)])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_half_floats_keep_their_brightness(tmp_path, kind, size, near, channels):
    levels = [2.0 ** (level / 16.0 - 8) for level in smooth_chain(*size, channels)]
    file = written(tmp_path, kind, levels, format="bc6h")
    assert file.format == "BC6H_UFLOAT"
    assert file.alpha == ("opaque" if kind == "dds" else "straight")
    ratio = np.log2(np.maximum(file.levels[0], 1e-9) / levels[0][..., :3])
    assert np.sqrt(np.mean(ratio**2)) < near
    assert np.abs(ratio).max() < 5 * near
    assert len(file.levels) == len(levels)
    assert all(np.isfinite(found).all() for found in file.levels)


def test_negative_values_become_0_in_bc6h(tmp_path, kind):
    levels = [np.full((8, 12, 1), 5.0, np.float32)]
    levels[0][:, :4], levels[0][:, 4:8] = -5, 0.25
    found = written(tmp_path, kind, levels, format="bc6h").levels[0]
    assert found.min() == 0
    np.testing.assert_allclose(found, np.repeat(np.maximum(levels[0], 0), 3, axis=2), rtol=0.02)


def test_bytes_are_decoded_for_half_floats_in_blocks(tmp_path, kind):
    levels = smooth_chain(96, 64, 3)
    file = written(tmp_path, kind, levels, format="bc6h", encoding="srgb")
    assert not file.is_srgb
    wanted = prefilter.to_linear(levels[0] / np.float32(255))
    assert np.sqrt(np.mean((file.levels[0] - wanted) ** 2)) < 0.01


def test_bc1_rgb_has_no_alpha(tmp_path, kind):
    levels = chain(13, 10, 4)
    file = written(tmp_path, kind, levels, format="bc1-rgb")
    assert file.alpha == ("opaque" if kind == "dds" else "straight")
    opaque = [level | np.array([0, 0, 0, 255], np.uint8) for level in levels]
    assert written(tmp_path, kind, opaque, format="bc1-rgb").level_data == file.level_data
    for found in file.levels:
        assert np.all(found[..., 3:] == 255)


def photographs() -> list:
    """Photographs of the textures in shared/, cut to 256 x 256; none where they are missing."""
    folder = Path(__file__).resolve().parents[3] / "shared/data/textured"
    names = ("DamagedHelmet/Default_albedo.jpg", "AntiqueCamera/camera_camera_BaseColor.png")
    oiio = pytest.importorskip("OpenImageIO")
    found = []
    for name in names:
        if (folder / name).exists():
            pixels = oiio.ImageBuf(str(folder / name)).get_pixels("uint8")
            found.append(np.ascontiguousarray(pixels[384:640, 384:640, :3]))
    return found or [pytest.skip("shared/data is missing")]


def test_bc7_is_5_db_better_than_bc1_on_photographs(tmp_path):
    for photograph in photographs():
        errors = {}
        for format in ("bc1", "bc7"):
            found = written(tmp_path, "dds", [photograph], format=format).levels[0]
            errors[format] = np.mean((found[..., :3] - photograph) ** 2)
        assert 10 * np.log10(errors["bc1"] / errors["bc7"]) >= 5


def test_levels_may_be_left_out(tmp_path, kind):
    levels = chain(16, 8, 3)
    for count in (1, 2, 4):
        assert len(written(tmp_path, kind, levels[:count]).levels) == count


def test_views_and_doubles_are_taken(tmp_path, kind):
    image = np.random.default_rng(3).random((8, 12, 6))
    views = [image[::2, ::-1, ::2], image[:2, :6, :3]]
    file = written(tmp_path, kind, views, format="rgba32f")
    for view, found in zip(views, file.levels, strict=True):
        np.testing.assert_array_equal(found[..., :3], view.astype(np.float32))


def test_file_is_the_same_for_any_thread_count(tmp_path):
    levels = chain(40, 50, 4, floats=True)
    for kind, format in itertools.product(WRITERS, ["rgba8", "bc1", "bc3", "bc6h", "bc7"]):
        contents = set()
        for threads in (1, 2, 7):
            path = tmp_path / f"{threads}.{kind}"
            WRITERS[kind][0](path, levels, format=format, encoding="srgb", threads=threads)
            contents.add(path.read_bytes())
        assert len(contents) == 1


GOOD = chain(8, 8, 3)
HALF = GOOD[1]


@pytest.mark.parametrize(
    ("levels", "options", "words"),
    [
        ([], {}, "levels: an empty list"),
        (np.zeros((8, 8, 3), np.uint8), {}, "levels: a ndarray"),
        ("levels", {}, "levels: a str"),
        ([GOOD[0], GOOD[2]], {}, "level 1 has 2 x 2 texels.* is 4 x 4"),
        ([GOOD[0], GOOD[0]], {}, "level 1 has 8 x 8 texels.* is 4 x 4"),
        ([*GOOD, GOOD[-1]], {}, "level 4 is one too many"),
        ([GOOD[0], HALF[..., :2]], {}, "level 1 has 2 channels, the one before 3"),
        ([GOOD[0], HALF / 255.0], {}, "level 1 has texels of float32, level 0 of uint8"),
        ([GOOD[0][0, 0]], {}, r"level 0: shape \(3,\)"),
        ([np.zeros((4, 4, 5), np.uint8)], {}, "level 0 has 5 channels; 1 to 4"),
        ([np.zeros((0, 4, 3), np.uint8)], {}, "level 0: shape .* no pixels"),
        ([np.zeros((4, 4, 3), np.uint32)], {}, "level 0: dtype uint32"),
        ([np.full((2, 3, 1), np.nan, np.float32)], {}, "level 0: the texel in row 0, .* nan"),
        ([np.full((2, 3, 1), np.inf)], {}, "level 0: the texel in row 0, .* inf"),
        ([np.full((2, 3, 1), -7e4)], {}, "levels: hold -70000.*'rgba32f' is needed"),
        ([np.full((2, 3, 1), 7e4)], {"format": "bc6h"}, "levels: hold 70000.* of format 'bc6h' "),
        ([np.full((2, 3, 1), np.inf)], {"format": "bc6h"}, "level 0: the texel in row 0, .* inf"),
        ([np.full((4, 4, 3), np.nan)], {"format": "bc7"}, "level 0: the texel in row 0, .* nan"),
        (GOOD, {"format": "bc2"}, "format: 'bc2' is not one of auto, r8, .*"),
        (GOOD, {"format": 8}, "format: 8 is not one of auto, r8"),
        ([GOOD[0][..., :1]], {"format": "rg8"}, "format: 'rg8' needs 2 channels; .* have 1"),
        ([GOOD[0][..., :1]], {"format": "bc5"}, "format: 'bc5' needs 2 channels; .* have 1"),
        ([np.full((4, 4, 3), np.nan)], {"format": "bc1"}, "level 0: the texel in row 0, .* nan"),
        (GOOD, {"alpha": "opaque"}, "alpha: 'opaque' is not one of straight, premultiplied, indep"),
        (GOOD, {"encoding": "linearish"}, "encoding: 'linearish' is not one of linear, srgb"),
        (GOOD, {"threads": -1}, "threads: -1"),
        (GOOD, {"progress": 3}, "progress: 3"),
    ],
)
def test_refusals(tmp_path, kind, levels, options, words):
    write, _ = WRITERS[kind]
    with pytest.raises(ValueError, match=words):
        write(tmp_path / "levels", levels, **options)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("kind", "format"),
    [("dds", "r8"), ("dds", "rg8"), *itertools.product(WRITERS, ["bc4", "bc5"])],
)
def test_formats_that_have_no_srgb_form(tmp_path, kind, format):
    with pytest.raises(ValueError, match=f"encoding: 'srgb' with the format '{format}'"):
        WRITERS[kind][0](tmp_path / "levels", GOOD, format=format, encoding="srgb")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("path", [3, None, "a\0b"])
def test_paths_that_are_none(kind, path):
    with pytest.raises(ValueError, match=r"path: .* is needed"):
        WRITERS[kind][0](path, GOOD)


def test_places_that_cannot_be_written(tmp_path, kind):
    write, _ = WRITERS[kind]
    with pytest.raises(OSError, match="there is no folder"):
        write(tmp_path / "missing" / "file", GOOD)
    with pytest.raises(OSError, match="is a folder"):
        write(tmp_path, GOOD)
    target = tmp_path / "kept"
    target.write_bytes(b"kept")
    target.chmod(0o444)
    with pytest.raises(OSError, match="is read-only"):
        write(target, GOOD)
    assert target.read_bytes() == b"kept"
    if os.name == "nt":  # Folders have no such marks there.
        return
    folder = tmp_path / "locked"
    folder.mkdir(0o555)
    with pytest.raises(OSError, match="is read-only"):
        write(folder / "file", GOOD)
    assert os.listdir(folder) == []


def test_file_is_replaced_with_its_mode_and_through_links(tmp_path, kind):
    write, read = WRITERS[kind]
    target = tmp_path / "file"
    target.write_bytes(b"old")
    target.chmod(0o640)
    link = tmp_path / "link"
    if os.name == "nt":  # Links need rights there, and modes are no more than read-only or not.
        write(target, GOOD)
        np.testing.assert_array_equal(read(target).levels[0][..., :3], GOOD[0])
        return
    link.symlink_to(target)
    write(link, GOOD)
    assert link.is_symlink()
    assert target.stat().st_mode & 0o777 == 0o640
    np.testing.assert_array_equal(read(target).levels[0][..., :3], GOOD[0])


def test_canceling_writes_nothing(tmp_path, kind):
    write, _ = WRITERS[kind]
    target = tmp_path / "file"
    target.write_bytes(b"old")
    fractions = []

    def stop(fraction):
        fractions.append(fraction)
        return len(fractions) < 3

    with pytest.raises(prefilter.Cancelled):
        write(target, GOOD, progress=stop)
    assert target.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["file"]
    fractions.clear()
    write(target, GOOD, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


@pytest.mark.parametrize("size", [*SIZES, (32, 24)])
@pytest.mark.parametrize("format", ["rgba8", *BLOCKS])
@pytest.mark.parametrize(
    ("encoding", "header"), [("linear", "legacy"), ("linear", "dx10"), ("srgb", "dx10")]
)
def test_pillow_and_openimageio_agree_on_dds(tmp_path, size, format, encoding, header):
    if encoding == "srgb" and NAMES[format][1] is None:
        encoding = "linear"
    if format not in LEGACY:
        header = "auto"
    levels = chain(*size, 4)
    if format == "bc1":
        levels = [level[..., :3] for level in levels]
    compared = 0
    for number in range(len(levels)):
        path = tmp_path / f"{number}.dds"
        prefilter.write_dds(path, levels[number:], format=format, encoding=encoding, header=header)
        expected = read_dds(path).level(0)
        # Decoders may round the ends to bytes, which is half a step, and then cut off the mean.
        near = 0 if format in {"rgba8", "bc7"} else 1.5
        for pixels in pillow_reading(path) + openimageio_reading(tmp_path / "0.dds", number):
            assert pixels.shape[:2] == expected.shape[:2]
            count = min(pixels.shape[2], expected.shape[2])
            is_rgb = format.startswith("bc1") and pixels.shape[2] == 3
            assert count == (3 if is_rgb else expected.shape[2])
            assert np.abs(pixels[..., :count] - expected[..., :count]).max() <= near
            compared += 1
    if compared == 0:
        pytest.skip("neither a Pillow nor an OpenImageIO that reads such files is there")


def pillow_reading(path: Path) -> list:
    """Level 0 as Pillow reads it; none where it is missing or too old."""
    try:
        from PIL import Image
    except ImportError:
        return []
    try:
        with Image.open(path) as image:
            pixels = np.asarray(image)
            return [pixels.reshape(*pixels.shape[:2], -1)]
    except NotImplementedError:
        return []


def openimageio_reading(path: Path, number: int) -> list:
    """A level as OpenImageIO reads it, alpha left straight; none where it is missing or too old."""
    try:
        import OpenImageIO as oiio
    except ImportError:
        return []
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    file = oiio.ImageInput.open(str(path), config)
    if file is None:
        return []
    assert file.seek_subimage(0, number), "the level is missing"
    return [file.read_image("uint8")]


KTX_PARSE = """
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
const { read } = await import(createRequire(process.cwd() + '/').resolve('ktx-parse'));
const file = read(readFileSync(process.argv[1]));
file.levels = file.levels.map(level => Buffer.from(level.levelData).toString('hex'));
console.log(JSON.stringify(file));
"""


def ktx_parse(path: Path) -> dict:
    """The file by the npm package ktx-parse, which node finds beside the tests or in NODE_PATH."""
    command = ["node", "--input-type=module", "--eval", KTX_PARSE, str(path)]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=600)
    except FileNotFoundError:
        pytest.skip("there is no node")
    if "Cannot find module 'ktx-parse'" in run.stderr:
        pytest.skip("node finds no package ktx-parse")
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


@pytest.mark.parametrize("format", NAMES)
def test_ktx_parse_agrees_on_ktx2(tmp_path, format):
    levels = chain(13, 6, 4)
    path = tmp_path / "levels.ktx2"
    for srgb, alpha in itertools.product((False, True), ("straight", "premultiplied")):
        if NAMES[format][srgb] is None:
            continue
        encoding = "srgb" if srgb else "linear"
        prefilter.write_ktx2(path, levels, format=format, encoding=encoding, alpha=alpha)
        ours, theirs = read_ktx2(path), ktx_parse(path)
        assert theirs["vkFormat"] == FORMATS[ours.format][1]
        assert (theirs["pixelWidth"], theirs["pixelHeight"]) == (6, 13)
        assert [bytes.fromhex(level) for level in theirs["levels"]] == ours.level_data
        assert theirs["keyValue"] == ours.metadata
        descriptor = theirs["dataFormatDescriptor"][0]
        assert descriptor["transferFunction"] == (2 if ours.is_srgb else 1)
        has_alpha = FORMATS[ours.format][2] == 4
        assert descriptor["flags"] == int(alpha == "premultiplied" and has_alpha)
        assert len(descriptor["samples"]) == len(ours.samples)


def test_descriptions_name_the_sizes_of_texels():
    words = {0.25: "a quarter of a byte", 0.5: "half a byte", 1.0: "1 byte"}
    described = TEXTURE_FORMATS.keys() & prefilter.TEXEL_FORMATS.keys() - {"etc1s"}
    assert {"rgba8", "bc1", "astc-6x6", "uastc"} <= described
    for name in described:
        size = prefilter.TEXEL_FORMATS[name].texel_bytes
        phrase = f"{words.get(size, f'{size:.2g} bytes')} per texel"
        assert phrase in TEXTURE_FORMATS[name].description
