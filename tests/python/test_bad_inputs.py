# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input gets a message that names the argument, what was found and what is allowed.

A row is a function, the arguments that differ from good ones, and what its message must hold: the
argument's name first. The error is a ValueError, or an OSError where the disk is what is wrong.
"""

import numpy as np
import prefilter
import pytest
from clouds import sphere
from refusals import AXES, NAN, NUMBERS, TEXELS, THREADS, WRAPS, changed, check_refusal
from scenes import random_image, soup, square
from test_bad_sampling_inputs import FUNCTIONS as SAMPLING_FUNCTIONS
from test_bad_voxel_inputs import FUNCTIONS as VOXEL_FUNCTIONS

IMAGE = random_image(0, 16, 16, 3)
RGBA = random_image(1, 8, 8, 4)
BYTES = np.zeros((4, 4, 3), np.uint8)
MESH = square()
SURFACE = MESH.surface
FLAT = soup(np.zeros((1, 3, 2)), np.zeros(1)).surface
AWAY = square((2, 2), (3, 3)).surface
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
    "mipmaps": (prefilter.mipmaps, {"image": IMAGE, "surface": SURFACE}),
    "coarser_levels": (prefilter.coarser_levels, {"image": IMAGE, "surface": SURFACE}),
    "mipmap_error": (
        prefilter.mipmap_error,
        {"levels": [IMAGE], "image": IMAGE, "surface": SURFACE, "mip_values": [0.0]},
    ),
    "seam_contrast": (prefilter.seam_contrast, {"levels": [IMAGE], "surface": SURFACE}),
    "normal_mipmaps": (
        prefilter.normal_mipmaps,
        {"normals": np.full((8, 8, 3), 0.5), "surface": SURFACE},
    ),
    "keep_coverage": (prefilter.keep_coverage, {"levels": [RGBA], "surface": SURFACE}),
    "texel_weights": (prefilter.texel_weights, {"surface": SURFACE, "width": 4, "height": 4}),
    "fill_unused": (prefilter.fill_unused, {"image": IMAGE, "surface": SURFACE}),
    "fill_transparent": (prefilter.fill_transparent, {"image": RGBA}),
    "write_exr": (prefilter.write_exr, {"path": "out.exr", "levels": [IMAGE[:1, :1]]}),
    "write_dds": (prefilter.write_dds, {"path": "out.dds", "levels": [RGBA]}),
    "write_ktx2": (prefilter.write_ktx2, {"path": "out.ktx2", "levels": [RGBA]}),
    "reconstruct": (
        prefilter.reconstruct,
        {"points": CLOUD.points, "normals": CLOUD.normals, "depth": 3},
    ),
    "resize": (prefilter.resize, {"image": IMAGE, "width": 5, "height": 7}),
    "to_linear": (prefilter.to_linear, {"image": IMAGE}),
    "to_srgb": (prefilter.to_srgb, {"image": IMAGE}),
}

NEEDS_POINTS = "at least 3 are needed"

ROWS = [
    (
        "Surface",
        {"triangles": TRIANGLES[:0], "uvs": UVS[:0]},
        ["triangles: none", "at least one is needed"],
    ),
    ("Surface", {"positions": POINTS[:, :2]}, ["positions: shape (6, 2)", "(vertices, 3) is"]),
    ("Surface", {"positions": "abc"}, ["positions: dtype <U3", NUMBERS]),
    ("Surface", {"triangles": TRIANGLES[:, :2]}, ["triangles: shape (2, 2)", "(triangles, 3) is"]),
    ("Surface", {"triangles": TRIANGLES * 1.0}, ["triangles: dtype float64", "integers are"]),
    ("Surface", {"triangles": TRIANGLES + 1}, ["triangles: ", "vertex 6", "6 vertices (0 to 5)"]),
    ("Surface", {"triangles": TRIANGLES - 1}, ["triangles: triangle 0 names vertex -1", "(0 to"]),
    ("Surface", {"uvs": UVS[:1]}, ["uvs: shape (1, 3, 2)", "(2, 3, 2) for", "(6, 2) for"]),
    ("Surface", {"uvs": POINTS[:5, :2]}, ["uvs: shape (5, 2)", "(6, 2) for the vertices"]),
    ("Surface", {"uvs": POINTS}, ["uvs: shape (6, 3)", "(6, 2) for the vertices"]),
    (
        "Surface",
        {"uvs": POINTS[:, :2], "triangles": TRIANGLES + 1},
        ["triangles: ", "vertex 6", "6 vertices (0 to 5)"],
    ),
    (
        "Surface",
        {"uvs": POINTS[:, :2], "triangles": TRIANGLES - 1},
        ["triangles: triangle 0 names vertex -1", "(0 to"],
    ),
    ("Surface", {"uvs": POINTS[:, :2] * NAN}, ["uvs: triangle 0", "nan", "finite"]),
    ("Surface", {"uvs": POINTS[:, :2] + 1j}, ["uvs: dtype complex128", NUMBERS]),
    ("Surface", {"positions": []}, ["positions: shape (0,)", "(vertices, 3) is needed"]),
    ("Surface", {"positions": POINTS > 0}, ["positions: dtype bool", NUMBERS]),
    ("Surface", {"triangles": []}, ["triangles: shape (0,)", "(triangles, 3) is needed"]),
    ("Surface", {"triangles": [[0, 1, 2.5]]}, ["triangles: dtype float64", "integers are"]),
    (
        "Surface",
        {"triangles": TRIANGLES.astype(np.uint64) + 2**63},
        ["triangles: found 9223372036854775813", "63 bits"],
    ),
    ("Surface", {"triangles": TRIANGLES > 0}, ["triangles: dtype bool", "integers are"]),
    ("Surface", {"uvs": None}, ["uvs: dtype object", NUMBERS]),
    (
        "Surface",
        {"positions": changed(POINTS, (4, 1), NAN)},
        ["positions: vertex 4", "nan", "finite"],
    ),
    (
        "Surface",
        {"positions": changed(POINTS, (2, 0), np.inf)},
        ["positions: vertex 2", "inf", "finite"],
    ),
    ("Surface", {"uvs": changed(UVS, (1, 2, 0), NAN)}, ["uvs: triangle 1", "nan", "finite"]),
    ("Surface", {"positions": POINTS * 1e200}, ["positions: the area of triangle 0", "too large"]),
    (
        "Surface",
        {"weights": np.ones(3)},
        ["weights: shape (3,) of float64", "(6,) for vertices, (2,) or (2, 1) for triangles"],
    ),
    ("Surface", {"weights": np.ones(6, bool)}, ["weights: shape (6,) of bool", "real numbers"]),
    ("Surface", {"weights": "heavy"}, ["weights: shape () of", "real numbers"]),
    (
        "Surface",
        {"weights": changed(np.ones(6), 1, -0.5)},
        ["weights: vertex 1 has -0.5", "finite weights of 0 and up are needed"],
    ),
    ("Surface", {"weights": np.array([1.0, NAN])}, ["weights: triangle 1 has nan", "0 and up"]),
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
    ("from_subdivision", {"face_uvs": QUAD}, ["face_uvs: shape (4, 3)", "(corners, 2) is needed"]),
    ("from_subdivision", {"level": 11}, ["level: 11", "1 to 10 are allowed"]),
    ("from_subdivision", {"level": 10**30}, ["level: 1" + 30 * "0", "from 1 to 10 is needed"]),
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
    *(
        ("reconstruct", {"points": CLOUD.points[:n], "normals": CLOUD.normals[:n]}, words)
        for n, words in (
            (0, ["points: 0, of which 0", NEEDS_POINTS]),
            (1, ["points: 1, of which 0", NEEDS_POINTS]),
            (2, ["points: 2, of which 0", NEEDS_POINTS]),
        )
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
        ("reconstruct", arguments, ["points: 1000, of which 1000 are not finite", NEEDS_POINTS])
        for arguments in (
            {"points": CLOUD.points * NAN},
            {"points": CLOUD.points * 1e301},
            {"normals": CLOUD.normals * 0},
            {"normals": CLOUD.normals * np.inf},
            {"weights": ONES * 0},
        )
    ),
    ("reconstruct", {"points": [[1.0], [1.0, 2.0]]}, ["points: found no array", "inhomogeneous"]),
    ("reconstruct", {"points": CLOUD.points[:, :2]}, ["points: shape (1000, 2)", "(points, 3)"]),
    ("reconstruct", {"points": np.ones((9, 3), bool)}, ["points: dtype bool", NUMBERS]),
    ("reconstruct", {"points": None}, ["points: dtype object", NUMBERS]),
    ("reconstruct", {"normals": "up"}, ["normals: dtype <U2", NUMBERS]),
    ("reconstruct", {"normals": CLOUD.normals[:9]}, ["normals: 9 rows", "1000 are needed"]),
    *(
        ("reconstruct", {"depth": depth}, [f"depth: {depth!r}; ", "from 1 to 12 is needed"])
        for depth in (0, -1, 13, True, 2.5, "9", None, 10**30)
    ),
    ("reconstruct", {"wavelet": "d6"}, ["wavelet: 'd6' is not one of haar, d4"]),
    ("reconstruct", {"wavelet": None}, ["wavelet: None", "a name is needed"]),
    ("reconstruct", {"isovalue": "mode"}, ["isovalue: 'mode'", "auto, mean, half, or a number"]),
    *(
        ("reconstruct", {"isovalue": isovalue}, [f"isovalue: {isovalue!r}", "a number is needed"])
        for isovalue in (True, None, [0.5])
    ),
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
    *(
        (
            "reconstruct",
            {"weights": changed(ONES, 7, weight)},
            ["weights: point 7 has ", "numbers from 0 to 1e+30 are needed"],
        )
        for weight in (-0.5, NAN, np.inf, 1e31)
    ),
    ("reconstruct", {"attributes": ONES}, ["attributes: shape (1000,)", "(1000, n) is needed"]),
    *(
        (
            "reconstruct",
            {"attributes": changed(CLOUD.points, (7, 2), value)},
            ["attributes: point 7 has ", "numbers from -1e+30 to 1e+30 are needed"],
        )
        for value in (NAN, -np.inf, 1e31)
    ),
    *(
        ("reconstruct", {"memory_limit": limit}, [f"memory_limit: {limit!r}", "MiB from 0"])
        for limit in (-1, 2.5, True, "1 GB")
    ),
    *(
        ("reconstruct", {"threads": threads}, [f"threads: {threads!r}", THREADS])
        for threads in (-1, 1.5, True)
    ),
    ("reconstruct", {"progress": 5}, ["progress: 5", "a callable of one number is needed"]),
    ("reconstruct", {"report": {}}, ["report: {}", "a ReconstructionReport is needed, or None"]),
    ("placed", {"matrices": np.eye(3)}, ["matrices: shape (3, 3)", "(4, 4), (3, 4) or several"]),
    ("placed", {"matrices": np.empty((0, 4, 4))}, ["matrices: none", "at least one is needed"]),
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
    ("placed", {"matrices": [["a"]]}, ["matrices: found no array of numbers", "'a'"]),
    *(
        ("udim_tile", {"number": number}, [f"number: {number!r}; ", "from 1001 to 9999"])
        for number in (1000, 10000, 10**30, "1001", True)
    ),
    ("merged", {"surfaces": 5}, ["surfaces: a int", "a list of Surface is needed"]),
    ("merged", {"surfaces": [SURFACE, 3]}, ["surfaces: holds a int", "a Surface is needed"]),
    *(
        ("mipmaps", {"image": image}, words)
        for image, words in (
            (np.zeros((16, 16, 5), np.float32), ["image: 5 channels", "1 to 4 are allowed"]),
            (IMAGE[0, 0], ["image: shape (3,)", AXES]),
            (IMAGE[None], ["image: shape (1, 16, 16, 3)", AXES]),
            (IMAGE[:0], ["image: shape (0, 16, 3) holds no pixels", "at least one is needed"]),
            ([[1.0], [1.0, 2.0]], ["image: found no array", "inhomogeneous"]),
            (np.zeros((16, 16, 3), np.int16), ["image: dtype int16", TEXELS]),
            (IMAGE.astype(np.complex64), ["image: dtype complex64", TEXELS]),
            (None, ["image: dtype object", TEXELS]),
            ("image.png", ["image: dtype <U9", TEXELS]),
            ([], ["image: shape (0,)", AXES]),
            ([[]], ["image: shape (1, 0) holds no pixels", "at least one is needed"]),
            (
                [[0, 1], [255, 1]],
                ["image: a list of whole numbers, among them 255", "only 0 and 1 are allowed"],
            ),
            ([[0, -1]], ["image: a list of whole numbers, among them -1", "arrays of uint8"]),
            ([[2**70]], ["image: dtype object", TEXELS]),
            (
                np.full((16, 16, 3), 1e300),
                ["image: the texel in row 0, column 0 holds inf", "at most 1e30"],
            ),
        )
    ),
    *(
        (
            "mipmaps",
            {"filter": filter, "image": changed(IMAGE, (3, 5, 1), NAN)},
            ["image: the texel in row 3, column 5 holds nan in channel 1", "finite"],
        )
        for filter in ("box", "lanczos3-covered", "pam-box", "pam-bilinear", "pam-trilinear")
    ),
    ("mipmaps", {"image": BYTES[0, 0]}, ["image: shape (3,)", "(height, width, channels)"]),
    ("mipmaps", {"image": BYTES[:0]}, ["image: shape (0, 4, 3) holds no pixels", "at least one"]),
    (
        "mipmaps",
        {"image": np.zeros((4, 4, 5), np.uint8)},
        ["image: 5 channels", "1 to 4 are allowed"],
    ),
    ("mipmaps", {"encoding": "gamma"}, ["encoding: 'gamma'", "one of linear, srgb"]),
    (
        "mipmaps",
        {"encoding": "srgb"},
        ["encoding: 'srgb' requires images of uint8 or uint16", "decode others with to_linear"],
    ),
    (
        "mipmaps",
        {"filter": "pam"},
        ["filter: 'pam' is not one of " + ", ".join(f.name for f in prefilter.MIPMAP_FILTERS)],
    ),
    ("mipmaps", {"filter": 3}, ["filter: 3", "a name is needed"]),
    ("mipmaps", {"filter": "\ud800"}, ["filter: '?' is not one of"]),
    ("mipmaps", {"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
    *(
        ("mipmaps", {"wrap": wrap}, [f"wrap: {wrap!r}", "a pair of names for u and v, is needed"])
        for wrap in (("clamp", "clamp", "clamp"), ("clamp", 3), None, 5)
    ),
    (
        "mipmaps",
        {"bounds": (1.0, 0.0)},
        ["bounds: the low bound is 1 ", "high bound is 0; ", "low must not be above high"],
    ),
    ("mipmaps", {"bounds": (NAN, None)}, ["bounds: the low bound is nan", "high bound is open"]),
    ("mipmaps", {"bounds": (1e39, None)}, ["bounds: the low bound is inf", "high bound is open"]),
    (
        "mipmaps",
        {"bounds": (None, -np.inf)},
        ["bounds: the low bound is open and the high bound is -inf"],
    ),
    *(
        ("mipmaps", {"bounds": bounds}, ["bounds: ", "pair (low, high) of numbers"])
        for bounds in ((0.0,), 5, ("a", "b"), (1j, None))
    ),
    *(
        ("mipmaps", {"levels": levels}, [f"levels: {levels}", "a whole number of at least 1"])
        for levels in (0, -2, 2.5)
    ),
    ("mipmaps", {"levels": 6}, ["levels: 6 asked for", "16 x 16 texels has 1 to 5"]),
    ("mipmaps", {"levels": 10**30}, ["levels: ", "16 x 16 texels has 1 to 5"]),
    *(
        ("mipmaps", {"seam_budget": budget}, [f"seam_budget: {budget}", "of at least 0 is needed"])
        for budget in (-1, NAN, np.inf)
    ),
    *(
        ("mipmaps", {"seam_budget": budget}, [f"seam_budget: {budget!r}", "a number is needed"])
        for budget in ("1", True, None)
    ),
    ("mipmaps", {"reader": "gamma"}, ["reader: 'gamma'", "one of linear, srgb-after"]),
    (
        "mipmaps",
        {"reader": "srgb-after", "filter": "pam-trilinear"},
        ["reader: 'srgb-after' requires pam-bilinear", "use linear for pam-trilinear"],
    ),
    *(
        ("mipmaps", {"threads": threads}, [f"threads: {threads!r}", THREADS])
        for threads in (-1, 1.5, "a")
    ),
    ("mipmaps", {"progress": 5}, ["progress: 5", "a callable of one number is needed, or None"]),
    ("mipmaps", {"surface": 5}, ["surface: a int", "a Surface or a list is needed"]),
    *(
        (
            "mipmaps",
            {"surface": none},
            ["surface: none was given, and pam-bilinear needs one", "use one of box, tent, "],
        )
        for none in (None, [])
    ),
    ("mipmaps", {"surface": [3]}, ["surface: holds a int", "a Surface is needed"]),
    ("mipmaps", {"surface": FLAT}, ["surface: ", "area of 0 in all", "positive, finite one"]),
    (
        "mipmaps",
        {"surface": AWAY, "wrap": "border"},
        ["surface: none of it lies inside the image"],
    ),
    (
        "mipmaps",
        {"surface": square((2, 2), (1e12, 3)).surface},
        ["uvs: triangle 0 spans", "any other up to 2^30"],
    ),
    ("mipmap_error", {"levels": None}, ["levels: a NoneType", "a list of arrays is needed"]),
    ("mipmap_error", {"levels": []}, ["levels: 0 were given", "16 x 16 texels has 1 to 5"]),
    ("mipmap_error", {"levels": [IMAGE] * 6}, ["levels: 6 were given", "has 1 to 5"]),
    (
        "mipmap_error",
        {"levels": [IMAGE, IMAGE]},
        ["levels: level 1 has 16 x 16 texels of 3 channels", "8 x 8 of 3 are expected"],
    ),
    (
        "mipmap_error",
        {"levels": [IMAGE[..., :1]]},
        ["levels: level 0 has 16 x 16 texels of 1 channels", "16 x 16 of 3 are expected"],
    ),
    (
        "mipmap_error",
        {"levels": [np.full_like(IMAGE, NAN)]},
        ["levels: level 0: the texel in row 0", "holds nan", "finite"],
    ),
    (
        "mipmap_error",
        {"image": np.full_like(IMAGE, NAN)},
        ["image: the texel in row 0, column 0 holds nan", "finite"],
    ),
    ("mipmap_error", {"mip_values": [0.5, NAN]}, ["mip_values: holds nan", "numbers are needed"]),
    ("mipmap_error", {"mip_values": "a"}, ["mip_values: numbers are needed", "'a'"]),
    ("mipmap_error", {"mip_values": [1j]}, ["mip_values: numbers are needed", "complex"]),
    ("mipmap_error", {"surface": None}, ["surface: none was given", "at least one is needed"]),
    ("mipmap_error", {"wrap": "tile"}, ["wrap: 'tile'", WRAPS]),
    ("mipmap_error", {"reader": "gpu"}, ["reader: 'gpu'", "one of linear, srgb-after"]),
    ("seam_contrast", {"levels": 5}, ["levels: a int", "a list of arrays is needed"]),
    ("seam_contrast", {"levels": []}, ["levels: none were given", "at least one is needed"]),
    (
        "seam_contrast",
        {"levels": [IMAGE, IMAGE[:8, :8, :1]]},
        ["levels: level 1 has 1 channels and level 0 3", "must have the same"],
    ),
    ("seam_contrast", {"surface": None}, ["surface: none was given", "at least one is needed"]),
    (
        "normal_mipmaps",
        {"normals": IMAGE[..., :2]},
        ["normals: shape (16, 16, 2)", "(height, width, 3) is needed"],
    ),
    (
        "normal_mipmaps",
        {"normals": np.full((8, 8, 3), NAN)},
        ["normals: the texel in row 0, column 0 holds nan", "finite"],
    ),
    ("normal_mipmaps", {"roughness": 2}, ["roughness: 2", "a number in [0, 1] or an image"]),
    (
        "normal_mipmaps",
        {"roughness": np.zeros((4, 4, 1))},
        ["roughness: shape (4, 4, 1)", "(8, 8, 1) is needed"],
    ),
    ("normal_mipmaps", {"levels": 9}, ["levels: 9 asked for", "8 x 8 texels has 1 to 4"]),
    *(
        (
            "keep_coverage",
            {"threshold": threshold},
            [f"threshold: {threshold!r}", "a number above 0 and at most 1 is needed"],
        )
        for threshold in (0, 1.5, NAN)
    ),
    ("keep_coverage", {"threshold": "a"}, ["threshold: 'a'", "a number is needed"]),
    ("keep_coverage", {"levels": []}, ["levels: none were given", "at least level 0 is needed"]),
    (
        "keep_coverage",
        {"levels": [IMAGE]},
        ["levels: level 0 has 3 channels", "all need 4, the last of them alpha, or all 1"],
    ),
    (
        "keep_coverage",
        {"levels": [RGBA, RGBA[:4, :4] * NAN]},
        ["levels: level 1 holds alpha that is not finite"],
    ),
    *(
        ("texel_weights", {name: size}, [f"{name}: {size!r}", "a whole number from 1 to 1048576"])
        for name, size in (("width", 0), ("height", -2), ("width", 2.5), ("height", 10**9))
    ),
    ("texel_weights", {"surface": FLAT}, ["surface: ", "area of 0 in all", "positive, finite"]),
    (
        "texel_weights",
        {"surface": [], "wrap": "clamp"},
        ["surface: none was given", "at least one"],
    ),
    (
        "texel_weights",
        {"surface": AWAY, "wrap": "border"},
        ["surface: none of it lies inside the image"],
    ),
    (
        "fill_unused",
        {"image": np.zeros((4, 4, 5), np.float32)},
        ["image: 5 channels", "1 to 4 are allowed"],
    ),
    (
        "fill_transparent",
        {"image": np.zeros((4, 4, 1), np.float32)},
        ["image: 1 channels", "2 to 4 are allowed", "alpha"],
    ),
    ("fill_transparent", {"image": BYTES.astype(np.int64)}, ["image: dtype int64", TEXELS]),
    ("fill_transparent", {"wrap": "mirror"}, ["wrap: ", "mirror"]),
    ("fill_unused", {"image": BYTES.astype(np.int64)}, ["image: dtype int64", TEXELS]),
    ("fill_unused", {"surface": None}, ["surface: none was given", "at least one is needed"]),
    (
        "fill_unused",
        {"surface": AWAY, "wrap": "border"},
        ["surface: none of it lies inside the image"],
    ),
    *(
        ("resize", arguments, words)
        for arguments, words in (
            ({"image": BYTES.astype(np.int8)}, ["image: dtype int8", TEXELS]),
            ({"image": IMAGE[0, 0]}, ["image: shape (3,)", AXES]),
            ({"image": np.zeros((0, 4, 3))}, ["image: shape (0, 4, 3)", "at least one"]),
            ({"image": np.zeros((4, 4, 5))}, ["image: 5 channels", "1 to 4 are allowed"]),
            ({"image": changed(IMAGE, (2, 3, 1), NAN)}, ["image: the texel in row 2, column 3"]),
            ({"image": changed(RGBA, (2, 3, 3), np.inf)}, ["image: ", "inf in channel 3"]),
            ({"image": IMAGE * 1e31}, ["image: the texel", "at most 1e30"]),
            ({"width": 0}, ["width: 0", "from 1 to 1048576"]),
            ({"height": -3}, ["height: -3", "from 1 to 1048576"]),
            ({"height": 2**20 + 1}, ["height: 1048577", "from 1 to 1048576"]),
            ({"width": 2.0}, ["width: 2.0", "a whole number"]),
            ({"width": True}, ["width: True", "a whole number"]),
            ({"height": NAN}, ["height: nan", "a whole number"]),
            ({"height": 10**30}, ["height: 1000", "a whole number"]),
            ({"filter": "cubic"}, ["filter: 'cubic' is not one of box, tent", "least-squares"]),
            ({"filter": None}, ["filter: None", "a name is needed"]),
            ({"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
            ({"wrap": ("clamp",)}, ["wrap: ('clamp',)", "a pair"]),
            ({"progress": 1}, ["progress: 1", "a callable"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        ("to_linear", arguments, words)
        for arguments, words in (
            ({"image": BYTES.astype(np.int8)}, ["image: dtype int8", TEXELS]),
            ({"image": IMAGE[0, 0]}, ["image: shape (3,)", AXES]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    ("to_srgb", {"image": BYTES.astype(np.int64)}, ["image: dtype int64", TEXELS]),
    *(
        ("coarser_levels", arguments, words)
        for arguments, words in (
            ({"image": IMAGE[0, 0]}, ["image: ", AXES]),
            ({"encoding": "srgb"}, ["encoding: 'srgb'", "uint8 or uint16"]),
            ({"levels": 99}, ["levels: 99 asked for"]),
            ({"filter": "cubic"}, ["filter: 'cubic'"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        ("write_exr", arguments, words)
        for arguments, words in (
            ({"path": 3}, ["path: 3", "the path of a file is needed"]),
            ({"levels": []}, ["levels: an empty list", "level 0 first, is needed"]),
            ({"levels": IMAGE}, ["levels: a ndarray", "a list of images"]),
            (
                {"levels": [RGBA]},
                ["levels: the last of 1 has 8 x 8 texels", "down to 1 x 1 are needed"],
            ),
            (
                {"levels": [RGBA, RGBA]},
                ["levels: level 1 has 8 x 8 texels", "rounded down, is 4 x 4"],
            ),
            (
                {"levels": [RGBA[:1, :1], RGBA[:1, :1]]},
                ["levels: level 1 is one too many", "1 x 1 texel"],
            ),
            (
                {"levels": [np.zeros((1, 1, 5), np.float32)]},
                ["levels: level 0 has 5 channels", "1 to 4 are allowed"],
            ),
            ({"format": "uint8"}, ["format: 'uint8'", "one of half, float"]),
            ({"encoding": "gamma"}, ["encoding: 'gamma'", "one of linear, srgb"]),
            ({"alpha": "none"}, ["alpha: 'none'", "one of straight, premultiplied"]),
            ({"attributes": "wrap"}, ["attributes: a str", "in a dict"]),
            ({"attributes": {"wrap": 3}}, ["attributes: found 'wrap': 3", "a text are needed"]),
            ({"attributes": {"": "a"}}, ["attributes: the name ''", "1 to 255 bytes"]),
            ({"attributes": {"tiles": "a"}}, ["attributes: the name 'tiles'", "have anyway"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        ("write_dds", arguments, words)
        for arguments, words in (
            ({"path": 3}, ["path: 3", "the path of a file is needed"]),
            ({"levels": []}, ["levels: an empty list", "level 0 first, is needed"]),
            (
                {"levels": [RGBA, RGBA]},
                ["levels: level 1 has 8 x 8 texels", "half of the one before", "is 4 x 4"],
            ),
            (
                {"levels": [RGBA, RGBA[:4, :4, :3]]},
                ["levels: level 1 has 3 channels", "the one before 4", "must be alike"],
            ),
            (
                {"levels": [changed(RGBA, (2, 3, 1), NAN)]},
                ["levels: level 0", "row 2, column 3 holds nan", "finite values are needed"],
            ),
            ({"levels": [RGBA * 1e6]}, ["levels: hold ", "(65504)", "'rgba32f' is needed"]),
            (
                {"format": "bc4", "encoding": "srgb"},
                ["encoding: 'srgb'", "'bc4'", "'linear' or another format is needed"],
            ),
            ({"format": "bc2"}, ["format: 'bc2'", "one of auto, ", "bc5"]),
            ({"encoding": "gamma"}, ["encoding: 'gamma'", "one of linear, srgb"]),
            ({"alpha": "none"}, ["alpha: 'none'", "one of straight, premultiplied"]),
        )
    ),
    ("write_ktx2", {"format": "bc4", "encoding": "srgb"}, ["'srgb'", "no sRGB form in KTX 2"]),
]
# Where something stands in the way on the disk.
PLACES = [
    ("nowhere/out.dds", ["path: there is no folder", "nowhere"]),
    ("folder.dds", ["path: ", "folder.dds' is a folder"]),
    ("kept.dds", ["path: ", "kept.dds' is read-only"]),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder: it holds a read-only file, and a folder that is named like a file."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kept.dds").write_bytes(b"kept")
    (tmp_path / "kept.dds").chmod(0o444)
    (tmp_path / "folder.dds").mkdir()
    return tmp_path


def contents(folder):
    return {path.name: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.mark.parametrize(
    ("function", "arguments", "words", "error"),
    [
        *((*row, ValueError) for row in ROWS),
        *(("write_dds", {"path": path}, words, OSError) for path, words in PLACES),
    ],
)
def test_refusal(function, arguments, words, error, folder):
    before = contents(folder)
    check_refusal(FUNCTIONS[function], arguments, words, error)
    assert contents(folder) == before


@pytest.mark.parametrize("filter", ["box", "radial3", "least-squares"])
def test_an_image_that_would_not_fit_is_refused_before_it_is_made(filter):
    with pytest.raises(MemoryError, match="width, height: an image of 1048576 x 1048576 texels"):
        prefilter.resize(IMAGE, 2**20, 2**20, filter=filter)


@pytest.mark.parametrize("function", [name for name, (_, good) in FUNCTIONS.items() if good])
def test_the_other_arguments_of_the_rows_are_good(function, folder):
    call, good = FUNCTIONS[function]
    call(**good)


def test_every_function_is_there():
    constants = {
        "MAX_DEPTH",
        "MIPMAP_FILTERS",
        "PIXEL_FILTERS",
        "POINT_EXTENSIONS",
        "RASTER_FILTERS",
        "RESIZE_FILTERS",
        "SAMPLING_FILTERS",
        "TEXEL_FORMATS",
    }
    classes = {
        "Cancelled",
        "ClosedMesh",
        "CornerPoints",
        "FilteredLevels",
        "MipmapFilter",
        "MeshMeasures",
        "NearestPoints",
        "PickedTexels",
        "PixelFilter",
        "ReconstructionReport",
        "SamplingTable",
        "ScanPoints",
        "Shape",
        "SolidMesh",
        "Surface",
        "SvgDrawing",
        "SvgWarning",
        "TableSection",
        "TexelFormat",
        "TracedContour",
    }
    # In test_normals_of_points, test_face_normals, test_scan_files, test_scan_failures,
    # test_shape_arguments and test_svg_files.
    elsewhere = {"estimate_normals", "file_normals", "grid_normals", "mesh_normals"}
    elsewhere |= {"rasterize", "read_points", "read_svg", "reconstruct_file"}
    elsewhere |= {"available_memory"}  # takes nothing
    public = set(prefilter.__all__) - constants - classes - elsewhere
    assert public <= {*FUNCTIONS, *SAMPLING_FUNCTIONS, *VOXEL_FUNCTIONS}
    assert {row[0] for row in ROWS} == set(FUNCTIONS)
