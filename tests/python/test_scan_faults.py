# SPDX-License-Identifier: GPL-3.0-or-later

"""Points without a measurement, and normals that are missing or contradict each other."""

from pathlib import Path

import numpy as np
import prefilter
import pytest
from clouds import Cloud, sphere, torus
from scan_writers import ply, write
from solids import mesh_volume

NAMES = ("x", "y", "z", "nx", "ny", "nz")
BALL = sphere(20_000, radius=2.0, center=(30.0, -12.0, 4.0))
VOLUME = 4 / 3 * np.pi * 8


def written(folder: Path, *columns: np.ndarray) -> Path:
    rows = np.hstack(columns)
    properties = [("float", name) for name in NAMES[: rows.shape[1]]]
    contents = ply("binary_little_endian", [("vertex", properties, rows.tolist())])
    return write(folder, "cloud.ply", contents)


def made(points, normals=None, **options):
    report = prefilter.ReconstructionReport()
    found = prefilter.reconstruct(points, normals, report=report, **options)
    return mesh_volume(*found[:2]), report


@pytest.mark.parametrize("place", [(0, 0, 0), (-9999, -9999, -9999), (1e10, 0, 0), (29, -12, 4)])
@pytest.mark.parametrize("count", [4, 20, 1000, 30_000])
@pytest.mark.parametrize("has_normals", [True, False])
def test_points_at_one_place_are_left_out(place, count, has_normals) -> None:
    points = np.concatenate([BALL.points, np.tile(np.array(place, float), (count, 1))])
    normals = np.concatenate([BALL.normals, np.tile([0.0, 0.0, 1.0], (count, 1))])
    given = normals if has_normals else None
    expected = prefilter.reconstruct(BALL.points, BALL.normals if has_normals else None, depth=5)
    for order in (slice(None), np.random.default_rng(2).permutation(len(points))):
        report = prefilter.ReconstructionReport()
        found = prefilter.reconstruct(
            points[order], None if given is None else given[order], depth=5, report=report
        )
        assert report.phantoms == ((tuple(map(float, place)), count),)
        assert (report.points, report.dropped) == (len(points), 0)
        np.testing.assert_array_equal(found[1], expected[1])


@pytest.mark.parametrize("memory_limit", [None, 0])
@pytest.mark.parametrize("threads", [1, 3])
def test_points_at_one_place_in_a_file(tmp_path, memory_limit, threads) -> None:
    """More points than in a batch, so that each batch has only some of the points at a position."""
    cloud = sphere(400_000, center=(3.0, 0.0, 0.0))
    random = np.random.default_rng(3)
    points = np.concatenate([cloud.points, np.zeros((600, 3))])
    normals = np.concatenate([cloud.normals, np.zeros((600, 3))])
    order = random.permutation(len(points))
    source = written(tmp_path, points[order], normals[order])
    report = prefilter.reconstruct_file(
        source, tmp_path / "a.ply", depth=5, memory_limit=memory_limit, threads=threads
    )
    assert report.phantoms == (((0.0, 0.0, 0.0), 600),)
    assert report.directions == ("given",)
    found = prefilter.read_points(tmp_path / "a.ply").positions
    assert np.abs(np.linalg.norm(found - (3.0, 0.0, 0.0), axis=1) - 1.0).max() < 0.05


def uv_sphere(rings: int, segments: int) -> np.ndarray:
    """Triangle corners of a sphere: 4 to 6 copies of each vertex, and many of the poles."""
    v, u = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.arange(segments + 1), indexing="ij")
    u = u % segments * (2 * np.pi / segments)
    grid = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=2)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.round(np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3), 9)


@pytest.mark.parametrize(
    "points",
    [
        np.tile(BALL.points[:2000], (50, 1)),
        np.round(BALL.points * 6),
        np.round(sphere(30_000).points / np.linspace(0.03, 1.0, 30_000)[:, None], 1),
        uv_sphere(40, 64),
        np.concatenate([BALL.points, np.repeat(BALL.points[:200], 40, axis=0)]),
        np.zeros((500, 3)),
    ],
    ids=["copies", "rounded", "rounded, denser near", "corners", "some copies", "one place"],
)
def test_copies_are_no_phantoms(points) -> None:
    assert prefilter._native.find_phantoms(np.ascontiguousarray(points, float), None, 0) == []


@pytest.mark.parametrize("value", [1e30, -3.4e38, np.nan, np.inf])
def test_placeholder_coordinates(value) -> None:
    random = np.random.default_rng(4)
    points = BALL.points.copy()
    unseen = random.choice(len(points), 4000, replace=False)
    points[unseen, random.integers(0, 3, 4000)] = value
    volume, report = made(points, depth=5)
    assert volume == pytest.approx(VOLUME, rel=0.02)
    cause = "huge" if np.isfinite(value) else "not_finite"
    assert report.causes[cause] + sum(count for _, count in report.phantoms) == 4000


@pytest.mark.parametrize("zero", [0.0, np.nan])
@pytest.mark.parametrize("share", [1.0, 0.5, 0.002])
@pytest.mark.parametrize("is_file", [False, True])
def test_normals_that_are_missing_are_estimated(tmp_path, zero, share, is_file) -> None:
    cloud = torus(20_000)
    lacks = np.random.default_rng(5).random(20_000) < share
    normals = np.where(lacks[:, None], zero, 127.0 * cloud.normals)
    volume = 2 * np.pi**2 * 0.16
    if is_file:
        source = written(tmp_path, cloud.points, normals)
        report = prefilter.reconstruct_file(source, tmp_path / "a.ply", depth=6)
        assert report.triangles > 0
    else:
        found, report = made(cloud.points, normals, depth=6)
        assert found == pytest.approx(volume, rel=0.02)
    assert (report.points, report.dropped, report.estimated) == (20_000, 0, lacks.sum())
    assert report.directions == (("outward",) if share == 1.0 else ("given",))
    assert not report.is_flipped


def test_a_part_without_normals_follows_the_rest() -> None:
    """Given normals point inward, as in a room, and so do the normals inferred from them."""
    cloud = sphere(20_000)
    normals = -cloud.normals
    normals[cloud.points[:, 0] > 0.3] = 0.0
    _, report = made(cloud.points, normals, depth=5)
    assert report.is_room
    apart = np.concatenate([cloud.points, cloud.points + np.array([5.0, 0.0, 0.0])])
    both = np.concatenate([cloud.normals, 0.0 * cloud.normals])
    volume, report = made(apart, both, depth=6)
    assert volume == pytest.approx(8 / 3 * np.pi, rel=0.03)
    assert report.estimated == 20_000


@pytest.mark.parametrize("share", [0.25, 0.5])
@pytest.mark.parametrize("cloud", [sphere(20_000), torus(20_000)], ids=["sphere", "torus"])
@pytest.mark.parametrize("is_file", [False, True])
def test_normals_that_contradict_each_other(tmp_path, share, cloud: Cloud, is_file) -> None:
    signs = np.where(np.random.default_rng(6).random(20_000) < share, -1.0, 1.0)
    normals = signs[:, None] * cloud.normals
    expected, _ = made(cloud.points, cloud.normals, depth=6)
    if is_file:
        source = written(tmp_path, cloud.points, normals)
        report = prefilter.reconstruct_file(source, tmp_path / "a.ply", depth=6)
    else:
        found, report = made(cloud.points, normals, depth=6)
        assert found == pytest.approx(expected, rel=1e-3)
        found, kept = made(cloud.points, normals, depth=6, direction="given")
        assert kept.is_contradictory
        assert not kept.is_reoriented
    assert report.is_contradictory
    assert report.is_reoriented
    # A pair is opposed where just one of the two is reversed.
    assert report.contradiction == pytest.approx(2 * share * (1 - share), abs=0.05)


def test_directions_at_random_are_replaced() -> None:
    cloud = torus(20_000)
    order = np.random.default_rng(7).permutation(20_000)
    expected, _ = made(cloud.points, depth=6)
    found, report = made(cloud.points, cloud.normals[order], depth=6)
    assert report.is_reoriented
    assert found == pytest.approx(expected, rel=0.02)


def plate(thickness: float) -> Cloud:
    """Both sides of a plate whose points are 0.01 apart."""
    random = np.random.default_rng(8)
    points = np.column_stack([random.random((20_000, 2)), np.zeros(20_000)])
    points[10_000:, 2] = thickness
    normals = np.tile([0.0, 0.0, -1.0], (20_000, 1))
    normals[10_000:] *= -1.0
    return Cloud(points, normals, lambda p: p[:, 2])


@pytest.mark.parametrize(
    "cloud",
    [sphere(20_000), torus(20_000, tube=0.02), plate(0.003), plate(0.01), plate(0.1)],
    ids=["sphere", "wire", "foil", "sheet", "plate"],
)
@pytest.mark.parametrize("depth", [None, 4])
def test_normals_that_agree_are_kept(cloud: Cloud, depth) -> None:
    _, report = made(cloud.points, cloud.normals, depth=depth)
    assert not report.is_contradictory
    assert report.contradiction < 0.1
    assert report.directions == ("given",)


def facing_origin(points: np.ndarray, **options) -> tuple[float, prefilter.ReconstructionReport]:
    """The share of the area of a surface that faces the origin."""
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(points, report=report, **options)
    corners = positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces = (across * corners.mean(axis=1)).sum(axis=1) < 0
    area = np.linalg.norm(across, axis=1)
    return float(area[faces].sum() / area.sum()), report


def rays(count: int, width: float = 1.2, height: float = 0.9) -> np.ndarray:
    """Random rays of a camera that looks along z."""
    random = np.random.default_rng(9)
    x, y = random.uniform(-0.5, 0.5, (2, count))
    return np.column_stack([width * x, height * y, np.ones(count)])


def facade() -> np.ndarray:
    """A wall with a niche."""
    seen = rays(20_000)
    wall = 6.0 * seen
    is_niche = (np.abs(wall[:, :2]) < (1.0, 1.2)).all(axis=1)
    return np.where(is_niche[:, None], 6.5 * seen, wall)


def half_sphere() -> np.ndarray:
    """The visible points of a sphere of radius 1 whose center is 3 away."""
    seen = rays(60_000)
    square = (seen**2).sum(axis=1)
    root = 9.0 - 8.0 * square
    near = (3.0 - np.sqrt(np.maximum(root, 0.0))) / square
    return (seen * near[:, None])[root > 0]


def room() -> np.ndarray:
    """Points on the walls around a scanner, equally dense over directions."""
    seen = np.random.default_rng(10).normal(size=(20_000, 3))
    far = np.abs(np.array([3.0, 2.5, 1.4]) / seen).min(axis=1)
    return seen * far[:, None]


def turned(points: np.ndarray, axis: int) -> np.ndarray:
    return np.roll(points, axis, axis=1)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("scale", [1.0, -1000.0])
@pytest.mark.parametrize("points", [facade(), half_sphere(), room()], ids=["wall", "ball", "room"])
def test_points_seen_from_the_origin_face_it(points, scale, axis) -> None:
    faces, report = facing_origin(scale * turned(points, axis))
    assert faces > 0.97
    assert report.origin == "scanner"
    assert report.directions == ("viewpoint",)
    faces, report = facing_origin(scale * turned(points, axis), direction="outward")
    assert report.origin == "none"


def box_surface(sides: tuple[float, float, float], count: int = 20_000) -> np.ndarray:
    """Random points, uniform over the surface of a box around the origin."""
    random = np.random.default_rng(11)
    half = np.array(sides) / 2
    areas = np.prod(half) / half
    axis = random.choice(3, count, p=areas / areas.sum())
    points = random.uniform(-1.0, 1.0, (count, 3)) * half
    points[np.arange(count), axis] = random.choice([-1.0, 1.0], count) * half[axis]
    return points


@pytest.mark.parametrize(
    ("points", "origin"),
    [
        (sphere(20_000).points, "either"),
        (sphere(20_000).points * (2.0, 1.0, 1.0), "none"),
        (box_surface((6.0, 5.0, 2.8)), "none"),
        (box_surface((1.0, 1.0, 1.0)), "none"),
        (sphere(20_000, center=(0.0, 0.0, 3.0)).points, "none"),
        (sphere(20_000, center=(0.0, 0.0, 300.0)).points, "none"),
        (torus(20_000).points, "none"),
        (torus(20_000).points + np.array([5.0, 1.0, 0.0]), "none"),
    ],
    ids=["ball", "egg", "box", "cube", "ball beside", "ball far off", "torus", "torus beside"],
)
def test_objects_are_seen_from_outside(points, origin) -> None:
    report = prefilter.ReconstructionReport()
    positions, triangles = prefilter.reconstruct(points, report=report)
    assert mesh_volume(positions, triangles) > 0
    assert report.directions == ("outward",)
    assert report.origin == origin


@pytest.mark.parametrize("is_grid", [False, True])
@pytest.mark.parametrize("offset", [(0, 0, 0), (0, 0, 40), (0, 0, 300), (5e5, 5e6, 300)])
def test_a_terrain_faces_the_sky(offset, is_grid) -> None:
    random = np.random.default_rng(12)
    x, y = random.uniform(0.0, 100.0, (2, 20_000))
    if is_grid:  # around the origin, as a camera's view would be
        x, y = (axis.ravel() - 50.0 for axis in np.mgrid[:101, :101])
    points = np.column_stack([x, y, 5 * np.sin(x / 9) * np.cos(y / 7)]) + offset
    report = prefilter.ReconstructionReport()
    prefilter.reconstruct(points, report=report)
    assert report.directions == ("up",)


def test_normals_by_themselves_face_the_origin() -> None:
    for points in (facade(), room()):
        normals = prefilter.estimate_normals(points)
        assert ((normals * points).sum(axis=1) < 0).mean() > 0.98
