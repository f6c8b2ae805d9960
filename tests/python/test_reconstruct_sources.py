# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of files and of scans in memory, alone and put together."""

from pathlib import Path

import numpy as np
import prefilter
import pytest
import solids
from clouds import Cloud, sphere, torus
from scan_writers import ply, write

DEPTH = 6
TORUS = torus(30_000)
FAR = np.array([500_000.0, 5_000_000.0, 100.0])
XYZ = [("double", name) for name in "xyz"]
NORMALS = [("float", name) for name in ("nx", "ny", "nz")]


def _written(
    folder: Path,
    name: str,
    cloud: Cloud,
    part: slice = slice(None),
    more: tuple[tuple[str, str, np.ndarray], ...] = (),
    has_normals: bool = True,
) -> Path:
    kinds = XYZ + (NORMALS if has_normals else []) + [(kind, name) for kind, name, _ in more]
    columns = [*cloud.points[part].T.tolist()]
    columns += cloud.normals[part].T.tolist() if has_normals else []
    columns += [values[part].tolist() for _, _, values in more]
    rows = list(zip(*columns, strict=True))
    return write(folder, name, ply("binary_little_endian", [("vertex", kinds, rows)]))


def _is_torus(positions: np.ndarray, triangles: np.ndarray, cells: float = 0.1) -> bool:
    error = np.abs(TORUS.distance(positions)).mean()
    return solids.surface_faults(positions, triangles).none and error < cells * 4 / 2**DEPTH


def test_a_file_gives_the_same_surface_as_its_arrays(tmp_path: Path) -> None:
    path = _written(tmp_path, "torus.ply", TORUS)
    read = prefilter.read_points(path)
    expected = prefilter.reconstruct(read.positions, read.normals, depth=DEPTH)
    for source in (path, str(path), [path], read, [read]):
        found = prefilter.reconstruct(source, depth=DEPTH)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("count", [2, 3])
def test_parts_give_the_same_surface_as_the_whole(tmp_path: Path, count: int) -> None:
    """Results agree up to rounding, for files and for scans in memory."""
    expected = prefilter.reconstruct(TORUS.points, TORUS.normals, depth=DEPTH)
    parts = [slice(i, None, count) for i in range(count)]
    paths = [_written(tmp_path, f"{i}.ply", TORUS, part) for i, part in enumerate(parts)]
    scans = [prefilter.ScanPoints(TORUS.points[part], TORUS.normals[part]) for part in parts]
    for sources in (paths, scans, [paths[0], *scans[1:]]):
        found = prefilter.reconstruct(sources, depth=DEPTH)
        np.testing.assert_array_equal(found[1], expected[1])
        np.testing.assert_allclose(found[0], expected[0], atol=1e-5)


def test_files_to_a_file_keep_their_doubles(tmp_path: Path) -> None:
    """Floats are half a unit apart at five millions."""
    far = Cloud(TORUS.points + FAR, TORUS.normals, TORUS.distance)
    halves = [_written(tmp_path, f"{i}.ply", far, slice(i, None, 2)) for i in range(2)]
    target = tmp_path / "out.ply"
    report = prefilter.reconstruct_file(halves, target, depth=DEPTH)
    assert report.points == len(far.points)
    assert b"property double x" in target.read_bytes()[:300]
    made = prefilter.read_points(target)
    assert len(made.positions) == report.vertices
    assert np.abs(TORUS.distance(made.positions - FAR)).mean() < 0.1 * report.cell


def test_a_file_without_normals_keeps_its_doubles(tmp_path: Path) -> None:
    far = Cloud(TORUS.points + FAR, TORUS.normals, TORUS.distance)
    source = _written(tmp_path, "far.ply", far, has_normals=False)
    target = tmp_path / "out.ply"
    report = prefilter.reconstruct_file(source, target, depth=DEPTH)
    made = prefilter.read_points(target)
    assert np.abs(TORUS.distance(made.positions - FAR)).mean() < 0.1 * report.cell


def test_normals_of_parts_are_estimated_together(tmp_path: Path) -> None:
    """Each of three files has every third point of a torus; only one has normals."""
    parts = [slice(i, None, 3) for i in range(3)]
    paths = [
        _written(tmp_path, f"{i}.ply", TORUS, part, has_normals=i == 0)
        for i, part in enumerate(parts)
    ]
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(paths, depth=DEPTH, report=report)
    assert report.points == len(TORUS.points)
    assert _is_torus(positions, triangles)


def test_viewpoints_count_for_their_scans_alone() -> None:
    """Two spheres, each seen from outside; both from the same side would turn half of one."""
    ball = sphere(20_000)
    scans = []
    for sign in (-1.0, 1.0):
        place = np.array([sign * 30.0, 0.0, 0.0])
        seen = ball.points[:, 0] * sign > 0.2
        scans.append(prefilter.ScanPoints(ball.points[seen], viewpoint=place))
    scans.append(
        prefilter.ScanPoints(
            ball.points[np.abs(ball.points[:, 0]) < 0.3],
            ball.normals[np.abs(ball.points[:, 0]) < 0.3],
        )
    )
    positions, triangles = prefilter.reconstruct(scans, depth=5)
    assert solids.mesh_volume(positions, triangles) == pytest.approx(4 / 3 * np.pi, rel=0.02)


def test_cell_size_is_the_greatest_side_of_a_cell() -> None:
    report = prefilter.ReconstructionReport()
    cells = []
    for depth in range(2, 8):
        prefilter.reconstruct(TORUS.points, TORUS.normals, depth=depth, report=report)
        cells.append(report.cell)
    for depth, cell in enumerate(cells, 2):
        for size in (cell, np.float32(cell) * np.float32(1 - 1e-7), 1.9 * cell):
            prefilter.reconstruct(TORUS.points, TORUS.normals, cell_size=size, report=report)
            assert report.cell == cell, depth


def test_attributes_of_several(tmp_path: Path) -> None:
    """Attributes are matched by name; a missing color is white, any other missing value 0."""
    left, right = TORUS.points[:, 0] < 0, TORUS.points[:, 0] >= 0
    heights = TORUS.points[:, 2]
    black = np.zeros(len(heights), int)
    colors = tuple(("uchar", name, black) for name in ("red", "green", "blue"))
    paths = []
    for name, chosen, more in (
        ("left.ply", left, (("float", "height", 100 + heights), *colors)),
        ("right.ply", right, (("float", "age", heights),)),
    ):
        cloud = Cloud(TORUS.points[chosen], TORUS.normals[chosen], TORUS.distance)
        own = tuple((kind, one, values[chosen]) for kind, one, values in more)
        paths.append(_written(tmp_path, name, cloud, more=own))
    positions, _, found = prefilter.reconstruct(paths, depth=DEPTH, attributes=True)
    assert {name: values.dtype.name for name, values in found.items()} == {
        "height": "float32",
        "red": "uint8",
        "green": "uint8",
        "blue": "uint8",
        "age": "float32",
    }
    far = np.abs(positions[:, 0]) > 0.2
    is_left = positions[far, 0] < 0
    np.testing.assert_array_equal(found["red"][far], np.where(is_left, 0, 255))
    z = positions[far, 2]
    np.testing.assert_allclose(found["height"][far], np.where(is_left, 100 + z, 0), atol=0.1)
    np.testing.assert_allclose(found["age"][far], np.where(is_left, 0, z), atol=0.1)


def test_weights_of_scans() -> None:
    """A second, larger torus of weight 0 does not count."""
    count = len(TORUS.points)
    scans = [
        prefilter.ScanPoints(TORUS.points, TORUS.normals),
        prefilter.ScanPoints(
            TORUS.points + 0.1 * TORUS.normals, TORUS.normals, np.zeros(count, np.float32)
        ),
    ]
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(scans, depth=DEPTH, report=report)
    assert (report.points, report.dropped) == (2 * count, count)
    assert _is_torus(positions, triangles)


def test_progress_goes_up_to_the_end(tmp_path: Path) -> None:
    for has_normals in (True, False):
        path = _written(tmp_path, "torus.ply", TORUS, has_normals=has_normals)
        told: list[float] = []
        prefilter.reconstruct([path, path], depth=5, progress=told.append)
        assert told == sorted(told)
        assert told[-1] == 1.0
        assert told[0] <= 0.1


SCAN = prefilter.ScanPoints(TORUS.points, TORUS.normals)


@pytest.mark.parametrize(
    ("source", "options", "words"),
    [
        (SCAN, {"normals": TORUS.normals}, "normals: given beside files or scans"),
        (SCAN, {"weights": np.ones(3)}, "weights: given beside files or scans"),
        (SCAN, {"attributes": np.ones((3, 1))}, "attributes: given beside files or scans"),
        ([], {}, "points: "),
        (["none.xxx"], {}, r"'none.xxx': unsupported extension"),
        ([SCAN, TORUS.points], {}, "points"),
        (prefilter.ScanPoints(TORUS.points[:, :2]), {}, r"positions: shape \(30000, 2\)"),
        (prefilter.ScanPoints(TORUS.points, TORUS.normals[1:]), {}, "normals: 29999 rows"),
        (
            prefilter.ScanPoints(TORUS.points, TORUS.normals, attributes={"a": np.ones(3)}),
            {},
            r"attributes: 'a': shape \(3,\)",
        ),
        (SCAN, {"cell_size": 0.0}, "cell_size: 0; a length above 0 is needed"),
        (SCAN, {"cell_size": float("nan")}, "cell_size: nan"),
        (SCAN, {"cell_size": "1"}, "cell_size: '1'"),
        (
            SCAN,
            {"cell_size": 1e-6},
            "cell_size: 1e-06 would need more than 4096 cells .* use 0.00.* or",
        ),
    ],
)
def test_refusals(source: object, options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        prefilter.reconstruct(source, **options)
