# SPDX-License-Identifier: GPL-3.0-or-later

"""Sharp contours of shapes whose edges are known, by measures that share nothing with the library.

The same measures, of more shapes and in finer cells, are in bench/voxels/edges.py and corpus.py.
"""

import itertools
import sys
from pathlib import Path

import numpy as np
import prefilter
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench import solids as bench_solids
from bench.voxels import booleans, corpus, edges, measures, meshes, sharp_shapes

spatial = pytest.importorskip("scipy.spatial")

SIZE = 128
SHARP = edges.Contour.named("sharp")
CLEAN = edges.Contour.named("sharp+clean")


def cuts(positions, triangles):
    """Pairs of triangles without a common vertex, an edge of one of which passes through the other.

    Only where rounding cannot have made it so: every volume whose sign decides is far from 0.
    """
    corners = positions[triangles]
    middles = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middles[:, None], axis=2).max()
    pairs = spatial.cKDTree(middles).query_pairs(2 * radius, output_type="ndarray")
    low, high = corners.min(axis=1), corners.max(axis=1)
    meet = (low[pairs[:, 0]] <= high[pairs[:, 1]]) & (low[pairs[:, 1]] <= high[pairs[:, 0]])
    pairs = pairs[meet.all(axis=1)]
    shared = (triangles[pairs[:, 0], :, None] == triangles[pairs[:, 1], None, :]).any(axis=(1, 2))
    pairs = pairs[~shared]
    found = np.zeros(len(pairs), bool)
    least = 1e-12 * np.ptp(positions, axis=0).max() ** 3

    def volume(a, b, c, d):
        return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)

    for first, second in (pairs.T, pairs.T[::-1]):
        a, b, c = np.moveaxis(corners[second], 1, 0)
        for k in range(3):
            p, q = corners[first, k], corners[first, (k + 1) % 3]
            above, below = volume(a, b, c, p), volume(a, b, c, q)
            sides = [volume(p, q, *ends) for ends in ((a, b), (b, c), (c, a))]
            through = (above * below < 0) & (np.minimum(np.abs(above), np.abs(below)) > least)
            for one, other in itertools.combinations(sides, 2):
                through &= (one * other > 0) & (np.minimum(np.abs(one), np.abs(other)) > least)
            found |= through
    return pairs[found]


def check_sound(name, positions, triangles):
    found = measures.manifoldness(triangles, len(positions))
    assert found.is_manifold, (name, found)
    assert len(cuts(positions, triangles)) == 0, name


def test_the_measures_find_what_was_done_to_a_cube():
    """Moved by a tenth of a cell along an axis, and with an edge that is cut off."""
    cube = sharp_shapes.shape("cube", turned=False)
    lines = measures.sharp_edges(cube.positions, cube.triangles, 30)
    assert len(lines.ends) == 12
    np.testing.assert_allclose(lines.degrees, 90)
    cell = 0.1
    same = measures.edge_errors(cube.positions, cube.triangles, lines, cell)
    assert max(same.numbers) < 1e-9
    moved = measures.edge_errors(
        cube.moved(np.eye(3), [0.01, 0, 0]).positions, cube.triangles, lines, cell
    )
    # Eight edges are moved across themselves, four along, where the surface stays.
    np.testing.assert_allclose(moved.crease_mean, 8 / 12 * 0.1, rtol=0.01)
    np.testing.assert_allclose(moved.corner, 0.1)
    whole = measures.surface_errors(
        cube.positions, cube.triangles, cube.positions, cube.triangles, lines, cell, 20_000
    )
    assert whole.wrong == 0
    sheared = cube.positions + 0.5 * cube.positions[:, [2, 0, 0]] * [1, 0, 0]
    leaning = measures.surface_errors(
        sheared, cube.triangles, cube.positions, cube.triangles, lines, cell, 20_000
    )
    side = 2 * 4 * np.sqrt(1.25)
    np.testing.assert_allclose(leaning.wrong, side / (side + 16), atol=0.01)


def test_cuts_are_found():
    first = sharp_shapes.shape("cube")
    second = first.moved(np.eye(3), 0.5)
    positions = np.concatenate([first.positions, second.positions])
    triangles = np.concatenate([first.triangles, second.triangles + len(first.positions)])
    assert len(cuts(positions, triangles)) > 6
    assert len(cuts(first.positions, first.triangles)) == 0


@pytest.mark.parametrize(
    ("name", "how"), [("cube", SHARP), ("cylinder", CLEAN), ("bracket", CLEAN)]
)
def test_edges_are_where_they_are(name, how):
    subject = edges.single(name)
    _, cell = edges.box_around(subject.sources, SIZE)
    positions, triangles, _ = edges.contour(subject, SIZE, how)
    errors = measures.edge_errors(positions, triangles, subject.edges, cell)
    assert max(errors.surface_mean, errors.crease_mean) < edges.EDGE_MEAN, errors
    assert max(errors.surface_95, errors.crease_95) < edges.EDGE_95, errors
    truth = subject.truth
    off = measures.surface_errors(
        positions, triangles, truth.positions, truth.triangles, subject.edges, cell, 20_000
    )
    assert off.wrong < edges.AREA, off
    check_sound(name, positions, triangles)


@pytest.mark.parametrize("operation", list(booleans.OPERATORS))
@pytest.mark.skipif(bool(booleans.missing()), reason="manifold3d is not there")
def test_rims_are_where_surfaces_meet(operation):
    subject = edges.boolean("cube", "cylinder", operation, 1)
    _, cell = edges.box_around(subject.sources, SIZE)
    positions, triangles, _ = edges.contour(subject, SIZE, CLEAN)
    errors = measures.edge_errors(positions, triangles, subject.edges, cell)
    assert max(errors.surface_mean, errors.crease_mean) < edges.EDGE_MEAN, errors
    assert max(errors.surface_95, errors.crease_95) < edges.EDGE_95, errors


def test_the_rim_of_two_cubes_is_exact():
    """Shapes along the axes have only planes and their corners."""
    first = sharp_shapes.shape("cube", turned=False)
    second = first.moved(np.eye(3), [0.777, 0.613, 0.521])
    subject = edges.Subject("", (first, second), "union", first, edges.NO_EDGES)
    positions, triangles, _ = edges.contour(subject, 32, SHARP)
    check_sound("cubes", positions, triangles)
    inside = (1 - 0.777 + 1) * (1 - 0.613 + 1) * (1 - 0.521 + 1)
    assert corpus.volume(positions, triangles) == pytest.approx(16 - inside, rel=1e-6)


def plane_through_block(degrees):
    """A block, and one that covers its part below a plane at an angle to its top.

    The plane meets the top at x = -0.6.
    """
    angle = np.radians(degrees)
    block = bench_solids.box((-1, -1, -1), (1, 1, 0))
    cover = bench_solids.box((-1.6, -1.6, -1.5), (2.2, 1.6, 0))
    tilt = np.array(
        [
            [np.cos(angle), 0, np.sin(angle)],
            [0, 1, 0],
            [-np.sin(angle), 0, np.cos(angle)],
        ]
    )
    shapes = [sharp_shapes.Shape("block", block.positions, block.triangles.astype(np.int64))]
    moved = cover.positions @ tilt.T + [-0.6, 0, 0]
    shapes.append(sharp_shapes.Shape("cover", moved, cover.triangles.astype(np.int64)))
    return shapes


@pytest.mark.parametrize(("degrees", "seed"), [(15, 1), (15, 3), (20, 1), (29, 3)])
def test_acute_rims_have_no_teeth(degrees, seed):
    """A block without its part below a plane that leaves its top: a wedge, whose tip is the rim."""
    turn = sharp_shapes.rotation(seed)
    block, cover = (s.moved(turn) for s in plane_through_block(degrees))

    def tip(reach):
        ends = np.array([[[-0.6, -reach, 0], [-0.6, reach, 0]]]) @ turn.T
        return measures.Edges(ends, np.array([180.0 - degrees]))

    subject = edges.Subject("", (block, cover), "difference", block, tip(1))
    _, cell = edges.box_around(subject.sources, SIZE)
    positions, triangles, _ = edges.contour(subject, SIZE, SHARP)
    assert measures.topology(triangles) == (1, 0)
    height = 1.6 * np.tan(np.radians(degrees))
    assert corpus.volume(positions, triangles) == pytest.approx(1.6 * height, rel=0.002)
    errors = measures.edge_errors(positions, triangles, tip(0.9), cell)
    assert max(errors.surface_mean, errors.crease_mean) < edges.EDGE_MEAN, errors
    assert max(errors.surface_95, errors.crease_95) < edges.EDGE_95, errors
    assert measures.folds(positions, triangles, 120, tip(1), 3 * cell) == 0
    check_sound(f"{degrees} {seed}", positions, triangles)


def block_with_a_lip(wide):
    """A block that a plane at 45 degrees to its top cuts to a wedge, and a cover for the rest.

    At y = 4 the block ends, except for a lip behind the wedge's edge, x = 0. The lip is `wide`
    there, and tapers to a point at y = 4 + 16 (wide + 1) / 3.
    """
    end = 4 + 16 * (wide + 1) / 3
    outline = [(-3, -12), (12, -12), (12, 4), (wide, 4), (-1, end), (-3, end)]
    block = sharp_shapes.Solid()
    block.prism(np.array(outline, float), -12, 0)
    cover = bench_solids.box((-30, -30, -30), (30, 30, 0))
    cosine = np.sqrt(0.5)
    tilt = np.array([[cosine, 0, cosine], [0, 1, 0], [-cosine, 0, cosine]])
    return (np.array(block.points), np.array(block.triangles)), (
        cover.positions @ tilt.T,
        cover.triangles,
    )


@pytest.mark.parametrize("seed", range(6))
def test_lips_are_not_cut_where_the_shape_ends_behind_them(seed):
    """A wedge's tip is cut off where it is too thin for cells: a lip of two cells has but a tip."""
    wide = 2.0
    turn = bench_solids.random_rotation(seed)
    offset = 32 + np.random.default_rng(seed).uniform(-0.5, 0.5, 3)
    meshes = [(p @ turn.T + offset, t) for p, t in block_with_a_lip(wide)]
    bounds = ((0, 0, 0), (64, 64, 64))
    block, cover = (prefilter.voxelize(*mesh, depth=6, bounds=bounds) for mesh in meshes)
    positions, triangles = block.difference(cover).contour(interpolant="sharp", sources=meshes)
    along = ((positions - offset) @ turn)[np.unique(triangles), 1]
    # There it is 1.34 cells wide.
    assert along.max() > 7.5
    check_sound(f"lip {seed}", positions, triangles.astype(np.int64))


@pytest.mark.parametrize("seed", range(1, 7))
def test_slits_between_slabs_do_not_fold(seed):
    """A slit of half a cell is bridged here and there; slabs turn by 90 degrees at their edges."""
    cell, slit = 0.125, 0.07
    slabs = bench_solids.join(
        bench_solids.box((-1, -1, -1), (1, 1, -slit / 2)),
        bench_solids.box((-1, -1, slit / 2), (1, 1, 1)),
    )
    turn = bench_solids.random_rotation(seed)
    source = (slabs.positions @ turn.T, slabs.triangles)
    bounds = (np.full(3, -16 * cell), np.full(3, 16 * cell))
    tree = prefilter.voxelize(*source, depth=5, bounds=bounds)
    positions, triangles = tree.contour(interpolant="sharp", sources=[source])
    assert measures.folds(positions, triangles) == 0
    check_sound("slabs", positions, triangles.astype(np.int64))
    assert np.abs(positions @ turn).max() < 1 + 0.5 * cell


def wedge(degrees):
    """A prism over an isosceles triangle, turned against the axes; its tip is an edge."""
    half = np.radians(degrees) / 2
    solid = sharp_shapes.Solid()
    solid.prism(np.array([(0, 0), (1, -np.tan(half)), (1, np.tan(half))]), -0.5, 0.5)
    return solid.named("wedge").moved(sharp_shapes.rotation(5))


@pytest.mark.parametrize("how", [SHARP, CLEAN], ids=["sharp", "clean"])
@pytest.mark.parametrize("degrees", [45.0, 55.0])
def test_edges_of_wedges_are_no_folds(degrees, how):
    """Edges that turn by more than 120 degrees are preserved."""
    shape = wedge(degrees)
    lines = measures.sharp_edges(shape.positions, shape.triangles, 120)
    assert len(lines.ends) == 1
    subject = edges.Subject("wedge", (shape,), "", shape, lines)
    _, cell = edges.box_around(subject.sources, 64)
    positions, triangles, _ = edges.contour(subject, 64, how)
    errors = measures.edge_errors(positions, triangles, lines, cell)
    assert max(errors.surface_mean, errors.crease_mean) < 0.05, errors  # Tips are thin.
    assert measures.folds(positions, triangles) > 30
    assert measures.folds(positions, triangles, 120, lines, 0.5 * cell) == 0
    check_sound("wedge", positions, triangles)


def share_off(positions, triangles, shape, degrees):
    """The share of the area whose normal differs by more from the nearest point's on the shape."""
    off = measures.degrees_off(
        positions, triangles, shape.positions, shape.triangles, 0.1, samples=20_000
    )
    return (off > degrees).mean()


def ball(rounds, turn=3):
    made = bench_solids.sphere(1.0, rounds)
    shape = sharp_shapes.Shape("ball", made.positions, made.triangles.astype(np.int64))
    return shape.moved(sharp_shapes.rotation(turn))


@pytest.mark.parametrize("how", [SHARP, CLEAN], ids=["sharp", "clean"])
@pytest.mark.parametrize(
    "shape",
    [sharp_shapes.cylinder(24).moved(sharp_shapes.rotation(6)), ball(3)],
    ids=["cylinder", "ball"],
)
def test_blunt_edges_between_wide_facets_are_straight(shape, how):
    """Edges of 15 degrees, and of 7 to 12: normals are a facet's, and none lies between two."""
    subject = edges.Subject("", (shape,), "", shape, edges.NO_EDGES)
    positions, triangles, _ = edges.contour(subject, 64, how)
    assert share_off(positions, triangles, shape, 2) < 0.01
    assert share_off(*edges.contour(subject, 64, edges.Contour.named("plane"))[:2], shape, 2) > 0.1
    check_sound("facets", positions, triangles)


@pytest.mark.parametrize("how", [SHARP, CLEAN], ids=["sharp", "clean"])
def test_rims_that_run_into_edges_have_no_burr(how):
    """A cube is cut out of a ball of facets: all normals are from either solid."""
    first = ball(2, 2)
    second = sharp_shapes.cube().moved(0.8 * sharp_shapes.rotation(4), [0.9, 0, 0])
    subject = edges.Subject("", (first, second), "difference", first, edges.NO_EDGES)
    positions, triangles, _ = edges.contour(subject, SIZE, how)
    both = sharp_shapes.Shape(
        "",
        np.concatenate([first.positions, second.positions]),
        np.concatenate([first.triangles, second.triangles[:, ::-1] + len(first.positions)]),
    )
    assert share_off(positions, triangles, both, 10) < edges.AREA
    check_sound("rims", positions, triangles)


def test_facets_that_are_small_beside_cells_have_no_edges():
    """Facets smaller than a cell, with edges of two degrees, count as a smooth surface."""
    shape = ball(6)
    subject = edges.Subject("", (shape,), "", shape, edges.NO_EDGES)
    sharp = edges.contour(subject, 64, SHARP)
    plain = edges.contour(subject, 64, edges.Contour.named("plane"))
    np.testing.assert_array_equal(sharp[0], plain[0])
    np.testing.assert_array_equal(np.sort(sharp[1], axis=0), np.sort(plain[1], axis=0))


def solids():
    made = corpus.made()
    chosen = [s for s in made if s.name.split()[0] in ("ring", "gear", "joint", "plate", "cone")]
    if (meshes.DATA / "suzanne.obj").exists():
        read = meshes.read(meshes.DATA / "suzanne.obj")
        chosen.append(corpus.fitted("suzanne", read.positions, read.triangles))
    return chosen


@pytest.mark.parametrize("how", [SHARP, CLEAN], ids=["sharp", "clean"])
def test_contours_of_many_meshes_are_sound(how):
    for shape in [*solids()[::2], corpus.clutter(0), corpus.clutter(3)]:
        subject = edges.Subject(shape.name, (shape,), "", shape, edges.NO_EDGES)
        check_sound(shape.name, *edges.contour(subject, 32, how)[:2])


@pytest.mark.parametrize("how", [SHARP, CLEAN], ids=["sharp", "clean"])
def test_random_booleans_are_sound(how):
    closed = [shape for shape in solids() if corpus.is_closed(shape)]
    for one in corpus.random_booleans(8, closed):
        subject = edges.Subject("", one.sources, one.operation, one.sources[0], edges.NO_EDGES)
        check_sound(one.name, *edges.contour(subject, 32, how)[:2])
