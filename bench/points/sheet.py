# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws surfaces side by side: a row a set, a column per folder of results.

python3 -m bench.points.sheet TARGET.png FOLDER... [--sets NAME...] [--depth N] [--zoom X Y F]

FOLDERs have files "SET, DEPTH.ply", as real.py leaves them. All of a row are seen from the same
side; backs of faces are red. Prints which set each row is.
"""

import argparse
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.points import ply
from bench.points.sets import Model

SIZE = 520  # Pixels of a picture.
SAMPLES = 10  # Per pixel, if the surface were a square that fills the picture.
FRONT, BACK, PAPER = np.array([0.80, 0.81, 0.84]), np.array([0.86, 0.27, 0.22]), 1.0
VIEW = (0.45, 0.35, 0.82)  # Toward the eye.
UP = (0.0, 1.0, 0.0)
LIGHT = (0.3, 0.7, 0.65)
AMBIENT = 0.25
Floats = NDArray[np.float64]


def frame_of(view: Sequence[float], up: Sequence[float]) -> Floats:
    """Returns rows: right, up, toward the eye."""
    toward = np.array(view) / np.linalg.norm(view)
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), toward])


def window(path: Path, frame: Floats, zoom: Sequence[float]) -> tuple[Floats, float]:
    """Returns the center of the visible part, and half of its side."""
    placed = ply.read_mesh(path).positions @ frame.T
    low, high = np.percentile(placed, (0.1, 99.9), axis=0)[:, :2]
    half = (high - low).max() / 2 * 1.05
    return (low + high) / 2 + half * np.array(zoom[:2]), half / zoom[2]


def picture(path: Path, frame: Floats, middle: Floats, half: float) -> Floats:
    """Draws a surface by many samples, of which the nearest counts."""
    model = Model.of(ply.read_mesh(path))
    pixels = np.full((SIZE * SIZE, 3), PAPER)
    if not len(model.sums) or not model.sums[-1]:
        return pixels.reshape(SIZE, SIZE, 3)
    density = SAMPLES * (SIZE / (2 * half)) ** 2
    placed = [model.mesh.positions[model.mesh.triangles] @ frame.T]
    corners = placed[0][..., :2]
    seen = ((corners.max(axis=1) > middle - half) & (corners.min(axis=1) < middle + half)).all(
        axis=1
    )
    areas = np.diff(model.sums, prepend=0) * seen
    random = np.random.default_rng(0)
    counts = np.floor(areas * density + random.random(len(areas))).astype(np.int64)
    depths = np.full(SIZE * SIZE, -np.inf)
    light = np.array(LIGHT) / np.linalg.norm(LIGHT)
    for chosen in np.array_split(np.flatnonzero(counts), max(1, counts.sum() // 2_000_000)):
        found = np.repeat(chosen, counts[chosen])
        a, b, c = np.moveaxis(placed[0][found], 1, 0)
        root, share = np.sqrt(random.random((len(found), 1))), random.random((len(found), 1))
        points = (1 - root) * a + root * ((1 - share) * b + share * c)
        spot = np.floor((points[:, :2] - middle + half) / (2 * half) * SIZE).astype(np.int64)
        inside = ((spot >= 0) & (spot < SIZE)).all(axis=1)
        number = (SIZE - 1 - spot[:, 1]) * SIZE + spot[:, 0]
        order = np.flatnonzero(inside)[np.argsort(points[inside, 2], kind="stable")]
        order = order[points[order, 2] > depths[number[order]]]
        normals = model.normals[found[order]] @ frame.T
        toward = np.abs(normals[:, 2:] * 0.5 + (normals @ light)[:, None] * 0.5)
        shade = AMBIENT + (1 - AMBIENT) * toward
        colors = np.where(normals[:, 2:] >= 0, FRONT, BACK) * shade
        pixels[number[order]], depths[number[order]] = colors, points[order, 2]
    return pixels.reshape(SIZE, SIZE, 3)


def write_png(path: Path, pixels: Floats) -> None:
    """Writes colors from 0 to 1."""
    rows = np.round(255 * np.clip(pixels, 0, 1)).astype(np.uint8)
    high, wide = rows.shape[:2]
    data = np.concatenate([np.zeros((high, 1), np.uint8), rows.reshape(high, -1)], axis=1)
    parts = [
        (b"IHDR", struct.pack(">IIBBBBB", wide, high, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(data.tobytes(), 6)),
        (b"IEND", b""),
    ]
    with path.open("wb") as stream:
        stream.write(b"\x89PNG\r\n\x1a\n")
        for kind, body in parts:
            check = struct.pack(">I", zlib.crc32(kind + body))
            stream.write(struct.pack(">I", len(body)) + kind + body + check)


def main() -> None:
    """Draws the sets that all folders have."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("target", type=Path)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--sets", nargs="+", default=[])
    parser.add_argument("--depth", type=int, default=0, help="0: any")
    parser.add_argument("--view", type=float, nargs=3, default=VIEW, help="toward the eye")
    parser.add_argument("--up", type=float, nargs=3, default=UP)
    parser.add_argument("--zoom", type=float, nargs=3, default=(0, 0, 1), metavar=("X", "Y", "F"))
    parser.add_argument("--columns", type=int, default=1, help="rows of sets side by side")
    options = parser.parse_args()
    last = options.folders[-1]
    files = sorted(path.name for path in last.glob(f"*, {options.depth or '*'}.ply"))
    if options.sets:
        files = [file for name in options.sets for file in files if file.split(",")[0] == name]
    frame = frame_of(options.view, options.up)
    rows = []
    for file in files:
        middle, half = window(last / file, frame, options.zoom)
        paths = [folder / file for folder in options.folders]
        rows.append(np.hstack([picture(path, frame, middle, half) for path in paths]))
        print(file.removesuffix(".ply"), flush=True)
    while len(rows) % options.columns:
        rows.append(np.full_like(rows[0], PAPER))
    lines = [rows[k : k + options.columns] for k in range(0, len(rows), options.columns)]
    write_png(options.target, np.vstack([np.hstack(row) for row in lines]))


if __name__ == "__main__":
    main()
