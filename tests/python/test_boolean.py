# SPDX-License-Identifier: GPL-3.0-or-later

"""Set operations on bad meshes, against random points and winding numbers."""

from dataclasses import dataclass

import numpy as np
import prefilter
import pytest
from solids import (
    Estimate,
    RandomPoints,
    Solid,
    WindingNumbers,
    box,
    crumpled,
    join,
    load,
    mesh_volume,
    random_rotation,
    sphere,
    surface_faults,
    torus,
    winding_numbers,
)

INTERPOLANTS = ("occupancy", "plane", "linear")
VOLUME_BAR, ERROR_BAR = 0.005, 0.001


@dataclass(frozen=True)
class Operation:
    """A method of Octree, and the same operation on a point's winding numbers."""

    name: str

    def __call__(self, a: prefilter.Octree, b: prefilter.Octree) -> prefilter.Octree:
        return getattr(a, self.name)(b)

    def inside(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        x, y = a >= 0.5, b >= 0.5
        return {"union": x | y, "intersection": x & y, "difference": x & ~y}[self.name]


OPERATIONS = [Operation(name) for name in ("union", "intersection", "difference")]


def bounds_of(*solids: Solid) -> tuple[np.ndarray, np.ndarray]:
    """A cube around all solids with a small margin."""
    low = np.min([s.positions.min(axis=0) for s in solids], axis=0)
    high = np.max([s.positions.max(axis=0) for s in solids], axis=0)
    side = 1.04 * (high - low).max()
    return (low + high) / 2 - side / 2, (low + high) / 2 + side / 2


def check_surface(octree: prefilter.Octree, expected: float, interpolants=INTERPOLANTS) -> None:
    """Asserts that a surface is closed, 2-manifold, oriented outward, and has the volume."""
    for interpolant in interpolants:
        cleanup = interpolant == "plane"  # As in Blender.
        positions, triangles = octree.contour(interpolant=interpolant, cleanup=cleanup)
        assert len(triangles) > 0
        faults = surface_faults(positions, triangles)
        assert faults.none, f"{interpolant}: {faults}"
        volume = mesh_volume(positions, triangles)
        print(f"{interpolant}: {len(triangles)} triangles, volume {volume / expected - 1:+.3%}")
        assert volume == pytest.approx(expected, rel=VOLUME_BAR)


def check(a: Solid, b: Solid, depth: int = 8) -> None:
    """Checks all operations against estimates by random points."""
    low, high = bounds_of(a, b)
    octrees = [
        prefilter.voxelize(s.positions, s.triangles, depth=depth, bounds=(low, high))
        for s in (a, b)
    ]
    estimates = RandomPoints([a, b], low, high).estimates(
        [operation.inside for operation in OPERATIONS], error=ERROR_BAR
    )
    for operation, estimate in zip(OPERATIONS, estimates, strict=True):
        assert estimate.error < ERROR_BAR * estimate.volume
        octree = operation(*octrees)
        print(f"{operation.name}: +- {estimate.error / estimate.volume:.3%}")
        # "linear" has the loops of "occupancy"; smaller surfaces are checked with all three.
        check_surface(octree, estimate.volume, ("occupancy", "plane"))


def test_the_estimate_finds_a_known_volume():
    solid = crumpled(1)
    points = RandomPoints([solid], np.zeros(3), np.ones(3))
    found = points.estimate(lambda w: w >= 0.5, error=0.002)
    assert isinstance(found, Estimate)
    assert abs(found.volume - solid.volume) < 4 * found.error
    assert found.error < 0.002 * found.volume


def test_crossings_and_a_fan_make_winding_numbers():
    points = np.random.default_rng(0).uniform(-0.1, 1.1, (500, 3))
    closed = crumpled(2, 3)
    numbers = winding_numbers(closed, points)
    assert np.abs(numbers - np.round(numbers)).max() < 1e-9
    holed = crumpled(2, 3).without(range(60))
    for solid in (closed, closed.flipped(), holed, join(closed, holed)):
        expected = winding_numbers(solid, points)
        assert np.abs(WindingNumbers(solid)(points) - expected).max() < 1e-9


def test_the_check_of_surfaces_sees_faults():
    solid = sphere(1.0, 2)
    assert surface_faults(*vars(solid).values()).none
    assert surface_faults(solid.positions, solid.triangles[1:]).open_or_crowded_edges == 3
    turned = np.concatenate([solid.triangles[:1, ::-1], solid.triangles[1:]])
    assert surface_faults(solid.positions, turned).open_or_crowded_edges > 0
    # Two balls that touch in a vertex, and two boxes that touch along an edge.
    pair = join(solid, solid.transformed(np.eye(3), (2, 0, 0)))
    first, second = 0, len(solid.positions) + 1
    assert (pair.positions[first] == pair.positions[second]).all()
    pinched = np.where(pair.triangles == second, first, pair.triangles)
    assert surface_faults(pair.positions, pinched).pinched_vertices == 1
    flat = np.concatenate([solid.triangles, [[0, 0, 1]]])
    assert surface_faults(solid.positions, flat).degenerate_triangles == 1


def test_the_open_bunny_and_the_armadillo():
    bunny = load("stanford-bunny.obj").fitted((0, 0, 0), (1, 1, 1))
    armadillo = load("armadillo.obj").fitted((0.1, -0.4, -0.1), (1.0, 1.0, 1.1))
    check(bunny, armadillo)


def test_meshes_that_intersect_themselves():
    # Fitted to the same box, because in the files they barely overlap.
    unit = (0, 0, 0), (1, 1, 1)
    a, b = (load(f"csg_self_intersect{name}.obj") for name in "AB")
    check(a.fitted(*unit), b.fitted(*unit))


def test_edges_of_more_than_two_faces():
    dragon = load("dragon_vrip_res3.ply").fitted((0, 0, 0), (1, 1, 1))
    check(dragon, sphere(0.25, 4, (0.45, 0.55, 0.5)))


def test_a_primitive_with_holes_against_one_that_crosses_itself():
    """What needs no gathered models: a ball without some of its triangles, and three balls."""
    holed = sphere(0.5, 4).without(range(0, 2048, 97))
    crossing = join(
        *(sphere(0.27, 3, center) for center in ((0.4, 0, 0), (0.2, 0.3, 0.1), (0.3, 0.1, -0.3)))
    )
    check(holed, crossing, 7)


UNIT_BOUNDS = (np.full(3, -0.5), np.full(3, 1.5))
BOXES = {
    # (the second box, the volumes of union, intersection and difference)
    "one face in common": (box((1, 0, 0), (1.4, 1, 1)), (1.4, 0.0, 1.0)),
    "part of a face in common": (box((0.2, 0.2, 1), (0.6, 0.7, 1.4)), (1.08, 0.0, 1.0)),
    "the same box": (box(), (1.0, 1.0, 0.0)),
    "flush on three sides": (box((0, 0, 0), (0.5, 0.5, 0.5)), (1.0, 0.125, 0.875)),
    "through the middle": (box((0.3, 0.3, 0), (0.7, 0.7, 1)), (1.0, 0.16, 0.84)),
    "inside": (box((0.25, 0.3, 0.35), (0.7, 0.7, 0.7)), (1.0, 0.063, 0.937)),
    "apart": (box((1.1, 1.1, 1.1), (1.3, 1.3, 1.3)), (1.008, 0.0, 1.0)),
    "one edge in common": (box((1, 1, 0), (1.4, 1.4, 1)), (1.16, 0.0, 1.0)),
    "one corner in common": (box((1, 1, 1), (1.4, 1.4, 1.4)), (1.064, 0.0, 1.0)),
}


@pytest.mark.parametrize(
    ("shift", "depth"),
    [(0.0, 6), (0.5, 7), (0.37, 6)],
    ids=["on borders", "mid-cell", "between"],
)
@pytest.mark.parametrize("name", BOXES)
def test_boxes_with_faces_in_common(name, shift, depth):
    """Faces lie on cell borders, in cell middles, where values are 1/2, and in between."""
    second, volumes = BOXES[name]
    low, high = (corner + shift * 2 / 2**depth for corner in UNIT_BOUNDS)
    a, b = (
        prefilter.voxelize(s.positions, s.triangles, depth=depth, bounds=(low, high))
        for s in (box(), second)
    )
    cell = 2 / 2**depth
    for operation, volume in zip(OPERATIONS, volumes, strict=True):
        octree = operation(a, b)
        if volume == 0:
            # min(a, 1 - a) and min(a, b) leave half a layer of cells at most, and no surface.
            assert octree.volume <= 6 * cell / 2
            assert (octree.dense() < 0.5).all()
            assert len(octree.contour()[1]) == 0
            continue
        for interpolant in INTERPOLANTS:
            positions, triangles = octree.contour(interpolant=interpolant)
            faults = surface_faults(positions, triangles)
            assert faults.none, f"{operation.name}, {interpolant}: {faults}"
            # Corners and edges are rounded off within a cell.
            found = mesh_volume(positions, triangles)
            assert found == pytest.approx(volume, abs=12 * cell**2 + 0.004)


def test_nested_shells():
    """Balls nested in each other, every other one inside out."""
    radii = (0.48, 0.4, 0.3, 0.15)
    shells = [sphere(radius, 4, (0.5, 0.5, 0.5)) for radius in radii]
    solid = join(*(s if k % 2 == 0 else s.flipped() for k, s in enumerate(shells)))
    volume = sum((-1) ** k * s.volume for k, s in enumerate(shells))
    half = box((-1, -1, -1), (0.5, 2, 2))
    bounds = (np.zeros(3), np.ones(3))
    a, b = (
        prefilter.voxelize(s.positions, s.triangles, depth=7, bounds=bounds) for s in (solid, half)
    )
    assert a.volume == pytest.approx(volume, abs=1e-6)
    check_surface(a, volume)
    for operation in (a.intersection(b), a.difference(b)):
        check_surface(operation, volume / 2)
    whole = prefilter.voxelize(shells[0].positions, shells[0].triangles, depth=7, bounds=bounds)
    check_surface(whole.difference(a), shells[0].volume - volume)
    check_surface(a.union(whole), shells[0].volume)


def test_shells_that_are_all_the_same_way_around_are_full():
    shells = [sphere(radius, 4, (0.5, 0.5, 0.5)) for radius in (0.45, 0.3)]
    solid = join(*shells)
    octree = prefilter.voxelize(solid.positions, solid.triangles, depth=7)
    check_surface(octree, shells[0].volume)


def test_one_operand_inside_the_other():
    outer = crumpled(1, 3, 0.1)
    inner = crumpled(1, 3, 0.1).transformed(0.4 * np.eye(3), (0.3, 0.3, 0.3))
    bounds = (np.zeros(3), np.ones(3))
    a, b = (
        prefilter.voxelize(s.positions, s.triangles, depth=8, bounds=bounds) for s in (outer, inner)
    )
    check_surface(a.union(b), outer.volume)
    check_surface(a.intersection(b), inner.volume)
    check_surface(a.difference(b), outer.volume - inner.volume)
    assert b.difference(a).volume == 0
    assert len(b.difference(a).contour()[1]) == 0


def test_many_operands():
    """Twelve balls along a circle, then bored through one after another."""
    bounds = (np.full(3, -1.0), np.full(3, 1.0))
    angles = np.arange(12) * np.pi / 6
    centers = [(0.6 * np.cos(t), 0.6 * np.sin(t), 0.05 * np.sin(3 * t)) for t in angles]
    balls = [sphere(0.25, 3, center) for center in centers]
    bore = torus(0.6, 0.07, 64, 24)
    octrees = [
        prefilter.voxelize(s.positions, s.triangles, depth=7, bounds=bounds) for s in (*balls, bore)
    ]
    made = octrees[0]
    for octree in octrees[1:-1]:
        made = made.union(octree)
    made = made.difference(octrees[-1])

    def inside(outer: np.ndarray, bored: np.ndarray) -> np.ndarray:
        return (outer >= 0.5) & (bored < 0.5)

    # All balls wind the same way around, so their winding numbers add up.
    estimate = RandomPoints([join(*balls), bore], *bounds).estimate(inside)
    check_surface(made, estimate.volume)


@pytest.mark.parametrize("seed", range(4))
def test_random_pairs(seed):
    """Full checks on surfaces whose cells meet in every way."""
    a = crumpled(seed, 2, 0.9)
    b = crumpled(seed + 50, 2, 0.9).transformed(random_rotation(seed), (0.3, 0.2, -0.1))
    bounds = bounds_of(a, b)
    octrees = [prefilter.voxelize(s.positions, s.triangles, depth=5, bounds=bounds) for s in (a, b)]
    for operation in OPERATIONS:
        octree = operation(*octrees)
        for interpolant in INTERPOLANTS:
            faults = surface_faults(*octree.contour(interpolant=interpolant))
            assert faults.none, f"{operation.name}, {interpolant}: {faults}"
