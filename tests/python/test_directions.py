# SPDX-License-Identifier: GPL-3.0-or-later

"""Directions of normals: as given, up, to the viewpoint, outward; and Automatic's choice."""

import numpy as np
import prefilter
import pytest
import solids
from prefilter import _native
from scan_writers import ply, write

RANDOM = np.random.default_rng(71)
AWAY = np.array([5e5, 5e6, 300])
ROOM = np.array([4.013, 3.027, 1.529])


def unit(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def ball(count=20_000):
    return unit(np.random.default_rng(1).normal(size=(count, 3)))


def box(half=ROOM, count=60_000):
    """Points on the faces of a box, as many on each area, and the normals that point out of it."""
    random = np.random.default_rng(2)
    areas = np.repeat(half.prod() / half, 2)
    face = random.choice(6, count, p=areas / areas.sum())
    rows = np.arange(count)
    points, normals = random.uniform(-1, 1, (count, 3)), np.zeros((count, 3))
    points[rows, face // 2] = normals[rows, face // 2] = np.where(face % 2, 1.0, -1.0)
    return points * half, normals


def terrain(count=40_000, noise=0.0):
    random = np.random.default_rng(3)
    x, y = random.uniform(-5, 5, (2, count))
    z = 0.4 * np.sin(x) * np.cos(y)
    slopes = np.stack([-0.4 * np.cos(x) * np.cos(y), 0.4 * np.sin(x) * np.sin(y)], axis=1)
    normals = unit(np.column_stack([slopes, np.ones(count)]))
    return np.column_stack([x, y, z + noise * random.normal(size=count)]), normals


def town(count=60_000):
    """A plane with houses on it: their flat roofs and upright walls; and the normals."""
    ground = np.random.default_rng(4).uniform(-5, 5, (count, 2))
    centers = np.array([[-2.5, -2.5], [0.4, 2.0], [3.0, -1.5]])
    off = ground[:, None] - centers
    on_roof = (np.abs(off) < 1.0).all(axis=2).any(axis=1)
    points = [np.column_stack([ground, np.where(on_roof, 1.5, 0.0)])]
    normals = [np.tile([0.0, 0.0, 1.0], (count, 1))]
    random = np.random.default_rng(5)
    for center in centers:
        for axis in (0, 1):
            for side in (-1.0, 1.0):
                wall = random.uniform(-1, 1, (int(count * 0.03), 3))
                wall[:, axis], wall[:, 2] = side, 0.75 * (wall[:, 2] + 1)
                points.append(wall + np.array([*center, 0.0]))
                out = np.zeros((len(wall), 3))
                out[:, axis] = side
                normals.append(out)
    return np.concatenate(points), np.concatenate(normals)


def signs(count):
    return np.random.default_rng(6).choice([-1.0, 1.0], (count, 1))


def rebuilt(*arguments, **options):
    report = prefilter.ReconstructionReport()
    mesh = prefilter.reconstruct(*arguments, **{"depth": 6, "report": report} | options)
    return *mesh[:2], report


def oriented(points, normals):
    """Writes points to a file."""
    columns = [("double", axis) for axis in "xyz"] + [("double", f"n{axis}") for axis in "xyz"]
    rows = np.column_stack([points, normals])
    return ply("binary_little_endian", [("vertex", columns, rows)])


def volume(mesh):
    return solids.mesh_volume(*mesh[:2])


def is_field(points):
    return _native.is_height_field(np.ascontiguousarray(points, np.float64), None)


def forest(count=40_000):
    """The ground, and leaves at all heights above it."""
    points, _ = terrain(count)
    high = RANDOM.random(count) < 0.6
    points[high, 2] += RANDOM.uniform(0.5, 4.0, high.sum())
    return points


def turned(points):
    return points[:, [2, 0, 1]]


SHEETS = {
    "terrain": terrain()[0],
    "noisy terrain": terrain(noise=0.05)[0],
    "very noisy terrain": terrain(noise=0.15)[0],
    "hillside": terrain()[0] @ np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]]).T,
    "town": town()[0],
    "plane": np.column_stack([RANDOM.uniform(0, 1, (500, 2)), np.zeros(500)]),
    "strip": np.column_stack([RANDOM.uniform(0, 1, (5000, 2)) * [20, 1], np.zeros(5000)]),
    "upper half of a ball": ball()[ball()[:, 2] > 0.3],
}
SOLIDS = {
    "ball": ball(),
    "few points of a ball": ball(150),
    "noisy ball": ball() + RANDOM.normal(0, 0.02, (20_000, 3)),
    "box": box()[0],
    "thin plate": box(np.array([5.0, 5.0, 0.12]))[0],
    "torus": unit(ball() * [1, 1, 0]) + 0.3 * ball(),
    "facade": turned(terrain()[0]),
    "tower without a floor": box(np.array([1.0, 1.0, 4.0]))[0][box()[1][:, 2] >= 0],
    "blob": RANDOM.normal(size=(20_000, 3)),
    "line": np.column_stack([RANDOM.uniform(0, 1, 1000), np.zeros((1000, 2))]),
    "few points": terrain()[0][:90],
    "one place": np.zeros((1000, 3)),
}


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_are_height_fields(name):
    points = SHEETS[name]
    assert is_field(points)
    assert is_field(1e-3 * points)
    assert is_field(points + AWAY)
    strays = np.array([[0.0, 0.0, 0.0], [np.nan, 1.0, 2.0], [3e7, -1e9, 5.0]])
    assert is_field(np.concatenate([points + AWAY, strays]))


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_and_walls_are_not(name):
    assert not is_field(SOLIDS[name])
    assert not is_field(1e6 * SOLIDS[name])


def test_extreme_coordinates():
    for scale in (1e300, 1e-300):
        assert is_field(scale * SHEETS["plane"])
        assert not is_field(scale * SOLIDS["ball"])


def test_up_of_a_terrain():
    points, normals = terrain()
    found = prefilter.estimate_normals(points, direction="up")
    assert np.einsum("ij,ij->i", found, normals).min() > 0.9
    np.testing.assert_array_equal(prefilter.estimate_normals(points), found)
    np.testing.assert_array_equal(prefilter.estimate_normals(points, threads=3), found)


def test_walls_of_houses_point_away_from_them():
    """The sky sees ground and roofs; walls follow from these, across convex and concave edges."""
    points, normals = town()
    found = prefilter.estimate_normals(points, direction="up")
    agree = np.einsum("ij,ij->i", found, normals)
    is_wall = normals[:, 2] == 0
    # Planes fitted at edges mix the points of both sides.
    assert (agree[~is_wall] > 0).all()
    assert (agree[is_wall] > 0).mean() > 0.99


def test_walls_alone_agree_with_each_other():
    """An upright wall has no upper side, but all of its normals face the same side."""
    points = turned(terrain()[0]) * [0.1, 1, 1]
    found = prefilter.estimate_normals(points, direction="up")
    assert abs(np.sign(found[:, 0]).sum()) == len(points)


def test_up_of_a_forest():
    points = forest()
    found = prefilter.estimate_normals(points, direction="up")
    steep = np.abs(found[:, 2]) < 0.17
    assert (found[~steep, 2] > 0).all()


def test_a_tile_without_normals_is_taken_from_above():
    points = np.concatenate([town()[0], [[4.0, 4.0, 0.0]]])
    *mesh, report = rebuilt(points, trim=1.0)
    assert report.directions == ("up",)
    positions, triangles = mesh
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    flux = np.cross(b - a, c - a)[:, 2] / 2
    # The footprint is 100, and faces up.
    assert flux.sum() == pytest.approx(100, rel=0.1)
    assert -flux[flux < 0].sum() < 5


def test_given_normals_of_a_room_are_kept():
    points, outward = box()
    *mesh, report = rebuilt(points, -outward, depth=7)
    assert report.directions == ("given",)
    assert (report.is_room, report.is_flipped) == (True, False)
    assert volume(mesh) == pytest.approx(-8 * ROOM.prod(), rel=0.01)
    assert np.abs(np.abs(mesh[0]).max(axis=0) - ROOM).max() < report.cell
    *flipped, report = rebuilt(points, -outward, depth=7, direction="outward")
    assert (report.is_room, report.is_flipped) == (False, True)
    assert report.directions == ("outward",)
    assert volume(flipped) == pytest.approx(8 * ROOM.prod(), rel=0.01)
    for isovalue in ("half", 0.4):
        mesh = rebuilt(points, -outward, depth=7, isovalue=isovalue)
        assert mesh[2].is_room
        assert volume(mesh) == pytest.approx(-8 * ROOM.prod(), rel=0.05)


@pytest.mark.parametrize("wavelet", ["haar", "d4"])
def test_a_room_faces_its_scanner(wavelet):
    points, _ = box()
    scan = prefilter.ScanPoints(points, viewpoint=np.array([0.3, -0.4, 0.1]))
    *mesh, report = rebuilt(scan, wavelet=wavelet)
    assert (report.directions, report.is_room) == (("viewpoint",), True)
    assert volume(mesh) == pytest.approx(-8 * ROOM.prod(), rel=0.03)
    *outside, report = rebuilt(scan, wavelet=wavelet, direction="outward")
    assert (report.directions, report.is_room) == (("outward",), False)
    assert volume(outside) == pytest.approx(8 * ROOM.prod(), rel=0.03)


def test_a_terrain_is_no_room():
    """The result does not depend on the position in the cube."""
    points, normals = terrain()
    for end in (np.empty((0, 3)), [[0, 0, 9.0]], [[0, 0, -9.0]]):
        more = np.array(end).reshape(-1, 3)
        report = rebuilt(
            np.concatenate([points, more]), np.concatenate([normals, np.ones_like(more)])
        )[2]
        assert not report.is_room


@pytest.mark.parametrize(
    ("direction", "cloud", "viewpoint"),
    [("up", terrain(), None), ("viewpoint", box(), (0.2, 0.1, 0.3)), ("viewpoint", box(), None)],
)
def test_given_normals_are_turned(tmp_path, direction, cloud, viewpoint):
    """Random signs of single normals are corrected."""
    points, normals = cloud
    normals = normals if direction == "up" else -normals
    mixed = signs(len(points)) * normals
    expected = rebuilt(points, normals)
    path = write(tmp_path, "mixed.ply", oriented(points, mixed))
    for found in (
        rebuilt(points, mixed, direction=direction, viewpoint=viewpoint),
        rebuilt(prefilter.ScanPoints(points, mixed), direction=direction, viewpoint=viewpoint),
        rebuilt(path, direction=direction, viewpoint=viewpoint),
    ):
        assert found[2].directions == (direction,)
        np.testing.assert_array_equal(found[0], expected[0])
        np.testing.assert_array_equal(found[1], expected[1])
    target = tmp_path / "mesh.ply"
    report = prefilter.reconstruct_file(
        path, target, depth=6, direction=direction, viewpoint=viewpoint
    )
    assert report.directions == (direction,)
    assert report.triangles == len(expected[1])


def test_a_viewpoint_for_each_point():
    """The test has more points than are read at once."""
    points, normals = box(count=140_000)
    mixed = signs(len(points)) * normals
    expected = rebuilt(points, normals)
    found = rebuilt(points, mixed, viewpoint=2 * points)
    np.testing.assert_array_equal(found[0], expected[0])
    scan = prefilter.ScanPoints(points, mixed, viewpoint=2 * points)
    found = rebuilt(scan, direction="viewpoint")
    np.testing.assert_array_equal(found[0], expected[0])
    # Normals that contradict each other are turned to where their points were seen from.
    found = rebuilt(scan)
    assert found[2].is_reoriented
    assert found[2].directions == ("viewpoint",)
    assert len(found[1]) == pytest.approx(len(expected[1]), rel=0.01)
    # Without normals as well.
    bare = rebuilt(points, viewpoint=2 * points)
    assert bare[2].directions == ("viewpoint",)
    assert volume(bare) == pytest.approx(8 * ROOM.prod(), rel=0.03)


def test_a_viewpoint_for_each_source():
    """Two balls, of which one is seen from within."""
    scans = [prefilter.ScanPoints(ball() + np.array([x, 0, 0])) for x in (0.0, 6.0)]
    mesh = rebuilt(scans, viewpoint=[[0.0, 0.1, 0.0], [0.0, 0.1, 0.0]])
    assert mesh[2].directions == ("viewpoint",)
    both = rebuilt(scans, viewpoint=[[0.0, 0.1, 0.0], [6.0, 0.1, 0.0]])
    assert volume(both) == pytest.approx(-8 / 3 * np.pi, rel=0.05)


def test_points_seen_from_above_point_up():
    points = forest()
    assert not is_field(points)
    scan = prefilter.ScanPoints(points, is_from_above=True)
    assert rebuilt(scan)[2].directions == ("up",)
    assert rebuilt(prefilter.ScanPoints(points))[2].directions == ("outward",)
    assert rebuilt([scan, prefilter.ScanPoints(ball())])[2].directions == ("up", "outward")
    assert rebuilt(prefilter.ScanPoints(*terrain(), is_from_above=True))[2].directions == ("given",)


def test_mixed_sources_keep_what_is_given():
    inward = prefilter.ScanPoints(ball(), -ball())
    report = rebuilt([inward, prefilter.ScanPoints(0.1 * ball() + [4, 0, 0])])[2]
    assert report.directions == ("given", "outward")
    assert not report.is_flipped


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"direction": "down"}, "direction: 'down' is not one of auto, up, viewpoint, outward"),
        ({"direction": 3}, "direction: 3 is not one of"),
        ({"direction": "given"}, "direction: 'given', but there are points without normals"),
        ({"direction": "up", "viewpoint": (0, 0, 0)}, "viewpoint: given beside the direction 'up'"),
        ({"viewpoint": (0, 0)}, r"viewpoint: shape \(2,\)"),
        ({"viewpoint": (0, 0, np.inf)}, "viewpoint: row 0 holds inf"),
        ({"viewpoint": np.zeros((7, 3))}, "viewpoint: found 7 for 20000 points"),
    ],
)
def test_refusals(options, message):
    with pytest.raises(ValueError, match=message):
        rebuilt(ball(), **options)


def test_refusals_of_given_normals():
    for viewpoint, message in (
        (np.zeros((7, 3)), "viewpoint: found 7 for 20000 points"),
        ((0, 0, np.nan), "viewpoint: row 0 holds nan"),
    ):
        with pytest.raises(ValueError, match=message):
            rebuilt(ball(), ball(), viewpoint=viewpoint)
    scan = prefilter.ScanPoints(ball(), ball())
    with pytest.raises(ValueError, match="viewpoint: found 3 for 2 sources; one for all or one"):
        rebuilt([scan, scan], viewpoint=np.zeros((3, 3)))
    with pytest.raises(ValueError, match="direction: 'sideways' is not one of outward, up"):
        prefilter.estimate_normals(ball(), direction="sideways")
