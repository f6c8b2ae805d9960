# SPDX-License-Identifier: GPL-3.0-or-later

"""KTX 2 files in ETC1S: levels that share codebooks, compressed by BasisLZ."""

import io
import shutil
import struct
import subprocess

import numpy as np
import prefilter
import pytest


def written(levels, **options):
    file = io.BytesIO()
    prefilter.write_ktx2(file, levels, format="etc1s", **options)
    return file.getvalue()


def read(data):
    return prefilter.read_ktx2(io.BytesIO(data))[0]


def pyramid(image):
    """All levels, each from every other row and column of the one before."""
    levels = [image]
    while max(levels[-1].shape[:2]) > 1:
        height, width, _ = levels[-1].shape
        shape = max(1, height // 2), max(1, width // 2)
        rows, columns = (np.arange(half) * 2 + (half > 1) for half in shape)
        levels.append(np.ascontiguousarray(levels[-1][rows][:, columns]))
    return levels


def waves(height=160, width=128, channels=3):
    v, u = np.mgrid[0:height, 0:width] / 20
    phases = [np.sin(u + channel) * np.cos(1.7 * v - 0.3 * channel) for channel in range(channels)]
    return np.rint(127 + 90 * np.stack(phases, axis=2)).astype(np.uint8)


def codebook_sizes(data):
    """How many endpoints and selectors the levels share."""
    (offset,) = struct.unpack_from("<Q", data, 64)
    return struct.unpack_from("<2H", data, offset)


@pytest.mark.parametrize("color", [(0, 0, 0), (255, 255, 255), (200, 40, 90), (3, 130, 251)])
@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (8, 4), (37, 22)])
def test_one_color_is_kept_as_near_as_5_bits_are(color, shape):
    (found,) = read(written([np.full((*shape, 3), color, np.uint8)]))
    assert found.shape == (*shape, 3)
    # A block has 31 steps a channel, of 8.23 each.
    assert np.abs(found.astype(int) - color).max() <= 5


@pytest.mark.parametrize("alpha", [0, 255])
def test_alpha_is_kept_apart_from_colors(alpha):
    image = np.concatenate([waves(), np.full((160, 128, 1), alpha, np.uint8)], axis=2)
    (found,) = read(written([image]))
    (opaque,) = read(written([image[..., :3]]))
    assert (found[..., 3] == alpha).all()
    assert opaque.shape[2] == 3
    errors = [np.abs(one[..., :3].astype(float) - image[..., :3]).mean() for one in (found, opaque)]
    assert errors[0] <= 1.2 * errors[1]


def test_quality_is_paid_for_in_bytes():
    levels = pyramid(np.random.default_rng(3).integers(0, 256, (320, 320, 3)).astype(np.uint8))
    sizes, errors, selectors = [], [], []
    for quality in (1, 64, 128, 192, 255):
        data = written(levels, encoding="srgb", quality=quality)
        sizes.append(len(data))
        selectors.append(codebook_sizes(data)[1])
        (first, *_) = read(data)
        errors.append(np.mean((first.astype(float) - levels[0]) ** 2))
    assert sizes == sorted(sizes)
    assert errors == sorted(errors, reverse=True)
    assert sizes[-1] > 1.5 * sizes[0]
    assert selectors[0] < 200
    assert (np.diff(selectors) > 100).all()


def test_levels_share_their_codebooks():
    levels = pyramid(waves())
    data = written(levels)
    endpoints, selectors = codebook_sizes(data)
    alone = [codebook_sizes(written([level])) for level in levels]
    blocks = sum(-(-level.shape[0] // 4) * -(-level.shape[1] // 4) for level in levels)
    assert 0 < endpoints < min(blocks, sum(size[0] for size in alone))
    assert 0 < selectors < min(blocks, sum(size[1] for size in alone))
    assert len(data) < 0.85 * sum(len(written([level])) for level in levels)


def test_every_level_is_in_its_place():
    levels = pyramid(waves(64, 256))
    found = read(written(levels))
    assert [level.shape for level in found] == [level.shape for level in levels]
    for one, level in zip(found, levels, strict=True):
        assert np.abs(one.astype(float) - level).mean() < 0.5 * level.std() + 6


def test_top_rows_come_first():
    image = np.zeros((16, 8, 3), np.uint8)
    image[12:] = 255  # the top
    (found,) = read(written([image]))
    np.testing.assert_allclose(found, image, atol=4)


@pytest.mark.parametrize("threads", [2, 3, 8])
def test_threads_change_nothing(threads):
    levels = pyramid(np.random.default_rng(8).integers(0, 256, (300, 200, 4)).astype(np.uint8))
    assert written(levels, threads=threads) == written(levels, threads=1)


def test_floats_are_encoded():
    image = waves()
    linear = prefilter.to_linear(image)
    assert written([linear], encoding="srgb") == written([image], encoding="srgb")


@pytest.mark.parametrize("stop_at", [0.0, 0.8])
def test_canceling_writes_nothing(tmp_path, stop_at):
    with pytest.raises(prefilter.Cancelled):
        prefilter.write_ktx2(
            tmp_path / "file.ktx2",
            [waves()],
            format="etc1s",
            progress=lambda fraction: fraction < stop_at,
        )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"quality": 0}, "quality: 0; 1 to 255 are allowed"),
        ({"quality": 256}, "quality: 256; 1 to 255"),
        ({"quality": 1.5}, "quality: 1.5; 1 to 255"),
        ({"quality": True}, "quality: True; 1 to 255"),
        ({"supercompression": "zstd"}, "supercompression: 'zstd' with the format 'etc1s'"),
    ],
)
def test_bad_arguments_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        written([waves()], **options)


def test_dds_files_have_none(tmp_path):
    with pytest.raises(ValueError, match="format: DDS files have no 'etc1s'"):
        prefilter.write_dds(tmp_path / "file.dds", [waves()], format="etc1s")


@pytest.mark.skipif(shutil.which("ktx") is None, reason="Khronos' ktx is not installed")
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_khronos_accepts_what_gltf_files_hold(tmp_path, channels, encoding):
    path = tmp_path / "texture.ktx2"
    prefilter.write_ktx2(path, pyramid(waves(64, 32, channels)), format="etc1s", encoding=encoding)
    command = ["ktx", "validate", "--gltf-basisu", "--warnings-as-errors", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("ktx") is None, reason="Khronos' ktx is not installed")
def test_as_near_as_khronos_tool_makes_it(tmp_path):
    """The tool has the same encoder, with codebooks of other sizes."""
    levels = pyramid(waves(256, 256))
    raw, path = tmp_path / "raw.ktx2", tmp_path / "theirs.ktx2"
    prefilter.write_ktx2(raw, [np.ascontiguousarray(one) for one in levels], format="rgba8")
    options = ["--codec", "basis-lz", "--clevel", "2", "--qlevel", "192"]
    subprocess.run(["ktx", "encode", *options, str(raw), str(path)], check=True)
    theirs, _ = prefilter.read_ktx2(path)
    ours = read(written(levels, quality=192))
    errors = [np.mean((one[0][..., :3].astype(float) - levels[0]) ** 2) for one in (ours, theirs)]
    assert errors[0] < 1.1 * errors[1]
