# SPDX-License-Identifier: GPL-3.0-or-later

"""`adaptivity` of reconstructions: fewer triangles, within that distance of the surface."""

import numpy as np
import prefilter
import pytest
from clouds import sphere, torus

RING = torus(40_000)


def wall(count=60_000, seed=0):
    """Points of two walls that meet, one with a hole to fill, and their normals."""
    points = np.random.default_rng(seed).random((count, 3)) * [4.0, 4.0, 0.0]
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    is_bent = points[:, 0] > 2.0
    points[is_bent] = points[is_bent] * [0.0, 1.0, 0.0] + (points[is_bent, :1] - 2.0) * [0, 0, 1.0]
    points[is_bent, 0] = 2.0
    normals[is_bent] = [-1.0, 0.0, 0.0]
    kept = np.hypot(points[:, 0] - 1.0, points[:, 1] - 2.0) > 0.08
    return points[kept], normals[kept]


def both(cloud, **options):
    """A surface with all its triangles, and the simplified one."""
    options = {"depth": 7, "support": True, "threads": 1} | options
    adaptivity = options.pop("adaptivity")
    report = prefilter.ReconstructionReport()
    full = prefilter.reconstruct(*cloud, **options)
    less = prefilter.reconstruct(*cloud, **options, adaptivity=adaptivity, report=report)
    return full, less, report


def samples(positions, triangles, count=20_000):
    random = np.random.default_rng(7)
    weights = random.dirichlet(np.ones(3), count)
    chosen = triangles[random.integers(len(triangles), size=count)]
    return np.einsum("nk,nkd->nd", weights, positions[chosen])


def edge_counts(triangles):
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert len(np.unique(ends, axis=0)) == len(ends)
    return np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)[1]


@pytest.mark.parametrize("adaptivity", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("cloud", [RING.both, wall()], ids=["ring", "wall"])
def test_surfaces_stay_within_their_distance(cloud, adaptivity):
    full, less, report = both(cloud, adaptivity=adaptivity)
    assert len(less[1]) == report.triangles
    assert len(less[1]) < len(full[1]) / 2
    for source, target in ((full, less), (less, full)):
        found = np.concatenate([source[0], samples(*source[:2])])
        distances = prefilter.nearest_points(found, *target[:2])[2]
        assert distances.max() <= adaptivity * report.cell


def test_a_closed_surface_stays_closed():
    for watertight in (False, True):
        full, less, _ = both(RING.both, adaptivity=0.1, watertight=watertight)
        for mesh in (full, less):
            assert (edge_counts(mesh[1]) == 2).all()
            edges = 3 * len(mesh[1]) // 2
            assert len(mesh[0]) - edges + len(mesh[1]) == 0


def test_borders_and_attributes_stay():
    points, normals = wall()
    full, less, _ = both((points, normals), adaptivity=0.1, attributes=points[:, :2])
    assert (edge_counts(full[1]) == 1).sum() == (edge_counts(less[1]) == 1).sum() > 0
    kept = {place.tobytes(): i for i, place in enumerate(full[0])}
    chosen = [kept[place.tobytes()] for place in less[0]]
    np.testing.assert_array_equal(less[2], full[2][chosen])
    for name in ("distance", "density"):
        np.testing.assert_array_equal(less[3][name], full[3][name][chosen])


def test_filled_holes_can_be_cut_afterward():
    full, less, _ = both(wall(), adaptivity=0.1)
    is_far = [mesh[2]["distance"] > 1.5 for mesh in (full, less)]
    assert is_far[0].sum() == is_far[1].sum() > 0
    triangles = prefilter.trim(*less[:2], less[2]["distance"], less[2]["density"], hole=0)[1]
    assert (edge_counts(triangles) == 1).sum() > (edge_counts(less[1]) == 1).sum()


def test_flat_walls_take_few_triangles():
    full, less, _ = both(wall(), adaptivity=0.1)
    assert len(less[1]) < len(full[1]) / 8


def test_the_surface_does_not_depend_on_threads_or_memory(tmp_path):
    scan = prefilter.ScanPoints(*sphere(60_000).both)
    options = {"depth": 7, "adaptivity": 0.05, "support": True}
    expected = prefilter.reconstruct(scan, threads=1, **options)
    for more in ({"threads": 3}, {"memory_limit": 0}):
        found = prefilter.reconstruct(scan, **options, **more)
        np.testing.assert_array_equal(found[0], expected[0])
        np.testing.assert_array_equal(found[1], expected[1])
    del options["support"]  # files always have it
    less = prefilter.reconstruct_file(scan, tmp_path / "less.ply", **options)
    full = prefilter.reconstruct_file(scan, tmp_path / "full.ply", depth=7)
    assert less.triangles == len(expected[1]) < full.triangles


def test_no_adaptivity_changes_nothing():
    full, same, _ = both(RING.both, adaptivity=0.0)
    np.testing.assert_array_equal(full[0], same[0])
    np.testing.assert_array_equal(full[1], same[1])


def test_trimmed_surfaces_are_simplified_too():
    full, less, report = both(wall(), adaptivity=0.1, trim=1.0)
    assert len(less[1]) == report.triangles < len(full[1]) / 8


@pytest.mark.parametrize("adaptivity", [-0.1, np.nan, np.inf, 1e7])
def test_values_out_of_range_are_refused(adaptivity):
    with pytest.raises(ValueError, match=r"adaptivity: .* allowed are 0 to 1e"):
        prefilter.reconstruct(*RING.both, depth=4, adaptivity=adaptivity)


def test_a_large_distance_leaves_a_manifold():
    _, less, _ = both(RING.both, adaptivity=1e6)
    assert (edge_counts(less[1]) == 2).all()


def test_a_cancel_stops_it():
    with pytest.raises(prefilter.Cancelled):
        prefilter.reconstruct(
            *RING.both, depth=7, adaptivity=0.1, progress=lambda fraction: fraction < 0.8
        )
