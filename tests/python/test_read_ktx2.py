# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading KTX 2 files by `write_ktx2`, and files that other tools write for glTF.

Khronos' `ktx create --generate-mipmap` wrote the files in ktx2/ from one small picture, using
`--encode basis-lz` or `--encode uastc --zstd 5`; the texels are by `ktx transcode --target rgba8`.
"""

import io
import struct
from pathlib import Path

import numpy as np
import prefilter
import pytest
import texture_readers

FILES = Path(__file__).parent / "ktx2"
SAMPLES = sorted(path for path in FILES.glob("*.ktx2") if not path.stem.endswith("texels"))
SIZES = [(37, 22), (64, 32), (1, 1)]


def noise(width, height, channels=4):
    rng = np.random.default_rng(width)
    levels = []
    while True:
        levels.append(rng.integers(0, 256, (height, width, channels), np.uint8))
        if width == height == 1:
            return levels
        width, height = max(1, width // 2), max(1, height // 2)


def written(levels, **options):
    file = io.BytesIO()
    prefilter.write_ktx2(file, levels, **options)
    return file.getvalue()


def read(data):
    return prefilter.read_ktx2(io.BytesIO(data))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize(("name", "channels"), [("r8", 1), ("rg8", 2), ("rgba8", 4)])
def test_bytes_come_back(name, channels, encoding, size):
    levels = noise(*size, channels)
    found, info = read(written(levels, format=name, encoding=encoding))
    assert (info.format, info.encoding, info.supercompression) == (name, encoding, "none")
    assert info.alpha == ("straight" if channels == 4 else None)
    assert info.metadata["KTXwriter"] == f"prefilter {prefilter.__version__}"
    assert len(found) == len(levels)
    for one, level in zip(found, levels, strict=True):
        assert one.dtype == np.uint8
        np.testing.assert_array_equal(one, level)


@pytest.mark.parametrize("name", ["rgba16f", "rgba32f"])
def test_floats_come_back(name):
    levels = [(level.astype(np.float32) - 100) / 16 for level in noise(37, 22)]
    found, info = read(written(levels, format=name, alpha="premultiplied"))
    assert (info.format, info.encoding, info.alpha) == (name, "linear", "premultiplied")
    for one, level in zip(found, levels, strict=True):
        assert one.dtype == np.float32
        np.testing.assert_array_equal(one, level)


@pytest.mark.parametrize(
    ("name", "code", "channels", "dtype"),
    [("rgba16", 91, 4, np.uint16), ("rg16f", 83, 2, np.float16), ("rgb8", 29, 3, np.uint8)],
)
def test_formats_of_others(name, code, channels, dtype):
    """The bytes of a file in another format, of half floats, taken for texels of this one."""
    unit = channels * np.dtype(dtype).itemsize
    halves = np.arange(64 * 4 * 6, dtype=np.float32).reshape(4, 96, 4) / 32
    data = written([halves], format="rgba16f")
    stored = np.ascontiguousarray(halves[::-1]).astype(np.float16).tobytes()
    width = 96 * 8 // unit
    (found,), info = read(header(data, code=code, width=width))
    expected = np.frombuffer(stored, dtype).reshape(4, width, channels)[::-1]
    assert (info.format, info.encoding) == (name, "srgb" if code == 29 else "linear")
    assert found.dtype == (np.float32 if dtype is np.float16 else dtype)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["bc1", "bc1-rgb", "bc3", "bc4", "bc5"])
def test_blocks_are_decoded_as_their_definitions_say(name, size, tmp_path):
    (tmp_path / "x.ktx2").write_bytes(written(noise(*size), format=name))
    found, info = prefilter.read_ktx2(tmp_path / "x.ktx2")
    assert info.format == name
    expected = texture_readers.read_ktx2(tmp_path / "x.ktx2").levels  # without rounding
    for one, level in zip(found, expected, strict=True):
        assert one.shape == level.shape
        assert np.abs(one - level).max() <= 1


def test_blocks_of_openimageio(tmp_path):
    path = tmp_path / "x.ktx2"
    path.write_bytes(written(noise(37, 22), format="bc7"))
    for one, level in zip(
        prefilter.read_ktx2(path)[0], texture_readers.read_ktx2(path).levels, strict=True
    ):
        np.testing.assert_array_equal(one, level)
    path.write_bytes(
        written([level.astype(np.float32) / 16 for level in noise(37, 22, 3)], format="bc6h")
    )
    for one, level in zip(
        prefilter.read_ktx2(path)[0], texture_readers.read_ktx2(path).levels, strict=True
    ):
        np.testing.assert_allclose(one, level, rtol=1e-3)


@pytest.mark.parametrize("name", sorted(prefilter.TEXEL_FORMATS))
def test_what_was_written_is_near_what_is_read(name):
    """A smooth picture, which all formats can hold: channels in their places, rows and columns."""
    v, u = np.mgrid[0:48, 0:40] / 47
    image = np.stack([u, v, 0.5 * u + 0.3, 1 - 0.5 * v], axis=2)
    levels = [image.astype(np.float32)]
    if not prefilter.TEXEL_FORMATS[name].is_float:
        levels = [np.rint(255 * image).astype(np.uint8)]
    (found,), info = read(written(levels, format=name))
    assert info.format == name
    channels = prefilter.TEXEL_FORMATS[name].channels
    if name == "bc1":
        channels = 3  # its alpha is 0 or 1
    assert found.shape[2] == prefilter.TEXEL_FORMATS[name].channels
    values = found / 255 if found.dtype == np.uint8 else found
    assert np.abs(values[..., :channels] - image[..., :channels]).mean() < 0.02


@pytest.mark.parametrize("name", sorted({*prefilter.TEXEL_FORMATS} - {"etc1s"}))
def test_zstd_and_threads_change_nothing(name):
    levels = noise(37, 22)
    if prefilter.TEXEL_FORMATS[name].is_float:
        levels = [level.astype(np.float32) / 255 for level in levels]
    plain, info = read(written(levels, format=name))
    data = written(levels, format=name, supercompression="zstd")
    packed, packed_info = prefilter.read_ktx2(io.BytesIO(data), threads=1)
    assert (info.supercompression, packed_info.supercompression) == ("none", "zstd")
    for one, other in zip(plain, packed, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_files_of_khronos_tool(path):
    found, info = prefilter.read_ktx2(path)
    expected = texture_readers.read_ktx2(path.with_suffix(".texels.ktx2")).levels
    encoder, _, channels = path.stem.rpartition("-")
    assert info.format == {"basis-lz": "etc1s", "uastc": "uastc"}[encoder]
    assert info.supercompression == {"basis-lz": "basislz", "uastc": "zstd"}[encoder]
    assert info.encoding == ("srgb" if channels in ("rgb", "rgba") else "linear")
    assert len(found) == len(expected) == 5
    assert found[0].shape[2] >= len(channels)
    for one, level in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, level[..., : one.shape[2]])


def test_rows_that_go_up():
    data = written(noise(8, 4, 1), format="r8")
    down, _ = read(data)
    up, _ = read(data.replace(b"KTXorientation\0rd", b"KTXorientation\0ru"))
    left, _ = read(data.replace(b"KTXorientation\0rd", b"KTXorientation\0ld"))
    np.testing.assert_array_equal(up[0], down[0][::-1])
    np.testing.assert_array_equal(left[0], down[0][:, ::-1])


def header(data, **changed):
    """The file with other numbers in its header."""
    names = ("code", "size", "width", "height", "depth", "layers", "faces", "levels", "scheme")
    for name, value in changed.items():
        at = 12 + 4 * names.index(name)
        data = data[:at] + struct.pack("<I", value) + data[at + 4 :]
    return data


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"depth": 4}, ["depth of 4"]),
        ({"layers": 3}, ["3 layers"]),
        ({"faces": 6}, ["6 faces"]),
        ({"width": 0}, ["0 x 4"]),
        ({"height": 1 << 20}, ["sides of 1 to 65536"]),
        ({"levels": 9}, ["9 levels"]),
        ({"scheme": 3}, ["supercompression 3"]),
        ({"scheme": 1}, ["not read"]),
        ({"code": 4711}, ["VkFormat 4711"]),
        ({"width": 16}, ["take 256"]),
    ],
)
def test_what_is_not_read_is_said(changed, words):
    data = header(written(noise(8, 4)), **changed)
    with pytest.raises(ValueError, match="path: the file") as error:
        read(data)
    for word in words:
        assert word in str(error.value)


def test_other_files(tmp_path):
    (tmp_path / "x.ktx2").write_bytes(b"\x89PNG")
    with pytest.raises(ValueError, match="no KTX 2 file"):
        prefilter.read_ktx2(tmp_path / "x.ktx2")
    with pytest.raises(FileNotFoundError):
        prefilter.read_ktx2(tmp_path / "none.ktx2")
    with pytest.raises(ValueError, match="path"):
        prefilter.read_ktx2(3)
    with pytest.raises(ValueError, match="open to read bytes"):
        prefilter.read_ktx2(io.StringIO("text"))


def test_few_bytes_do_not_take_much_memory():
    """Sizes that the data cannot have are refused before room is made for them."""
    data = header((FILES / "basis-lz-rgb.ktx2").read_bytes(), width=1 << 16, height=1 << 16)
    with pytest.raises(ValueError, match="texels of ETC1S"):
        read(data)
    data = written(noise(8, 4), supercompression="zstd")
    at = 80 + 16  # how many bytes level 0 has when decompressed
    data = data[:at] + struct.pack("<Q", 1 << 40) + data[at + 8 :]
    with pytest.raises(ValueError, match="cannot hold"):
        read(data)


@pytest.mark.parametrize("kind", ["basis-lz-rgba", "uastc-rgba", "bc7", "astc-6x6", "etc2-rgba"])
def test_damage_is_told_or_harmless(kind):
    path = FILES / f"{kind}.ktx2"
    data = path.read_bytes() if path.exists() else written(noise(20, 12), format=kind)
    rng = np.random.default_rng(5)
    refused = 0
    for trial in range(300):
        damaged = bytearray(data)
        for _ in range(rng.integers(1, 4)):
            damaged[rng.integers(12, len(data))] = rng.integers(256)
        if trial % 3 == 0:
            del damaged[rng.integers(12, len(data)) :]
        try:
            levels, _ = read(bytes(damaged))
        except ValueError:
            refused += 1
        else:
            assert all(level.ndim == 3 for level in levels)
    assert refused > 100


def test_cancel():
    data = written(noise(64, 64), format="bc7")
    with pytest.raises(prefilter.Cancelled):
        prefilter.read_ktx2(io.BytesIO(data), progress=lambda _: False)
