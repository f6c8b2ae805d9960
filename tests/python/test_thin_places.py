# SPDX-License-Identifier: GPL-3.0-or-later

"""Thin places, against rays through the solid and against finer cells."""

import numpy as np
import prefilter
import pytest
from solids import Solid, box, join, sheet, sphere

from bench.solids import random_rotation
from bench.voxels.thin_shapes import plate, posed, ring, rod

DEPTH = 6
CELLS = 2**DEPTH
LEAST = 1.5
BOUNDS = (np.zeros(3), np.full(3, float(CELLS)))


def voxelized(solid: Solid, depth: int = DEPTH, **options) -> prefilter.Octree:
    return prefilter.voxelize(
        solid.positions,
        solid.triangles,
        depth=depth,
        bounds=BOUNDS,
        **{"thickness": LEAST, **options},
    )


def thin_places(solid: Solid, depth: int = DEPTH, **options) -> prefilter.ThinPlaces:
    return voxelized(solid, depth, **options).thin_places


def depths_below(solid: Solid, triangles) -> np.ndarray:
    """Returns the lengths of rays from triangles' middles inward until they leave the solid."""
    corners = solid.positions[solid.triangles]
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    found = []
    for t in triangles:
        way = -normals[t] / np.linalg.norm(normals[t])
        edge, other = b - a, c - a
        p = np.cross(way, other)
        det = (edge * p).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = corners[t].mean(axis=0) - a
            u = (offset * p).sum(axis=1) / det
            q = np.cross(offset, edge)
            v = (q @ way) / det
            far = (other * q).sum(axis=1) / det
            inner = u + v <= 1
        is_hit = (np.abs(det) > 1e-12) & (u >= 0) & (v >= 0) & inner & (far > 1e-9)
        found.append(far[is_hit].min())
    return np.array(found)


@pytest.mark.parametrize("thickness", [0.02, 0.5, 1.0, 1.4])
def test_a_plate_is_as_thick_as_rays_say(thickness):
    for seed in range(3):
        solid = posed(plate(thickness), seed, CELLS)
        found = thin_places(solid)
        # Its sides face each other across the plate, and are not thin.
        areas = np.linalg.norm(
            np.cross(*np.diff(solid.positions[solid.triangles], axis=1).swapaxes(0, 1)), axis=1
        )
        assert found.triangles.tolist() == np.flatnonzero(areas > 2 * 30 * thickness).tolist()
        np.testing.assert_allclose(found.thickness, depths_below(solid, found.triangles), rtol=1e-6)
        assert found.areas.sum() == pytest.approx(2 * 40 * 30, rel=0.02)
        assert found.thickness_of() == pytest.approx(thickness)
        assert found.refinement() == pytest.approx(LEAST / thickness, rel=0.3)


@pytest.mark.parametrize("thickness", [0.2, 0.7, 1.0, 1.3])
def test_finer_cells_keep_what_is_promised(thickness):
    for shape in (plate, rod, ring):
        solid = posed(shape(thickness), 1, CELLS)
        share = 0.9
        found = thin_places(solid)
        finer = DEPTH + int(np.ceil(np.log2(found.refinement(share))))
        left = thin_places(solid, finer)
        scale = 4.0 ** (finer - DEPTH)
        assert left.areas.sum() / scale <= (1 - share) * found.areas.sum() + 1e-9
        coarser = thin_places(solid, finer - 1)
        assert coarser.areas.sum() * 4 / scale > (1 - share) * found.areas.sum()


def test_of_a_triangle_the_thinnest_place_counts():
    """A wedge of 2 degrees, of few triangles."""
    positions = np.array(
        [(x, y, z) for x, h in ((0.0, 0.1), (50.0, 1.0)) for y in (0.0, 30.0) for z in (-h, h)]
    )
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    found = thin_places(Solid(positions + np.array([7.2, 17.1, 32.3]), triangles[:, ::-1]))
    ends = found.thickness[found.triangles < 4]
    assert len(ends) == 4
    assert ends.min() == pytest.approx(0.2, abs=0.03)
    # Half of the area of thickness 0.2 to 1.5 on either side.
    assert found.areas.sum() == pytest.approx(2 * 30 * (1.5 - 0.2) / 1.8 * 50, rel=0.05)


def test_of_large_thicknesses_too():
    solid = posed(plate(4.0), 1, CELLS)
    found = thin_places(solid, thickness=6.0)
    assert found.thickness_of() == pytest.approx(4.0)
    assert found.areas.sum() == pytest.approx(2 * 40 * 30, rel=0.3)


def test_sheets_have_no_thickness():
    flat = sheet(8, lambda x, y: 0 * x).transformed(20 * np.eye(3), np.full(3, 32.4))
    mesh = prefilter.as_solid(flat.positions, flat.triangles, cell=1.0, sheets="faces")
    found = thin_places(Solid(mesh.positions, mesh.triangles))
    assert np.unique(mesh.origins[found.triangles]).tolist() == list(range(len(flat.triangles)))
    assert found.thickness_of() == 0.0
    assert found.refinement(0.5) == np.inf


def test_numbers_are_those_of_the_mesh():
    """Also where triangles are far away, or have no area."""
    thin = posed(plate(0.5), 1, CELLS)
    far = box((1e12, 0, 0), (1.1e12, 10, 10))
    flat = Solid(np.eye(3) + 30, np.array([[0, 1, 1]]))
    for other in (far, flat, sphere(3.0, 3, (6.0, 6.0, 6.0))):
        found = thin_places(join(other, thin))
        expected = thin_places(thin)
        shift = len(other.triangles)
        assert (found.triangles - shift).tolist() == expected.triangles.tolist()


def wedge(degrees: float) -> Solid:
    """Opens from an edge of 30 to 20 away, by an angle."""
    far = 20 * np.tan(np.radians(degrees / 2))
    sections = ((0, 0), (20, far))
    positions = np.array([(x, y, z) for x, h in sections for y in (0, 30) for z in (-h, h)])
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (4, 5, 7, 6)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    solid = Solid(positions - (10.0, 15, 0), triangles[:, ::-1])
    return solid.transformed(random_rotation(1), np.full(3, CELLS / 2))


@pytest.mark.parametrize("degrees", [6.0, 9.0, 11.0, 16.0, 25.0])
def test_wedges_are_no_walls(degrees):
    solid = wedge(degrees)
    tree = voxelized(solid)
    assert (len(tree.thin_walls.triangles) > 0) == (degrees < 10)


@pytest.mark.parametrize("degrees", [2.0, 5.0, 9.0])
def test_of_a_narrow_wedge_nine_tenths_are_thicker(degrees):
    """Thickness grows in proportion to the way from the edge; two triangles a face cover it."""
    found = voxelized(wedge(degrees)).thin_walls
    way = min(LEAST / 2 / np.tan(np.radians(degrees / 2)), 20.0)
    # Distances from the edge below which a tenth of the area lies: for the triangle with two
    # corners on the edge, whose width falls from 1 to 0 over 20, and for the one with one corner.
    two = 20 - np.sqrt(400 - 40 * 0.1 * (way - way**2 / 40))
    one = way * np.sqrt(0.1)
    expected = 2 * np.tan(np.radians(degrees / 2)) * np.array([two, two, one, one])
    np.testing.assert_allclose(np.sort(found.thickness), expected, atol=0.03)
    slope = 30 / np.cos(np.radians(degrees / 2))
    areas = slope * np.array([way - way**2 / 40, way**2 / 40])
    np.testing.assert_allclose(np.sort(found.areas), np.sort(np.repeat(areas, 2)), rtol=0.1)


def test_walls_are_thin_places_of_plates():
    for thickness in (0.02, 0.7, 1.2):
        tree = voxelized(posed(plate(thickness), 1, CELLS))
        walls, places = tree.thin_walls, tree.thin_places
        for name in ("triangles", "thickness", "areas"):
            np.testing.assert_allclose(getattr(walls, name), getattr(places, name), rtol=1e-6)


def test_nothing_is_thin():
    solid = sphere(20.0, 4, (32, 32, 32))
    for found in (thin_places(solid), thin_places(posed(rod(0.5), 1, CELLS), thickness=0.0)):
        assert len(found.triangles) == 0
        assert found.thickness_of() == np.inf
        assert found.refinement(0.5) == 1.0


def test_threads_do_not_change_a_bit():
    solid = join(posed(ring(0.5), 3, CELLS), posed(plate(0.3), 4, CELLS))
    first, second = (thin_places(solid, threads=threads) for threads in (1, 4))
    for name in ("triangles", "thickness", "made", "areas"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_the_share_is_one():
    found = thin_places(posed(plate(0.5), 1, CELLS))
    for share in (0.0, -1.0, 1.5, np.nan):
        with pytest.raises(ValueError, match="share"):
            found.thickness_of(share)
