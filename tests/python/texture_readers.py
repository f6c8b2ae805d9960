# SPDX-License-Identifier: GPL-3.0-or-later

"""Readers of DDS and KTX 2 files, after their specifications; nothing here is shared with a writer.

A file is read into a `File`, whose levels are as stored: the top row first.
"""

import itertools
import struct
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

# name: (DXGI_FORMAT, VkFormat, channels, dtype or None for blocks, bytes a texel or block, is sRGB)
FORMATS = {
    "R8_UNORM": (61, 9, 1, np.uint8, 1, False),
    "R8_SRGB": (None, 15, 1, np.uint8, 1, True),
    "R8G8_UNORM": (49, 16, 2, np.uint8, 2, False),
    "R8G8_SRGB": (None, 22, 2, np.uint8, 2, True),
    "R8G8B8A8_UNORM": (28, 37, 4, np.uint8, 4, False),
    "R8G8B8A8_SRGB": (29, 43, 4, np.uint8, 4, True),
    "R16G16B16A16_SFLOAT": (10, 97, 4, np.float16, 8, False),
    "R32G32B32A32_SFLOAT": (2, 109, 4, np.float32, 16, False),
    "BC1_UNORM": (71, 133, 4, None, 8, False),
    "BC1_SRGB": (72, 134, 4, None, 8, True),
    "BC1_RGB_UNORM": (None, 131, 3, None, 8, False),
    "BC1_RGB_SRGB": (None, 132, 3, None, 8, True),
    "BC3_UNORM": (77, 137, 4, None, 16, False),
    "BC3_SRGB": (78, 138, 4, None, 16, True),
    "BC4_UNORM": (80, 139, 1, None, 8, False),
    "BC5_UNORM": (83, 141, 2, None, 16, False),
    "BC6H_UFLOAT": (95, 143, 3, None, 16, False),
    "BC7_UNORM": (98, 145, 4, None, 16, False),
    "BC7_SRGB": (99, 146, 4, None, 16, True),
    "ETC2_R8G8B8_UNORM": (None, 147, 3, None, 8, False),
    "ETC2_R8G8B8_SRGB": (None, 148, 3, None, 8, True),
    "ETC2_R8G8B8A8_UNORM": (None, 151, 4, None, 16, False),
    "ETC2_R8G8B8A8_SRGB": (None, 152, 4, None, 16, True),
    "EAC_R11_UNORM": (None, 153, 1, None, 8, False),
    "EAC_R11G11_UNORM": (None, 155, 2, None, 16, False),
    "ASTC_4x4_UNORM": (None, 157, 4, None, 16, False),
    "ASTC_4x4_SRGB": (None, 158, 4, None, 16, True),
    "ASTC_6x6_UNORM": (None, 165, 4, None, 16, False),
    "ASTC_6x6_SRGB": (None, 166, 4, None, 16, True),
    "ASTC_8x8_UNORM": (None, 171, 4, None, 16, False),
    "ASTC_8x8_SRGB": (None, 172, 4, None, 16, True),
    "ASTC_4x4_SFLOAT": (None, 1000066000, 4, None, 16, False),
    "ASTC_6x6_SFLOAT": (None, 1000066004, 4, None, 16, False),
    # Vulkan has no name for UASTC; the file's descriptor identifies it.
    "UASTC_UNORM": (None, 0, 4, None, 16, False),
    "UASTC_SRGB": (None, 0, 4, None, 16, True),
}


@dataclass
class File:
    """The contents of a texture file."""

    format: str
    width: int
    height: int
    level_data: list[bytes]
    alpha: str
    samples: list[dict] = field(default_factory=list)
    metadata: dict[str, str] = field(default_factory=dict)
    has_dx10: bool = False

    @property
    def is_srgb(self) -> bool:
        return FORMATS[self.format][5]

    def level(self, number: int) -> np.ndarray:
        """A level, the top row first; block formats are decoded to floats."""
        _, _, channels, dtype, _, _ = FORMATS[self.format]
        height, width = max(1, self.height >> number), max(1, self.width >> number)
        if dtype is None:
            return decoded_blocks(self.level_data[number], self.format, width, height)
        values = np.frombuffer(self.level_data[number], np.dtype(dtype).newbyteorder("<"))
        return values.reshape(height, width, channels)

    @property
    def levels(self) -> list[np.ndarray]:
        """All levels, the bottom row first."""
        return [self.level(number)[::-1] for number in range(len(self.level_data))]


def level_bytes(name: str, width: int, height: int, number: int) -> int:
    """The size of a level in bytes."""
    width, height = max(1, width >> number), max(1, height >> number)
    _, _, _, dtype, unit, _ = FORMATS[name]
    if dtype is None:
        side = block_side(name)
        width, height = -(-width // side), -(-height // side)
    return width * height * unit


def block_side(name: str) -> int:
    """How many texels the side of a block has, of a format of square blocks."""
    return int(name[5]) if name.startswith("ASTC") else 4


# The codes of Direct3D 9, and the equivalent pixel format with masks:
# (flags except the alpha flag, bits a texel, masks of red, green, blue and alpha).
FOUR_CCS = {
    b"DXT1": "BC1_UNORM",
    b"DXT5": "BC3_UNORM",
    b"ATI1": "BC4_UNORM",
    b"ATI2": "BC5_UNORM",
    b"\x71\0\0\0": "R16G16B16A16_SFLOAT",  # D3DFMT_A16B16G16R16F
    b"\x74\0\0\0": "R32G32B32A32_SFLOAT",  # D3DFMT_A32B32G32R32F
}
MASKS = {
    (0x20000, 8, 0xFF, 0, 0): "R8_UNORM",  # D3DFMT_L8
    (0x40, 32, 0xFF0000, 0xFF00, 0xFF): "R8G8B8A8_UNORM",  # D3DFMT_A8R8G8B8
}


def read_dds(path: Path) -> File:
    """Reads a DDS file with either header, and checks what its header has to say."""
    data = path.read_bytes()
    assert data[:4] == b"DDS "
    size, flags, height, width, pitch, depth, mips = struct.unpack_from("<7I", data, 4)
    assert (size, depth) == (124, 0)
    caps, caps2, caps3, caps4, reserved = struct.unpack_from("<5I", data, 108)
    assert (caps2, caps3, caps4, reserved) == (0, 0, 0, 0)
    has_dx10 = data[84:88] == b"DX10"
    name, alpha = (_read_dx10 if has_dx10 else _read_pixel_format)(data)

    assert flags & 0x1007 == 0x1007
    assert mips >= 1
    assert bool(flags & 0x20000) == (mips > 1)
    assert caps == (0x1000 if mips == 1 else 0x401008)
    if FORMATS[name][3] is None:
        assert flags & 0x80008 == 0x80000
        assert pitch == level_bytes(name, width, height, 0)
    else:
        assert flags & 0x80008 == 0x8
        assert pitch == width * FORMATS[name][4]

    offset, levels = 148 if has_dx10 else 128, []
    for number in range(mips):
        count = level_bytes(name, width, height, number)
        level = data[offset : offset + count]
        if not has_dx10 and name.startswith("R8G8B8A8"):
            blue, green, red, rest = (level[channel::4] for channel in range(4))
            level = bytes(itertools.chain.from_iterable(zip(red, green, blue, rest, strict=True)))
        levels.append(level)
        offset += count
    assert offset == len(data)
    return File(name, width, height, levels, alpha, has_dx10=has_dx10)


def _read_dx10(data: bytes) -> tuple[str, str]:
    """The format, and the kind of alpha."""
    assert struct.unpack_from("<2I", data, 76) == (32, 4)
    dxgi, dimension, misc, array_size, misc2 = struct.unpack_from("<5I", data, 128)
    assert (dimension, misc, array_size) == (3, 0, 1)
    name = next(name for name, entry in FORMATS.items() if entry[0] == dxgi)
    return name, {1: "straight", 2: "premultiplied", 3: "opaque", 4: "custom"}[misc2]


def _read_pixel_format(data: bytes) -> tuple[str, str]:
    """The same of the header of Direct3D 9."""
    size, flags, code, bits, *masks, alpha_mask = struct.unpack_from("<2I4s5I", data, 76)
    assert size == 32
    alpha = "straight" if flags & 1 else "opaque"
    if flags & 4:
        assert flags | 1 == 5
        assert (bits, masks, alpha_mask) == (0, [0, 0, 0], 0)
        return FOUR_CCS[code], alpha
    assert code == bytes(4)
    assert alpha_mask == (0xFF000000 if flags & 1 else 0)
    return MASKS[(flags & ~1, bits, *masks)], alpha


def read_ktx2(path: Path) -> File:
    """Reads a KTX 2.0 file, and checks the rules of its specification on the way."""
    data = path.read_bytes()
    assert data[:12] == bytes([0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 13, 10, 26, 10])
    vulkan, type_size, width, height, depth, layers, faces, count, scheme = struct.unpack_from(
        "<9I", data, 12
    )
    assert (depth, layers, faces) == (0, 0, 1)
    assert scheme in (0, 2)
    assert 1 <= count <= max(width, height).bit_length()
    names = [name for name, entry in FORMATS.items() if entry[1] == vulkan]
    name = names[0]
    if vulkan == 0:
        transfer = data[struct.unpack_from("<I", data, 48)[0] + 14]
        name = next(name for name in names if FORMATS[name][5] == (transfer == 2))
    _, _, _, dtype, unit, _ = FORMATS[name]
    assert type_size == (1 if dtype is None else np.dtype(dtype).itemsize)

    dfd_offset, dfd_length, kvd_offset, kvd_length = struct.unpack_from("<4I", data, 48)
    assert struct.unpack_from("<2Q", data, 64) == (0, 0)
    assert dfd_offset == 80 + 24 * count
    assert kvd_offset == dfd_offset + dfd_length
    index = [struct.unpack_from("<3Q", data, 80 + 24 * number) for number in range(count)]
    # Data goes from the smallest level to the largest, each at the first multiple that is free, or
    # at the next byte where it is supercompressed.
    free = kvd_offset + kvd_length
    for number in reversed(range(count)):
        offset, length, uncompressed = index[number]
        while scheme == 0 and (free % unit or free % 4):
            assert data[free] == 0
            free += 1
        assert offset == free
        assert uncompressed == level_bytes(name, width, height, number)
        assert scheme or length == uncompressed
        free += length
    assert free == len(data)
    levels = [data[offset : offset + length] for offset, length, _ in index]
    if scheme == 2:
        levels = [
            _inflated(level, count) for level, (_, _, count) in zip(levels, index, strict=True)
        ]

    alpha, samples = _read_descriptor(data[dfd_offset : dfd_offset + dfd_length], name)
    metadata, keys = {}, []
    at, end = kvd_offset, kvd_offset + kvd_length
    while at < end:
        (length,) = struct.unpack_from("<I", data, at)
        key, value = data[at + 4 : at + 4 + length].split(b"\0", 1)
        assert value.endswith(b"\0")
        metadata[key.decode()] = value[:-1].decode()
        keys.append(key)
        at += 4 + (length + 3) // 4 * 4
    assert at == end
    assert keys == sorted(keys)
    return File(name, width, height, levels, alpha, samples, metadata)


def _inflated(frame: bytes, count: int) -> bytes:
    """The contents of one zstd frame, whose header gives its size as `count` bytes."""
    import zstandard

    assert zstandard.frame_content_size(frame) == count
    return zstandard.ZstdDecompressor().decompress(frame, read_across_frames=False)


def _read_descriptor(data: bytes, name: str) -> tuple[str, list[dict]]:
    total, vendor_and_type, version, size = struct.unpack_from("<2I2H", data)
    assert total == len(data)
    assert (vendor_and_type, version, size) == (0, 2, total - 4)
    model, primaries, transfer, flags = data[12:16]
    _, _, _, dtype, unit, srgb = FORMATS[name]
    # glTF's KHR_texture_basisu: "KHR_DF_PRIMARIES_UNSPECIFIED" (0) for UASTC that is no color.
    assert primaries == (0 if name == "UASTC_UNORM" else 1)
    assert transfer == (2 if srgb else 1)
    last = block_side(name) - 1 if dtype is None else 0
    assert list(data[16:20]) == [last, last, 0, 0]
    assert list(data[20:28]) == [unit, 0, 0, 0, 0, 0, 0, 0]
    samples = []
    for start in range(28, total, 16):
        offset, bits, channel, position, low, high = struct.unpack_from("<H2B3I", data, start)
        assert position == 0
        samples.append(
            {
                "bits": (offset, bits + 1),
                "channel": channel & 0xF,
                "qualifiers": channel & 0xF0,
                "range": (low, high),
            }
        )
    # Every bit of a texel or block belongs to one sample.
    assert [sample["bits"][0] for sample in samples] == [
        sum(sample["bits"][1] for sample in samples[:number]) for number in range(len(samples))
    ]
    assert sum(sample["bits"][1] for sample in samples) == 8 * unit
    models = {"BC1": 128, "BC3": 130, "BC4": 131, "BC5": 132, "BC6": 133, "BC7": 134}
    models |= {"ETC": 161, "EAC": 161, "AST": 162, "UAS": 166}
    assert model == models.get(name[:3], 1)
    return "premultiplied" if flags & 1 else "straight", samples


def decoded_blocks(data: bytes, name: str, width: int, height: int) -> np.ndarray:
    """Blocks of a format of FORMATS as values from 0 to 255, or as floats.

    BC1, BC3, BC4 and BC5 are decoded after their definitions, BC6H and BC7 by OpenImageIO.
    """
    if name.startswith(("BC6H", "BC7")):
        return _decoded_by_openimageio(data, name, width, height)
    is_rgb = name.startswith("BC1_RGB")
    name = name[:3]
    rows, columns = (height + 3) // 4, (width + 3) // 4
    blocks = np.frombuffer(data, np.uint8).reshape(rows * columns, -1)
    if name == "BC1":
        texels = _decoded_colors(blocks, has_cut_out=True)
        if is_rgb:
            assert np.all(texels[..., 3] == 255)
            texels = texels[..., :3]
    elif name == "BC3":
        texels = _decoded_colors(blocks[:, 8:], has_cut_out=False)
        texels[..., 3] = _decoded_channel(blocks[:, :8])
    else:
        halves = np.split(blocks, {"BC4": 1, "BC5": 2}[name], axis=1)
        texels = np.stack([_decoded_channel(half) for half in halves], axis=2)
    texels = texels.reshape(rows, columns, 4, 4, -1).swapaxes(1, 2)
    return texels.reshape(4 * rows, 4 * columns, -1)[:height, :width]


def _decoded_by_openimageio(data: bytes, name: str, width: int, height: int) -> np.ndarray:
    oiio = pytest.importorskip("OpenImageIO", reason="nothing decodes BC6H and BC7")
    dxgi, _, channels, _, _, _ = FORMATS[name]
    file = b"DDS " + struct.pack("<7I44x", 124, 0x81007, height, width, len(data), 0, 1)
    file += struct.pack("<2I4s20x", 32, 4, b"DX10") + struct.pack("<I16x", 0x1000)
    file += struct.pack("<5I", dxgi, 3, 0, 1, 0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "level.dds"
        path.write_bytes(file + data)
        config = oiio.ImageSpec()
        config.attribute("oiio:UnassociatedAlpha", 1)
        image = oiio.ImageInput.open(str(path), config)
        if image is None:
            pytest.skip("OpenImageIO is too old for BC6H and BC7")
        texels = image.read_image("float" if name.startswith("BC6H") else "uint8")
        image.close()
    texels = np.asarray(texels).astype(float).reshape(height, width, -1)
    assert texels.shape[2] == channels
    return texels


def _decoded_colors(blocks: np.ndarray, *, has_cut_out: bool) -> np.ndarray:
    words = np.ascontiguousarray(blocks[:, :4]).view("<u2").astype(int)
    ends = np.stack(
        [(words >> 11) * 255 / 31, (words >> 5 & 63) * 255 / 63, (words & 31) * 255 / 31], axis=2
    )
    first, second = ends[:, 0], ends[:, 1]
    colors = np.full((len(blocks), 4, 4), 255.0)
    colors[:, 0, :3], colors[:, 1, :3] = first, second
    colors[:, 2, :3], colors[:, 3, :3] = (2 * first + second) / 3, (first + 2 * second) / 3
    if has_cut_out:
        three = words[:, 0] <= words[:, 1]
        colors[three, 2, :3] = ((first + second) / 2)[three]
        colors[three, 3] = 0
    bits = np.ascontiguousarray(blocks[:, 4:8]).view("<u4")
    index = bits >> 2 * np.arange(16) & 3
    return np.take_along_axis(colors, index[..., None].astype(int), axis=1)


def _decoded_channel(blocks: np.ndarray) -> np.ndarray:
    low, high = blocks[:, :1].astype(float), blocks[:, 1:2].astype(float)
    six, four = np.arange(1, 7) / 7, np.arange(1, 5) / 5
    eight_values = np.hstack([low, high, low + (high - low) * six])
    limits = np.broadcast_to([0.0, 255.0], (len(blocks), 2))
    six_values = np.hstack([low, high, low + (high - low) * four, limits])
    values = np.where(low > high, eight_values, six_values)
    padded = np.zeros((len(blocks), 8), np.uint8)
    padded[:, :6] = blocks[:, 2:8]
    index = padded.view("<u8") >> np.arange(0, 48, 3, dtype=np.uint64) & 7
    return np.take_along_axis(values, index.astype(int), axis=1)
