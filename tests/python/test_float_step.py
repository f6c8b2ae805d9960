# SPDX-License-Identifier: GPL-3.0-or-later

"""Detection of coordinates far from the origin that single precision has rounded."""

import clouds
import numpy as np
import prefilter
import pytest
from scan_writers import ply, write

AWAY = np.array([512_000.0, 5_403_000.0, 250.0])


def rounded(points):
    return points.astype(np.float32).astype(np.float64)


def test_the_step_is_that_of_single_precision():
    points = 100 * clouds.sphere(2000).points
    for shift in (0.0, 3e3, 7e5, 5.4e6, 1e12):
        moved = rounded(points + np.array([shift, 0, 0]))
        expected = float(np.spacing(np.float32(np.abs(moved).max())))
        assert prefilter.float_step(moved) == expected
        assert prefilter.float_step(-moved) == expected
        assert prefilter.float_step(moved[:, [1, 2, 0]]) == expected


@pytest.mark.parametrize(
    "points",
    [
        clouds.sphere(2000).points + AWAY,
        (clouds.sphere(2000).points + AWAY).round(2),
        # Numbers that single precision holds exactly do not count as rounded.
        np.random.default_rng(1).integers(0, 1000, (2000, 3)) * 1.0,
        np.random.default_rng(1).integers(0, 1000, (2000, 3)) * 0.25 + [5e5, 5e5, 0],
        np.random.default_rng(1).integers(0, 1000, (2000, 3)) * 0.25
        + [5e5, 5e5, 5e5]
        + (np.arange(2000) < 50)[:, None] * 2.0**-5,
        np.zeros((5, 3)),
        np.empty((0, 3)),
        np.full((9, 3), np.nan),
        np.full((9, 3), 1e300),
    ],
)
def test_coordinates_without_rounding(points):
    assert prefilter.float_step(points) == 0


def test_one_axis_is_enough():
    points = clouds.sphere(2000).points + AWAY
    points[:, 1] = rounded(points[:, 1])
    points[::9] = np.inf
    assert prefilter.float_step(points) == 0.5


def test_reconstructions_report_the_step(tmp_path):
    """Steps are reported if they are larger than a quarter of a cell."""
    ball = clouds.sphere(20_000, radius=40.0)
    columns = [(kind, name) for kind in ("float",) for name in (*"xyz", "nx", "ny", "nz")]
    rows = np.hstack([ball.points + AWAY, ball.normals])
    single = write(tmp_path, "single.ply", ply("binary_little_endian", [("vertex", columns, rows)]))
    for depth, expected in ((3, 0.0), (7, 0.5)):
        report = prefilter.reconstruct_file(single, tmp_path / "mesh.ply", depth=depth)
        assert report.float_step == expected
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(ball.points + AWAY, ball.normals, depth=7, report=report)
    assert report.float_step == 0
    prefilter.reconstruct(rounded(ball.points + AWAY), ball.normals, depth=7, report=report)
    assert report.float_step == 0.5


def test_bad_input():
    for points in (np.zeros((3, 2)), "points", [[1.0, 2.0]]):
        with pytest.raises(ValueError, match="positions: "):
            prefilter.float_step(points)
