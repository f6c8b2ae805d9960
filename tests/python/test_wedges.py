# SPDX-License-Identifier: GPL-3.0-or-later

"""Telling folds of results from edges of the voxelized mesh, and contours at ends of slits."""

import sys
from pathlib import Path

import numpy as np
import prefilter
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from solids import Solid, box, join

from bench.voxels import measures, wedges

pytest.importorskip("scipy")


def folds_left(positions, triangles, solid):
    """Counts folds away from and at wedges of a solid, in cells of size 1."""
    triangles = np.asarray(triangles, np.int64)
    folded = measures.folded_pairs(positions, triangles)
    is_wedge = wedges.are_wedges(positions, triangles, folded, solid, 1.0)
    return int((~is_wedge).sum()), int(is_wedge.sum())


def prism(corners, height=8.0):
    """A polygon of the plane, counterclockwise, from -height to height along the third axis."""
    count = len(corners)
    low, high = (np.c_[corners, np.full(count, z)] for z in (-height, height))
    triangles = [(0, k + 1, k) for k in range(1, count - 1)]
    triangles += [(count, count + k, count + k + 1) for k in range(1, count - 1)]
    for k in range(count):
        other = (k + 1) % count
        triangles += [(k, other, count + other), (k, count + other, count + k)]
    return Solid(np.concatenate([low, high]), np.array(triangles, np.int32))


def turned_prism(corners):
    """A prism, inside out."""
    made = prism(corners)
    return Solid(made.positions, made.triangles[:, ::-1].copy())


TIP = np.array([[0, 0], [6, -1.5], [6, 1.5]], float)  # 28 degrees


def test_an_edge_of_the_solid_is_a_wedge():
    made = prism(TIP)
    assert folds_left(made.positions, made.triangles, (made.positions, made.triangles)) == (0, 1)
    blunt = prism(np.array([[-0.1, -3], [6, -3], [6, 3], [-0.1, 3]], float))
    assert folds_left(made.positions, made.triangles, (blunt.positions, blunt.triangles)) == (1, 0)


def test_a_convex_wedge_of_crossed_faces_is_one_where_only_what_is_behind_both_is_inside():
    """The sides of the tip continue beyond it, where the faces enclose a volume inside out."""
    sides = np.array([[-1, 0.25], [6, -1.5], [6, 1.5], [-1, -0.25]], float)
    crossed = prism(sides)
    made = prism(TIP)
    solid = crossed.positions, crossed.triangles.astype(np.int64)
    # The crossing is 1 from the edges of the mesh; the fold is on it.
    assert folds_left(made.positions, made.triangles, solid) == (0, 1)
    # Wherever parts that are right side out overlap, the crossing is concave.
    over = join(
        prism(np.array([[-1, 0.25], [6, -1.5], [6, -3], [-1, -3]], float)[::-1]),
        prism(np.array([[-1, -0.25], [6, 1.5], [6, 3], [-1, 3]], float)),
    )
    assert folds_left(made.positions, made.triangles, (over.positions, over.triangles))[1] == 0
    gap = turned_prism(TIP)
    assert folds_left(gap.positions, gap.triangles, (over.positions, over.triangles)) == (0, 1)


def tilted_box(low, high, angles):
    """A box, turned around the first axis and then around the second by small angles."""
    made = box(low, high)
    for angle, axis in zip(angles, (0, 1), strict=True):
        cosine, sine = np.cos(angle), np.sin(angle)
        i, j = (k for k in range(3) if k != axis)
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = cosine
        turn[i, j], turn[j, i] = -sine, sine
        made = made.transformed(turn)
    return made


def folds_of_contour(solid, *, is_clean):
    """Folds of the sharp contour at the usual thickness, in 32 cells of size 1."""
    bounds = ((0, 0, 0), (32, 32, 32))
    source = solid.positions, solid.triangles
    tree = prefilter.voxelize(*source, depth=5, bounds=bounds, thickness=1.5)
    made = tree.contour(interpolant="sharp", cleanup=is_clean, sources=[source])
    return folds_left(*made[:2], (solid.positions, solid.triangles.astype(np.int64)))[0]


@pytest.mark.parametrize("is_clean", [False, True])
@pytest.mark.parametrize("seed", [3, 4])
def test_ends_of_slits_do_not_fold(seed, is_clean):
    """A box that hovers askew over another by less than a cell: the slit has no edge at its end."""
    rng = np.random.default_rng(seed)
    gap = rng.uniform(0.02, 0.3)
    upper = tilted_box((-5, -5, 0), (3, 3, 5), rng.uniform(-0.08, 0.08, 2))
    both = join(box((-8, -8, -6), (8, 8, 0)), upper.transformed(np.eye(3), (0, 0, gap)))
    turn, signs = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.diag(signs))
    if np.linalg.det(turn) < 0:
        turn[:, 0] *= -1
    posed = both.transformed(turn, 16 + rng.uniform(-0.5, 0.5, 3))
    assert folds_of_contour(posed, is_clean=is_clean) == 0


def test_clean_up_leaves_wedges_as_sharp_as_they_are():
    """A flat tetrahedron of few cells, whose edges turn by more than 120 degrees themselves."""
    corners = [(8.075, 6.336, 23.304), (10.579, 9.156, 24.049), (6.596, 9.37, 24.801)]
    tip = (12.712, 3.947, 26.288)
    sides = [(0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 2, 1)]
    made = Solid(np.array([*corners, tip]), np.array(sides, np.int32))
    assert folds_of_contour(made, is_clean=False) == 0
    assert folds_of_contour(made, is_clean=True) == 0
