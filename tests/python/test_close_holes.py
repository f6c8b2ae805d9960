# SPDX-License-Identifier: GPL-3.0-or-later

"""Closed holes, compared with the removed surfaces and with the rest of the open mesh."""

import time

import numpy as np
import prefilter
import pytest
from solids import Solid, box, join, load, mesh_volume, sheet, soup, sphere, winding_numbers

METHODS = ("smooth", "flat", "fan")


def middles(solid):
    return solid.corners.mean(axis=1)


def kept(solid, where):
    return Solid(solid.positions, solid.triangles[where])


def without_cap(solid, degrees, axis=(0.3, -0.5, 0.8)):
    """A sphere around the origin without the triangles within `degrees` of an axis."""
    points = middles(solid)
    along = points @ axis / np.linalg.norm(axis) / np.linalg.norm(points, axis=1)
    return kept(solid, along < np.cos(np.radians(degrees)))


def closed(solid, method="smooth"):
    """The caps' corners, (n, 3, 3), and the whole mesh."""
    found = prefilter.close_holes(solid.positions, solid.triangles, method=method)
    whole = Solid(found.positions, found.triangles)
    return whole.corners[len(solid.triangles) :], whole, found


def areas(corners):
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def spread(corners, count=4000):
    """Points of triangles, uniform by area."""
    random = np.random.default_rng(3)
    chosen = random.choice(len(corners), count, p=areas(corners) / areas(corners).sum())
    return np.einsum("nc,ncd->nd", random.dirichlet((1, 1, 1), count), corners[chosen])


def bends(whole, first):
    """The angles in degrees between triangles on either side of edges from `first` on."""
    sides = {}
    a, b, c = np.moveaxis(whole.corners, 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for number, triangle in enumerate(whole.triangles.tolist()):
        for k in range(3):
            sides.setdefault(frozenset((triangle[k], triangle[k - 1])), []).append(number)
    pairs = np.array([s for s in sides.values() if len(s) == 2 and min(s) < first <= max(s)])
    cosines = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]])
    return np.degrees(np.arccos(np.clip(cosines, -1, 1)))


def tube(columns, rows, *, jag=0.0):
    """A cylinder of radius 1 around z, from -1 to 1, open at both ends."""
    angle = 2 * np.pi * np.arange(columns) / columns
    z = np.linspace(-1, 1, rows)[:, None] + jag * np.where(np.arange(columns) % 2, 1, -1)
    points = np.stack(np.broadcast_arrays(np.cos(angle), np.sin(angle), z), -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b = (i * columns + j).ravel(), (i * columns + (j + 1) % columns).ravel()
    triangles = np.concatenate([np.c_[a, b, b + columns], np.c_[a, b + columns, a + columns]])
    return Solid(points, triangles)


def pieces(solid, gap):
    """Six open cylinders, by the axis that faces point along, moved apart."""
    points = middles(solid)
    axis = np.abs(points).argmax(axis=1)
    sign = np.take_along_axis(points, axis[:, None], 1)[:, 0] > 0
    parts = []
    for a in range(3):
        for s in (False, True):
            part = kept(solid, (axis == a) & (sign == s))
            parts.append(part.transformed(np.eye(3), gap * (2 * s - 1) * np.eye(3)[a]))
    return join(*parts)


@pytest.mark.parametrize("degrees", [10, 20, 30, 45, 60, 70])
def test_a_sphere_gets_its_missing_part(degrees):
    whole = sphere(1.0, 5)
    opened = without_cap(whole, degrees)
    away = {}
    for method in METHODS:
        caps, _, found = closed(opened, method)
        assert (found.holes, found.left_open) == (1, 0)
        away[method] = np.abs(np.linalg.norm(spread(caps), axis=1) - 1).mean()
    # The sphere's edges are 0.05 long.
    assert away["smooth"] < 0.0045
    assert away["smooth"] < (0.2 if degrees == 10 else 0.06) * min(away["flat"], away["fan"])
    caps, mended, _ = closed(opened)
    assert mended.volume == pytest.approx(whole.volume, rel=0.005)
    # The sphere itself bends by up to 3 degrees from triangle to triangle.
    assert np.median(bends(mended, len(opened.triangles))) < 3.5
    assert bends(mended, len(opened.triangles)).max() < 15
    # The cap's triangles are about as dense as the border, before bending.
    assert np.median(areas(caps)) < 2 * np.median(areas(whole.corners))


def test_coarse_spheres_too():
    for rounds in (2, 3):
        whole = sphere(1.0, rounds)
        opened = without_cap(whole, 50)
        assert closed(opened)[1].volume == pytest.approx(whole.volume, rel=0.02)
        assert closed(opened, "fan")[1].volume < 0.93 * whole.volume


def test_ellipsoids_and_turned_frames():
    turned = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    whole = sphere(1.0, 5).transformed(turned @ np.diag([30.0, 50.0, 20.0]), (1e4, 0, -3e4))
    points = middles(whole) - (1e4, 0, -3e4)
    opened = kept(whole, points @ turned[:, 2] < 15)
    _, mended, found = closed(opened)
    assert found.holes == 1
    assert abs(mended.volume) == pytest.approx(abs(whole.volume), rel=0.005)
    assert abs(closed(opened, "flat")[1].volume) < 0.97 * abs(whole.volume)


def test_a_saddle_is_continued():
    def height(x, y):
        return 0.4 * (x * x - y * y)

    whole = sheet(59, height)
    opened = kept(whole, np.hypot(*middles(whole)[:, :2].T) > 0.4)
    away = {}
    for method in METHODS:
        caps, _, found = closed(opened, method)
        # The boundary around the sheet stays open.
        assert (found.holes, found.left_open) == (2, 1)
        points = spread(caps)
        away[method] = np.abs(points[:, 2] - height(points[:, 0], points[:, 1])).mean()
    assert away["smooth"] < 0.002
    assert away["smooth"] < 0.25 * away["fan"]


@pytest.mark.parametrize("jag", [0.0, 0.05])
def test_the_ends_of_a_tube_are_flat(jag):
    solid = tube(64, 21, jag=jag)
    for method in ("smooth", "flat"):
        caps, whole, found = closed(solid, method)
        assert (found.holes, found.left_open) == (2, 0)
        assert np.abs(np.abs(caps[..., 2]) - 1).max() <= jag + 1e-9
        base = 64 / 2 * np.sin(2 * np.pi / 64)
        assert whole.volume == pytest.approx(2 * base, rel=1.01 * jag + 1e-9)


def test_a_missing_half_of_a_side_is_flat_again():
    # Three borders are creases, the fourth continues.
    n = 12
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            flat = sheet(n - 1, lambda x, y: np.ones_like(x))
            turn = np.roll(np.eye(3), axis, axis=0)
            faces.append(flat.transformed(turn @ np.diag([1, side, side])))
    joined = join(*faces)
    whole = Solid(joined.positions.round(9), joined.triangles)
    assert whole.volume == pytest.approx(8)
    points = middles(whole)
    opened = kept(whole, ~((points[:, 2] > 0.999) & (points[:, 0] > 0.1)))
    _, mended, found = closed(opened)
    assert (found.holes, found.left_open) == (1, 0)
    assert mended.volume == pytest.approx(8, rel=1e-3)


def test_long_loops_do_not_take_long():
    count = 5000
    angle = 2 * np.pi * np.arange(count) / count
    tilt = np.pi / 4 + 0.1 * np.sin(5 * angle)
    rows = []
    for k in range(8):
        t = tilt + 0.001 * k
        rows.append(np.c_[np.sin(t) * np.cos(angle), np.sin(t) * np.sin(angle), np.cos(t)])
    i, j = np.meshgrid(np.arange(7), np.arange(count), indexing="ij")
    a, b = (i * count + j).ravel(), (i * count + (j + 1) % count).ravel()
    last = 7 * count + np.arange(count)
    triangles = np.concatenate(
        [
            np.c_[a, a + count, b + count],
            np.c_[a, b + count, b],
            np.c_[last, np.full(count, 8 * count), np.roll(last, -1)],
        ]
    )
    solid = Solid(np.concatenate([*rows, [(0, 0, -1)]]), triangles)
    began = time.process_time()
    caps, _, found = closed(solid)
    assert time.process_time() - began < 10
    assert (found.holes, found.open_edges) == (1, count)
    assert np.abs(np.linalg.norm(spread(caps), axis=1) - 1).mean() < 0.002


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("gap", [1e-9, 1e-4, 1e-2, 0.1])
def test_a_soup_loses_nothing(method, gap):
    solid = soup(sphere(1.0, 4), shrunk=gap)
    whole, found = closed(solid, method)[1:]
    assert found.left_open == found.holes == len(solid.triangles)
    assert len(whole.triangles) == len(solid.triangles)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("gap", [1e-9, 1e-4, 0.01, 0.05])
def test_pieces_of_a_sphere_lose_nothing(method, gap):
    solid = pieces(sphere(1.0, 4), gap)
    bounds = ([-1.3] * 3, [1.3] * 3)
    raw = prefilter.voxelize(solid.positions, solid.triangles, depth=6, bounds=bounds)
    whole = closed(solid, method)[1]
    octree = prefilter.voxelize(whole.positions, whole.triangles, depth=6, bounds=bounds)
    assert octree.volume > raw.volume - 1e-3
    middle = [(0.0, 0.0, 0.0)]
    # Close to the surface, on its inner side.
    inner = middles(solid) * 0.95
    assert (octree.values(inner) > raw.values(inner) - 0.01).all()
    assert octree.values(middle)[0] > raw.values(middle)[0] - 0.01


@pytest.mark.parametrize("method", METHODS)
def test_a_sheet_stays_open_but_for_its_holes(method):
    whole = sheet(59, lambda x, y: 0.1 * np.sin(5 * x) * np.cos(4 * y))
    _, _, found = closed(whole, method)
    assert (found.holes, found.left_open, len(found.triangles)) == (1, 1, len(whole.triangles))
    opened = kept(whole, np.hypot(middles(whole)[:, 0], middles(whole)[:, 1] - 0.2) > 0.2)
    caps, _, found = closed(opened, method)
    assert (found.holes, found.left_open) == (2, 1)
    assert np.hypot(caps[..., 0], caps[..., 1] - 0.2).max() < 0.25


@pytest.mark.parametrize("method", METHODS)
def test_shells_within_others_are_closed(method):
    outer, inner = sphere(1.0, 4), sphere(0.7, 4).flipped()
    opened = join(kept(outer, middles(outer)[:, 2] < 0.9), kept(inner, middles(inner)[:, 0] < 0.6))
    whole, found = closed(opened, method)[1:]
    assert (found.holes, found.left_open) == (2, 0)
    points = np.array([[0, 0, 0], [0, 0.85, 0], [0, 0, -0.85], [0, 0, 1.1], [0.5, 0, 0]])
    assert winding_numbers(whole, points).round(6).tolist() == [0, 1, 1, 0, 0]


def test_turned_faces_are_made_up_for():
    whole = sphere(1.0, 4)
    triangles = whole.triangles.copy()
    turned = np.random.default_rng(5).random(len(triangles)) < 0.02
    triangles[turned] = triangles[turned][:, ::-1]
    mended, found = closed(Solid(whole.positions, triangles))[1:]
    assert found.left_open == 0
    assert mended.volume == pytest.approx(whole.volume, rel=1e-3)


def test_borders_that_touch():
    # Two holes with a corner in common, three faces at an edge, and a vertex twice.
    whole = sphere(1.0, 3)
    at = whole.positions[np.argmax(whole.positions[:, 2])]
    around = np.flatnonzero((whole.corners == at).all(axis=2).any(axis=1))
    ring = sorted(around, key=lambda t: np.arctan2(middles(whole)[t, 1], middles(whole)[t, 0]))
    pinched = whole.without([ring[0], ring[len(ring) // 2]])
    assert closed(pinched)[1].volume == pytest.approx(whole.volume, rel=1e-3)

    fin = Solid(
        np.concatenate([whole.positions, [(0, 0, 2)]]),
        np.concatenate([whole.triangles, [(*whole.triangles[ring[0]][:2], len(whole.positions))]]),
    )
    for method in METHODS:
        corners = closed(fin, method)[1].corners
        a, b, c = np.moveaxis(corners, 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(whole.volume, rel=0.05)

    copied = np.concatenate([whole.positions, whole.positions])
    triangles = whole.triangles.copy()
    triangles[::2] += len(whole.positions)
    doubled = without_cap(Solid(copied, triangles), 40)
    assert closed(doubled)[1].volume == pytest.approx(whole.volume, rel=0.02)


def test_a_box_without_a_lid():
    solid = box()
    opened = solid.without([8, 9])
    for method in METHODS:
        assert closed(opened, method)[1].volume == pytest.approx(1)


@pytest.mark.parametrize(
    "name", ["stanford-bunny.obj", "suzanne.obj", "broken_many_small_holes.ply"]
)
def test_models(name):
    solid = load(name)
    low, high = solid.positions.min(axis=0), solid.positions.max(axis=0)
    bounds = (low - 0.05 * (high - low), low + 1.05 * (high - low).max())
    volumes = {}
    for method in METHODS:
        whole, found = closed(solid, method)[1:]
        assert found.left_open <= 1
        octree = prefilter.voxelize(whole.positions, whole.triangles, depth=7, bounds=bounds)
        volumes[method] = octree.volume
    assert volumes["smooth"] == pytest.approx(volumes["flat"], rel=0.01)
    assert volumes["smooth"] == pytest.approx(volumes["fan"], rel=0.02)
    assert mesh_volume(solid.positions, solid.triangles) != 0
