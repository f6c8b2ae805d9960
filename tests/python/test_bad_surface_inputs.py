# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input of surfaces with UVs and of points, as in test_bad_inputs.py."""

import numpy as np
import prefilter
import pytest
from clouds import sphere
from refusals import NAN, NUMBERS, changed, check_refusal
from scenes import square

MESH = square()
SURFACE = MESH.surface
POINTS, TRIANGLES, UVS = MESH.positions, MESH.triangles, MESH.uvs
QUAD = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
CLOUD = sphere(1000)
ONES = np.ones(1000)


def placed(matrices):
    return SURFACE.placed(matrices)


def udim_tile(number):
    return SURFACE.udim_tile(number)


FUNCTIONS = {
    "Surface": (
        prefilter.Surface,
        {"positions": POINTS, "triangles": TRIANGLES, "uvs": UVS},
    ),
    "from_subdivision": (
        prefilter.Surface.from_subdivision,
        {
            "positions": QUAD,
            "face_sizes": np.array([4]),
            "face_vertices": np.arange(4),
            "face_uvs": QUAD[:, :2].copy(),
        },
    ),
    "placed": (placed, {}),
    "udim_tile": (udim_tile, {}),
    "merged": (prefilter.Surface.merged, {}),
    "reconstruct": (
        prefilter.reconstruct,
        {"points": CLOUD.points, "normals": CLOUD.normals, "depth": 3},
    ),
}

NEEDS_POINTS = "at least 3 are needed"

ROWS = [
    (
        "Surface",
        {"triangles": TRIANGLES[:0], "uvs": UVS[:0]},
        ["triangles: none", "at least one is needed"],
    ),
    (
        "Surface",
        {"uvs": POINTS[:, :2], "triangles": TRIANGLES + 1},
        ["triangles: ", "vertex 6", "6 vertices (0 to 5)"],
    ),
    (
        "Surface",
        {"positions": changed(POINTS, (2, 0), np.inf)},
        ["positions: vertex 2", "inf", "finite"],
    ),
    (
        "Surface",
        {"weights": np.ones(3)},
        ["weights: shape (3,) of float64", "(6,) for vertices, (2,) or (2, 1) for triangles"],
    ),
    (
        "Surface",
        {"weights": changed(np.ones(6), 1, -0.5)},
        ["weights: vertex 1 has -0.5", "finite weights of 0 and up are needed"],
    ),
    (
        "Surface",
        {"weights": np.array([[1.0, 1, 1], [1, 1, np.inf]])},
        ["weights: triangle 1 has inf", "0 and up"],
    ),
    (
        "Surface",
        {"weights": np.array([1e308, 1.0]), "positions": POINTS * 10},
        ["weights: the area of triangle 0", "too large"],
    ),
    (
        "from_subdivision",
        {"face_sizes": np.array([2, 2])},
        ["face_sizes: face 0 has 2 corners", "3 to 65535 are allowed"],
    ),
    (
        "from_subdivision",
        {"face_sizes": np.array([5])},
        ["face_sizes: add up to 5", "face_vertices has 4", "both must be equal"],
    ),
    (
        "from_subdivision",
        {"face_vertices": np.array([0, 1, 2, 9])},
        ["face_vertices: face 0 names vertex 9", "(0 to 3)"],
    ),
    (
        "from_subdivision",
        {"face_vertices": np.array([0, 1, 2, 0])},
        ["face_vertices: face 0 names vertex 0 twice", "needs different vertices"],
    ),
    (
        "from_subdivision",
        {"creases": 5},
        ["creases: int", "a pair (vertices, sharpness) is needed"],
    ),
    (
        "from_subdivision",
        {"creases": ([[0, 2]], [1.0])},
        ["creases: crease 0 is between vertices 0 and 2", "an edge of a face is needed"],
    ),
    (
        "from_subdivision",
        {"creases": ([[0, 1]], [1.0, 2.0])},
        ["creases: sharpness: shape (2,)", "(1,) is needed"],
    ),
    (
        "from_subdivision",
        {"corners": ([0], [-1.0])},
        ["corners: corner 0 has sharpness -1", "0 and up is needed"],
    ),
    (
        "from_subdivision",
        {"scheme": "doo-sabin"},
        ["scheme: 'doo-sabin'", "one of catmull-clark, loop, bilinear"],
    ),
    (
        "from_subdivision",
        {"faces": np.array([0], np.int64)},
        ["faces: shape (1,) of int64", "(1,) of bool is needed"],
    ),
    (
        "reconstruct",
        {"points": CLOUD.points[:0], "normals": None},
        ["points: none", "at least one"],
    ),
    (
        "reconstruct",
        {"points": CLOUD.points * 0 + 3},
        ["points: all coincide", "an extent is needed"],
    ),
    *(
        (
            "reconstruct",
            {"weights": changed(ONES, 7, weight)},
            ["weights: point 7 has ", "numbers from 0 to 1e+30 are needed"],
        )
        for weight in (-0.5, NAN, np.inf, 1e31)
    ),
    *(
        (
            "reconstruct",
            {"attributes": changed(CLOUD.points, (7, 2), value)},
            ["attributes: point 7 has ", "numbers from -1e+30 to 1e+30 are needed"],
        )
        for value in (NAN, -np.inf, 1e31)
    ),
    (
        "placed",
        {"matrices": np.full((2, 4, 4), 1.0)},
        ["matrices: the last row of matrix 0 is [1.0, 1.0, 1.0, 1.0]", "0, 0, 0, 1 is needed"],
    ),
    (
        "placed",
        {"matrices": np.full((2, 3, 4), NAN)},
        ["matrices: matrix 0: row 0 holds nan", "finite"],
    ),
    (
        "placed",
        {"matrices": np.eye(4) * [1e200, 1e200, 1, 1]},
        ["matrices: the area of triangle 0", "too large"],
    ),
    ("Surface", {"uvs": POINTS}, ["uvs: shape (6, 3)", "(6, 2) for the vertices"]),
    ("Surface", {"uvs": POINTS[:, :2] * NAN}, ["uvs: triangle 0", "nan", "finite"]),
    ("Surface", {"uvs": changed(UVS, (1, 2, 0), NAN)}, ["uvs: triangle 1", "nan", "finite"]),
    ("Surface", {"positions": POINTS * 1e200}, ["positions: the area of triangle 0", "too large"]),
    ("Surface", {"weights": np.ones(6, bool)}, ["weights: shape (6,) of bool", "real numbers"]),
    ("Surface", {"weights": "heavy"}, ["weights: shape () of", "real numbers"]),
    ("Surface", {"weights": np.array([1.0, NAN])}, ["weights: triangle 1 has nan", "0 and up"]),
    ("from_subdivision", {"face_uvs": QUAD}, ["face_uvs: shape (4, 3)", "(corners, 2) is needed"]),
    ("from_subdivision", {"level": 11}, ["level: 11", "1 to 10 are allowed"]),
    ("from_subdivision", {"level": 10**30}, ["level: 1" + 30 * "0", "from 1 to 10 is needed"]),
    *(
        ("reconstruct", {"points": CLOUD.points[:n], "normals": CLOUD.normals[:n]}, words)
        for n, words in (
            (0, ["points: none", NEEDS_POINTS]),
            (1, ["points: 1;", NEEDS_POINTS]),
            (2, ["points: 2;", NEEDS_POINTS]),
        )
    ),
    *(
        ("reconstruct", arguments, ["points: 0 of 1000 count", NEEDS_POINTS])
        for arguments in (
            {"points": CLOUD.points * NAN},
            {"points": CLOUD.points * 1e301},
            {"weights": ONES * 0},
        )
    ),
    ("reconstruct", {"points": CLOUD.points[:, :2]}, ["points: shape (1000, 2)", "(points, 3)"]),
    ("reconstruct", {"normals": "up"}, ["normals: dtype <U2", NUMBERS]),
    ("reconstruct", {"normals": CLOUD.normals[:9]}, ["normals: 9 rows", "1000 are needed"]),
    *(
        ("reconstruct", {"depth": depth}, [f"depth: {depth!r}; ", "from 1 to 12 is needed"])
        for depth in (0, 2.5)
    ),
    ("reconstruct", {"wavelet": "d6"}, ["wavelet: 'd6' is not one of haar, d4"]),
    ("reconstruct", {"isovalue": "mode"}, ["isovalue: 'mode'", "auto, mean, half, or a number"]),
    ("reconstruct", {"isovalue": None}, ["isovalue: None", "a number is needed"]),
    *(
        ("reconstruct", {"isovalue": isovalue}, ["isovalue: ", "finite number of at most 1e30"])
        for isovalue in (NAN, np.inf, -np.inf, 1e300)
    ),
    *(
        ("reconstruct", {"trim": trim}, [f"trim: {trim:g}; ", "above 0 and up to 1e6"])
        for trim in (0, -1.0, NAN, np.inf, 1e300)
    ),
    ("reconstruct", {"trim": True}, ["trim: True", "a number is needed"]),
    ("reconstruct", {"weights": ONES[:9]}, ["weights: shape (9,)", "(1000,) is needed"]),
    ("reconstruct", {"weights": ONES > 0}, ["weights: dtype bool", NUMBERS]),
    ("reconstruct", {"attributes": ONES}, ["attributes: shape (1000,)", "(1000, n) is needed"]),
    *(
        ("reconstruct", {"memory_limit": limit}, [f"memory_limit: {limit!r}", "MiB from 0"])
        for limit in (-1, 2.5, True, "1 GB")
    ),
    ("reconstruct", {"report": {}}, ["report: {}", "a ReconstructionReport is needed, or None"]),
    ("placed", {"matrices": np.eye(3)}, ["matrices: shape (3, 3)", "(4, 4), (3, 4) or several"]),
    ("placed", {"matrices": np.empty((0, 4, 4))}, ["matrices: none", "at least one is needed"]),
    ("placed", {"matrices": [["a"]]}, ["matrices: found no array of numbers", "'a'"]),
    *(
        ("udim_tile", {"number": number}, [f"number: {number!r}; ", "from 1001 to 9999"])
        for number in (1000, 10000, 10**30, "1001", True)
    ),
    ("merged", {"surfaces": 5}, ["surfaces: a int", "a list of Surface is needed"]),
    ("merged", {"surfaces": [SURFACE, 3]}, ["surfaces: holds a int", "a Surface is needed"]),
]


@pytest.mark.parametrize(("function", "arguments", "words"), ROWS)
def test_refusal(function, arguments, words):
    check_refusal(FUNCTIONS[function], arguments, words)


@pytest.mark.parametrize("function", [name for name, (_, good) in FUNCTIONS.items() if good])
def test_the_other_arguments_of_the_rows_are_good(function):
    call, good = FUNCTIONS[function]
    call(**good)


def test_every_function_has_rows():
    assert {row[0] for row in ROWS} == set(FUNCTIONS)
