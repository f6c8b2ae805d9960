# SPDX-License-Identifier: GPL-3.0-or-later

"""Lookups with numpy at random points of a surface, independent of the library."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Texels = NDArray[np.float32]

BATCH = 1 << 18
POINTS_PER_TEXEL = 8  # Along seams.
SAME_UV = 1e-6  # Modifiers round coordinates of the faces beside an edge differently.


class Taps:
    """The texels that bilinear lookups read at some points, and their weights, as on a GPU."""

    def __init__(self, points: Floats, shape: tuple[int, ...], wrap: str) -> None:
        """Takes texture coordinates (n, 2), and the shape (height, width, ...) of the image."""
        height, width = shape[:2]
        x, y = (points * (width, height) - 0.5).T
        column, row = np.floor(x).astype(int), np.floor(y).astype(int)
        s, t = x - column, y - row
        columns = [wrapped(column + dx, width, wrap) for dx in (0, 1)]
        rows = [width * wrapped(row + dy, height, wrap) for dy in (0, 1)]
        self._texels = [row + column for row in rows for column in columns]
        self._weights = [(b * a)[:, None] for b in (1 - t, t) for a in (1 - s, s)]
        self._count = height * width

    def of(self, texels: Texels) -> Floats:
        """Returns the lookups (n, channels) of an image of that shape."""
        return self.of_flat(texels.reshape(-1, texels.shape[2]))

    def of_flat(self, flat: Texels | Floats) -> Floats:
        """Returns the lookups of the texels (height * width, channels) of such an image."""
        return sum(
            w * flat.take(i, axis=0) for i, w in zip(self._texels, self._weights, strict=True)
        )

    def matrix(self) -> Floats:
        """Returns the shares (n, height * width) of all texels in the lookups: for few of them."""
        shares = np.zeros((len(self._weights[0]), self._count))
        for i, w in zip(self._texels, self._weights, strict=True):
            # At a border two taps can be one texel.
            shares[np.arange(len(i)), i] += w[:, 0]
        return shares

    def normal_equations(self, values: Floats) -> tuple[Floats, Floats]:
        """Returns the equations of the texels whose lookups are nearest to values (n, channels)."""
        taps = list(zip(self._texels, self._weights, strict=True))
        matrix = np.zeros((self._count, self._count))
        right = np.zeros((self._count, values.shape[1]))
        for i, w in taps:
            np.add.at(right, i, w * values)
            for j, v in taps:
                np.add.at(matrix, (i, j), (w * v)[:, 0])
        return matrix / len(values), right / len(values)


def lookup(texels: Texels, points: Floats, wrap: str) -> Floats:
    """Returns bilinear lookups of an image."""
    return Taps(points, texels.shape, wrap).of(texels)


def wrapped(index: NDArray[np.int64], size: int, wrap: str) -> NDArray[np.int64]:
    """Returns which texel an index along an axis reads."""
    if wrap == "repeat":
        return index % size
    if wrap == "clamp":
        return np.clip(index, 0, size - 1)
    raise ValueError(f"wrap: found '{wrap}'; the sampled check knows repeat and clamp")


def areas_of(corners: Floats) -> Floats:
    """Returns the areas of triangles (m, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def random_points(corners: Floats, uvs: Floats, count: int) -> Floats:
    """Returns texture coordinates (count, 2) of points spread evenly at random over the surface.

    `corners` are the positions (m, 3, 3) of its triangles, and `uvs` (m, 3, 2) are theirs.
    """
    random = np.random.default_rng(1)
    ends = np.cumsum(areas_of(corners))
    # One point in each of `count` equal shares of the area: less noise than free points.
    shares = (np.arange(count) + random.random(count)) / count
    chosen = np.minimum(np.searchsorted(ends, shares * ends[-1], side="right"), len(ends) - 1)
    root, s = np.sqrt(random.random(count)), random.random(count)
    weights = np.stack([1 - root, root * (1 - s), root * s], axis=1)
    return np.einsum("nk,nkd->nd", weights, uvs[chosen])


def random_mip_values(count: int, last: int) -> Floats:
    """Returns numbers spread evenly at random over [0, last], in no order."""
    random = np.random.default_rng(2)
    return last * random.permutation((np.arange(count) + random.random(count)) / count)


@dataclass(frozen=True)
class SeamLines:
    """The edges of triangles that lie at two places of the texture.

    Attributes:
        lengths: (n,) in space.
        left: (n, 2, 2) texture coordinates of the ends on one side, and `right` of the same ends
            on the other.
        right: See `left`.
        ends: (n, 2, 3) in space.
    """

    lengths: Floats
    left: Floats
    right: Floats
    ends: Floats

    def contrast(self, level: Texels, wrap: str) -> float:
        """Returns the root mean square of the difference across, over length and channels."""
        return float(np.sqrt(self.lengths @ self.squares(level, wrap) / self.lengths.sum()))

    def squares(self, level: Texels, wrap: str) -> Floats:
        """Returns the mean square (n,) of the difference across each."""
        left, right, shares, seam = self._points(level.shape)
        squares = (lookup(level, left, wrap) - lookup(level, right, wrap)) ** 2
        sums = np.bincount(seam, shares * squares.mean(axis=1), len(self.lengths))
        return sums / self.lengths

    def where(self, chosen: NDArray[np.bool_]) -> "SeamLines":
        """Returns some of them."""
        return SeamLines(
            self.lengths[chosen], self.left[chosen], self.right[chosen], self.ends[chosen]
        )

    def matrix(self, shape: tuple[int, ...], wrap: str) -> Floats:
        """Returns that whose quadratic form is the square of the contrast, for one channel."""
        left, right, shares, _ = self._points(shape)
        steps = Taps(left, shape, wrap).matrix() - Taps(right, shape, wrap).matrix()
        return steps.T @ (shares[:, None] * steps) / self.lengths.sum()

    def _points(self, shape: tuple[int, ...]) -> tuple[Floats, Floats, Floats, NDArray[np.int64]]:
        """Returns points on either side, the length that each stands for, and its seam."""
        size = np.array([shape[1], shape[0]])
        texels = [np.linalg.norm(np.diff(s * size, axis=1), axis=(1, 2)) for s in self._sides()]
        counts = np.ceil(POINTS_PER_TEXEL * np.maximum(*texels) + 1).astype(int)
        seam = np.repeat(np.arange(len(counts)), counts)
        place = np.arange(len(seam)) - np.repeat(np.cumsum(counts) - counts, counts)
        f = ((place + 0.5) / counts[seam])[:, None]
        left, right = ((1 - f) * s[seam, 0] + f * s[seam, 1] for s in self._sides())
        return left, right, (self.lengths / counts)[seam], seam

    def _sides(self) -> tuple[Floats, Floats]:
        return self.left, self.right


def seam_lines(corners: Floats, uvs: Floats, parts: NDArray[np.int64] | None = None) -> SeamLines:
    """Finds the seams of triangles (m, 3, 3) with texture coordinates (m, 3, 2).

    Corners at the same position are one, if they are of the same of the parts (m,); edges of more
    than two triangles are none.
    """
    keys = np.zeros((len(corners), 3, 4))
    keys[..., 0] = 0 if parts is None else parts[:, None]
    keys[..., 1:] = corners
    known, vertices = np.unique(keys.reshape(-1, 4), axis=0, return_inverse=True)
    vertices = vertices.reshape(-1, 3)
    edges = np.stack([vertices, np.roll(vertices, -1, axis=1)], axis=2).reshape(-1, 2)
    sides = np.stack([uvs, np.roll(uvs, -1, axis=1)], axis=2).reshape(-1, 2, 2)
    turned = edges[:, 0] > edges[:, 1]
    edges[turned], sides[turned] = edges[turned, ::-1], sides[turned, ::-1]
    real = edges[:, 0] != edges[:, 1]
    edges, sides = edges[real], sides[real]
    order = np.lexsort(edges.T)
    edges, sides = edges[order], sides[order]
    _, first, counts = np.unique(edges, axis=0, return_index=True, return_counts=True)
    # lexsort and unique order edges differently, but keep equal ones together.
    first = first[counts == 2]
    left, right = sides[first], sides[first + 1]
    apart = (np.abs(left - right) > SAME_UV).any(axis=(1, 2))
    ends = known[edges[first[apart]], 1:]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return SeamLines(lengths, left[apart], right[apart], ends)


def squared_errors(
    mipmaps: dict[str, Sequence[Texels]],
    points: Floats,
    wrap: str,
    mip_values: Floats | None = None,
    level: int = 0,
) -> dict[str, Floats]:
    """Returns the squared errors (n,) of lookups at the points, mean over the channels, by name.

    Mipmaps have level 0 first, which is the image, and the same sizes. Lookups are trilinear, at a
    mip value for each point; without these they are bilinear, of one level.
    """
    squares: dict[str, list[Floats]] = {name: [] for name in mipmaps}
    image = next(iter(mipmaps.values()))[0]
    for part, values in _batches(points, mip_values, level):
        truth = lookup(image, part, wrap)
        found = {name: np.zeros_like(truth) for name in mipmaps}
        for k in range(len(next(iter(mipmaps.values())))):
            share = np.maximum(1 - np.abs(values - k), 0)
            (near,) = np.nonzero(share)
            if len(near):
                taps = Taps(part[near], next(iter(mipmaps.values()))[k].shape, wrap)
                for name, levels in mipmaps.items():
                    found[name][near] += share[near, None] * taps.of(levels[k])
        for name in mipmaps:
            squares[name].append(((found[name] - truth) ** 2).mean(axis=1))
    return {name: np.concatenate(parts) for name, parts in squares.items()}


def _batches(
    points: Floats, mip_values: Floats | None, level: int
) -> Iterator[tuple[Floats, Floats]]:
    """Yields the points in parts that fit in memory with all that is made of them."""
    for start in range(0, len(points), BATCH):
        part = points[start : start + BATCH]
        if mip_values is None:
            yield part, np.full(len(part), float(level))
        else:
            yield part, mip_values[start : start + BATCH]
