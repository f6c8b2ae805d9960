# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels fitted to views, against frames that numpy draws."""

import numpy as np
import prefilter
import pytest
from prefilter import Surface

SIDE = 64
PIXELS = 26  # Along each side of a frame.
SAMPLES = 10  # Along each side of a pixel.


def box() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the quads of a cube (6, 4, 3) and their charts (6, 4, 2), which lie apart."""
    quads, charts = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            middle = side * np.eye(3)[axis]
            quads.append([middle + a * u + b * v for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
            number = len(charts)
            low = np.array([number % 3, number // 3]) / 3 + 0.04
            charts.append(low + 0.25 * np.array([(0, 0), (1, 0), (1, 1), (0, 1)]))
    return np.array(quads), np.array(charts)


def scene() -> tuple[np.ndarray, Surface]:
    """Returns an image of dark and bright charts with noise, magenta between, and its surface."""
    quads, charts = box()
    random = np.random.default_rng(2)
    image = np.tile(np.array([1.0, 0.0, 1.0]), (SIDE, SIDE, 1))
    for number, chart in enumerate(charts):
        low, high = np.floor(chart.min(0) * SIDE).astype(int), np.ceil(chart.max(0) * SIDE)
        rows, columns = slice(low[1], int(high[1])), slice(low[0], int(high[0]))
        shape = image[rows, columns].shape
        image[rows, columns] = 0.15 + 0.13 * number + 0.12 * random.uniform(-1, 1, shape)
    corners = np.array([0, 1, 2, 0, 2, 3])
    positions = quads.reshape(-1, 3)
    triangles = (4 * np.arange(6)[:, None] + corners).reshape(-1, 3)
    uvs = charts[:, corners].reshape(-1, 3, 2)
    return image.astype(np.float32), Surface(positions, triangles, uvs)


def bilinear(level: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Returns clamped lookups."""
    height, width = level.shape[:2]
    x = np.clip(u * width - 0.5, 0, width - 1)
    y = np.clip(v * height - 0.5, 0, height - 1)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = (x - i)[..., None], (y - j)[..., None]
    right, up = np.minimum(i + 1, width - 1), np.minimum(j + 1, height - 1)
    below = (1 - a) * level[j, i] + a * level[j, right]
    above = (1 - a) * level[up, i] + a * level[up, right]
    return (1 - b) * below + b * above


def cast(directions: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """Returns where parallel rays meet the cube first: u, v, du and dv by x and y, and whether."""
    quads, charts = box()
    right, up, toward = directions
    best = np.full(x.shape, -np.inf)
    found = np.zeros((6, *x.shape))
    for quad, chart in zip(quads, charts, strict=True):
        first, second = quad[1] - quad[0], quad[3] - quad[0]
        normal = np.cross(first, second)
        if abs(normal @ toward) < 1e-9:
            continue
        start = x[..., None] * right + y[..., None] * up
        t = ((quad[0] - start) @ normal) / (toward @ normal)
        point = start + t[..., None] * toward - quad[0]
        a, b = (point @ first) / (first @ first), (point @ second) / (second @ second)
        hit = (a >= 0) & (a <= 1) & (b >= 0) & (b <= 1) & (t > best)
        best[hit] = t[hit]
        across = [chart[1] - chart[0], chart[3] - chart[0]]
        place = chart[0] + a[..., None] * across[0] + b[..., None] * across[1]
        found[0][hit], found[1][hit] = place[hit].T
        for k, step in enumerate((right, up)):
            moved = step - (step @ normal) / (toward @ normal) * toward
            slope = (moved @ first) / (first @ first) * across[0]
            slope = slope + (moved @ second) / (second @ second) * across[1]
            found[2 + 2 * k][hit], found[3 + 2 * k][hit] = slope
    return (*found, np.isfinite(best))


def errors(levels: list[np.ndarray], lookups: str) -> float:
    """Returns the root mean square over the covered pixels of frames from other sides."""
    random = np.random.default_rng(9)
    squares = []
    pixel = 4.0 / PIXELS
    for _ in range(12):
        rotation, _ = np.linalg.qr(random.normal(size=(3, 3)))
        fine = ((np.arange(PIXELS * SAMPLES) + 0.5) / SAMPLES - PIXELS / 2) * pixel
        u, v, *_, hit = cast(rotation, *np.meshgrid(fine, fine))
        shape = (PIXELS, SAMPLES, PIXELS, SAMPLES)
        covered = hit.reshape(shape).all(axis=(1, 3))
        truth = bilinear(levels[0], u, v).reshape(*shape, 3).mean(axis=(1, 3))
        middles = (np.arange(PIXELS) + 0.5 - PIXELS / 2) * pixel
        u, v, ux, vx, uy, vy, _ = cast(rotation, *np.meshgrid(middles, middles))
        sides = pixel * SIDE * np.array([np.hypot(ux, vx), np.hypot(uy, vy)])
        longer, shorter = sides.max(axis=0), np.maximum(sides.min(axis=0), 1e-9)
        count = np.ones(longer.shape)
        if lookups == "anisotropic":
            count = np.clip(np.ceil(longer / shorter), 1, 16)
        mip = np.clip(np.log2(np.maximum(longer / count, 1)), 0, len(levels) - 1)
        along = np.where(sides[0] > sides[1], [ux, vx], [uy, vy]) * pixel
        shown = np.zeros_like(truth)
        for i in range(1, 17):
            at = i / (count + 1) - 0.5
            place = u + at * along[0], v + at * along[1]
            for number, level in enumerate(levels):
                share = np.maximum(1 - np.abs(mip - number), 0) * (i <= count) / count
                shown += share[..., None] * bilinear(level, *place)
        squares.append(((shown - truth)[covered] ** 2).mean(axis=1))
    return float(np.sqrt(np.concatenate(squares).mean()))


@pytest.fixture(scope="module")
def start() -> tuple[list[np.ndarray], Surface]:
    image, surface = scene()
    return prefilter.mipmaps(image, surface, footprint=1.0), surface


@pytest.mark.parametrize("lookups", ["trilinear", "anisotropic"])
def test_pixels_are_nearer_to_what_they_should_show(start, lookups):
    levels, surface = start
    fitted = prefilter.fit_to_views(levels, surface, lookups=lookups)
    assert errors(fitted, lookups) < 0.9 * errors(levels, lookups)


def test_levels_for_both_are_nearer_either_way(start):
    levels, surface = start
    both = prefilter.fit_to_views(levels, surface)
    for lookups in ("trilinear", "anisotropic"):
        assert errors(both, lookups) < 0.95 * errors(levels, lookups)


def test_threads_do_not_matter(start):
    levels, surface = start
    one, two = (
        prefilter.fit_to_views(levels, surface, threads=threads, effort=0.2) for threads in (1, 3)
    )
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a, b)


def test_one_color_stays(start):
    _, surface = start
    levels = prefilter.mipmaps(np.full((SIDE, SIDE, 4), (0.2, 0.5, 0.9, 0.3)), surface)
    for level in prefilter.fit_to_views(levels, surface, effort=0.2):
        np.testing.assert_allclose(level[..., 3], 0.3, atol=1e-4)
        np.testing.assert_allclose(
            level, np.broadcast_to((0.2, 0.5, 0.9, 0.3), level.shape), atol=2e-3
        )


@pytest.mark.parametrize("bounds", [(0.4, 1.0), None])
def test_colors_of_what_hardly_covers_stay_in_the_range_of_the_image(start, bounds):
    _, surface = start
    random = np.random.default_rng(4)
    image = random.uniform(0.5, 0.6, (SIDE, SIDE, 4))
    image[..., 3] = random.uniform(0, 1, (SIDE, SIDE)) ** 8
    levels = prefilter.mipmaps(image, surface, footprint=1.0, bounds=bounds)
    for level in prefilter.fit_to_views(levels, surface, bounds=bounds, effort=0.2)[1:]:
        assert level[..., :3].min() >= 0.5 - 1e-5
        assert level[..., :3].max() <= 0.6 + 1e-5
        assert level[..., 3].min() >= 0
        assert level[..., 3].max() <= 1


def test_level_0_and_bounds_stay(start):
    levels, surface = start
    before = [level.copy() for level in levels]
    fitted = prefilter.fit_to_views(levels, surface, bounds=(0.3, 0.5), effort=0.2)
    np.testing.assert_array_equal(fitted[0], levels[0])
    assert [level.shape for level in fitted] == [level.shape for level in levels]
    for level in fitted[1:]:
        assert level.min() >= 0.3
        assert level.max() <= 0.5
    for level, kept in zip(levels, before, strict=True):
        np.testing.assert_array_equal(level, kept)


def test_nasty_surfaces():
    """Surfaces that cannot be seen leave levels unchanged."""
    levels = prefilter.mipmaps(np.random.default_rng(1).random((8, 8)), filter="tent")
    flat = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)])
    inside = np.array([[(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)]])
    for positions, uvs in (
        (0 * flat, inside),
        (flat, 0 * inside),
        (flat, 1e200 * inside),
        (1e-200 * flat, inside),
        (flat, 1e5 * inside),
        (np.concatenate([flat, [(1e140, 0, 0), (0, -1e140, 0), (3, 4, 1)]]), inside),
    ):
        # Triangles without a position in the texture still hide the ones behind them.
        triangles = np.arange(len(positions)).reshape(-1, 3)
        nowhere = np.zeros((len(triangles) - 1, 3, 2))
        surface = Surface(positions, triangles, np.concatenate([uvs, nowhere]))
        for level, before in zip(
            prefilter.fit_to_views(levels, surface, wrap="repeat", effort=0.1), levels, strict=True
        ):
            assert np.isfinite(level).all()
            assert level.shape == before.shape
    single = prefilter.fit_to_views([np.float32([[0.5]])], Surface(flat, [(0, 1, 2)], inside))
    np.testing.assert_array_equal(single[0], [[0.5]])
