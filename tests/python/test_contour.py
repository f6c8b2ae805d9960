# SPDX-License-Identifier: GPL-3.0-or-later

"""Contours of grids: planes, spheres and boxes whose measures are known in closed form."""

import itertools

import numpy as np
import prefilter
import pytest
import solids

INTERPOLANTS = ["occupancy", "plane", "linear"]


def enclosed(positions, triangles):
    a, b, c = (positions[triangles[:, k]].astype(float) for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def is_closed(triangles):
    """Whether every edge occurs once in each direction."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    forward = set(map(tuple, edges.tolist()))
    return len(forward) == len(edges) and all((b, a) in forward for a, b in forward)


def slab(size, normal, offset):
    """The share of each cell below a plane: inclusion and exclusion over its corners."""
    lows = np.indices((size,) * 3) + np.where(np.array(normal) < 0, 1, 0)[:, None, None, None]
    rest = offset - np.einsum("a,axyz->xyz", normal, lows)
    sides = np.abs(normal)
    shares = sum(
        (-1) ** sum(corner) * np.maximum(rest - np.dot(corner, sides), 0) ** 3
        for corner in itertools.product((0, 1), repeat=3)
    ) / (6 * sides.prod())
    return np.where(rest <= 0, 0, np.where(rest >= sides.sum(), 1, shares)).clip(0, 1)


@pytest.mark.parametrize(
    ("interpolant", "most"), [("plane", 5e-5), ("occupancy", 0.03), ("linear", 0.12)]
)
def test_vertices_lie_on_planes(interpolant, most):
    random = np.random.default_rng(0)
    for _ in range(20):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        offset = normal @ (8 + random.uniform(-0.5, 0.5, 3))
        grid = slab(16, normal, offset).astype(np.float32)
        positions, triangles = prefilter.contour(grid, interpolant=interpolant, cleanup=False)
        assert is_closed(triangles)
        inner = positions[((positions > 5) & (positions < 11)).all(axis=1)]
        assert np.abs(inner @ normal - offset).max() < most


def normal_errors(positions, triangles, center):
    """Degrees between the facets and a sphere under their middles; and their areas."""
    corners = positions[triangles] - center
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    middles = corners.mean(axis=1)
    cosines = (normals * middles).sum(axis=1) / (areas * np.linalg.norm(middles, axis=1))
    return np.degrees(np.arccos(cosines.clip(-1, 1))), areas


@pytest.mark.parametrize("center", [(0.2, 0.3, 0.4), (0.0, 0.0, 0.0), (0.5, 0.05, 0.77)])
def test_normals_on_a_sphere_of_fifteen_cells(center):
    """Facets with vertices on it, and any of the diagonals that cells leave free: 0.86 degrees."""
    sphere = solids.sphere(15.0, 5, center)
    octree = prefilter.voxelize(
        sphere.positions, sphere.triangles, depth=6, bounds=((-32,) * 3, (32,) * 3)
    )
    means, largest = {}, {}
    for interpolant in INTERPOLANTS:
        errors, areas = normal_errors(
            *octree.contour(interpolant=interpolant, cleanup=False), center
        )
        means[interpolant] = np.average(errors, weights=areas)
        largest[interpolant] = errors[areas > 1e-6 * areas.sum()].max()
    assert means["plane"] < 0.79
    assert means["occupancy"] < 0.95
    assert largest["occupancy"] < means["linear"]  # Figure 5.8


@pytest.mark.parametrize("center", [(0.2, 0.3, 0.4), (0.61, 0.05, 0.77)])
def test_facets_of_a_sphere_are_as_good_as_with_exact_vertices(center):
    """Also on steep slopes, where two cells alone would misplace a vertex by a tenth of a cell."""
    sphere = solids.sphere(18.4, 6, center)
    octree = prefilter.voxelize(
        sphere.positions, sphere.triangles, depth=6, bounds=((-32,) * 3, (32,) * 3)
    )
    positions, triangles = octree.contour(interpolant="plane", cleanup=False)
    # Along the lines between samples that they are on.
    points = positions - center
    axis = np.abs(positions - 0.5 - np.round(positions - 0.5)).argmax(axis=1)
    rows = np.arange(len(points))
    across = (points**2).sum(axis=1) - points[rows, axis] ** 2
    exact = points.copy()
    exact[rows, axis] = np.copysign(np.sqrt(18.4**2 - across), points[rows, axis])
    means = []
    for vertices in (points, exact):
        errors, areas = normal_errors(vertices + center, triangles, center)
        means.append(np.average(errors, weights=areas))
    assert means[0] < 1.02 * means[1]


def test_edges_do_not_bend_what_is_beside_them():
    """Columns across an edge give no heights: facets there are as accurate as with two cells."""
    means = dict.fromkeys(("plane", "occupancy"), 0.0)
    for seed in range(6):
        rotation = solids.random_rotation(seed)
        cube = solids.box((-0.3,) * 3, (0.3,) * 3).transformed(rotation, (0.5,) * 3)
        octree = prefilter.voxelize(
            cube.positions, cube.triangles, depth=6, bounds=((0,) * 3, (1,) * 3)
        )
        for interpolant in means:
            positions, triangles = octree.contour(interpolant=interpolant, cleanup=False)
            corners = positions[triangles]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            areas = np.linalg.norm(normals, axis=1)
            cosines = np.abs(normals @ rotation).max(axis=1) / areas
            errors = np.degrees(np.arccos(cosines.clip(-1, 1)))
            means[interpolant] += np.average(errors, weights=areas) / 6
    assert means["plane"] < means["occupancy"] < 1.9


@pytest.mark.parametrize("interpolant", INTERPOLANTS)
@pytest.mark.parametrize("low", [0, 3, 4, 8])
def test_a_box_of_ones_is_the_same_anywhere(interpolant, low):
    """The box's edges are cut off by 1/8 of a cell, and its corners by 5/48."""
    grid = np.zeros((20, 17, 16))
    grid[low : low + 8, low : low + 8, low : low + 8] = 1
    positions, triangles = prefilter.contour(grid, interpolant=interpolant, cleanup=False)
    assert is_closed(triangles)
    assert len(positions) == 6 * 64
    assert enclosed(positions, triangles) == pytest.approx(512 - 12 * 7 / 8 - 8 * 5 / 48, abs=1e-3)


def test_signed_distances_have_the_iso_value_zero():
    """A grid that is no power of two along any axis: the space around it counts as outside."""
    x, y, z = np.meshgrid(np.arange(19), np.arange(21), np.arange(22), indexing="ij")
    distance = np.sqrt((x - 9) ** 2 + (y - 10) ** 2 + (z - 10) ** 2)
    positions, triangles = prefilter.contour(6.3 - distance, interpolant="linear", isovalue=0)
    assert is_closed(triangles)
    radius = np.linalg.norm(positions - (9.5, 10.5, 10.5), axis=1)
    assert np.abs(radius - 6.3).max() < 0.05


def test_spacing_and_origin_place_the_cells():
    random = np.random.default_rng(1)
    grid = random.random((5, 6, 7))
    plain, triangles = prefilter.contour(grid, cleanup=False)
    larger, same = prefilter.contour(grid, spacing=4, cleanup=False)
    np.testing.assert_array_equal(triangles, same)
    np.testing.assert_array_equal(larger, plain * 4)
    placed, others = prefilter.contour(grid, spacing=(0.5, 2, 3), origin=(1, -2, 4), cleanup=False)
    assert is_closed(others)  # The diagonals are the best ones where the surface is.
    np.testing.assert_allclose(placed, plain * (0.5, 2, 3) + (1, -2, 4), rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("center", [0.0, 1e5, -3e6])
@pytest.mark.parametrize("scale", [1.0, 1e39])
def test_shapes_have_a_surface_wherever_they_are(center, scale):
    sphere = solids.sphere(1.0, 4, (0.0, 0.0, 0.0))
    octree = prefilter.voxelize(scale * (sphere.positions + center), sphere.triangles, depth=6)
    positions, triangles = octree.contour(interpolant="occupancy")
    assert positions.dtype == np.float64
    local = positions / scale - center
    corners = local[triangles]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert areas.min() > 0
    assert is_closed(triangles)
    assert enclosed(local, triangles) == pytest.approx(4 / 3 * np.pi, rel=0.01)
    rounded = local.astype(np.float32)
    assert len(np.unique(rounded, axis=0)) == len(rounded)


def test_outlines_have_points_wherever_they_are():
    grid = np.zeros((4, 4))
    grid[1:3, 1:3] = 1
    (near,) = prefilter.contour(grid, spacing=1e-3)
    (far,) = prefilter.contour(grid, spacing=1e-3, origin=(1e7, -1e7))
    assert near.dtype == np.float64
    np.testing.assert_allclose(far - (1e7, -1e7), near, atol=1e-8)


@pytest.mark.parametrize("grid", [np.ones((2, 2)), np.ones((2, 2, 2))])
def test_cells_without_a_size_are_refused(grid):
    for place in ({"origin": 1e20}, {"spacing": 1e308}):
        with pytest.raises(ValueError, match=r"spacing: the grid: from .* along x"):
            prefilter.contour(grid, **place)


def test_threads_and_types_do_not_matter():
    grid = np.random.default_rng(2).random((17, 13, 21)).astype(np.float32)
    first = prefilter.contour(grid, interpolant="plane", threads=1)
    for other in (
        prefilter.contour(grid, interpolant="plane", threads=5),
        prefilter.contour(grid.astype(float), interpolant="plane"),
    ):
        np.testing.assert_array_equal(first[0], other[0])
        np.testing.assert_array_equal(first[1], other[1])


def test_clean_up_is_the_default():
    grid = np.random.default_rng(3).random((9, 9, 9)).astype(np.float32)
    solid = solids.sphere(0.4, 3, (0.5, 0.5, 0.5))
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=5)
    for make in (lambda **options: prefilter.contour(grid, **options), octree.contour):
        cleaned, raw = make(), make(cleanup=False)
        assert len(cleaned[1]) < len(raw[1])
        np.testing.assert_array_equal(cleaned[1], make(cleanup=True)[1])


def test_stops_when_asked():
    with pytest.raises(prefilter.Cancelled):
        prefilter.contour(np.zeros((64, 64, 64)), progress=lambda fraction: False)


def sampled(positions, triangles, count, seed):
    """Random points all over a surface, and some of its vertices."""
    random = np.random.default_rng(seed)
    corners = positions[triangles]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    chosen = corners[random.choice(len(corners), count, p=areas / areas.sum())]
    inner = np.einsum("ij,ijk->ik", random.dirichlet((1, 1, 1), count), chosen)
    return np.concatenate([random.permutation(positions)[:count], inner])


def distances(points, positions, triangles):
    """Distances of points from a surface, by trying all of its triangles."""
    least = np.full(len(points), np.inf)
    for a, b, c in positions[triangles]:
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        inside = np.ones(len(points), bool)
        for start, end in ((a, b), (b, c), (c, a)):
            side = end - start
            inside &= (points - start) @ np.cross(normal, side) >= 0
            along = ((points - start) @ side / (side @ side)).clip(0, 1)
            apart = np.linalg.norm(points - start - along[:, None] * side, axis=1)
            least = np.minimum(least, apart)
        least = np.where(inside, np.minimum(least, np.abs((points - a) @ normal)), least)
    return least


@pytest.mark.parametrize(
    ("interpolant", "adaptivity"),
    [*((each, 0.1) for each in INTERPOLANTS), ("plane", 0.02), ("plane", 0.5)],
)
def test_adaptive_surfaces_stay_within_their_distance(interpolant, adaptivity):
    """The distance is measured from the contour before simplification and clean-up."""
    solid = solids.join(
        solids.torus(1.0, 0.4, 40, 24), solids.box((1.2, -0.2, -0.7), (2.1, 0.6, 0.9))
    )
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=5)
    cell = (np.array(octree.bounds[1]) - octree.bounds[0])[0] / 2**5
    full = octree.contour(interpolant=interpolant, cleanup=False)
    fewer = octree.contour(interpolant=interpolant, adaptivity=adaptivity)
    assert len(fewer[1]) < len(full[1])
    assert solids.surface_faults(*fewer).none
    for one, other in ((full, fewer), (fewer, full)):
        found = distances(sampled(*one, 300, 5), *other)
        assert found.max() <= adaptivity * cell


@pytest.mark.parametrize("seed", [None, 3, 4])
def test_an_adaptive_box_has_twelve_triangles(seed):
    """Vertices lie on the box's planes; edges and corners come from the source mesh."""
    solid = solids.box((0.1, 0.2, 0.3), (1.4, 1.1, 1.2))
    if seed is not None:
        solid = solid.transformed(solids.random_rotation(seed))
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=6)
    source = (solid.positions, solid.triangles)
    positions, triangles = octree.contour(
        interpolant="sharp", sources=[source], cleanup=False, adaptivity=0.02
    )
    assert solids.surface_faults(positions, triangles).none
    assert len(triangles) == 12
    assert distances(solid.positions, positions, triangles).max() < 1e-6
    assert enclosed(positions, triangles) == pytest.approx(solid.volume, rel=1e-6)


def test_adaptivity_is_in_cells():
    grid = slab(24, (0.36, 0.48, 0.8), 20.0).astype(np.float32)
    fewer = prefilter.contour(grid, interpolant="linear", adaptivity=0.1)
    wider = prefilter.contour(
        grid, interpolant="linear", spacing=(4, 8, 8), origin=100, adaptivity=0.1
    )
    other = prefilter.contour(grid, interpolant="linear", spacing=4, origin=100, adaptivity=0.1)
    np.testing.assert_array_equal(other[1], fewer[1])
    assert solids.surface_faults(*wider).none
    full = prefilter.contour(
        grid, interpolant="linear", spacing=(4, 8, 8), origin=100, cleanup=False
    )
    assert distances(sampled(*full, 1000, 6), *wider).max() <= 0.1 * 4


def test_adaptivity_does_not_depend_on_threads():
    solid = solids.sphere(0.4, 4, (0.5, 0.5, 0.5))
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=7)
    first, other = (
        octree.contour(interpolant="occupancy", adaptivity=0.1, threads=threads)
        for threads in (1, 3)
    )
    np.testing.assert_array_equal(first[0], other[0])
    np.testing.assert_array_equal(first[1], other[1])


@pytest.mark.parametrize("adaptivity", [-0.1, np.nan, np.inf, 1e7])
def test_adaptivity_out_of_range_is_refused(adaptivity):
    octree = prefilter.voxelize(*vars(solids.box()).values(), depth=3)
    with pytest.raises(ValueError, match=r"adaptivity: found .* allowed are 0 to 1e"):
        octree.contour(interpolant="occupancy", adaptivity=adaptivity)
    with pytest.raises(ValueError, match=r"adaptivity: found .* allowed are 0 to 1e"):
        prefilter.contour(np.ones((4, 4, 4)), adaptivity=adaptivity)


def test_adaptive_contours_stop_when_asked():
    solid = solids.sphere(0.4, 4, (0.5, 0.5, 0.5))
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=6)
    with pytest.raises(prefilter.Cancelled):
        octree.contour(
            interpolant="occupancy", adaptivity=0.1, progress=lambda fraction: fraction < 0.6
        )
