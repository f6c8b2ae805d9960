# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes a ship of tiny parts for bench/textures/opengl.py: a hull, and boxes all over it.

Usage: python3 bench/textures/tiny_parts.py [--folder FOLDER]

Each face of each box is a chart of its own, and the charts of the atlas are two texels apart.
Leaves FOLDER/ship.npz, as bench/textures/opengl_models.py leaves others.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Texels = NDArray[np.float32]

FOLDER = Path(__file__).resolve().parents[2] / "build/opengl"
SIZE = 2048
GAP = 2
TEXELS_PER_METER = 11
PARTS = 320
LENGTH, WIDTH, DEPTH = 100.0, 14.0, 8.0
BACKGROUND = (0.02, 0.02, 0.02)
PALETTE = ((0.45, 0.47, 0.5), (0.75, 0.75, 0.72), (0.3, 0.05, 0.03), (0.12, 0.14, 0.17))


@dataclass(frozen=True)
class Face:
    """A quadrilateral (4, 3), its sides in texels, and its color."""

    corners: Floats
    width: int
    height: int
    color: tuple[float, float, float]


def main(folder: Path) -> None:
    """Writes the ship."""
    random = np.random.default_rng(7)
    faces = [face for box in boxes(random) for face in faces_of(*box)]
    faces.sort(key=lambda face: -face.height)
    image = np.broadcast_to(np.array(BACKGROUND, np.float32), (SIZE, SIZE, 3)).copy()
    corners, uvs = [], []
    for face, (x, y) in zip(faces, packed(faces), strict=True):
        image[y : y + face.height, x : x + face.width] = drawn(face, random)
        ends = np.array([[0, 0], [face.width, 0], [face.width, face.height], [0, face.height]])
        quad = (ends + np.array([x, y])) / SIZE
        for three in ([0, 1, 2], [0, 2, 3]):
            corners.append(face.corners[three])
            uvs.append(quad[three])
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(
        folder / "ship.npz",
        names=["ship"],
        wraps=["clamp"],
        corners=np.array(corners),
        uvs=np.array(uvs),
        used=np.zeros(len(corners), int),
        image_0=image,
    )
    sides = np.median([(face.width, face.height) for face in faces], axis=0)
    print(f"ship.npz: {len(faces)} charts, half of them at most {sides[0]:.0f} x {sides[1]:.0f}")


def boxes(random: np.random.Generator) -> list[tuple[Floats, Floats, tuple[float, float, float]]]:
    """Returns centers, sides and colors: slices of the hull, and parts on its deck."""
    found = []
    slices = 20
    for k in range(slices):
        x = (k + 0.5) / slices - 0.5
        # Toward bow and stern it narrows.
        width = WIDTH * (1 - (2 * abs(x)) ** 3 * 0.8)
        found.append(
            (
                np.array([x * LENGTH, 0, -DEPTH / 2]),
                np.array([LENGTH / slices, width, DEPTH]),
                PALETTE[2] if k % 7 == 3 else PALETTE[0],
            )
        )
    for _ in range(PARTS):
        x = random.normal(0, 0.2)
        x = np.clip(x, -0.45, 0.45)
        side = np.exp(random.normal(0.6, 0.5, 3)).clip(0.6, 7)
        room = WIDTH * (1 - (2 * abs(x)) ** 3 * 0.8) / 2
        # The highest stand amidships.
        side[2] += random.exponential(7 * np.exp(-((x / 0.15) ** 2)))
        center = np.array([x * LENGTH, random.uniform(-room, room), side[2] / 2])
        found.append((center, side, PALETTE[random.integers(len(PALETTE))]))
    return found


def faces_of(center: Floats, sides: Floats, color: tuple[float, float, float]) -> list[Face]:
    """Returns the faces of a box without its bottom, seen from outside."""
    faces = []
    for axis, sign in ((0, -1), (0, 1), (1, -1), (1, 1), (2, 1)):
        along, up = ((1, 2), (0, 2), (0, 1))[axis]
        quad = np.zeros((4, 3))
        quad[:, axis] = sign
        quad[:, along] = [-1, 1, 1, -1]
        quad[:, up] = [-1, -1, 1, 1]
        texels = [max(2, round(sides[k] * TEXELS_PER_METER)) for k in (along, up)]
        faces.append(Face(center + quad * sides / 2, *texels, color))
    return faces


def packed(faces: list[Face]) -> list[tuple[int, int]]:
    """Returns where the corners of charts lie, in rows, of faces from high to low."""
    places = []
    x, y, row = GAP, GAP, 0
    for face in faces:
        if x + face.width + GAP > SIZE:
            x, y, row = GAP, y + row + GAP, 0
        row = max(row, face.height)
        places.append((x, y))
        x += face.width + GAP
        if y + row + GAP > SIZE:
            raise ValueError(f"the charts do not fit in {SIZE} x {SIZE} texels")
    return places


def drawn(face: Face, random: np.random.Generator) -> Texels:
    """Returns plates with seams, portholes and stains."""
    shape = (face.height, face.width, 1)
    plates = random.normal(0, 0.15, (face.height // 12 + 1, face.width // 12 + 1, 1))
    plates = plates.repeat(12, 0).repeat(12, 1)[: face.height, : face.width]
    color = np.array(face.color) * np.exp(plates + random.normal(0, 0.12, shape))
    row, column = np.indices(shape[:2])
    color[(row % 12 == 0) | (column % 12 == 0)] *= 0.35
    if min(shape[:2]) > 14 and random.random() < 0.5:
        ports = (row % 12 - 6) ** 2 + (column % 12 - 6) ** 2 < 8
        color[ports] = (0.9, 0.8, 0.5) if random.random() < 0.4 else (0.01, 0.01, 0.02)
    if random.random() < 0.15:
        color[(row + column) % 10 < 5] = (0.85, 0.75, 0.05)
    return color.clip(0, 1).astype(np.float32)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, default=FOLDER, help="(default: %(default)s)")
    main(parser.parse_args().folder)
