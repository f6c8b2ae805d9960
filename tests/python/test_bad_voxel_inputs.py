# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input to functions of voxels and meshes, in rows as in test_bad_inputs.py."""

import numpy as np
import prefilter
import pytest
from refusals import NAN, NUMBERS, changed, check_refusal
from solids import box

BOX = box()
QUAD = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
OCTREE = prefilter.voxelize(BOX.positions, BOX.triangles, depth=3)


def octree_method(name, *arguments, **options):
    return getattr(OCTREE, name)(*arguments, **options)


FUNCTIONS = {
    "voxelize": (
        prefilter.voxelize,
        {"positions": BOX.positions, "triangles": BOX.triangles, "depth": 3},
    ),
    "cube_around": (prefilter.cube_around, {"bounds": ((0, 0, 0), (1, 1, 1))}),
    "nearest_points": (
        prefilter.nearest_points,
        {"points": QUAD, "positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "corner_points": (
        prefilter.corner_points,
        {
            "positions": BOX.positions,
            "triangles": BOX.triangles,
            "origins": np.arange(12),
            "source_positions": BOX.positions,
            "source_triangles": BOX.triangles,
            "labels": np.zeros(12, np.int32),
        },
    ),
    "measure_mesh": (
        prefilter.measure_mesh,
        {"positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "self_intersections": (
        prefilter.self_intersections,
        {"positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "uv_charts": (
        prefilter.uv_charts,
        {
            "positions": BOX.positions,
            "triangles": BOX.triangles,
            "uvs": [np.zeros((12, 3, 2), np.float32)],
        },
    ),
    "mesh_edges": (
        prefilter.mesh_edges,
        {"positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "mesh_topology": (
        prefilter.mesh_topology,
        {"positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "close_holes": (
        prefilter.close_holes,
        {"positions": BOX.positions, "triangles": BOX.triangles},
    ),
    "as_solid": (
        prefilter.as_solid,
        {"positions": BOX.positions, "triangles": BOX.triangles, "cell": 0.1},
    ),
    "contour": (prefilter.contour, {"grid": np.ones((2, 2, 2))}),
    "Octree": (octree_method, {"name": "union", "other": OCTREE}),
}

VOXEL_ROWS = [
    *(
        ("voxelize", arguments, words)
        for arguments, words in (
            ({"positions": changed(BOX.positions, (3, 1), np.inf)}, ["positions: vertex 3", "inf"]),
            ({"triangles": BOX.triangles * 0}, ["triangles: all 12 have zero area"]),
            ({"positions": BOX.positions * 0}, ["triangles: all 12 have zero area"]),
            ({"depth": 0}, ["depth: 0", "from 1 to 12"]),
            ({"bounds": ((0, 0, 0), (1, 1, 0))}, ["bounds: ", "along z"]),
            ({"bounds": ((0, 0, 0), (-1, 1, 1))}, ["bounds: ", "along x"]),
            ({"bounds": ((0, 0, 0), (1, 1, NAN))}, ["bounds: ", "nan"]),
            ({"bounds": (0, 1)}, ["bounds: shape (2,)", "(2, 3)"]),
            ({"bounds": "all"}, ["bounds: 'all'", "two corners"]),
            ({"thickness": -1}, ["thickness: -1", "0 or more"]),
            ({"thickness": NAN}, ["thickness: nan"]),
        )
    ),
    *(
        ("Octree", {"name": name, **arguments}, words)
        for name, arguments, words in (
            ("union", {"other": None}, ["other: a NoneType", "an Octree is needed"]),
            ("difference", {"other": BOX}, ["other: a Solid", "an Octree is needed"]),
            ("intersection", {"other": np.zeros((8, 8, 8))}, ["other: a ndarray", "an Octree"]),
        )
    ),
]
QUERY_ROWS = [
    ("dense", {"depth": -1}, ["depth: -1", "from 0 to 12"]),
    ("dense", {"depth": 2.5}, ["depth: 2.5", "from 0 to 12"]),
    ("coarsened", {"depth": 13}, ["depth: 13", "from 0 to 12"]),
    (
        "lost_parts",
        {"positions": BOX.positions, "triangles": BOX.triangles, "part_of": np.zeros(11, int)},
        ["part_of: found 11 for 12 triangles"],
    ),
    (
        "lost_parts",
        {"positions": BOX.positions, "triangles": BOX.triangles + 1, "part_of": np.zeros(12, int)},
        ["triangles: vertices 1 to 8", "there are 8"],
    ),
    ("values", {"points": np.zeros((2, 2))}, ["points: shape (2, 2)", "(points, 3)"]),
    ("values", {"points": np.full((2, 3), NAN)}, ["points: row 0", "nan", "finite"]),
    ("classify", {"points": np.zeros((1, 3)), "tolerance": 0.5}, ["tolerance: 0.5", "below 0.5"]),
    ("classify", {"points": np.zeros((1, 3)), "tolerance": NAN}, ["tolerance: nan", "below 0.5"]),
    ("box_occupancy", {"low": (0, 0, 0), "high": (0, 1, 1)}, ["box: ", "along x"]),
    ("box_occupancy", {"low": (0, 0), "high": (1, 1)}, ["box: shape (2, 2)", "(2, 3)"]),
    ("save", {"path": 3}, ["path: 3"]),
    (
        "contour",
        {"interpolant": "cubic"},
        ["interpolant: 'cubic'", "occupancy, plane, linear, sharp"],
    ),
    ("contour", {"sources": [BOX.positions]}, ["sources: item 0", "(positions, triangles)"]),
    (
        "traced_contour",
        {"sources": [(BOX.positions, BOX.triangles, np.zeros(3, int))]},
        ["sources[0] groups: found 3 for 12 triangles", "one each"],
    ),
    ("traced_contour", {"sources": []}, ["sources: there are none", "at least one"]),
    (
        "quad_contour",
        {"interpolant": "cubic"},
        ["interpolant: 'cubic'", "occupancy, plane, linear, sharp"],
    ),
    ("quad_contour", {"sources": [BOX.positions]}, ["sources: item 0", "(positions, triangles)"]),
    ("contour", {"isovalue": 0}, ["isovalue: 0", "above 0 and up to 1"]),
]
NEAREST_ROWS = [
    ("nearest_points", arguments, words)
    for arguments, words in (
        ({"points": QUAD[:, :2]}, ["points: shape (4, 2)", "(points, 3)"]),
        ({"points": changed(QUAD, (2, 1), NAN)}, ["points: row 2", "nan"]),
    )
]
CORNER_ROWS = [
    ("corner_points", arguments, words)
    for arguments, words in (
        ({"origins": np.arange(11)}, ["origins: found 11 for 12 triangles"]),
        ({"origins": np.arange(1, 13)}, ["origins: item 11 names triangle 12", "there are 12"]),
        ({"origins": np.arange(12) - 1}, ["origins: item 0 names triangle -1"]),
        ({"labels": np.arange(13)}, ["labels: found 13 for 12 source triangles"]),
        ({"source_triangles": BOX.triangles + 1}, ["triangles: triangle ", "vertex 8"]),
        ({"source_positions": BOX.positions[:, :2]}, ["source_positions: shape (8, 2)"]),
    )
]
EMPTY_ROWS = [
    (name, {"triangles": BOX.triangles[:0]}, ["triangles: none", "at least one"])
    for name in (
        "voxelize",
        "nearest_points",
        "measure_mesh",
        "self_intersections",
        "mesh_edges",
        "mesh_topology",
        "close_holes",
        "as_solid",
    )
]
CHART_ROWS = [
    ("uv_charts", {"uvs": [np.zeros((11, 3, 2))]}, ["uvs[0]: shape (11, 3, 2)", "(12, 3, 2)"]),
]
CUBE_ROWS = [
    ("cube_around", {"bounds": (0, 0, 0)}, ["bounds: shape (3,)", "(2, 3)"]),
]
CLOSE_ROWS = [
    ("close_holes", arguments, words)
    for arguments, words in (({"method": "round"}, ["method: 'round'", "smooth, flat, fan"]),)
]
SOLID_ROWS = [
    ("as_solid", arguments, words)
    for arguments, words in (
        ({"cell": 0}, ["cell: 0", "above 0"]),
        ({"cell": NAN}, ["cell: nan", "above 0"]),
        ({"cell": "small"}, ["cell: 'small'"]),
        ({"weld": -0.1}, ["weld: -0.1", "0 or more"]),
        ({"gap": np.inf}, ["gap: inf", "finite"]),
        ({"thickness": -1}, ["thickness: -1", "0 or more"]),
        ({"sheets": "prisms"}, ["sheets: 'prisms'", "shell, faces"]),
    )
]
CONTOUR_ROWS = [
    ("contour", arguments, words)
    for arguments, words in (
        ({"grid": np.zeros(5)}, ["grid: shape (5,)", "(x, y, z) is needed"]),
        ({"grid": np.zeros((2, 2, 2), bool)}, ["grid: dtype bool", NUMBERS]),
        ({"grid": np.zeros((0, 2, 2))}, ["grid: 0 cells along x", "1 to 4096 are needed"]),
        ({"grid": np.full((2, 2, 2), np.nan)}, ["grid: holds nan", "finite"]),
        ({"grid": np.full((2, 2), np.inf)}, ["grid: holds inf", "finite"]),
        ({"interpolant": "cubic"}, ["interpolant: 'cubic'", "occupancy, plane, linear, sharp"]),
        ({"isovalue": np.nan}, ["isovalue: nan", "a finite number"]),
        ({"isovalue": "half"}, ["isovalue: 'half'", "a number is needed"]),
        ({"spacing": 0}, ["spacing: 0", "above 0"]),
        ({"spacing": (1, -1, 1)}, ["spacing: (1, -1, 1)", "above 0"]),
        ({"spacing": (1, 1)}, ["spacing: shape (2,)", "one number, or (3,)"]),
        ({"origin": np.inf}, ["origin: inf", "finite"]),
    )
]
ROWS = (
    VOXEL_ROWS
    + NEAREST_ROWS
    + CORNER_ROWS
    + EMPTY_ROWS
    + CHART_ROWS
    + CUBE_ROWS
    + CLOSE_ROWS
    + SOLID_ROWS
    + CONTOUR_ROWS
)


@pytest.mark.parametrize(("function", "arguments", "words"), ROWS)
def test_refusal(function, arguments, words):
    check_refusal(FUNCTIONS[function], arguments, words)


@pytest.mark.parametrize(("name", "arguments", "words"), QUERY_ROWS)
def test_refusal_of_a_query(name, arguments, words):
    check_refusal((octree_method, {"name": name}), arguments, words)


def test_a_grid_that_would_not_fit_is_refused_before_it_is_made():
    deep = prefilter.voxelize(BOX.positions, BOX.triangles, depth=3)
    with pytest.raises(MemoryError, match="depth"):
        deep.dense(12)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_the_other_arguments_of_the_rows_are_good(function):
    call, good = FUNCTIONS[function]
    call(**good)


def test_every_function_has_rows():
    assert {row[0] for row in ROWS} == set(FUNCTIONS)
