# SPDX-License-Identifier: GPL-3.0-or-later

"""Choosing points by class, by return, and by box."""

import numpy as np
import prefilter
import pytest
from scan_writers import ply, write

COUNT = 200_000  # More than are read at once.


def scan(seed=0, count=COUNT):
    """Points with all attributes."""
    random = np.random.default_rng(seed)
    of = random.integers(0, 5, count)
    return prefilter.ScanPoints(
        random.random((count, 3)),
        random.normal(size=(count, 3)).astype(np.float32),
        random.random(count).astype(np.float32),
        {
            "classification": random.integers(0, 20, count).astype(np.uint8),
            "return_number": np.minimum(random.integers(0, 5, count), of).astype(np.uint8),
            "number_of_returns": of.astype(np.uint8),
            "intensity": random.random(count).astype(np.float32),
        },
    )


def file_of(folder, points, names=("Classification", "ReturnNumber", "NumberOfReturns")):
    """A file of points, with attribute names of other programs."""
    kinds = [*(("double", axis) for axis in "xyz"), *(("float", f"n{axis}") for axis in "xyz")]
    kinds += [("float", "confidence"), *(("uchar", name) for name in names), ("float", "Intensity")]
    columns = [points.positions, points.normals, points.weights[:, None]]
    header = ply("binary_little_endian", [("vertex", kinds, [])])
    layout = np.dtype(
        [(name, {"double": "<f8", "float": "<f4", "uchar": "u1"}[kind]) for kind, name in kinds]
    )
    table = np.empty(len(points.positions), layout)
    values = [*np.concatenate(columns, axis=1).T, *points.attributes.values()]
    for (_, name), column in zip(kinds, values, strict=True):
        table[name] = column
    header = header.replace(b"element vertex 0", b"element vertex %d" % len(table))
    return write(folder, "cloud.ply", header + table.tobytes())


def expected(points, classes=None, returns="all", box=None):
    """Whether each point is chosen, tested one by one."""
    names = ("classification", "return_number", "number_of_returns")
    columns = zip(points.positions, *(points.attributes[name] for name in names), strict=True)
    for position, own, number, of in columns:
        is_first, is_last = max(number, 1) == 1, max(number, 1) == max(of, 1)
        yield (
            (classes is None or own in np.atleast_1d(classes))
            and {"all": True, "first": is_first, "last": is_last, "only": max(of, 1) == 1}[returns]
            and (box is None or all(a <= x <= b for a, b, x in zip(*box, position, strict=True)))
        )


@pytest.mark.parametrize(
    "choice",
    [
        {"classes": 2},
        {"classes": [0, 2, 19]},
        {"classes": 200},
        {"returns": "first"},
        {"returns": "last"},
        {"returns": "only"},
        {"box": [(0.25, 0.0, 0.5), (0.75, 1.0, 0.5625)]},
        {"classes": np.array([1, 3], np.uint8), "returns": "last", "box": ((0, 0, 0), (0.5, 1, 1))},
    ],
)
def test_choices(tmp_path, choice):
    points = scan(count=70_000)
    chosen = np.array(list(expected(points, **choice)))
    read = prefilter.read_points(file_of(tmp_path, points), **choice)
    for found in (read, prefilter.choose_points(points, **choice)):
        np.testing.assert_array_equal(found.positions, points.positions[chosen])
        np.testing.assert_array_equal(found.normals, points.normals[chosen])
        np.testing.assert_array_equal(found.weights, points.weights[chosen])
        assert list(found.attributes) == list(points.attributes)
        for name, values in points.attributes.items():
            np.testing.assert_array_equal(found.attributes[name], values[chosen])


def test_numbers_of_returns_from_one_on():
    points = scan(count=1000)
    for values in (points.attributes["return_number"], points.attributes["number_of_returns"]):
        values[:] = np.maximum(values, 1)
    first = prefilter.choose_points(points, returns="first")
    assert (first.attributes["return_number"] == 1).all()
    last = prefilter.choose_points(points, returns="last").attributes
    assert (last["return_number"] == last["number_of_returns"]).all()


def test_a_choice_of_everything_changes_nothing(tmp_path):
    points = scan(count=100)
    assert prefilter.choose_points(points) is points
    path = file_of(tmp_path, points)
    np.testing.assert_array_equal(prefilter.read_points(path, box=None).positions, points.positions)


def test_points_that_are_not_finite_are_in_no_box(tmp_path):
    points = scan(count=100)
    points.positions[:3] = [(np.nan, 0, 0), (0, np.inf, 0), (0, 0, -np.inf)]
    box = [(-np.inf,) * 3, (np.inf,) * 3]
    for found in (
        prefilter.choose_points(points, box=[(-1e30,) * 3, (1e30,) * 3]),
        prefilter.read_points(file_of(tmp_path, points), box=[(-1e30,) * 3, (1e30,) * 3]),
    ):
        np.testing.assert_array_equal(found.positions, points.positions[3:])
    np.testing.assert_array_equal(
        prefilter.choose_points(points, box=box).positions, points.positions[1:]
    )


def test_chosen_points_are_thinned(tmp_path):
    points = scan()
    path = file_of(tmp_path, points)
    every = prefilter.read_points(path, classes=2)
    some = prefilter.read_points(path, classes=2, most=1000)
    assert some.stride & (some.stride - 1) == 0
    np.testing.assert_array_equal(some.positions, every.positions[:: some.stride])
    assert 500 < len(some.positions) <= 1000


def test_refusals(tmp_path):
    points = scan(count=100)
    path = file_of(tmp_path, points, ("class", "number", "of"))
    bare = prefilter.ScanPoints(points.positions)
    for choice, name in [
        ({"classes": 2}, "classification"),
        ({"returns": "first"}, "return_number"),
        ({"returns": "last"}, "return_number"),
        ({"returns": "only"}, "number_of_returns"),
    ]:
        option = next(iter(choice))
        with pytest.raises(ValueError, match=rf"{option}: points of .*cloud.ply' have no '{name}'"):
            prefilter.read_points(path, **choice)
        with pytest.raises(ValueError, match=f"{option}: the points have no '{name}'"):
            prefilter.choose_points(bare, **choice)
    for choice, message in [
        ({"classes": []}, r"classes: \[\]; whole numbers from 0 to 255 are needed"),
        ({"classes": 256}, "classes: 256; whole"),
        ({"classes": -1}, "classes: -1; whole"),
        ({"classes": 2.5}, "classes: 2.5; whole"),
        ({"classes": [[2]]}, "classes: "),
        ({"classes": "ground"}, "classes: "),
        ({"returns": "second"}, "returns: 'second' is not one of all, first, last, only"),
        ({"box": [(1, 0, 0), (0, 1, 1)]}, "box: from .* to .*; the lowest corner and the highest"),
        ({"box": [(0, 0, np.nan), (1, 1, 1)]}, "box: from"),
        ({"box": [(0, 0), (1, 1)]}, "box: shape"),
    ]:
        with pytest.raises(ValueError, match=message):
            prefilter.choose_points(points, **choice)
        with pytest.raises(ValueError, match=message):
            prefilter.read_points(path, **choice)
    with pytest.raises(ValueError, match="box, align: given beside arrays; they are for files"):
        prefilter.reconstruct(points.positions, box=[(0, 0, 0), (1, 1, 1)])


def test_surfaces_of_chosen_points(tmp_path):
    """Chooses a plane without the objects on it: no vertex is far from the plane."""
    random = np.random.default_rng(2)
    points = scan(count=60_000)
    plane = random.random(60_000) < 0.7
    positions = np.where(plane[:, None], points.positions * (1, 1, 0.001), points.positions)
    points.normals[:] = (0, 0, 1)
    points.attributes["classification"][:] = np.where(plane, 2, 5)
    whole = prefilter.ScanPoints(positions, points.normals, None, points.attributes)
    path = file_of(
        tmp_path,
        prefilter.ScanPoints(
            positions, points.normals, np.ones(60_000, np.float32), points.attributes
        ),
    )
    for source in (whole, path):
        found, _ = prefilter.reconstruct([source], depth=6, trim=2.0, classes=2)
        assert len(found) > 1000
        assert np.abs(found[:, 2]).max() < 0.1
    target = tmp_path / "mesh.ply"
    box = [(0, 0, -1), (0.5, 0.5, 1)]
    report = prefilter.reconstruct_file(path, target, depth=6, trim=2.0, classes=2, box=box)
    assert report.points == np.count_nonzero(plane & (positions[:, :2] <= 0.5).all(axis=1))
    assert prefilter.read_points(target).positions[:, :2].max() < 0.6


def test_grids_and_faces_count_before_points_are_chosen(tmp_path):
    """Faces index points of the whole file; chosen points keep the normals of their faces."""
    side = 20
    x, y = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
    rows = [(float(a), float(b), 0.0) for a, b in zip(x.ravel(), y.ravel(), strict=True)]
    corners = [
        (k, k + side, k + side + 1, k + 1) for k in range(side * (side - 1)) if k % side != side - 1
    ]
    properties = [("float", axis) for axis in "xyz"]
    faces = [([*each],) for each in corners]
    path = write(
        tmp_path,
        "faces.ply",
        ply(
            "binary_little_endian",
            [("vertex", properties, rows), ("face", [("uchar", "int", "vertex_indices")], faces)],
        ),
    )
    report = prefilter.ReconstructionReport()
    found, _ = prefilter.reconstruct(
        [path], depth=4, trim=2.0, box=[(5, 5, -1), (15, 15, 1)], report=report
    )
    assert report.points == 11 * 11
    # The plane is where its points are, and bends by less than a cell where they end.
    inside = np.abs(found[:, :2] - 10).max(axis=1) < 3.5
    assert inside.sum() > 50
    assert np.abs(found[inside, 2]).max() < 1e-4
    assert np.abs(found[:, 2]).max() < 0.8
