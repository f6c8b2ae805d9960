# SPDX-License-Identifier: GPL-3.0-or-later

"""Solids that are thinner than cells can show get a thickness there, and nowhere else."""

import numpy as np
import prefilter
import pytest
from octrees import octrees_are_same
from solids import Solid, box, join, mesh_volume, sheet, sphere, surface_faults

from bench.solids import random_rotation
from bench.voxels.measures import folds, topology
from bench.voxels.thin_shapes import SHAPES, ThinShape, plate, posed, prism, ring, rod

DEPTH = 6
CELLS = 2**DEPTH
LEAST = 1.5


def voxelized(
    solid: Solid, thickness: float = LEAST, depth: int = DEPTH, **options
) -> prefilter.Octree:
    return prefilter.voxelize(
        solid.positions,
        solid.triangles,
        depth=depth,
        bounds=(np.zeros(3), np.full(3, 2.0**depth)),
        thickness=thickness,
        **options,
    )


def surface(solid: Solid, tree: prefilter.Octree, **options):
    sources = [(solid.positions, solid.triangles)]
    return tree.contour(interpolant="sharp", sources=sources, **options)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("thickness", [0.02, 0.8, 1.3, 2.0])
def test_parts_and_holes_are_those_of_the_shape(name, thickness):
    shape = SHAPES[name](thickness)
    for seed in range(3):
        solid = posed(shape, seed, 2**shape.depth)
        positions, triangles = surface(solid, voxelized(solid, depth=shape.depth))
        assert topology(triangles) == (shape.parts, shape.genus)
        assert surface_faults(positions, triangles).none
        assert folds(positions, triangles) == 0


@pytest.mark.parametrize("thickness", [0.02, 0.5, 1.2])
def test_a_plate_is_what_a_ball_sweeps(thickness):
    """A plate of a x b becomes the points within half of the thickness of its middle."""
    half = LEAST / 2
    expected = 40 * 30 * LEAST + (40 + 30) * np.pi * half**2 + 4 / 3 * np.pi * half**3
    for seed in range(3):
        solid = posed(plate(thickness), seed, CELLS)
        assert voxelized(solid).volume == pytest.approx(expected, rel=0.01)
    solid = posed(plate(thickness), 0, CELLS)
    positions, _ = surface(solid, voxelized(solid), cleanup=False)
    across = np.abs(positions - CELLS / 2)
    inner = (across[:, 0] < 18) & (across[:, 1] < 13)
    assert np.abs(across[inner, 2] - half).max() < 0.01


@pytest.mark.parametrize("thickness", [0.02, 0.5, 1.2, 1.6])
def test_rods_and_rings_have_one_section(thickness):
    for shape, length in ((rod(thickness), 40.0), (ring(thickness), 30 * np.pi)):
        volumes = [voxelized(posed(shape, seed, CELLS)).volume for seed in range(3)]
        radius = np.sqrt(np.array(volumes) / np.pi / length)
        assert (radius > 0.9).all()
        assert (radius < 1.0).all()


def test_what_is_thick_stays_as_it_is():
    """Edges and roughness are not thin."""
    ball = sphere(20.0, 5)
    noise = np.random.default_rng(0).normal(0, 0.01, len(ball.positions))
    rough = Solid(ball.positions * (1 + noise[:, None]) + 32, ball.triangles)
    for solid in (
        sphere(20.0, 4, (32, 32, 32)),
        box((10.3, 10.3, 10.3), (40.4, 50.1, 12.4)),
        rough,
    ):
        assert octrees_are_same(voxelized(solid, 0.0), voxelized(solid))


def wedge(degrees: float) -> Solid:
    """Opens by an angle, from an edge of 30 to 20 away."""
    far = 20 * np.tan(np.radians(degrees / 2))
    sections = ((0, 0), (20, far))
    positions = np.array([(x, y, z) for x, h in sections for y in (0, 30) for z in (-h, h)])
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (4, 5, 7, 6)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    return Solid(positions - (10.0, 15, 0), triangles[:, ::-1])


@pytest.mark.parametrize("seed", range(4))
def test_edges_of_wedges_stay_where_they_are(seed):
    """Wedges get no thickness at their edges, which contours place all the same."""
    for degrees in (27.0, 36.0, 44.0):
        solid = wedge(degrees).transformed(random_rotation(seed), np.full(3, CELLS / 2))
        assert octrees_are_same(voxelized(solid, 0.0), voxelized(solid))
        positions, triangles = surface(solid, voxelized(solid))
        assert topology(triangles) == (1, 0)
        start, end = solid.positions[[0, 2]]
        points = start + np.linspace(0.05, 0.95, 40)[:, None] * (end - start)
        corners = positions[triangles]
        along = np.cross(corners.mean(axis=1) - start, (end - start) / 30.0)
        corners = corners[np.linalg.norm(along, axis=1) < 3.0]
        gaps = np.min([distances(points, *triangle) for triangle in corners], axis=0)
        # Where it is narrow, cells that are less than half full leave notches.
        assert degrees < 30 or (gaps > 0.1).mean() < 0.1
    solid = wedge(12.0).transformed(random_rotation(seed), np.full(3, CELLS / 2))
    assert voxelized(solid).volume > voxelized(solid, 0.0).volume + 20


@pytest.mark.parametrize("sides", [4, 6, 7])
@pytest.mark.parametrize("thickness", [0.3, 1.0, 1.4])
def test_rods_of_few_sides_hold_together(sides, thickness):
    """Opposite faces of seven sides are not parallel."""
    for seed in range(3):
        one = ThinShape(prism(thickness / 2, thickness / 2, 40.0, sides), 1, 0)
        solid = posed(one, seed, CELLS)
        assert topology(surface(solid, voxelized(solid))[1]) == (1, 0)
        assert voxelized(solid).volume > 40 * np.pi * 0.75**2


def test_parts_that_touch_or_overlap_are_no_sheets():
    first = box((10, 10, 10), (30, 30, 30))
    for gap in (0.0, -0.1, -1.0):
        second = box((10, 10, 30 + gap), (30, 30, 50))
        both = join(first, second)
        assert voxelized(both).volume == pytest.approx(voxelized(both, 0.0).volume, rel=1e-4)


def ring_of(sides: int, radius: float, turn: float) -> np.ndarray:
    angles = turn + 2 * np.pi * np.arange(sides) / sides
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def between(rings: list[tuple[np.ndarray, float]]) -> Solid:
    """Returns the solid that a closed sequence of rings, each (outline, height), bounds."""
    sides = len(rings[0][0])
    positions = np.concatenate([np.insert(ring, 2, z, axis=1) for ring, z in rings])
    i = np.arange(sides)
    j = (i + 1) % sides
    triangles = []
    for k in range(len(rings)):
        a, b = k * sides, (k + 1) % len(rings) * sides
        triangles += [np.stack([a + i, a + j, b + j], 1), np.stack([a + i, b + j, b + i], 1)]
    return Solid(positions, np.concatenate(triangles).astype(np.int32))


@pytest.mark.parametrize("sides", [17, 19, 31])
@pytest.mark.parametrize("seed", range(3))
def test_pins_in_holes_of_other_sides_are_not_thin(sides, seed):
    """Faces that cross each other all around, a hair apart, must not be thickened."""
    hole, rim, pin = ring_of(24, 9.0, 0.0), ring_of(24, 20.0, 0.0), ring_of(sides, 9.0, 0.1 * seed)
    plate_ = between([(rim, -12.0), (rim, 12.0), (hole, 12.0), (hole, -12.0)])
    end = 0.01 * pin
    pin_ = between([(pin, -20.0), (pin, 12.0), (end, 12.0), (end, -20.0)])
    both = join(plate_, pin_)
    solid = Solid(both.positions @ random_rotation(seed).T + CELLS / 2, both.triangles)
    assert mesh_volume(solid.positions, solid.triangles) > 0.9 * 24 * np.pi * 20**2
    assert octrees_are_same(voxelized(solid), voxelized(solid, 0.0))


def test_beside_what_is_sunk_in_it_a_solid_is_not_thin():
    both = join(box((-16, -16, -16), (16, 16, 6)), box((-7, -7, 5.7), (7, 7, 12)))
    around = 4 * 14
    for seed in range(3):
        turned = both.positions @ random_rotation(seed).T + CELLS / 2
        solid = Solid(turned, both.triangles)
        plain, made = voxelized(solid, 0.0).dense(), voxelized(solid).dense()
        assert np.maximum(made - np.minimum(plain, 1), 0).sum() < 0.1 * around


def test_a_board_is_as_thick_above_a_leg_as_beside_it():
    board = box((4, 4, 40.2), (60, 60, 41.0))
    legs = join(board, box((20, 20, 10.5), (30, 30, 40.6)))
    alone, both = voxelized(board).dense(), voxelized(legs).dense()
    np.testing.assert_array_equal(both[..., 41:], alone[..., 41:])


@pytest.mark.parametrize("seed", [0, 1, 2, 9])
def test_slits_of_less_than_a_cell_stay_open(seed):
    """Cells that are a little more than half full would leave handles across them."""
    width, half = 0.9, 8
    parts = [box((-half, -half, -half), (half, half, -width / 2))]
    parts.append(box((-half, -half, width / 2), (half, half, half)))
    parts.append(box((half / 2, -half, -width), (half, half, width)))
    solid = join(*parts)
    turned = Solid(solid.positions @ random_rotation(seed).T + 16, solid.triangles)
    assert topology(voxelized(turned, depth=5).contour(interpolant="plane")[1]) == (1, 0)


def test_it_ends_without_a_step():
    """A wedge of 6 degrees: the thickened surface joins the mesh where that is thick enough."""
    positions = np.array(
        [(x, y, z) for x, h in ((0.0, 0.0), (50.0, 5.0)) for y in (0.0, 30.0) for z in (-h, h)]
    )
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    wedge = Solid(positions + np.array([7.2, 17.1, 32.3]), triangles[:, ::-1])
    points, _ = surface(wedge, voxelized(wedge), cleanup=False)
    inner = (np.abs(points[:, 1] - 32) < 10) & (points[:, 0] > 9) & (points[:, 0] < 50)
    x, height = points[inner, 0] - 7.2, np.abs(points[inner, 2] - 32.3)
    expected = np.maximum(LEAST / 2, x / 10)
    assert np.abs(height - expected).max() < 0.25
    thick = x > 9.0
    assert np.abs(height - expected)[thick].max() < 0.02


def test_sheets_are_their_faces():
    flat = sheet(8, lambda x, y: 0 * x).transformed(20 * np.eye(3), np.full(3, 32.4))
    found = prefilter.as_solid(flat.positions, flat.triangles, cell=1.0, sheets="faces")
    assert len(found.triangles) == 2 * len(flat.triangles)
    assert found.origins.tolist() == np.repeat(np.arange(len(flat.triangles)), 2).tolist()
    tree = voxelized(Solid(found.positions, found.triangles))
    expected = 40 * 40 * LEAST + 80 * np.pi * (LEAST / 2) ** 2
    assert tree.volume == pytest.approx(expected, rel=0.01)
    assert voxelized(Solid(found.positions, found.triangles), 0.0).volume == 0.0


def test_threads_do_not_change_a_bit():
    solid = join(posed(ring(0.5), 3, CELLS), posed(plate(0.3), 4, CELLS))
    first = voxelized(solid, threads=1)
    for threads in (2, 5):
        assert octrees_are_same(first, voxelized(solid, threads=threads))


def test_set_operations_keep_what_is_thick():
    solid = posed(rod(0.3), 2, CELLS)
    ball = sphere(6.0, 3, (32, 32, 32))
    both = voxelized(solid).union(voxelized(ball))
    sources = [(one.positions, one.triangles) for one in (solid, ball)]
    _, triangles = both.contour(interpolant="sharp", sources=sources)
    assert topology(triangles) == (1, 0)


def test_origins_are_unknown_where_it_is_thickened():
    solid = join(posed(rod(0.3), 0, CELLS), box((4, 4, 4), (12, 12, 12)))
    traced = voxelized(solid).traced_contour([(solid.positions, solid.triangles)])
    middles = traced.positions[traced.triangles].mean(axis=1)
    is_rod = middles[:, 0] > 20
    assert (traced.origins[is_rod] == -1).all()
    assert (traced.origins[~is_rod] >= len(solid.triangles) - 12).all()


def distances(points, a, b, c):
    """Returns how far points are from a triangle."""
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    heights = (points - a) @ normal
    is_above = np.ones(len(points), bool)
    least = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        is_above &= (points - start) @ np.cross(normal, side) >= 0
        along = np.clip((points - start) @ side / (side @ side), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - start - along[:, None] * side, axis=1))
    return np.where(is_above, np.abs(heights), least)


def solid_angle(a, b, c) -> float:
    """Returns the solid angle of triangles seen from the origin, as a share of all directions."""
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.arctan2(volume, rest).sum() / (2 * np.pi))


def test_nasty_meshes():
    triangle = np.array([(10.0, 10, 10), (30, 10, 10), (10, 30, 10)])
    both = np.array([(0, 1, 2), (0, 2, 1)])
    assert voxelized(Solid(triangle, both)).volume > 200 * LEAST
    point = Solid(np.array([(20.0, 20, 20), (21, 20, 20), (20, 21, 20)]), both)
    assert voxelized(point).volume > 0
    flat = np.concatenate([triangle, [(40.0, 40, 40)]])
    with_flat = Solid(flat, np.array([(0, 1, 2), (0, 2, 1), (3, 3, 3), (0, 0, 1)]))
    expected = voxelized(Solid(triangle, both)).volume
    assert voxelized(with_flat).volume == pytest.approx(expected, rel=1e-3)
    twice = join(posed(plate(0.3), 1, CELLS), posed(plate(0.3), 1, CELLS))
    once = voxelized(posed(plate(0.3), 1, CELLS))
    assert voxelized(twice).volume == pytest.approx(once.volume, rel=1e-3)


@pytest.mark.parametrize("count", [12, 400, 1500])
def test_of_a_soup_what_is_near_is_inside(count):
    """Triangles as large as the scene: few in each cell, and very many."""
    random = np.random.default_rng(count)
    positions = random.uniform(4, 28, (3 * count, 3))
    triangles = np.arange(3 * count).reshape(-1, 3)
    tree = voxelized(Solid(positions, np.concatenate([triangles, triangles[:, ::-1]])), depth=5)
    points, made = tree.contour(interpolant="occupancy", cleanup=False)
    corners = positions[triangles]
    samples = random.uniform(2, 30, (3000, 3))
    gaps = np.min([distances(samples, *triangle) for triangle in corners], axis=0)
    # The sign of the solid angle of all of the surface.
    a, b, c = (points[made[:, k]] for k in range(3))
    inside = np.array([solid_angle(a - x, b - x, c - x) for x in samples[:300]]) > 0.5
    assert (inside | (gaps[:300] > 0.4)).all()
    assert (~inside | (gaps[:300] < 2.2)).all()
    # The volume within 0.6 of the triangles, as a lower bound.
    assert tree.volume > (gaps < 0.6).mean() * 28**3


@pytest.mark.parametrize("seed", [1, 3])
def test_sheets_beside_edges_are_not_met(seed):
    """Boxes without lids, one in the other: the surface has edges beside the thickened parts."""
    outer, inner = box((-1, -1, -1), (1, 1, 1)), box((-0.8, -0.8, -0.8), (0.8, 0.8, 1.2))
    both = join(*(Solid(one.positions, one.triangles[:-2]) for one in (outer, inner)))
    solid = both.transformed(random_rotation(seed), np.zeros(3))
    bounds = prefilter.cube_around(
        (solid.positions.min(axis=0), solid.positions.max(axis=0)), depth=5
    )
    cell = float(bounds[1][0] - bounds[0][0]) / 2**5
    made = prefilter.as_solid(
        solid.positions, solid.triangles, cell=cell, gap=2.0, thickness=LEAST, sheets="faces"
    )
    mesh = (made.positions, made.triangles)
    tree = prefilter.voxelize(*mesh, depth=5, bounds=bounds, thickness=LEAST)
    for cleanup in (False, True):
        found = tree.contour(interpolant="sharp", cleanup=cleanup, sources=[mesh])
        assert surface_faults(*found).none
