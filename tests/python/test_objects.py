# SPDX-License-Identifier: GPL-3.0-or-later

"""Objects of the native module: shared, never emptied, and unusable before their __init__."""

import copy
import pickle

import numpy as np
import prefilter
import pytest
from octrees import octrees_are_same
from prefilter import _native
from scenes import random_image, square
from solids import box

SURFACE = square().surface
BOX = box()
OCTREE = prefilter.voxelize(BOX.positions, BOX.triangles, depth=3)
IMAGE = random_image(0, 8, 8, 1)
POINTS = np.zeros((1, 3))

# Every public use of an object: attributes, methods, and functions that take one.
USES = {
    prefilter.Octree: {
        "volume": lambda octree: octree.volume,
        "root": lambda octree: octree.root,
        "depth": lambda octree: octree.depth,
        "bounds": lambda octree: octree.bounds,
        "node_count": lambda octree: octree.node_count,
        "nbytes": lambda octree: octree.nbytes,
        "dense": lambda octree: octree.dense(2),
        "values": lambda octree: octree.values(POINTS),
        "classify": lambda octree: octree.classify(POINTS),
        "box_occupancy": lambda octree: octree.box_occupancy((0, 0, 0), (1, 1, 1)),
        "union": lambda octree: octree.union(OCTREE),
        "intersection": lambda octree: octree.intersection(OCTREE),
        "difference": lambda octree: OCTREE.difference(octree),
        "contour": lambda octree: octree.contour(),
        "traced_contour": lambda octree: octree.traced_contour([(np.eye(3), [[0, 1, 2]])]),
        "quad_contour": lambda octree: octree.quad_contour(),
        "thin_places": lambda octree: octree.thin_places,
        "thin_walls": lambda octree: octree.thin_walls,
        "lost_parts": lambda octree: octree.lost_parts(np.eye(3), [[0, 1, 2]], [0]),
        "coarsened": lambda octree: octree.coarsened(1),
        "save": lambda octree: octree.save("never.npz"),
        "load": None,
    },
    prefilter.Surface: {
        "triangle_count": lambda surface: surface.triangle_count,
        "area": lambda surface: surface.area,
        "positions": lambda surface: surface.positions,
        "triangles": lambda surface: surface.triangles,
        "uvs": lambda surface: surface.uvs,
        "areas": lambda surface: surface.areas,
        "placed": lambda surface: surface.placed(np.eye(4)),
        "with_areas_of": lambda surface: surface.with_areas_of(SURFACE),
        "udim_tile": lambda surface: surface.udim_tile(1001),
        "merged": lambda surface: prefilter.Surface.merged([SURFACE, surface]),
        "from_subdivision": None,
        "mipmaps": lambda surface: prefilter.mipmaps(IMAGE, surface),
        "mipmap_error": lambda surface: prefilter.mipmap_error([IMAGE], IMAGE, surface, [0]),
        "seam_contrast": lambda surface: prefilter.seam_contrast([IMAGE], [SURFACE, surface]),
        "texel_weights": lambda surface: prefilter.texel_weights(surface, 4, 4),
        "fill_unused": lambda surface: prefilter.fill_unused(IMAGE, surface),
    },
}


@pytest.mark.parametrize(
    ("kind", "use"),
    [(kind, name) for kind, uses in USES.items() for name, use in uses.items() if use],
)
def test_without_init_there_is_an_error(kind, use, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(TypeError, match=f"{kind.__name__}: an object whose __init__ has not run"):
        USES[kind][use](kind.__new__(kind))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", USES)
def test_every_attribute_is_tried(kind):
    assert {name for name in dir(kind) if not name.startswith("_")} <= set(USES[kind])


@pytest.mark.parametrize("kind", [_native.Octree, _native.Surface])
def test_one_without_init_shares_nothing(kind):
    with pytest.raises((TypeError, RuntimeError)):
        kind(kind.__new__(kind))


def test_an_octree_made_of_another_shares_it():
    other = prefilter.Octree(OCTREE)
    assert octrees_are_same(other, OCTREE)
    assert other.volume == OCTREE.volume == pytest.approx(1.0)
    volume = other.coarsened(2).volume
    kept = prefilter.Octree(prefilter.Octree(other.coarsened(2)))
    del other
    assert kept.volume == volume


def test_what_is_no_octree_makes_none():
    for given in (None, 3, SURFACE):
        with pytest.raises(ValueError, match=f"octree: a {type(given).__name__}; an Octree"):
            prefilter.Octree(given)


@pytest.mark.parametrize("made", [OCTREE, SURFACE], ids=["octree", "surface"])
def test_copies_are_refused_or_whole(made):
    for duplicate in (copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))):
        with pytest.raises(TypeError, match="pickle"):
            duplicate(made)
