# SPDX-License-Identifier: GPL-3.0-or-later

"""Difficult clouds that still have a surface; weights, attributes, and open surfaces."""

import numpy as np
import prefilter
import pytest
import solids
from clouds import sphere

CLOUD = sphere(20_000)
DEPTH = 5
BASES = pytest.mark.parametrize("wavelet", ["haar", "d4"])


def _rebuilt(points, normals=CLOUD.normals, **options):
    report = prefilter.ReconstructionReport()
    options = {"depth": DEPTH, "report": report} | options
    return *prefilter.reconstruct(points, normals, **options), report


def _assert_same(found, expected):
    """Compares up to rounding, which may flip a quadrilateral's diagonal in the D4 basis."""
    assert len(found[0]) == len(expected[0])
    assert len(found[1]) == len(expected[1])
    volumes = [solids.mesh_volume(*mesh[:2]) for mesh in (found, expected)]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-4)
    ends = [np.stack([f(mesh[0], axis=0) for f in (np.min, np.max)]) for mesh in (found, expected)]
    np.testing.assert_allclose(*ends, atol=1e-4)


def _edges(triangles):
    """The number of triangles at each edge."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1]


def _is_closed(triangles):
    return bool((_edges(triangles) % 2 == 0).all())


@BASES
def test_flipped_normals_give_the_same_surface(wavelet):
    options = {"wavelet": wavelet, "direction": "outward"}
    positions, triangles, report = _rebuilt(CLOUD.points, **options)
    assert not report.is_flipped
    found = _rebuilt(CLOUD.points, -CLOUD.normals, **options)
    assert found[2].is_flipped
    np.testing.assert_array_equal(found[1], triangles)
    np.testing.assert_allclose(found[0], positions, atol=1e-5)
    assert solids.mesh_volume(*found[:2]) == pytest.approx(4 / 3 * np.pi, rel=0.01)


@BASES
@pytest.mark.parametrize("count", [1, 3])
def test_copies_of_all_points_change_rounding_alone(wavelet, count):
    expected = _rebuilt(CLOUD.points, wavelet=wavelet)
    copied = [np.concatenate((count + 1) * [rows]) for rows in (CLOUD.points, CLOUD.normals)]
    _assert_same(_rebuilt(*copied, wavelet=wavelet), expected)


@BASES
@pytest.mark.parametrize("scale", [1e-200, 1e-3, 1e150, 1e299])
def test_any_unit_will_do(wavelet, scale):
    positions, triangles, _ = _rebuilt(CLOUD.points, wavelet=wavelet)
    found = _rebuilt(scale * CLOUD.points, wavelet=wavelet)
    # Rounding may put a sample into the next cell.
    assert len(found[1]) == pytest.approx(len(triangles), rel=0.01)
    assert _is_closed(found[1])
    distances = np.linalg.norm(found[0] / scale, axis=1)
    np.testing.assert_allclose(distances, 1.0, atol=0.005)
    assert len(found[0]) == pytest.approx(len(positions), rel=0.01)


@BASES
def test_far_from_the_origin(wavelet):
    positions, triangles, _ = _rebuilt(CLOUD.points + 1e6, wavelet=wavelet)
    assert solids.surface_faults(positions - 1e6, triangles).none
    np.testing.assert_allclose(np.linalg.norm(positions - 1e6, axis=1), 1.0, atol=0.005)


@BASES
def test_two_scans_that_overlap(wavelet):
    """A scan of the whole, and a second one of a half."""
    again = sphere(20_000, seed=1)
    upper = again.points[:, 2] > 0.0
    points = np.concatenate([CLOUD.points, again.points[upper]])
    normals = np.concatenate([CLOUD.normals, again.normals[upper]])
    positions, triangles, report = _rebuilt(points, normals, wavelet=wavelet)
    assert solids.surface_faults(positions, triangles).none
    assert not report.is_flipped
    np.testing.assert_allclose(np.linalg.norm(positions, axis=1), 1.0, atol=0.005)


@BASES
@pytest.mark.parametrize("smooth", [True, False])
def test_random_normals_give_a_closed_surface(wavelet, smooth):
    order = np.random.default_rng(1).permutation(len(CLOUD.points))
    positions, triangles, _ = _rebuilt(
        CLOUD.points, CLOUD.normals[order], wavelet=wavelet, smooth=smooth, watertight=True
    )
    assert np.isfinite(positions).all()
    assert len(triangles) > 0
    assert _is_closed(triangles)


FEW = {
    "three points": CLOUD.points[:3],
    "a line": np.random.default_rng(2).random((1000, 3)) * [1, 0, 0],
    "a plane": np.random.default_rng(2).random((5000, 3)) * [1, 1, 0],
    "a solid": np.random.default_rng(2).random((5000, 3)),
}


@BASES
@pytest.mark.parametrize("name", FEW)
@pytest.mark.parametrize("options", [{}, {"smooth": False}, {"fit": False}, {"depth": 9}])
def test_clouds_without_volume_give_a_closed_surface(wavelet, name, options):
    points = FEW[name]
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    positions, triangles, _ = _rebuilt(points, normals, wavelet=wavelet, watertight=True, **options)
    assert np.isfinite(positions).all()
    assert _is_closed(triangles)


def test_weights_of_zero_leave_points_out():
    points = np.concatenate([CLOUD.points, 0.5 * CLOUD.points])
    normals = np.concatenate([CLOUD.normals, -CLOUD.normals])
    weights = np.repeat([1.0, 0.0], len(CLOUD.points))
    positions, triangles, report = _rebuilt(points, normals, weights=weights)
    assert (report.points, report.dropped) == (40_000, 20_000)
    expected = _rebuilt(CLOUD.points)
    np.testing.assert_array_equal(triangles, expected[1])
    np.testing.assert_allclose(positions, expected[0], atol=1e-6)


@pytest.mark.parametrize("scale", [1e-6, 2.0, 1e12, 1e30])
def test_only_the_ratios_of_weights_count(scale):
    weights = np.random.default_rng(4).uniform(0.5, 1.0, len(CLOUD.points))
    expected = _rebuilt(CLOUD.points, weights=weights)
    found = _rebuilt(CLOUD.points, weights=scale * weights)
    # Rounding may decide between equivalent choices, so numbers of vertices may differ.
    assert len(found[1]) == len(expected[1])
    for a, b in ((found, expected), (expected, found)):
        off = prefilter.nearest_points(a[0].astype(np.float64), b[0], b[1])[2]
        assert off.max() < 1e-4


@BASES
def test_a_weight_of_two_is_a_second_copy(wavelet):
    """Points are equally dense everywhere, as the mean weight of a point assumes."""
    weights = np.full(len(CLOUD.points), 2.0)
    points = np.concatenate([CLOUD.points, CLOUD.points])
    normals = np.concatenate([CLOUD.normals, CLOUD.normals])
    expected = _rebuilt(points, normals, wavelet=wavelet)
    found = _rebuilt(CLOUD.points, weights=weights, wavelet=wavelet)
    _assert_same(found, expected)


@BASES
@pytest.mark.parametrize("depth", [5, 8])
def test_colors_arrive_where_they_were(wavelet, depth):
    red, blue = (1.0, 0.0, 0.25), (0.0, 1.0, 0.25)
    colors = np.where(CLOUD.points[:, :1] > 0, red, blue)
    report = prefilter.ReconstructionReport()
    positions, _, found = prefilter.reconstruct(
        CLOUD.points,
        CLOUD.normals,
        depth=depth,
        wavelet=wavelet,
        attributes=colors,
        report=report,
    )
    assert found.shape == (len(positions), 3)
    assert found.dtype == np.float32
    # Colors come from samples up to a cell away. Where there are only as many samples as cells,
    # the cells count four times as large.
    reach = max(2.0 * report.cell, 0.1)
    for is_side, color in ((positions[:, 0] > reach, red), (positions[:, 0] < -reach, blue)):
        assert is_side.any()
        np.testing.assert_allclose(
            found[is_side], np.broadcast_to(color, (is_side.sum(), 3)), atol=1e-5
        )
    np.testing.assert_allclose(found[:, 2], 0.25, atol=1e-5)
    np.testing.assert_allclose(found[:, 0] + found[:, 1], 1.0, atol=1e-5)


@BASES
@pytest.mark.parametrize(("depth", "trim"), [(6, 3.0), (6, 40.0), (7, 20.0)])
def test_a_trimmed_surface_ends_where_the_points_do(wavelet, depth, trim):
    cloud = sphere(60_000)
    upper = cloud.points[:, 2] > 0
    points, normals = cloud.points[upper], cloud.normals[upper]
    closed = _rebuilt(points, normals, depth=depth, wavelet=wavelet, watertight=True)
    assert _is_closed(closed[1])
    positions, triangles, report = _rebuilt(
        points, normals, depth=depth, wavelet=wavelet, trim=trim
    )
    # Distances from the half sphere; vertices below it are measured from its border.
    radius = np.hypot(positions[:, 0], positions[:, 1])
    distances = np.where(
        positions[:, 2] > 0,
        np.abs(np.linalg.norm(positions, axis=1) - 1),
        np.hypot(radius - 1, positions[:, 2]),
    )
    # Trimming measures to the means of samples in cells; a large trim uses larger cells.
    assert distances.max() < (1.25 * trim + 1.0) * report.cell
    if trim * report.cell > 1.0:
        return
    assert (_edges(triangles) == 1).any()
    # The surface has no gaps where there are points.
    corners = positions[triangles]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    ).sum()
    assert area / 2 > 0.98 * 2 * np.pi


@pytest.mark.parametrize("trim", [3.0, 30.0])
def test_threads_do_not_change_what_is_trimmed(trim):
    upper = CLOUD.points[:, 2] > 0
    one, three = (
        _rebuilt(
            CLOUD.points[upper], CLOUD.normals[upper], depth=7, trim=trim, threads=t, memory_limit=m
        )
        for t, m in ((1, None), (3, 0))
    )
    np.testing.assert_array_equal(one[0], three[0])
    np.testing.assert_array_equal(one[1], three[1])


@pytest.mark.parametrize("depth", [1, 2])
def test_cells_without_neighbors_count_where_none_are_larger(depth: int) -> None:
    """A corner of a box: too few samples to be neighbors of each other."""
    points = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, -1.0, -1.0]])
    positions, triangles = prefilter.reconstruct(points, points, depth=depth)
    assert len(triangles) > 0
    assert solids.surface_faults(positions, triangles).open_or_crowded_edges == 0


def test_normals_that_cancel_each_other_everywhere_are_an_error() -> None:
    cloud = sphere(3000)
    points = np.concatenate([cloud.points, cloud.points])
    normals = np.concatenate([cloud.normals, -cloud.normals])
    with pytest.raises(ValueError, match="normals: they contradict each other everywhere"):
        prefilter.reconstruct(points, normals, depth=3, direction="given")
    positions, triangles = prefilter.reconstruct(points, normals, depth=5)
    assert solids.mesh_volume(positions, triangles) == pytest.approx(4 / 3 * np.pi, rel=0.02)
