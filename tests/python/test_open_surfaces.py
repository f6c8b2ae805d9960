# SPDX-License-Identifier: GPL-3.0-or-later

"""Open scans: exactly the parts of the surface that no sample supports are cut."""

import numpy as np
import prefilter
import pytest
from clouds import sphere

BALL = sphere(60_000)
HALF = BALL.points[:, 2] > 0
BASES = pytest.mark.parametrize("wavelet", ["haar", "d4"])


def rebuilt(points, normals, **options):
    report = prefilter.ReconstructionReport()
    options = {"depth": 6, "report": report} | options
    return *prefilter.reconstruct(points, normals, **options), report


def edges(triangles):
    """The distinct edges, and the number of triangles at each."""
    found = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(found, axis=1), axis=0, return_counts=True)


def borders(triangles):
    """The number of closed curves at which a mesh ends; it is a manifold with these."""
    found, counts = edges(triangles)
    assert counts.max() <= 2
    ends = found[counts == 1]
    vertices, degrees = np.unique(ends, return_counts=True)
    assert (degrees == 2).all()
    next_of = {int(v): [] for v in vertices}
    for a, b in ends.tolist():
        next_of[a].append(b)
        next_of[b].append(a)
    count, left = 0, set(next_of)
    while left:
        count += 1
        waiting = [left.pop()]
        while waiting:
            for v in next_of[waiting.pop()]:
                if v in left:
                    left.remove(v)
                    waiting.append(v)
    return count


def area(positions, triangles):
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def flat(count, size, seed=0):
    """Points of a square, and their normals."""
    points = np.random.default_rng(seed).random((count, 3)) * [size, size, 0]
    return points, np.tile([0.0, 0.0, 1.0], (count, 1))


@BASES
@pytest.mark.parametrize("count", [1_500, 60_000])
@pytest.mark.parametrize("depth", [5, 7])
def test_a_closed_cloud_has_the_closed_surface_to_the_bit(wavelet, count, depth):
    cloud = sphere(count)
    found = [
        rebuilt(cloud.points, cloud.normals, wavelet=wavelet, depth=depth, watertight=watertight)
        for watertight in (False, True)
    ]
    np.testing.assert_array_equal(found[0][0], found[1][0])
    np.testing.assert_array_equal(found[0][1], found[1][1])
    assert (found[0][2].cut, found[0][2].islands) == (0, 0)


@BASES
@pytest.mark.parametrize("depth", [5, 6, 7])
def test_half_a_sphere_ends_where_its_points_do(wavelet, depth):
    positions, triangles, report = rebuilt(
        BALL.points[HALF], BALL.normals[HALF], wavelet=wavelet, depth=depth
    )
    assert borders(triangles) == 1
    found, counts = edges(triangles)
    ends = positions[np.unique(found[counts == 1])]
    assert np.abs(ends[:, 2]).max() < 3 * report.cell
    assert np.abs(np.linalg.norm(ends, axis=1) - 1).max() < 2 * report.cell
    whole = 2 * np.pi
    assert whole * 0.99 < area(positions, triangles) < whole + 2 * np.pi * 3 * report.cell
    assert 0.1 < report.cut < 0.6


@BASES
def test_a_plane_stays_a_plane(wavelet):
    points, normals = flat(40_000, 1.0)
    positions, triangles, report = rebuilt(points, normals, wavelet=wavelet, depth=7)
    assert borders(triangles) == 1
    heights = np.abs(positions[:, 2])
    is_inner = ((positions[:, :2] > 0) & (positions[:, :2] < 1)).all(axis=1)
    assert heights[is_inner].max() < 0.25 * report.cell
    # Beyond the last points the surface may bend.
    assert heights.max() < 2.5 * report.cell
    assert positions[:, :2].min() > -2.5 * report.cell
    assert positions[:, :2].max() < 1 + 2.5 * report.cell
    assert 0.95 < area(positions, triangles) < (1 + 5 * report.cell) ** 2


def test_borders_do_not_curl():
    """Beyond the last points a sheet would turn back: little of that is left, without folds."""
    points, normals = flat(40_000, 1.0)
    positions, triangles, _ = rebuilt(points, normals, depth=7)
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    faces = np.cross(b - a, c - a)
    steepness = faces[:, 2] / np.linalg.norm(faces, axis=1)
    assert steepness.min() > 0.3
    areas = np.linalg.norm(faces, axis=1)
    assert areas[steepness < 0.5].sum() < 5e-5 * areas.sum()


@pytest.mark.parametrize(("radius", "is_open"), [(3.0, False), (12.0, True)])
def test_small_holes_are_filled(radius, is_open):
    """Radii in cells."""
    cell = rebuilt(BALL.points, BALL.normals)[2].cell
    away = np.linalg.norm(BALL.points - [0, 0, 1], axis=1) > radius * cell
    positions, triangles, report = rebuilt(BALL.points[away], BALL.normals[away])
    assert borders(triangles) == int(is_open)
    assert (report.cut > 0) == is_open
    if is_open:
        hole = np.linalg.norm(positions - [0, 0, 1], axis=1).min()
        assert (radius - 2.5) * cell < hole < (radius + 0.5) * cell


@pytest.mark.parametrize("depth", [6, 7, 9])
def test_thin_parts_stay(depth):
    """A thousand times thinner at the top: points there are farther from each other."""
    cloud = sphere(2_000_000, seed=4)
    share = 10 ** (-1.5 * (cloud.points[:, 2] + 1))
    kept = np.random.default_rng(3).random(len(share)) < share
    _, triangles, report = rebuilt(cloud.points[kept], cloud.normals[kept], depth=depth)
    assert report.cut == 0
    assert borders(triangles) == 0


def with_patch(count, size):
    """A square of points, and a smaller one beside it."""
    points, normals = flat(20_000, 1.0)
    patch, up = flat(count, size, seed=1)
    beside = patch + np.array([1.5, 0.5, 0.0])
    return np.concatenate([points, beside]), np.concatenate([normals, up])


def test_islands_are_removed_and_reported():
    positions, _, report = rebuilt(*with_patch(3, 0.004), depth=7)
    assert positions[:, 0].max() < 1.2
    # Points that are so few beside so dense ones bound no surface in the first place.
    assert report.islands >= 1 or report.outliers == pytest.approx(3 / 20_003, rel=1e-3)
    assert report.island_share < 0.01


def test_small_parts_stay_unless_more_is_asked_for():
    cloud = with_patch(60, 0.04)
    assert rebuilt(*cloud, depth=7)[0][:, 0].max() > 1.5
    positions, triangles, support, _ = rebuilt(*cloud, depth=7, watertight=True, support=True)
    kept, gone = (
        prefilter.trim(positions, triangles, **support, island=island) for island in (12, 1000)
    )
    assert kept.positions[:, 0].max() > 1.5
    assert (gone.islands, gone.positions[:, 0].max() < 1.2) == (kept.islands + 1, True)


@BASES
@pytest.mark.parametrize("depth", [6, 8])
def test_threads_and_memory_do_not_count(wavelet, depth):
    found = [
        rebuilt(
            BALL.points[HALF],
            BALL.normals[HALF],
            wavelet=wavelet,
            depth=depth,
            threads=threads,
            memory_limit=limit,
            support=True,
        )
        for threads, limit in ((1, None), (3, 0), (2, None))
    ]
    assert found[1][3].is_spilled
    for other in found[1:]:
        for a, b in zip(found[0][:2], other[:2], strict=True):
            np.testing.assert_array_equal(a, b)
        for name, values in found[0][2].items():
            np.testing.assert_array_equal(values, other[2][name])


def test_support_of_vertices():
    positions, _, support, report = rebuilt(
        BALL.points[HALF], BALL.normals[HALF], depth=7, watertight=True, support=True
    )
    spacing = np.maximum(1 / np.sqrt(support["density"]), report.cell)
    tree = pytest.importorskip("scipy.spatial").cKDTree(BALL.points[HALF])
    distance = tree.query(positions)[0]
    # Distances are measured to the means of samples in cells, or of those facing the same way, so
    # they may be longer than the distance to a sample, and hardly shorter.
    assert (support["distance"] * spacing > 0.7 * distance - report.cell).all()
    on_ball = positions[:, 2] > 0
    assert np.quantile(support["distance"][on_ball], 0.999) < 1.5
    assert support["distance"][distance > 3 * report.cell].min() > 1.5
    above = positions[:, 2] > 3 * report.cell
    number = HALF.sum() / (2 * np.pi)
    assert np.median(support["density"][above]) == pytest.approx(number, rel=0.1)


def test_trimming_a_closed_surface_gives_the_open_one():
    points, normals = BALL.points[HALF], BALL.normals[HALF]
    positions, triangles, support, report = rebuilt(points, normals, watertight=True, support=True)
    heights = positions[:, 2:].astype(np.float32)
    made = prefilter.trim(positions, triangles, **support, attributes=heights)
    expected = rebuilt(points, normals)
    assert borders(made.triangles) == 1
    assert area(made.positions, made.triangles) == pytest.approx(area(*expected[:2]), rel=0.01)
    assert made.cut == pytest.approx(expected[2].cut, abs=0.02)
    assert made.distance.max() == pytest.approx(1.5)
    np.testing.assert_allclose(made.attributes[:, 0], made.positions[:, 2], atol=1e-5)
    # Less, then, from its end.
    less = prefilter.trim(made.positions, made.triangles, made.distance, made.density, limit=0.7)
    assert 0 < less.cut < 0.1
    assert less.positions[:, 2].min() > made.positions[:, 2].min() + 0.3 * report.cell
    assert borders(less.triangles) >= 1


def test_trimming_nothing_changes_nothing():
    positions, triangles, support, _ = rebuilt(BALL.points, BALL.normals, support=True)
    made = prefilter.trim(positions, triangles, **support)
    np.testing.assert_array_equal(made.positions, positions)
    np.testing.assert_array_equal(made.triangles, triangles)
    assert (made.cut, made.islands, made.attributes) == (0, 0, None)


TRIANGLE = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((*TRIANGLE, [0, 0], [1, 1, 1]), {}, "distance: "),
        ((*TRIANGLE, [0, np.nan, 0], [1, 1, 1]), {}, "distance: nan at vertex 1"),
        ((*TRIANGLE, [0, 0, 0], [1, 1, -1]), {}, "density: -1 at vertex 2"),
        ((TRIANGLE[0], [[0, 1, 3]], [0, 0, 0], [1, 1, 1]), {}, "triangles: index 3"),
        ((*TRIANGLE, [0, 0, 0], [1, 1, 1]), {"limit": -1}, "limit: -1"),
        ((*TRIANGLE, [0, 0, 0], [1, 1, 1]), {"hole": np.inf}, "hole: inf"),
        ((*TRIANGLE, [0, 0, 0], [1, 1, 1]), {"attributes": [[1]]}, "attributes: "),
    ],
)
def test_trimming_refuses_what_it_cannot_use(arguments, options, message):
    with pytest.raises(ValueError, match="^" + message):
        prefilter.trim(*arguments, **options)


def test_trimming_may_leave_nothing():
    made = prefilter.trim(*TRIANGLE, [9, 9, 9], [1, 1, 1])
    assert (len(made.positions), len(made.triangles), made.cut) == (0, 0, 1)
    empty = prefilter.trim(np.zeros((0, 3)), np.zeros((0, 3), int), [], [])
    assert (len(empty.triangles), empty.cut) == (0, 0)


def test_support_in_files(tmp_path):
    scan = prefilter.ScanPoints(BALL.points, BALL.normals, None, {})
    prefilter.reconstruct_file(scan, tmp_path / "a.ply", depth=5)
    read = prefilter.read_points(tmp_path / "a.ply")
    assert {"distance", "density"} <= set(read.attributes)
