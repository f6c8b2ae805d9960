# SPDX-License-Identifier: GPL-3.0-or-later

"""Messages for bad input name the argument, the value found and the values allowed.

A row is a function, the arguments that differ from good ones, and the words its message must hold:
the argument's name first. The error is a ValueError, or an OSError if the disk is at fault.
"""

import inspect
from pathlib import Path

import numpy as np
import prefilter
import pytest
from clouds import sphere
from refusals import AXES, NAN, TEXELS, THREADS, WRAPS, changed, check_refusal
from scenes import random_image, soup, square
from test_bad_sampling_inputs import FUNCTIONS as SAMPLING_FUNCTIONS
from test_bad_surface_inputs import FUNCTIONS as SURFACE_FUNCTIONS
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


FUNCTIONS = {
    "mipmaps": (prefilter.mipmaps, {"image": IMAGE, "surface": SURFACE}),
    "coarser_levels": (prefilter.coarser_levels, {"image": IMAGE, "surface": SURFACE}),
    "mipmap_error": (
        prefilter.mipmap_error,
        {"levels": [IMAGE], "image": IMAGE, "surface": SURFACE, "mip_values": [0.0]},
    ),
    "seam_contrast": (prefilter.seam_contrast, {"levels": [IMAGE], "surface": SURFACE}),
    "fit_to_views": (prefilter.fit_to_views, {"levels": [IMAGE], "surface": SURFACE}),
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
    "read_ktx2": (prefilter.read_ktx2, {"path": Path(__file__).parent / "ktx2/uastc-r.ktx2"}),
    "resize": (prefilter.resize, {"image": IMAGE, "width": 5, "height": 7}),
    "to_linear": (prefilter.to_linear, {"image": IMAGE}),
    "to_srgb": (prefilter.to_srgb, {"image": IMAGE}),
}

ROWS = [
    *(
        ("mipmaps", {"image": image}, words)
        for image, words in (
            (np.zeros((16, 16, 5), np.float32), ["image: 5 channels", "1 to 4 are allowed"]),
            (np.zeros((4, 4, 5), np.uint8), ["image: 5 channels", "1 to 4 are allowed"]),
            (BYTES[0, 0], ["image: shape (3,)", AXES]),
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
    ("mipmaps", {"filter": "\ud800"}, ["filter: '?' is not one of"]),
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
    ("mipmaps", {"bounds": 5}, ["bounds: 5", "pair (low, high) of numbers"]),
    ("mipmaps", {"levels": 0}, ["levels: 0", "a whole number of at least 1"]),
    ("mipmaps", {"levels": 6}, ["levels: 6 asked for", "16 x 16 texels has 1 to 5"]),
    ("mipmaps", {"levels": 10**30}, ["levels: ", "16 x 16 texels has 1 to 5"]),
    *(
        ("mipmaps", {"seam_budget": budget}, [f"seam_budget: {budget}", "of at least 0 is needed"])
        for budget in (-1, NAN, np.inf)
    ),
    ("mipmaps", {"seam_budget": "1"}, ["seam_budget: '1'", "a number is needed"]),
    (
        "mipmaps",
        {"reader": "srgb-after", "filter": "pam-trilinear"},
        ["reader: 'srgb-after' requires pam-bilinear", "use linear for pam-trilinear"],
    ),
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
    ("seam_contrast", {"levels": 5}, ["levels: a int", "a list of arrays is needed"]),
    ("seam_contrast", {"levels": []}, ["levels: none were given", "at least one is needed"]),
    (
        "seam_contrast",
        {"levels": [IMAGE, IMAGE[:8, :8, :1]]},
        ["levels: level 1 has 1 channels and level 0 3", "must have the same"],
    ),
    ("seam_contrast", {"surface": None}, ["surface: none was given", "at least one is needed"]),
    ("fit_to_views", {"levels": []}, ["levels: none", "at least one is needed"]),
    ("fit_to_views", {"levels": 3}, ["levels: a int", "a list of arrays is needed"]),
    (
        "fit_to_views",
        {"levels": [IMAGE, IMAGE]},
        ["levels: level 1 has 16 x 16 texels of 3 channels", "8 x 8 of 3 are needed"],
    ),
    (
        "fit_to_views",
        {"levels": [np.where(IMAGE > -1, NAN, IMAGE)]},
        ["levels: level 0", "finite"],
    ),
    ("fit_to_views", {"surface": None}, ["surface: none", "at least one is needed"]),
    ("fit_to_views", {"lookups": "nearest"}, ["lookups: 'nearest'", "trilinear", "both"]),
    ("fit_to_views", {"steadiness": -1}, ["steadiness: -1", "0 or more"]),
    ("fit_to_views", {"effort": 0}, ["effort: 0", "above 0 and up to 100"]),
    ("fit_to_views", {"bounds": (2, 1)}, ["bounds", "above"]),
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
    ("fill_unused", {"surface": None}, ["surface: none was given", "at least one is needed"]),
    (
        "fill_unused",
        {"surface": AWAY, "wrap": "border"},
        ["surface: none of it lies inside the image"],
    ),
    *(
        ("resize", arguments, words)
        for arguments, words in (
            ({"image": np.zeros((4, 4, 5))}, ["image: 5 channels", "1 to 4 are allowed"]),
            ({"image": changed(IMAGE, (2, 3, 1), NAN)}, ["image: the texel in row 2, column 3"]),
            ({"image": changed(RGBA, (2, 3, 3), np.inf)}, ["image: ", "inf in channel 3"]),
            ({"image": IMAGE * 1e31}, ["image: the texel", "at most 1e30"]),
            ({"filter": "cubic"}, ["filter: 'cubic' is not one of box, tent", "least-squares"]),
            ({"wrap": ("clamp",)}, ["wrap: ('clamp',)", "a pair"]),
        )
    ),
    *(
        ("coarser_levels", arguments, words)
        for arguments, words in (
            ({"encoding": "srgb"}, ["encoding: 'srgb'", "uint8 or uint16"]),
            ({"levels": 99}, ["levels: 99 asked for"]),
        )
    ),
    *(
        ("write_exr", arguments, words)
        for arguments, words in (
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
            ({"alpha": "none"}, ["alpha: 'none'", "one of straight, premultiplied"]),
            ({"attributes": "wrap"}, ["attributes: a str", "in a dict"]),
            ({"attributes": {"wrap": 3}}, ["attributes: found 'wrap': 3", "a text are needed"]),
            ({"attributes": {"": "a"}}, ["attributes: the name ''", "1 to 255 bytes"]),
            ({"attributes": {"tiles": "a"}}, ["attributes: the name 'tiles'", "have anyway"]),
        )
    ),
    *(
        ("write_dds", arguments, words)
        for arguments, words in (
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
            ({"alpha": "none"}, ["alpha: 'none'", "one of straight, premultiplied"]),
        )
    ),
    ("write_ktx2", {"format": "bc4", "encoding": "srgb"}, ["'srgb'", "no sRGB form in KTX 2"]),
]
# Arguments that conflict with files on the disk.
PLACES = [
    ("nowhere/out.dds", ["path: there is no folder", "nowhere"]),
    ("folder.dds", ["path: ", "folder.dds' is a folder"]),
    ("kept.dds", ["path: ", "kept.dds' is read-only"]),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with a read-only file, and a folder that has a file's name."""
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


ALL = {**FUNCTIONS, **SAMPLING_FUNCTIONS, **SURFACE_FUNCTIONS, **VOXEL_FUNCTIONS}
# Checks for every argument of a name: a function that spoils a good value, and the message.
USUAL = {
    "image": [(lambda good: good[0, 0], AXES), (lambda good: good.astype(np.int64), TEXELS)],
    "encoding": [(lambda _: "gamma", "is not one of linear, srgb")],
    "filter": [(lambda _: "cubic", "'cubic' is not one of"), (lambda _: 3, "3; a name is needed")],
    "wrap": [(lambda _: "mirror", "'mirror' " + WRAPS), (lambda _: 5, "a pair of names")],
    "reader": [(lambda _: "gamma", "one of linear, srgb-after")],
    "surface": [(lambda _: 5, "a int; a Surface or a list is needed")],
    "width": [(lambda _: 0, "a whole number from 1 to 1048576 is needed")],
    "height": [(lambda _: 2.5, "a whole number from 1 to 1048576 is needed")],
    "positions": [
        (lambda good: good[:, :2], "(vertices, 3) is needed"),
        (lambda good: changed(good, (3, 1), NAN), "vertex 3 "),
    ],
    "triangles": [
        (lambda good: good * 1.0, "integers are needed"),
        (lambda good: changed(good, (0, 1), 99), "names vertex 99"),
        (lambda good: changed(good, (0, 1), -1), "names vertex -1"),
    ],
    "depth": [(lambda _: 13, "a whole number from 1 to 12 is needed")],
    "coordinates": [
        (lambda good: good[0], "shape (2,); (samples, 2) is needed"),
        (lambda good: changed(good, (1, 0), np.inf), "found inf in row 1; finite numbers"),
    ],
    "scales": [
        (lambda _: [1.0, 2.0], "shape (2,); (3,) is needed"),
        (lambda _: [1.0, -1, 1.0], "found -1 at 1; finite numbers of at least 0 are needed"),
        (lambda _: [1.0, 1.0, np.inf], "found inf at 2; finite numbers"),
    ],
    "jacobians": [
        (lambda good: good[0], "(3, 2, 2) is needed"),
        (lambda good: changed(good, (2, 0, 1), NAN), "found nan in that of sample 2; finite"),
    ],
    "numbers": [
        (lambda good: good[:2], "shape (2,); (3,) is needed"),
        (lambda good: changed(good, 1, 1.0), "found 1 at 1; numbers from 0 to below 1"),
        (lambda good: changed(good, 0, NAN), "found nan at 0; numbers from 0 to below 1"),
    ],
    "max_probes": [(lambda _: 0, "from 1 to 256 is needed"), (lambda _: 2.5, "from 1 to 256")],
    "path": [(lambda _: 3, "the path of a file is needed")],
    "threads": [(lambda _: -1, THREADS)],
    "progress": [(lambda _: 3, "a callable of one number is needed, or None")],
}


@pytest.mark.parametrize(
    ("function", "argument"),
    [
        (function, argument)
        for function, (call, _) in ALL.items()
        for argument in inspect.signature(call).parameters
        if argument in USUAL
    ],
)
def test_usual_arguments_are_checked(function, argument, folder):
    before = contents(folder)
    call, good = ALL[function]
    for change, words in USUAL[argument]:
        bad = {argument: change(good.get(argument))}
        check_refusal((call, good), bad, [f"{argument}: ", words])
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
        "Ktx2Info",
        "MeshEdges",
        "MipmapFilter",
        "MeshMeasures",
        "MeshTopology",
        "NearestPoints",
        "PickedTexels",
        "PixelFilter",
        "QuadContour",
        "Reconstruction",
        "ReconstructionReport",
        "SamplingTable",
        "ScanAlignment",
        "ScanPoints",
        "Shape",
        "SolidMesh",
        "Surface",
        "SvgDrawing",
        "SvgWarning",
        "TableSection",
        "TexelFormat",
        "ThinPlaces",
        "TracedContour",
        "TrimmedSurface",
    }
    # Tested in test_normals_of_points, test_face_normals, test_float_step, test_open_surfaces,
    # test_painting, test_scan_files, test_scan_failures, test_point_choice, test_point_clouds,
    # test_shape_arguments, test_rasterize_svg and test_svg_files.
    elsewhere = {"estimate_normals", "file_normals", "grid_normals", "mesh_normals"}
    elsewhere |= {"rasterize", "rasterize_svg", "read_points", "read_svg", "reconstruct_file"}
    elsewhere |= {"align_scans", "choose_points", "find_outliers", "subsample_points"}
    elsewhere |= {"float_step", "paint_texture", "trim"}
    elsewhere |= {"available_memory"}  # takes nothing
    public = set(prefilter.__all__) - constants - classes - elsewhere
    assert public <= set(ALL)
