# SPDX-License-Identifier: GPL-3.0-or-later

"""Thinning points, removing outliers, and aligning scans."""

import numpy as np
import prefilter
import pytest


def cloud(seed=0, count=4000):
    """Points of a bent surface, ten times as dense on one side."""
    random = np.random.default_rng(seed)
    u, v = random.random((2, count))
    u = np.where(random.random(count) < 0.9, 0.3 * u, 0.3 + 0.7 * u)
    return np.stack([u, v, 0.2 * np.sin(5 * u) * np.cos(3 * v)], axis=1)


def distances(a, b):
    """Distances from each of `a` to each of `b`."""
    return np.sqrt(((a[:, None] - b[None]) ** 2).sum(axis=2))


def test_poisson_points_are_apart_and_leave_no_gap():
    points = cloud()
    for spacing in (0.01, 0.05, 0.3):
        kept = prefilter.subsample_points(points, spacing)
        assert (np.diff(kept) > 0).all()
        between = distances(points[kept], points[kept])
        np.fill_diagonal(between, np.inf)
        assert between.min() >= spacing
        assert distances(points, points[kept]).min(axis=1).max() < spacing
    assert len(prefilter.subsample_points(points, 10.0)) == 1


def test_poisson_points_do_not_depend_on_their_order():
    points = cloud()
    order = np.random.default_rng(1).permutation(len(points))
    kept = prefilter.subsample_points(points, 0.05)
    other = order[prefilter.subsample_points(points[order], 0.05)]
    np.testing.assert_array_equal(np.sort(other), kept)


def test_grid_points_are_nearest_to_the_mean_of_their_cell():
    points = cloud()
    spacing = 0.07
    cells = {}
    for index, cell in enumerate(((points - points.min(axis=0)) // spacing).astype(int).tolist()):
        cells.setdefault(tuple(cell), []).append(index)
    kept = prefilter.subsample_points(points, spacing, method="grid")
    assert len(kept) == len(cells)
    for indices in cells.values():
        own = np.intersect1d(indices, kept)
        assert len(own) == 1
        away = np.linalg.norm(points[indices] - points[indices].mean(axis=0), axis=1)
        assert np.linalg.norm(points[own[0]] - points[indices].mean(axis=0)) <= away.min() + 1e-12


@pytest.mark.parametrize("method", ["poisson", "grid"])
def test_subsampling_of_odd_points(method):
    kept = prefilter.subsample_points(np.empty((0, 3)), 1.0, method=method)
    assert (kept.dtype, kept.shape) == (np.int64, (0,))
    bad = [(np.nan, 0, 0), (0, 0, np.inf), (1e200, 0, 0)]
    np.testing.assert_array_equal(
        prefilter.subsample_points([*bad, (1, 2, 3), (1, 2, 3)], 1.0, method=method), [3]
    )
    assert len(prefilter.subsample_points(bad, 1.0, method=method)) == 0
    far = np.array([(5e5, 4e6, 100.0)]) + cloud(count=500)
    assert len(prefilter.subsample_points(far, 0.05, method=method)) > 50
    # Points without near neighbors are all kept.
    apart = np.arange(300.0).reshape(100, 3)
    assert len(prefilter.subsample_points(apart, 1.0, method=method)) == 100


def test_subsampling_refuses():
    points = cloud(count=10)
    for spacing in (0, -1, np.nan, np.inf, 1e-16):
        with pytest.raises(ValueError, match=r"spacing: found .*; a number above .* is needed"):
            prefilter.subsample_points(points, spacing)
    with pytest.raises(ValueError, match="spacing: 'x'; a number is needed"):
        prefilter.subsample_points(points, "x")
    with pytest.raises(ValueError, match="method: 'best' is not one of poisson, grid"):
        prefilter.subsample_points(points, 1.0, method="best")


def outliers_of(points, neighbours, factor):
    """Outliers by definition, from all distances."""
    between = distances(points, points)
    order = np.argsort(between, axis=1, kind="stable")[:, 1 : neighbours + 1]
    own = np.take_along_axis(between, order, axis=1).mean(axis=1)
    others = np.sort(own[order], axis=1)
    return own > factor * others[:, (others.shape[1] - 1) // 2]


@pytest.mark.parametrize(("neighbours", "factor"), [(3, 1.5), (16, 2.0), (40, 1.2), (500, 3.0)])
def test_outliers_are_those_of_the_definition(neighbours, factor):
    random = np.random.default_rng(5)
    points = np.concatenate([cloud(count=1500), 2 * random.normal(size=(40, 3))])
    found = prefilter.find_outliers(points, neighbours=neighbours, factor=factor)
    np.testing.assert_array_equal(found, outliers_of(points, neighbours, factor))


def test_parts_of_another_density_are_no_outliers():
    random = np.random.default_rng(6)
    dense, sparse = random.random((2, 3000, 3)) * (1, 1, 0)
    points = np.concatenate([dense * 0.1, sparse * 30 + (50, 0, 0)])
    strays = random.random((5, 3)) * (0.1, 0.1, 0) + (0, 0, 0.05)
    found = prefilter.find_outliers(np.concatenate([points, strays]))
    assert found[len(points) :].all()
    assert found[: len(points)].mean() < 0.002


def test_outliers_of_odd_points():
    assert len(prefilter.find_outliers(np.empty((0, 3)))) == 0
    points = np.array([(np.nan, 0, 0), (0, 0, 0), (0, 0, 0), (1e200, 0, 0), (1, 0, 0), (9, 9, 9)])
    np.testing.assert_array_equal(
        prefilter.find_outliers(points), [True, False, False, True, False, False]
    )
    # Copies count once: a hundred copies of an outlier are still an outlier.
    copies = np.concatenate([cloud(count=500), np.full((100, 3), 5.0)])
    assert prefilter.find_outliers(copies)[500:].all()
    for options, message in [
        ({"neighbours": 2}, "neighbours: found 2; a number from 3 to 1000 is needed"),
        ({"neighbours": 1001}, "neighbours: found 1001"),
        ({"factor": 1.0}, "factor: found 1; a number above 1 is needed"),
        ({"factor": np.nan}, "factor: found nan"),
        ({"factor": np.inf}, "factor: found inf"),
    ]:
        with pytest.raises(ValueError, match=message):
            prefilter.find_outliers(points, **options)


def turn(axis, angle):
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def motion(seed, angle=0.06, shift=0.03):
    random = np.random.default_rng(seed)
    matrix = np.eye(4)
    matrix[:3, :3] = turn(random.normal(size=3), angle)
    matrix[:3, 3] = shift * random.normal(size=3)
    return matrix


def body_scans(count, *, points=4000, noise=0.0, offset=(0.0, 0.0, 0.0)):
    """Views of a body from all around, each moved a little, and these motions."""
    scans, motions = [], []
    for k in range(count):
        random = np.random.default_rng(100 + k)
        u, v = random.random((2, points)) * 2 * np.pi
        ring = 1 + 0.35 * np.cos(v)
        body = np.stack(
            [ring * np.cos(u), 1.2 * ring * np.sin(u), 0.35 * np.sin(v) + 0.1 * np.cos(3 * u)], 1
        )
        side = np.array([np.cos(2 * np.pi * k / count), np.sin(2 * np.pi * k / count), 0.3])
        body = body[body @ side > -0.4]
        body = body + noise * random.normal(size=body.shape)
        matrix = motion(k) if k else np.eye(4)
        place = np.eye(4)
        place[:3, 3] = offset
        matrix = place @ matrix
        motions.append(matrix)
        scans.append(prefilter.ScanPoints(body @ matrix[:3, :3].T + matrix[:3, 3]))
    return scans, motions


@pytest.mark.parametrize(
    ("count", "noise", "offset", "allowed"),
    [(2, 0.0, (0, 0, 0), 3e-3), (5, 0.004, (0, 0, 0), 4e-3), (3, 0.0, (5e5, 4e6, 100), 3e-3)],
)
def test_scans_are_moved_back(count, noise, offset, allowed):
    """The oracle is the motion by which each was moved away."""
    scans, motions = body_scans(count, noise=noise, offset=offset)
    found = prefilter.align_scans(scans)
    np.testing.assert_array_equal(found.matrices[0], np.eye(4))
    for scan, matrix, moved_away in zip(scans, found.matrices, motions, strict=True):
        # Its points' positions in the frame of the first scan.
        local = (scan.positions - moved_away[:3, 3]) @ moved_away[:3, :3]
        expected = local @ motions[0][:3, :3].T + motions[0][:3, 3]
        aligned = scan.moved(matrix).positions
        assert np.linalg.norm(aligned - expected, axis=1).max() < allowed
        np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.linalg.det(matrix[:3, :3]) > 0
    assert found.after < 0.5 * found.before
    assert min(found.pairs) > 100


def farthest(scans, motions, found):
    """The greatest distance of an aligned point from its position in the first scan's frame."""
    most = 0.0
    for scan, matrix, away in zip(scans, found.matrices, motions, strict=True):
        local = (scan.positions - away[:3, 3]) @ away[:3, :3]
        expected = local @ motions[0][:3, :3].T + motions[0][:3, 3]
        aligned = scan.moved(matrix).positions
        most = max(most, np.linalg.norm(aligned - expected, axis=1).max())
    return most


@pytest.mark.parametrize("offset", [(0, 0, 0), (5e5, 4e6, 100)])
def test_a_surface_brings_five_scans_back_to_a_tenth_of_a_cell(offset):
    """Scans start off by a cell and more; the oracle is each scan's motion."""
    scans, motions = body_scans(5, points=8_000, noise=0.005, offset=offset)
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(scans, align="surface", report=report)
    found = prefilter.align_scans(scans, against="surface")
    assert report.alignment.after < 0.5 * report.alignment.before
    stay = prefilter.ScanAlignment(np.array([np.eye(4)] * 5), 0, 0, (0,) * 5)
    assert farthest(scans, motions, stay) > report.cell
    assert farthest(scans, motions, found) < 0.1 * report.cell
    np.testing.assert_array_equal(found.matrices[0], np.eye(4))
    assert found.after < 0.5 * found.before
    assert min(found.pairs) > 100


def test_a_surface_averages_the_noise_of_all():
    scans, motions = body_scans(5, points=20_000, noise=0.02)
    errors = {
        against: farthest(scans, motions, prefilter.align_scans(scans, against=against))
        for against in ("scans", "surface")
    }
    assert errors["surface"] < 0.8 * errors["scans"]


def test_normals_that_are_given_may_point_inward():
    scans, motions = body_scans(3, points=8000)
    turned = []
    for scan in scans:
        normals = prefilter.estimate_normals(scan.positions, direction="outward")
        turned.append(prefilter.ScanPoints(scan.positions, -normals))
    # Scans may be seen from inside or from outside, if all agree.
    center = scans[0].positions.mean(axis=0)
    for sign in (-1, 1):
        seen = []
        for scan in turned:
            away = np.einsum("nk,nk->n", scan.normals, scan.positions - center) < 0
            normals = np.where(away[:, None], -scan.normals, scan.normals) * sign
            seen.append(prefilter.ScanPoints(scan.positions, normals))
        found = prefilter.align_scans(seen, against="surface")
        assert farthest(scans, motions, found) < 5e-3


def test_outliers_and_unshared_points_do_not_move_a_scan():
    scans, motions = body_scans(2)
    random = np.random.default_rng(9)
    junk = 0.5 * random.normal(size=(400, 3)) + (0, 0, 2)
    near = scans[1].positions[:300] + 0.05 * random.normal(size=(300, 3))
    scans[1] = prefilter.ScanPoints(np.concatenate([scans[1].positions, junk, near]))
    found = prefilter.align_scans(scans)
    error = found.matrices[1] @ motions[1] - np.eye(4)
    assert np.abs(error).max() < 5e-3


def test_scans_apart_and_empty_ones_stay():
    scans, _ = body_scans(2)
    far = prefilter.ScanPoints(scans[0].positions + 50.0)
    odd = prefilter.ScanPoints(np.full((5, 3), np.nan), np.zeros((5, 3)))
    none = prefilter.ScanPoints(np.empty((0, 3)))
    for against in ("scans", "surface"):
        found = prefilter.align_scans([scans[0], far, odd, none], against=against)
        np.testing.assert_array_equal(found.matrices, [np.eye(4)] * 4)
        assert found.pairs == (0, 0, 0, 0)
        assert found.before == found.after == 0.0


def test_a_plane_slides_nowhere():
    """A plane fixes no motion along it: a scan is turned and lifted into it, and not slid along."""
    random = np.random.default_rng(3)
    first, second = random.random((2, 3000, 3)) * (1, 1, 0)
    tilted = second @ turn((1, 2, 0), 0.02).T + (0, 0, 0.01)
    found = prefilter.align_scans(
        [prefilter.ScanPoints(first), prefilter.ScanPoints(tilted)], reach=0.1
    )
    moved = prefilter.ScanPoints(tilted).moved(found.matrices[1]).positions
    assert np.abs(moved[:, 2]).max() < 1e-3
    assert np.abs(moved[:, :2] - tilted[:, :2]).max() < 0.02


def test_moved_points_have_moved_normals_and_viewpoints():
    points, normals = np.random.default_rng(4).normal(size=(2, 10, 3))
    matrix = motion(1, 0.7, 3.0)
    for viewpoint in (np.array([1.0, 2.0, 3.0]), points + 1.0):
        scan = prefilter.ScanPoints(points, normals, viewpoint=viewpoint).moved(matrix)
        rotation, shift = matrix[:3, :3], matrix[:3, 3]
        np.testing.assert_allclose(scan.positions, points @ rotation.T + shift, atol=1e-12)
        np.testing.assert_allclose(scan.normals, normals @ rotation.T, atol=1e-12)
        np.testing.assert_allclose(scan.viewpoint, viewpoint @ rotation.T + shift, atol=1e-12)
    with pytest.raises(ValueError, match="matrix: shape"):
        prefilter.ScanPoints(points).moved(np.eye(3))


def test_alignment_refuses():
    scans, _ = body_scans(2, points=200)
    for wrong, options, message in [
        (scans[:1], {}, "scans: found 1; two are needed"),
        ([scans[0].positions] * 2, {}, "scans: a list of ScanPoints is needed"),
        (scans, {"against": "points"}, "against: 'points'"),
        (scans, {"reach": 0.0}, "reach: found 0; a number above 0 is needed"),
        (scans, {"reach": np.inf}, "reach: found inf"),
        (scans, {"iterations": 0}, "iterations: found 0; a number from 1 to 1000 is needed"),
    ]:
        with pytest.raises(ValueError, match=message):
            prefilter.align_scans(wrong, **options)


def test_surfaces_of_aligned_scans(tmp_path):
    """Two scans that are apart have two surfaces; aligned, they have one, near the body's."""
    scans, _ = body_scans(3, points=20_000)
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(scans, depth=6, report=report)
    assert report.alignment is None
    apart = report.residual
    prefilter.reconstruct(scans, depth=6, align=True, report=report)
    assert report.alignment is not None
    assert report.alignment.after < 0.3 * report.alignment.before
    assert report.residual < 0.7 * apart
    one = prefilter.reconstruct_file(scans[0], tmp_path / "one.ply", depth=5, align=True)
    assert one.alignment is None


@pytest.mark.parametrize("threads", [1, 3])
def test_the_same_for_any_number_of_threads(threads):
    points = cloud(count=30_000)
    for method in ("poisson", "grid"):
        np.testing.assert_array_equal(
            prefilter.subsample_points(points, 0.02, method=method, threads=threads),
            prefilter.subsample_points(points, 0.02, method=method),
        )
    np.testing.assert_array_equal(
        prefilter.find_outliers(points, factor=1.3, threads=threads),
        prefilter.find_outliers(points, factor=1.3),
    )
    scans, _ = body_scans(3, points=1000)
    np.testing.assert_array_equal(
        prefilter.align_scans(scans, threads=threads).matrices,
        prefilter.align_scans(scans).matrices,
    )
    np.testing.assert_array_equal(
        prefilter.align_scans(scans, against="surface", threads=threads).matrices,
        prefilter.align_scans(scans, against="surface").matrices,
    )


def test_canceling():
    points = cloud(count=50_000)
    scans, _ = body_scans(2)
    for work in (
        lambda progress: prefilter.subsample_points(points, 0.01, progress=progress),
        lambda progress: prefilter.subsample_points(points, 0.01, method="grid", progress=progress),
        lambda progress: prefilter.find_outliers(points, progress=progress),
        lambda progress: prefilter.align_scans(scans, progress=progress),
        lambda progress: prefilter.align_scans(scans, against="surface", progress=progress),
    ):
        told = []
        work(lambda done, told=told: told.append(done))
        assert told == sorted(told)
        assert told[-1] == 1.0
        with pytest.raises(prefilter.Cancelled):
            work(lambda done: done < 0.4)
