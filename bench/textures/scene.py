# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the picture and the mesh that programs are compared on.

usage: scene.py FOLDER [--spot SPOT] [--triangles N], where SPOT is the folder of the model spot;
without it both are made, the mesh with about N triangles.

Leaves in FOLDER: picture.png (1024 x 1024, 8-bit RGBA), linear.npy (the same as scene-linear
floats, row 0 at the bottom), mesh.npz (the arguments of prefilter.Surface) and mesh.bin (the same:
counts of vertices and triangles, positions, triangles and UVs, 64 bits each).
"""

import argparse
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import prefilter
from numpy.typing import NDArray

SIZE = 1024
CHARTS = 8  # Along each axis.


def main(folder: Path, spot: Path | None, triangles: int) -> None:
    """Writes the files."""
    if spot is None:
        pixels, mesh = made_picture(), made_mesh(max(1, round((triangles / 2) ** 0.5 / CHARTS)))
    else:
        pixels = read_rgba(spot / "spot_texture.png")
        mesh = read_obj(spot / "spot_triangulated.obj")
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 4, "uint8")
    output = oiio.ImageOutput.create(str(folder / "picture.png"))
    if not (output.open(str(folder / "picture.png"), spec) and output.write_image(pixels)):
        raise OSError(output.geterror())
    output.close()
    values = pixels[::-1].astype(np.float32) / 255
    np.save(folder / "linear.npy", np.ascontiguousarray(prefilter.to_linear(values)))
    np.savez(folder / "mesh.npz", **mesh)
    with (folder / "mesh.bin").open("wb") as file:
        np.array([len(mesh["positions"]), len(mesh["triangles"])], np.int64).tofile(file)
        for key, kind in (("positions", float), ("triangles", np.int64), ("uvs", float)):
            mesh[key].astype(kind).tofile(file)
    height, width = pixels.shape[:2]
    print(f"{width} x {height} RGBA, {len(mesh['triangles'])} triangles")


def read_rgba(path: Path) -> NDArray[np.uint8]:
    """Reads a picture's bytes, with an alpha of 255 where it has none."""
    source = oiio.ImageBuf(str(path))
    pixels = source.get_pixels("uint8")
    if source.has_error:
        raise OSError(source.geterror())
    opaque = np.full((*pixels.shape[:2], 1), 255, np.uint8)
    return np.concatenate([pixels[..., :3], pixels[..., 3:4] if pixels.shape[2] > 3 else opaque], 2)


def read_obj(path: Path) -> dict[str, NDArray]:
    """Reads the triangles of an OBJ whose faces are `f v/vt v/vt v/vt`.

    Blender's importer is not needed for that, and Blender would be in the memory that is measured.
    """
    rows: dict[str, list] = {"v": [], "vt": [], "f": []}
    for line in path.read_text().splitlines():
        kind, *fields = line.split() or [""]
        if kind in ("v", "vt"):
            rows[kind].append([float(x) for x in fields])
        elif kind == "f":
            rows[kind].append([[int(i) - 1 for i in field.split("/")[:2]] for field in fields])
    faces = np.array(rows["f"])
    return {
        "positions": np.array(rows["v"]),
        "triangles": np.ascontiguousarray(faces[..., 0]),
        "uvs": np.array(rows["vt"])[faces[..., 1], :2],
    }


def made_picture() -> NDArray[np.uint8]:
    """Returns noise at every scale, so that no level is flat."""
    random = np.random.default_rng(1)
    total, scales = np.zeros((SIZE, SIZE, 3)), int(np.log2(SIZE)) - 1
    for scale in range(scales):
        block = 1 << scale
        noise = random.random((SIZE // block, SIZE // block, 3)) - 0.5
        total += noise.repeat(block, axis=0).repeat(block, axis=1)
    colors = np.clip(0.5 + total / np.sqrt(scales), 0, 1)
    alpha = np.ones((SIZE, SIZE, 1))
    return np.round(255 * np.concatenate([colors, alpha], axis=2)).astype(np.uint8)


def made_mesh(quads: int) -> dict[str, NDArray]:
    """Returns charts of `quads` x `quads`, of different scales, which cover half of the texture."""
    random = np.random.default_rng(2)
    side = np.linspace(-0.5, 0.5, quads + 1)
    s, t = (axis.ravel() for axis in np.meshgrid(side, side))
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    quad = first[:, None] + [0, 1, quads + 2, quads + 1]
    local = np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    positions, triangles, uvs = [], [], []
    for chart in range(CHARTS**2):
        angle, scale = random.uniform(0, 2 * np.pi), 2 ** random.uniform(-1, 1)
        turned = np.stack(
            [np.cos(angle) * s - np.sin(angle) * t, np.sin(angle) * s + np.cos(angle) * t]
        )
        center = (np.array(divmod(chart, CHARTS)) + 0.5) / CHARTS
        uv = center + turned.T * np.sqrt(0.5) / CHARTS
        triangles.append(local + chart * len(s))
        uvs.append(uv[local])
        positions.append(np.stack([scale * s, scale * t, np.full(len(s), chart)], axis=1))
    return {
        "positions": np.concatenate(positions),
        "triangles": np.concatenate(triangles),
        "uvs": np.concatenate(uvs),
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--spot", type=Path)
    parser.add_argument("--triangles", type=int, default=6272)
    options = parser.parse_args()
    main(options.folder, options.spot, options.triangles)
