# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the error that block compression adds to levels, on a model with one texture.

Usage: python3 bench/textures/block_formats.py MODEL.obj TEXTURE    (with the package importable)

prefilter.write_dds writes the files, and OpenImageIO (2.5 or later) reads them. Errors are in
scene-linear values over the surface, by prefilter.mipmap_error; and in steps of 8 bits over the
texels of level 0.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

Bytes = NDArray[np.uint8]

FORMATS = ("rgba8", "bc7", "bc3", "bc1")
LEVELS = range(7)


def read_obj(path: Path) -> prefilter.Surface:
    """Reads a triangle mesh with UVs."""
    positions, uvs, corners = [], [], []
    for line in path.read_text().splitlines():
        kind, *values = line.split() or [""]
        if kind == "v":
            positions.append([float(value) for value in values[:3]])
        elif kind == "vt":
            uvs.append([float(value) for value in values[:2]])
        elif kind == "f":
            assert len(values) == 3, "triangles only"
            corners.append([[int(index) - 1 for index in v.split("/")[:2]] for v in values])
    indices = np.array(corners)
    return prefilter.Surface(np.array(positions), indices[..., 0], np.array(uvs)[indices[..., 1]])


def as_read(levels: list[Bytes], texture_format: str) -> tuple[list[Bytes], int]:
    """Writes levels and reads them back; returns them, and the file's size."""
    read = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "levels.dds"
        prefilter.write_dds(path, levels, format=texture_format, encoding="srgb")
        size = path.stat().st_size
        file = oiio.ImageInput.open(str(path))
        for number in range(len(levels)):
            assert file.seek_subimage(0, number)
            read.append(np.asarray(file.read_image("uint8"))[::-1, :, :3].copy())
    return read, size


def main() -> None:
    """Measures each filter and format."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("texture", type=Path)
    add_json_option(parser)
    options = parser.parse_args()
    surface = read_obj(options.model)
    texture = oiio.ImageBuf(str(options.texture)).get_pixels("uint8")[::-1, :, :3].copy()
    linear = prefilter.to_linear(texture / np.float32(255))
    rows = []
    for name in ("box", "lanczos3", "pam-bilinear"):
        levels = prefilter.mipmaps(texture, surface, filter=name, encoding="srgb")
        for texture_format in FORMATS:
            found, size = as_read(levels, texture_format)
            steps = np.sqrt(np.mean((found[0].astype(float) - levels[0]) ** 2))
            values = [prefilter.to_linear(level / np.float32(255)) for level in found]
            errors = prefilter.mipmap_error(values, linear, surface, list(LEVELS))
            cells = [name, texture_format, f"{size // 1024}", f"{steps:.2f}"]
            rows.append([*cells, *(f"{error:.4f}" for error in errors)])
    head = ["filter", "format", "KiB", "steps", *(f"level {level}" for level in LEVELS)]
    report = Report()
    report.table(f"{options.model.stem} in block formats", head, rows, "errors")
    report.write(options.json)


if __name__ == "__main__":
    main()
