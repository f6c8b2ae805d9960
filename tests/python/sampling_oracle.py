# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables by brute force: filters as dense arrays over the plane.

Nothing here knows inner products in closed form, orthonormal polynomials or exchanges of texels:
the integral of equation 6.3 is a sum over a fine grid of the plane, and equation 6.4 a dense system
with all coefficients of a subdomain as its unknowns.
"""

from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import combinations

import numpy as np
from kernels import KERNELS, RADII


def _form(filter, x):
    if filter == "box":
        return np.where(np.abs(x) < 0.5, 1.0, 0.0)
    return KERNELS[filter][0](x)


@cache
def _integral(filter):
    return 2 * _form(filter, (np.arange(400_000) + 0.5) / 100_000).sum() / 100_000


def kernel(filter, x):
    """The kernel at x, of integral 1."""
    return _form(filter, x) / _integral(filter)


def taps(filter, center, width, first, last):
    """The weights of texels `first` to `last` under kernels whose units are `width` texels."""
    texel = np.arange(first, last + 1)
    center, width = np.asarray(center)[..., None], np.asarray(width)[..., None]
    if filter == "box":
        low = np.maximum(texel, center - width / 2)
        weights = np.maximum(0.0, np.minimum(texel + 1, center + width / 2) - low)
    else:
        weights = kernel(filter, (texel + 0.5 - center) / np.maximum(1.0, width))
    return weights / weights.sum(axis=-1, keepdims=True)


def filter_width(levels, f):
    """The width of a sample's filter, in cells."""
    return 1.0 if levels == 1 else 2.0 ** (f - 1)


def _gauss(low, high, panels, count):
    nodes, weights = np.polynomial.legendre.leggauss(count)
    edges = np.linspace(low, high, panels + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    return (
        (middle[:, None] + half[:, None] * nodes).ravel(),
        (half[:, None] * weights).ravel(),
    )


@lru_cache(maxsize=1024)
def line(filter, levels, texels, x, f):
    """Filters of the sample and of texels (finer, index) along an axis, with weights of positions.

    For three levels the positions are quadrature nodes on the line, else the texels of level 0.
    """
    width = filter_width(levels, f)
    reach = RADII[filter]
    of_all = {texel: k for k, texel in enumerate(dict.fromkeys(texels))}
    which, texels = [of_all[texel] for texel in texels], list(of_all)
    low = min([x - reach * width] + [(i + 0.5 - reach) / 2**d for d, i in texels])
    high = max([x + reach * width] + [(i + 0.5 + reach) / 2**d for d, i in texels])
    if levels == 3:
        # Whatever the texels, their kernels are smooth between multiples of 1/16 of a cell.
        step = min(width, 1) / 2 if RADII[filter] > 0.5 else width
        own = x - reach * width + step * np.arange(round(2 * reach * width / step) + 1)
        grid = np.arange(np.floor(16 * low), np.ceil(16 * high) + 1) / 16
        edges = np.unique(np.concatenate([grid, own]))
        edges = edges[np.concatenate([[True], np.diff(edges) > 1e-12])]
        nodes, weights = np.polynomial.legendre.leggauss(2)
        half = np.diff(edges) / 2
        place = ((edges[1:] + edges[:-1])[:, None] / 2 + half[:, None] * nodes).ravel()
        sample = kernel(filter, (place - x) / width) / width
        unit, i = 2.0 ** np.array(texels)[:, :1], np.array(texels)[:, 1:]
        of_texels = kernel(filter, place * unit - i - 0.5) * unit
        return sample, of_texels[which], (half[:, None] * weights).ravel()
    first, last = int(np.floor(low * levels)) - 1, int(np.ceil(high * levels)) + 1
    sample = taps(filter, x * levels, width * levels, first, last)
    width = levels / 2.0 ** np.array(texels)[:, 0]
    of_texels = taps(filter, (np.array(texels)[:, 1] + 0.5) * width, width, first, last)
    return sample, of_texels[which], np.ones(last - first + 1)


@dataclass
class Fields:
    """The filters of a sample and of texels, over the plane."""

    sample: np.ndarray  # (y, x)
    texels: np.ndarray  # (texel, y, x)
    weights: np.ndarray  # (y, x)

    def error(self, coefficients):
        """Equation 6.3."""
        difference = self.sample - np.einsum("i,iyx->yx", coefficients, self.texels)
        return float((self.weights * difference**2).sum())


def fields(filter, levels, offsets, x, y, f):
    """The fields of the sample at (x, y, f), for texels (finer, x, y)."""
    along_x = line(filter, levels, tuple((d, i) for d, i, _ in offsets), x, f)
    along_y = line(filter, levels, tuple((d, j) for d, _, j in offsets), y, f)
    return Fields(
        np.multiply.outer(along_y[0], along_x[0]),
        along_y[1][:, :, None] * along_x[1][:, None, :],
        np.multiply.outer(along_y[2], along_x[2]),
    )


def terms(degree, x, y, f):
    """The powers that the coefficients multiply."""
    if degree == 1:
        return np.array([1, x, y, f])
    return np.array([1, x, y, f, x * x, y * y, f * f, x * y, x * f, y * f])


@dataclass(frozen=True)
class Subdomain:
    """A part of the folded cell and of the interval between levels."""

    i: int
    j: int
    slice: int
    grid: int
    slices: int
    levels: int

    def nodes(self, panels, count):
        """Places (x, y, f) in it, and their weights. Where there is one level f is xy."""
        edge = [min(k / self.grid, 0.5) for k in (self.i, self.i + 1, self.j, self.j + 1)]
        along_x = _gauss(edge[0], edge[1], panels, count)
        low, high = self.slice / self.slices, (self.slice + 1) / self.slices
        along_f = _gauss(low, high, panels, count)
        found = []
        for x, weight_x in zip(*along_x, strict=True):
            top = x if self.i == self.j else edge[3]
            for y, weight_y in zip(*_gauss(edge[2], top, panels, count), strict=True):
                if self.levels == 1:
                    found.append((x, y, x * y, weight_x * weight_y))
                    continue
                for f, weight_f in zip(*along_f, strict=True):
                    found.append((x, y, f, weight_x * weight_y * weight_f))
        return found


def subdomains(grid, slices, levels):
    """All subdomains of a section, in the order of tables."""
    columns = (grid + 1) // 2
    slices = 1 if levels == 1 else slices
    return [
        Subdomain(i, j, k, grid, slices, levels)
        for k in range(slices)
        for i in range(columns)
        for j in range(i + 1)
    ]


def table_error(filter, degree, part, offsets, coefficients, panels=1, count=4):
    """Equation 6.4 for weights that are polynomials."""
    return sum(
        weight
        * fields(filter, part.levels, offsets, x, y, f).error(coefficients @ terms(degree, x, y, f))
        for x, y, f, weight in part.nodes(panels, count)
    )


def trilinear_texels(levels, x, y, f):
    """The texels of trilinear interpolation, and their weights."""
    result = {}
    # Shares of the cell's level and of the one below; the image alone if it is the only level.
    shares = [(0, 1.0)] if levels == 1 else [(0, f), (1, 1 - f)]
    for finer, share in shares:
        px, py = x * 2**finer - 0.5, y * 2**finer - 0.5
        i, j = int(np.floor(px)), int(np.floor(py))
        for di in (0, 1):
            for dj in (0, 1):
                weight = (px - i if di else 1 - px + i) * (py - j if dj else 1 - py + j)
                result[finer, i + di, j + dj] = share * weight
    return list(result), np.array(list(result.values()))


def trilinear_error(filter, part, panels=1, count=4):
    """The same of trilinear interpolation."""
    total = 0.0
    for x, y, f, weight in part.nodes(panels, count):
        offsets, weights = trilinear_texels(part.levels, x, y, f)
        total += weight * fields(filter, part.levels, offsets, x, y, f).error(weights)
    return total


class System:
    """Equation 6.4, where all coefficients of the given texels are unknown.

    `ramp_weight` weighs the squared distance, in cells, between a position and the weighted center
    of its texels, equally for sums over texels of level 0 and for integrals.
    """

    def __init__(self, filter, degree, part, offsets, panels=1, count=4, ramp_weight=0.0):
        """Integrates all products by brute force."""
        ramp_weight /= {3: 1, 2: 4, 1: 1}[part.levels]
        centers = np.array([((i + 0.5) / 2**d, (j + 0.5) / 2**d) for d, i, j in offsets])
        size, powers = len(offsets), 10 if degree == 2 else 4
        self.moments = np.zeros((powers, powers))
        self.right = np.zeros((size, powers))
        self.square = 0.0
        for x, y, f, weight in part.nodes(panels, count):
            sample_x, texels_x, along_x = line(
                filter, part.levels, tuple((d, i) for d, i, _ in offsets), x, f
            )
            sample_y, texels_y, along_y = line(
                filter, part.levels, tuple((d, j) for d, _, j in offsets), y, f
            )
            found = terms(degree, x, y, f)
            inner = (texels_x @ (along_x * sample_x)) * (texels_y @ (along_y * sample_y))
            inner = inner + ramp_weight * (centers @ (x, y))
            self.right += weight * inner[:, None] * found
            self.moments += weight * found[:, None] * found
            own = (along_x @ sample_x**2) * (along_y @ sample_y**2)
            own += ramp_weight * (x**2 + y**2)
            self.square += weight * own
        self.products = ((texels_x * along_x) @ texels_x.T) * ((texels_y * along_y) @ texels_y.T)
        self.products += ramp_weight * (centers @ centers.T)

    def solve(self, members):
        """The coefficients (member, term) with the least error, and that error."""
        members = list(members)
        count, powers = len(members), len(self.moments)
        products = self.products[np.ix_(members, members)]
        right = self.right[members].ravel()
        size = count * powers
        matrix = np.zeros((size + powers, size + powers))
        matrix[:size, :size] = np.kron(products, self.moments)
        matrix[size:, :size] = np.kron(np.ones(count), np.eye(powers))
        matrix[:size, size:] = matrix[size:, :size].T
        sums = np.zeros(powers)
        sums[0] = 1.0
        # Where there is one level, f and xy are the same.
        found = np.linalg.lstsq(matrix, np.concatenate([right, sums]), rcond=1e-13)[0][:size]
        error = self.square - 2 * found @ right + found @ matrix[:size, :size] @ found
        return found.reshape(count, powers), error

    def value(self, coefficients):
        """The minimized objective at coefficients (texel, term)."""
        found = coefficients.ravel()
        squares = found @ np.kron(self.products, self.moments) @ found
        return self.square - 2 * found @ self.right.ravel() + squares

    def best_set(self, count):
        """The set of `count` texels with the least error, by trying all, and that error."""
        sets = np.array(list(combinations(range(len(self.right)), count)))
        # A root of the moments splits the system by polynomials.
        root = np.linalg.cholesky(self.moments)
        right = np.linalg.solve(root, self.right.T).T
        sums = root[0]  # 1 is the first power, and a multiple of the first polynomial.
        least, best = np.inf, None
        for part in np.array_split(sets, max(1, len(sets) // 20_000)):
            inverse = np.linalg.inv(self.products[part[:, :, None], part[:, None, :]])
            free = inverse @ right[part]
            row = inverse.sum(axis=1)
            multiplier = (sums - free.sum(axis=1)) / row.sum(axis=1)[:, None]
            # The minimum of c' G c - 2 c' b is -b' G^-1 b + (the sum's deficit)^2 / (1' G^-1 1).
            errors = (
                self.square
                - (free * right[part]).sum(axis=(1, 2))
                + (multiplier**2).sum(axis=1) * row.sum(axis=1)
            )
            if errors.min() < least:
                least, best = errors.min(), part[errors.argmin()]
        return best, least


def candidates(filter, part):
    """All texels that the filter overlaps somewhere in a subdomain."""
    edge = [min(k / part.grid, 0.5) for k in (part.i, part.i + 1, part.j, part.j + 1)]
    widest = filter_width(part.levels, (part.slice + 1) / part.slices)

    def along(finer, low, high):
        reach = RADII[filter] * (widest + 2.0**-finer) - 1e-9
        return [i for i in range(-40, 41) if low - reach < (i + 0.5) / 2**finer < high + reach]

    return [
        (finer, i, j)
        for finer in range(part.levels)
        for j in along(finer, edge[2], edge[3])
        for i in along(finer, edge[0], edge[1])
    ]
