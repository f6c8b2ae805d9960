"""The seam term and the contrast across seams, against sums over points along them."""

import numpy as np
import prefilter
import pytest
from scenes import Mesh, bilinear, bilinear_taps, random_image, surface_samples
from test_mipmaps_oracle import Oracle

CLAMP = ("clamp", "clamp")


def folded():
    """Two unit squares that share an edge in space; in the texture they are apart.

    The second one is turned and smaller there.
    """
    positions = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1]], np.float64
    )
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    left = {0: (0.05, 0.1), 1: (0.45, 0.1), 2: (0.45, 0.8), 3: (0.05, 0.8)}
    right = {1: (0.6, 0.9), 4: (0.6, 0.5), 5: (0.95, 0.55), 2: (0.9, 0.95)}
    uvs = np.array(
        [[(left if k < 2 else right)[v] for v in t] for k, t in enumerate(triangles)], np.float64
    )
    return (
        Mesh(positions, triangles, uvs),
        np.array([left[1], left[2]]),
        np.array([right[1], right[2]]),
    )


def sides(left, right, count):
    f = ((np.arange(count) + 0.5) / count)[:, None]
    return left[0] + f * (left[1] - left[0]), right[0] + f * (right[1] - right[0])


@pytest.mark.parametrize("size", [(16, 16), (7, 13)])
def test_contrast_is_the_difference_along_the_seam(size):
    mesh, left, right = folded()
    levels = [random_image(1, *size, 3), random_image(2, 4, 3, 3), random_image(3, 1, 1, 3)]
    found = prefilter.seam_contrast(levels, mesh.surface)
    ours, theirs = sides(left, right, 20_000)
    for level, contrast in zip(levels, found, strict=True):
        difference = bilinear(level, ours, CLAMP) - bilinear(level, theirs, CLAMP)
        assert contrast == pytest.approx(np.sqrt((difference**2).mean()), rel=2e-4, abs=1e-6)


def test_contrast_without_a_seam_is_none():
    mesh, _, _ = folded()
    one = prefilter.Surface(mesh.positions, mesh.triangles[:2], mesh.uvs[:2])
    assert prefilter.seam_contrast([random_image(1, 8, 8, 1)], one).tolist() == [0.0]


def test_coordinates_that_differ_by_rounding_are_no_seam():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]], np.float64)
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    uvs = np.array([[(0.1, 0.1), (0.5, 0.1), (0.5, 0.9)], [(0.5, 0.1), (0.9, 0.1), (0.5, 0.9)]])
    image = random_image(1, 8, 8, 1)
    contrasts = []
    for apart in (8 * np.finfo(np.float32).eps / 2, 1e-4):
        moved = uvs + np.array([0, apart])[:, None, None]
        surface = prefilter.Surface(positions, triangles, moved)
        contrasts.append(prefilter.seam_contrast([image], surface)[0])
    assert contrasts[0] == 0.0
    assert contrasts[1] > 0.0


def test_a_tile_of_a_repeated_texture_has_no_contrast():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]], np.float64)
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    uvs = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 0), (0, 1)]], np.float64)
    surface = prefilter.Surface(positions, triangles, uvs)
    image = random_image(1, 8, 8, 2)
    assert prefilter.seam_contrast([image], surface, wrap="repeat")[0] < 1e-6
    assert prefilter.seam_contrast([image], surface, wrap="clamp")[0] > 0.1


def test_split_vertices_at_one_place_are_one():
    mesh, _, _ = folded()
    split = Mesh(
        mesh.positions[mesh.triangles].reshape(-1, 3), np.arange(12).reshape(-1, 3), mesh.uvs
    )
    image = random_image(1, 16, 16, 3)
    assert prefilter.seam_contrast([image], split.surface) == pytest.approx(
        prefilter.seam_contrast([image], mesh.surface), rel=1e-9
    )


def seam_rows(left, right, shape, count=20_000):
    """The texels' shares in the difference, at points along the seam."""
    ours, theirs = sides(left, right, count)
    taps, shares = bilinear_taps(ours, *shape, CLAMP)
    other_taps, other_shares = bilinear_taps(theirs, *shape, CLAMP)
    rows = np.zeros((count, shape[0] * shape[1]))
    np.add.at(rows, (np.arange(count)[:, None], taps), shares)
    np.add.at(rows, (np.arange(count)[:, None], other_taps), -other_shares)
    return rows


def seam_matrix(left, right, shape):
    rows = seam_rows(left, right, shape)
    return rows.T @ rows / len(rows)


def without_contrast(image, *lines):
    """The image with one colour in all texels that are read along the lines: none differs there."""
    changed = image.copy()
    for line in lines:
        taps, _ = bilinear_taps(line, *image.shape[:2], CLAMP)
        changed.reshape(-1, image.shape[2])[np.unique(taps)] = 0.5
    return changed


@pytest.mark.parametrize("weight", [30.0, 400.0])
@pytest.mark.parametrize("size", [(16, 16), (9, 14)])
def test_levels_minimise_the_error_and_the_seams(size, weight):
    mesh, left, right_side = folded()
    # Seams along which the image differs count less, by a curve that is the library's own.
    image = without_contrast(random_image(4, *size, 2), *sides(left, right_side, 20_000))
    assert prefilter.seam_contrast([image], mesh.surface)[0] < 1e-7
    levels = prefilter.mipmaps(image, mesh.surface, bounds=None, seam_weight=weight)
    for level in levels[1:3]:
        shape = level.shape[:2]
        oracle = Oracle(mesh, image, shape, CLAMP, steps=300)
        # The oracle's weights are areas in space, of which there are 2; the seam is 1 long, and
        # a texel as wide as the mean of its two sides says.
        scale = np.array(shape[::-1])
        texels = [np.linalg.norm((side[1] - side[0]) * scale) for side in (left, right_side)]
        strip = 1.0 / np.mean(texels)
        area = surface_samples(mesh, 10)[1].sum()
        matrix = oracle.pulled + weight * strip * (area / 2.0) * seam_matrix(
            left, right_side, shape
        )
        values = level.reshape(-1, 2).astype(np.float64)
        used = oracle.used
        gradient = (matrix @ values - oracle.pulled_right)[used]
        diagonal = np.diag(matrix)[used]
        scaled = gradient / np.maximum(diagonal, 0.01 * diagonal.mean())[:, None]
        assert np.abs(scaled).max() < 2e-3


def test_corners_of_one_colour_do_not_tell_the_contrast():
    """Stripes that have a whole number of periods along every edge of a mesh of few triangles."""
    period = 0.3
    positions = np.array([(x, y, 0) for x in range(3) for y in range(2)], np.float64)
    triangles = np.array([(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)])
    low = {0: (0.05, 0.1), 2: (0.45, 0.1), 3: (0.45, 0.4), 1: (0.05, 0.4)}
    high = {2: (0.55, 0.4), 4: (0.95, 0.4), 5: (0.95, 0.7), 3: (0.55, 0.7)}
    uvs = np.array([[(low if k < 2 else high)[v] for v in t] for k, t in enumerate(triangles)])
    surface = prefilter.Surface(positions, triangles, uvs)
    rows = (np.arange(128) + 0.5) / 128
    waves = sum(np.sin(2 * np.pi * (k * rows / period + 0.1 * k)) for k in (1, 2, 3))
    image = np.broadcast_to((0.5 + 0.15 * waves)[:, None, None], (128, 128, 1)).astype(np.float32)
    before, after = (
        prefilter.seam_contrast(prefilter.mipmaps(image, surface, seam_weight=weight), surface)
        for weight in (0.0, 1.0)
    )
    assert (after[3:6] < 0.6 * before[3:6]).all()


def continuous(mesh, size):
    """An image of a pattern on the surface: the same on both sides of the seam."""
    centres = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(centres, centres)
    at = np.zeros((size, size, 3))
    for corners, uvs in zip(mesh.positions[mesh.triangles], mesh.uvs, strict=True):
        edges = np.linalg.inv((uvs[1:] - uvs[0]).T)
        b, c = np.einsum("ij,jkl->ikl", edges, np.stack([u - uvs[0, 0], v - uvs[0, 1]]))
        a = 1 - b - c
        inside = np.minimum(np.minimum(a, b), c) > -0.1
        near = np.einsum("ikl,ij->klj", np.stack([a, b, c]), corners)
        at = np.where(inside[..., None], near, at)
    waves = np.sin(at @ np.array([[9.0, 2, 4], [3, 11, 8], [7, 5, 3]]) + [0, 1, 2])
    return (0.5 + 0.45 * waves).astype(np.float32)


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
@pytest.mark.parametrize("reader", ["linear", "srgb-after"])
def test_a_heavy_seam_closes(filter, reader):
    if filter == "pam-trilinear" and reader != "linear":
        pytest.skip("readers that decode after the lookup do not interpolate between levels")
    mesh, _, _ = folded()
    image = continuous(mesh, 32)

    def contrast(weight):
        levels = prefilter.mipmaps(
            image, mesh.surface, filter=filter, reader=reader, seam_weight=weight, levels=4
        )
        return prefilter.seam_contrast(levels, mesh.surface)

    alone, light, heavy = (contrast(weight) for weight in (0.0, 1.0, 100.0))
    assert (light[1:] < 0.8 * alone[1:]).all()
    if reader == "linear":  # The rounds of the other fit end before a weight like this is through.
        assert (heavy[1:] < 0.5 * light[1:]).all()


def test_weights_and_scales_of_the_surface_do_not_matter():
    mesh, _, _ = folded()
    image = random_image(6, 16, 16, 1)
    levels = prefilter.mipmaps(image, mesh.surface, seam_weight=1.0)
    larger = prefilter.Surface(mesh.positions * 37.0, mesh.triangles, mesh.uvs)
    for a, b in zip(levels, prefilter.mipmaps(image, larger, seam_weight=1.0), strict=True):
        np.testing.assert_allclose(a, b, atol=2e-5)
    twice = [mesh.surface, mesh.surface]
    for a, b in zip(levels, prefilter.mipmaps(image, twice, seam_weight=1.0), strict=True):
        np.testing.assert_allclose(a, b, atol=2e-4)


def test_results_do_not_depend_on_threads():
    mesh, _, _ = folded()
    image = random_image(7, 200, 160, 3)
    one, many = (
        prefilter.mipmaps(image, mesh.surface, seam_weight=1.0, threads=threads)
        for threads in (1, 4)
    )
    for a, b in zip(one, many, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_change_of_colour_along_a_seam_stays():
    mesh, _, _ = folded()
    image = np.zeros((32, 32, 1), np.float32)
    image[:, 17:] = 1.0  # The one square is black and the other white.
    levels = prefilter.mipmaps(image, mesh.surface, seam_weight=1.0, levels=4)
    alone = prefilter.mipmaps(image, mesh.surface, levels=4)
    values = [1.0, 2.0, 3.0]
    error = prefilter.mipmap_error(levels, image, mesh.surface, values)
    least = prefilter.mipmap_error(alone, image, mesh.surface, values)
    assert (error <= least + 0.01).all()


def test_bad_levels_are_refused():
    mesh, _, _ = folded()
    image = random_image(1, 8, 8, 1)
    with pytest.raises(ValueError, match="levels: none"):
        prefilter.seam_contrast([], mesh.surface)
    with pytest.raises(ValueError, match="levels: level 1 has 2 channels"):
        prefilter.seam_contrast([image, random_image(1, 4, 4, 2)], mesh.surface)
    with pytest.raises(
        ValueError, match="levels: a seam reads a texel that is not finite in level 0"
    ):
        prefilter.seam_contrast([np.full((8, 8, 1), np.nan)], mesh.surface)
    with pytest.raises(ValueError, match="surface: none was given"):
        prefilter.seam_contrast([image], [])
