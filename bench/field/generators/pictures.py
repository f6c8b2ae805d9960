# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures with each orientation, profile, depth and number of channels."""

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

_ORIENTATION = 274
_D50 = (0.9642, 1.0, 0.8249)
_PRIMARIES = {
    # Columns are XYZ of red, green and blue, adapted to D50, and the exponent of the curve.
    "Adobe RGB": (((0.60974, 0.31111, 0.01947), (0.20528, 0.62567, 0.06087),
                   (0.14919, 0.06322, 0.74457)), 2.19921875),
    "Display P3": (((0.51512, 0.24120, -0.00105), (0.29198, 0.69225, 0.04189),
                    (0.15710, 0.06657, 0.78407)), 2.2),
}  # fmt: skip


def write(stem: Path, random: np.random.Generator) -> Mapping[str, Any]:
    """Writes a picture as PNG, JPEG or TIFF."""
    size = int(random.choice([64, 60, 33])), int(random.choice([64, 40, 95]))
    mode = str(random.choice(["RGB", "RGB", "RGBA", "L", "LA", "P", "L16", "RGB16"]))
    extension = str(random.choice([".png", ".png", ".jpg", ".tif"]))
    if extension == ".jpg" and mode not in ("RGB", "L"):
        mode = "RGB"
    values = _values(size, random)
    options: dict[str, Any] = {}
    if random.random() < 0.4:
        exif = Image.Exif()
        exif[_ORIENTATION] = int(random.integers(1, 9))
        options["exif"] = exif
    if mode in ("RGB", "RGBA") and random.random() < 0.5:
        name = str(random.choice(sorted(_PRIMARIES)))
        options["icc_profile"] = matrix_profile(name)
    path = stem.with_suffix(extension)
    if mode == "RGB16":
        path = stem.with_suffix(".png")
        _write_png16(path, values)
        return {"must_work": True, "made": mode}
    _image(values, mode).save(path, **options, **({"quality": 95} if extension == ".jpg" else {}))
    # Colors outside of sRGB may be refused where a file cannot hold them.
    must_work = "icc_profile" not in options
    return {"must_work": must_work, "made": f"{mode}, {', '.join(options) or 'plain'}"}


def _values(size: tuple[int, int], random: np.random.Generator) -> NDArray[np.float64]:
    """Returns smooth colors that differ at each corner, and alpha, (h, w, 4) from 0 to 1."""
    width, height = size
    y, x = np.mgrid[:height, :width]
    u, v = x / (width - 1), y / (height - 1)
    corners = random.random((4, 3))
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=2)
    alpha = 0.25 + 0.75 * u
    return np.concatenate([weights @ corners, alpha[..., None]], axis=2)


def _image(values: NDArray[np.float64], mode: str) -> Image.Image:
    rgba = Image.fromarray(np.uint8(np.rint(255 * values)))
    if mode == "L16":
        return Image.fromarray(np.uint16(np.rint(65535 * values[..., 0])))
    if mode == "P":
        return rgba.convert("RGB").quantize(64)
    if mode == "LA":
        alpha = rgba.getchannel("A")
        gray = rgba.convert("L")
        return Image.merge("LA", (gray, alpha))
    return rgba.convert("RGB").convert(mode) if mode != "RGBA" else rgba


def _write_png16(path: Path, values: NDArray[np.float64]) -> None:
    """Writes 16 bits a channel, which Pillow does not."""
    import zlib

    pixels = np.rint(65535 * values[..., :3]).astype(">u2")
    height, width = pixels.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows)),
        (b"IEND", b""),
    ]
    with path.open("wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, body in chunks:
            crc = struct.pack(">I", zlib.crc32(name + body))
            file.write(struct.pack(">I", len(body)) + name + body + crc)


def matrix_profile(name: str) -> bytes:
    """Returns an ICC profile, version 2.1, of primaries and an exponent (ICC.1:2001-04)."""
    primaries, exponent = _PRIMARIES[name]
    text = name.encode() + b"\0"
    curve = b"curv\0\0\0\0" + struct.pack(">IH", 1, round(exponent * 256))
    tags = {
        b"desc": b"desc\0\0\0\0" + struct.pack(">I", len(text)) + text + bytes(78),
        b"cprt": b"text\0\0\0\0none\0",
        b"wtpt": _xyz(_D50),
        **{key: _xyz(xyz) for key, xyz in zip((b"rXYZ", b"gXYZ", b"bXYZ"), primaries, strict=True)},
        **dict.fromkeys((b"rTRC", b"gTRC", b"bTRC"), curve),
    }
    offset, table, body = 128 + 4 + 12 * len(tags), b"", b""
    for key, data in tags.items():
        data += bytes(-len(data) % 4)
        table += key + struct.pack(">II", offset + len(body), len(data))
        body += data
    size = offset + len(body)
    header = struct.pack(">I4sI4s4s4s", size, b"\0\0\0\0", 0x02100000, b"mntr", b"RGB ", b"XYZ ")
    header += struct.pack(">6H", 2026, 1, 1, 0, 0, 0) + b"acsp" + bytes(28)
    header += b"".join(struct.pack(">i", round(65536 * value)) for value in _D50)
    return header.ljust(128, b"\0") + struct.pack(">I", len(tags)) + table + body


def _xyz(values: tuple[float, ...]) -> bytes:
    return b"XYZ \0\0\0\0" + b"".join(struct.pack(">i", round(65536 * value)) for value in values)
