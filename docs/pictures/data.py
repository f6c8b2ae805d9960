# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the pictures of docs/data.md, and prints their figures.

usage: python3 data.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/cutout.png and FOLDER/lobes.png.
"""

import sys
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray
from PIL import Image
from sheets import PAPER, encoded, sheet

Array = NDArray[np.float64]

THRESHOLD = 0.5
CUTOUT_LEVELS = (0, 2, 3, 4, 5)
CUTOUT_CELL = 240
BALL = 300
BALL_LEVEL = 4
BALL_TILES = 32  # Around half of the ball.


def main(folder: Path) -> None:
    """Makes both pictures."""
    cutout().save(folder / "cutout.png")
    lobes().save(folder / "lobes.png")


def cutout() -> Image.Image:
    """A twig after the alpha test, by levels without and with preserved coverage."""
    ordinary = prefilter.mipmaps(twig(512).astype(np.float32), card())
    rows = {
        "ordinary levels": ordinary,
        "coverage kept": prefilter.keep_coverage(ordinary, card(), threshold=THRESHOLD),
    }
    cells = []
    for title, levels in rows.items():
        for number in CUTOUT_LEVELS:
            shown, share = tested(levels[number])
            print(f"{title}, level {number}: {100 * share:.1f} % shown")
            cells.append((shown, f"{title if number else 'image'}, level {number}: {share:.1%}"))
    return sheet(cells, len(CUTOUT_LEVELS))


def card() -> prefilter.Surface:
    """A card that shows the whole image."""
    positions = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    uvs = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], float)
    return prefilter.Surface(positions, np.array([(0, 1, 2), (0, 2, 3)]), uvs)


def twig(size: int) -> Array:
    """Straight RGBA of thin leaves along curved stems; magenta elsewhere."""
    random = np.random.default_rng(5)
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    alpha, shade = np.zeros((size, size)), np.zeros((size, size))
    for x0, lean in ((0.5, 0.0), (0.35, -0.5), (0.65, 0.5)):
        for at in np.linspace(0.08, 0.95, 19):
            x = x0 + lean * at**1.5 * 0.6
            alpha = np.maximum(alpha, blade(u, v, (x, at), 0.05, 0.003, np.pi / 2, size))
            for side in (-1, 1):
                turn = np.pi / 2 - side * random.uniform(0.7, 1.2)
                length = random.uniform(0.05, 0.11) * (1.15 - at)
                center = (x + length * np.cos(turn), at + length * np.sin(turn))
                leaf = blade(u, v, center, length, 0.13 * length, turn, size)
                alpha = np.maximum(alpha, leaf)
                shade = np.where(leaf > 0, random.uniform(0.6, 1.0), shade)
    image = np.zeros((size, size, 4))
    image[...] = (0.8, 0.0, 0.8, 0.0)
    green = np.stack([0.10 + 0.12 * shade, 0.16 + 0.24 * shade, 0.05 + 0.03 * shade], axis=2)
    image[alpha > 0, :3] = green[alpha > 0]
    image[..., 3] = alpha
    return image


def blade(
    u: Array, v: Array, center: tuple[float, float], length: float, width: float, turn: float,
    size: int,
) -> Array:  # fmt: skip
    """The alpha of a leaf pointed at both ends, over a texel from 0 to 1."""
    x, y = u - center[0], v - center[1]
    along = (x * np.cos(turn) + y * np.sin(turn)) / length
    across = np.abs(-x * np.sin(turn) + y * np.cos(turn))
    return np.clip((width * (1 - along**2) - across) * size + 0.5, 0, 1) * (np.abs(along) < 1)


def tested(level: NDArray[np.float32]) -> tuple[Array, float]:
    """The result of an alpha test of bilinear lookups, sRGB from the top, and its coverage."""
    samples = 4
    at = (np.arange(CUTOUT_CELL * samples) + 0.5) / (CUTOUT_CELL * samples)
    u, v = np.meshgrid(at, at)
    found = bilinear(level, np.stack([u, v], axis=2))
    shown = found[..., 3:] >= THRESHOLD
    color = np.where(shown, found[..., :3], (np.array(PAPER) / 255) ** 2.2)
    blocks = color.reshape(CUTOUT_CELL, samples, CUTOUT_CELL, samples, 3).mean((1, 3))
    return encoded(blocks)[::-1], float(shown.mean())


def lobes() -> Image.Image:
    """A ball with bumps: every texel shaded, a level of the normals alone, and with roughness."""
    normals = bumps(256)
    rough = np.full((256, 256, 1), 0.25, np.float32)
    levels, rougher = prefilter.normal_mipmaps(normals, card(), roughness=rough, wrap="repeat")
    truth = ball(normals, rough, samples=16)
    views = {
        "every texel, 256 a pixel": truth,
        f"level {BALL_LEVEL}, normals only": ball(levels[BALL_LEVEL], rough, samples=1),
        f"level {BALL_LEVEL}, with roughness": ball(
            levels[BALL_LEVEL], rougher[BALL_LEVEL], samples=1
        ),
    }
    y, x = np.mgrid[:BALL, :BALL] * 2.08 / BALL - 1.04
    within = x**2 + y**2 < 0.95
    cells = []
    for title, light in views.items():
        error = np.sqrt(((light - truth)[within] ** 2).mean())
        print(f"{title}: RMSE {error:.4f}")
        note = title if light is truth else f"{title}: RMSE {error:.3f}"
        cells.append((encoded(np.repeat(light[::-1, :, None], 3, axis=2)), note))
    return sheet(cells, len(cells))


def bumps(size: int) -> NDArray[np.float32]:
    """An encoded, tileable normal map of round dents."""
    random = np.random.default_rng(3)
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    height = np.zeros((size, size))
    for x, y, radius in random.uniform((0, 0, 0.012), (1, 1, 0.035), (2000, 3)):
        du, dv = (u - x + 0.5) % 1 - 0.5, (v - y + 0.5) % 1 - 0.5
        height -= 0.15 * radius * np.exp(-(du**2 + dv**2) / (0.5 * radius) ** 2)
    slopes = [(np.roll(height, 1, axis) - np.roll(height, -1, axis)) * size / 2 for axis in (1, 0)]
    vectors = unit(np.stack([*slopes, np.ones((size, size))], axis=2))
    return ((vectors + 1) / 2).astype(np.float32)


def ball(normals: NDArray[np.float32], rough: NDArray[np.float32], *, samples: int) -> Array:
    """The light of a lamp that a ball reflects (GGX, height-correlated masking), each pixel."""
    light = np.zeros((BALL, BALL))
    to_lamp, to_eye = unit(np.array([-0.5, 0.6, 0.8])), np.array([0.0, 0.0, 1.0])
    middle = unit(to_lamp + to_eye)
    for j, i in np.ndindex(samples, samples):
        offset = (np.array([i, j]) + 0.5) / samples
        y, x = (np.mgrid[:BALL, :BALL] + offset[1 - np.arange(2)][:, None, None]) / BALL
        x, y = 2.08 * x - 1.04, 2.08 * y - 1.04
        inside = x**2 + y**2 < 0.999
        z = np.sqrt(np.where(inside, 1 - x**2 - y**2, 1))
        up = np.stack([x, y, z], axis=2)
        longitude, latitude = np.arctan2(x, z), np.arcsin(np.clip(y, -1, 1))
        uvs = np.stack([longitude, latitude], axis=2) * BALL_TILES / np.pi
        right = unit(np.stack([z, np.zeros_like(x), -x], axis=2))
        bump = unit(2 * bilinear(normals, uvs % 1, wrap=True) - 1)
        alpha2 = bilinear(rough, uvs % 1, wrap=True)[..., 0] ** 4
        normal = bump[..., :1] * right + bump[..., 1:2] * np.cross(up, right) + bump[..., 2:] * up
        to_light = np.clip(normal @ to_lamp, 1e-4, 1)
        to_view = np.clip(normal @ to_eye, 1e-4, 1)
        density = alpha2 / (np.pi * (np.clip(normal @ middle, 0, 1) ** 2 * (alpha2 - 1) + 1) ** 2)
        masking = to_light * np.sqrt(to_view**2 * (1 - alpha2) + alpha2)
        masking += to_view * np.sqrt(to_light**2 * (1 - alpha2) + alpha2)
        gloss = 0.04 * density * 0.5 / masking
        light += np.where(inside, (0.06 + gloss) * to_light * 2.5, 0.924)
    return light / samples**2


def bilinear(texels: NDArray[np.float32], uvs: Array, *, wrap: bool = False) -> Array:
    """Bilinear lookups, clamped or wrapped."""
    sides = np.array(texels.shape[1::-1])
    at = uvs * sides - 0.5
    low = np.floor(at).astype(int)
    share = at - low

    def read(dx: int, dy: int) -> Array:
        index = low + np.array((dx, dy))
        index = index % sides if wrap else np.clip(index, 0, sides - 1)
        return texels[index[..., 1], index[..., 0]].astype(float)

    s, t = share[..., :1], share[..., 1:]
    return ((1 - s) * read(0, 0) + s * read(1, 0)) * (1 - t) + (
        (1 - s) * read(0, 1) + s * read(1, 1)
    ) * t


def unit(vectors: Array) -> Array:
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


main(Path(sys.argv[1]))
