# SPDX-License-Identifier: GPL-3.0-or-later

"""Arguments refused by shapes and `rasterize`: messages name the argument and allowed values."""

import numpy as np
import prefilter
import pytest
from refusals import refused

NAN, INF = np.nan, np.inf
NUMBERS = "one to 4 numbers are needed"
PAIR = "a pair of finite numbers is needed"
NO_PAIRS = "control_points: found no pairs (x, y)"
MATRIX = "(2, 3) of finite numbers is needed"
STOPS = [(0.0, (1.0,)), (1.0, (0.0,))]
RISING = "rising numbers in [0, 1] are needed"
WEIGHT = "a number from 1e-6 to 1e6 is needed"


def begun():
    shape = prefilter.Shape()
    shape.move_to(1.0, 1.0)
    return shape


# A method, its arguments, and the words its message must hold.
METHODS = [
    *(("move_to", point, ["x, y: ", PAIR]) for point in ((NAN, 0), (0, INF), ("a", 0), (None, 0))),
    ("line_to", (0, NAN), ["x, y: (0, nan)", PAIR]),
    ("curve_to", (), ["control_points: 0 points; 1 to 60 are needed"]),
    *(
        ("curve_to", points, [NO_PAIRS])
        for points in ((1,), (1, 2, 3), ((1, 2, 3),), ("ab", "cd"), (None,), (1j, 2), ([[[1, 2]]],))
    ),
    ("curve_to", ((1, 2), 3, 4), ["control_points: found no array"]),
    ("curve_to", (NAN, 1), ["control_points: a coordinate is not finite"]),
    ("curve_to", ((1, 2), (3, -INF)), ["control_points: a coordinate is not finite"]),
    ("curve_to", (1.0,) * 122, ["control_points: 61 points; 1 to 60 are needed"]),
    *(
        ("conic_to", (1, 2, weight, 3, 4), [f"weight: {weight!r}", WEIGHT])
        for weight in (0, -1, -0.0, NAN, INF, 9e-7, 1.1e6)
    ),
    ("conic_to", (1, 2, "1", 3, 4), ["weight: '1'; a number is needed"]),
    ("conic_to", (NAN, 2, 1, 3, 4), ["x1, y1: (nan, 2)", PAIR]),
    ("conic_to", (1, 2, 1, 3, INF), ["x2, y2: (3, inf)", PAIR]),
    ("add_polygon", ([],), ["points: shape (0,)", "(points, 2) is needed"]),
    ("add_polygon", (np.zeros((0, 2)),), ["points: found none; at least one is needed"]),
    ("add_polygon", (np.zeros((3, 3)),), ["points: shape (3, 3)", "(points, 2) is needed"]),
    ("add_polygon", (np.zeros((3, 2), bool),), ["points: dtype bool", "real numbers are needed"]),
    ("add_polygon", (np.full((3, 2), NAN),), ["points: a coordinate is not finite"]),
    ("add_polygon", ("abc",), ["points: dtype <U3", "real numbers are needed"]),
    *(
        ("add_beziers", (np.zeros(shape),), [f"points: shape {shape}", "2 to 61 points is needed"])
        for shape in ((0, 3, 2), (1, 1, 2), (1, 62, 2))
    ),
    ("add_beziers", (np.zeros((2, 3)),), ["points: shape (2, 3)", "(curves, points, 2)"]),
    ("add_beziers", (np.full((1, 3, 2), NAN),), ["points: a coordinate is not finite"]),
    (
        "add_beziers",
        (np.arange(12.0).reshape(2, 3, 2),),
        ["points: curve 1 does not begin where the one before it ends"],
    ),
    ("add_path", ("MX", [1.0, 2.0]), ["letters: 'X' is not one of M, L, Q, C, W, Z"]),
    ("add_path", ("L", [1.0, 2.0]), ["letters: ", "M is needed"]),
    ("add_path", ("ML", [1.0, 2.0]), ["numbers: 2; the letters need 4"]),
    ("add_path", ("M", [1.0, 2.0, 3.0]), ["numbers: 3; the letters need 2"]),
    ("add_path", ("M", [1.0, NAN]), ["numbers: one is not finite"]),
    ("add_path", ("M", [[1.0, 2.0]]), ["numbers: shape (1, 2)", "a row of numbers"]),
    ("add_path", (3, [1.0]), ["letters: 3", "a name is needed"]),
    *(
        ("add_path", ("MW", [0.0, 0, 1, 2, weight, 3, 4]), ["weight", "1e-6 to 1e6"])
        for weight in (0.0, -2.0, 1e7)
    ),
    *(
        ("transformed", (matrix,), ["matrix: shape", MATRIX])
        for matrix in (np.eye(3), np.full((2, 3), NAN), "x", None)
    ),
    ("transformed", (np.zeros((2, 3)),), ["matrix: ", "a matrix of rank 2 is needed"]),
    ("transformed", ([(1, 2, 0), (2, 4, 9)],), ["matrix: ", "a matrix of rank 2 is needed"]),
    ("gradient", ((1,), (1, 2), (1,)), ["along_x: 2 values; 1, as value has"]),
    ("gradient", ((1,), (1,), (1, 2)), ["along_y: 2 values; 1, as value has"]),
    ("gradient", ((1,), (1,), (NAN,)), ["along_y: (nan,)", "finite"]),
    ("gradient", ((), (), ()), ["value: ()", NUMBERS]),
    ("linear_gradient", ((0, 0), (0, 0), STOPS), ["end: (0.0, 0.0)", "another point than start"]),
    ("linear_gradient", ((0, 0, 0), (1, 0), STOPS), ["start: (0, 0, 0)", PAIR]),
    ("linear_gradient", ((0, 0), (1, NAN), STOPS), ["end: (1, nan)", PAIR]),
    ("linear_gradient", ((0, 0), (1, 0), []), ["stops: found none; at least one is needed"]),
    ("linear_gradient", ((0, 0), (1, 0), 3), ["stops: pairs (offset, color) are needed"]),
    ("linear_gradient", ((0, 0), (1, 0), [3]), ["stops: pairs (offset, color) are needed"]),
    *(
        ("linear_gradient", ((0, 0), (1, 0), stops), ["stops: offset ", RISING])
        for stops in (STOPS[::-1], [(1.5, (1,))], [(-0.1, (1,))], [(NAN, (1,))])
    ),
    ("linear_gradient", ((0, 0), (1, 0), [("a", (1,))]), ["stops: offset: 'a'"]),
    ("linear_gradient", ((0, 0), (1, 0), [(0, (NAN,))]), ["stops: color: (nan,)", "finite"]),
    (
        "linear_gradient",
        ((0, 0), (1, 0), [(0, (1,)), (1, (1, 2))]),
        ["stops: colors with as many values each are needed"],
    ),
    *(
        ("radial_gradient", ((0, 0), radius, STOPS), [f"radius: {radius!r}", "above 0 is needed"])
        for radius in (0, -1, NAN, INF)
    ),
    ("radial_gradient", ((0, 0), "1", STOPS), ["radius: '1'; a number is needed"]),
    ("radial_gradient", ((0, NAN), 1, STOPS), ["center: (0, nan)", PAIR]),
]


@pytest.mark.parametrize(("method", "arguments", "words"), METHODS)
def test_refusal_by_a_method(method, arguments, words):
    shape = begun()
    before = shape.bounds, shape.color
    with refused(words):
        getattr(shape, method)(*arguments)
    assert (shape.bounds, shape.color) == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"fill_rule": "odd"}, ["fill_rule: 'odd'", "one of nonzero, evenodd"]),
        ({"fill_rule": None}, ["fill_rule: None; a name is needed"]),
        *(
            ({"color": color}, ["color: ", NUMBERS])
            for color in ((), (1,) * 5, 1.0, "red", ((1, 2),), (1j,), (True,), None)
        ),
        ({"color": (0, NAN)}, ["color: (0, nan)", "finite numbers are needed"]),
    ],
)
def test_refusal_by_a_shape(arguments, words):
    with refused(words):
        prefilter.Shape(**arguments)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"spread": "mirror"}, ["spread: 'mirror'", "one of pad, repeat, reflect"]),
        ({"spread": 3}, ["spread: 3; a name is needed"]),
        ({"transform": np.zeros((2, 3))}, ["transform: ", "a matrix of rank 2 is needed"]),
        ({"transform": np.eye(3)}, ["transform: shape (3, 3)", MATRIX]),
    ],
)
def test_refusal_by_both_gradients(options, words):
    for set_gradient in (
        lambda **given: begun().linear_gradient((0, 0), (1, 0), STOPS, **given),
        lambda **given: begun().radial_gradient((0, 0), 1, STOPS, **given),
    ):
        with refused(words):
            set_gradient(**options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"focus": (1,)}, ["focus: (1,)", PAIR]),
        *(
            ({"focus_radius": radius}, [f"focus_radius: {radius!r}", "at least 0"])
            for radius in (-1, NAN, INF)
        ),
    ],
)
def test_refusal_by_a_radial_gradient(options, words):
    with refused(words):
        begun().radial_gradient((0, 0), 1, STOPS, **options)


@pytest.mark.parametrize("method", ["line_to", "curve_to", "conic_to"])
def test_what_draws_on_needs_a_contour(method):
    arguments = {"line_to": (1, 2), "curve_to": (1, 2, 3, 4), "conic_to": (1, 2, 1, 3, 4)}[method]
    with pytest.raises(ValueError, match=f"{method}: no contour has begun; call move_to first"):
        getattr(prefilter.Shape(), method)(*arguments)


def away(x, y):
    shape = begun()
    shape.line_to(x, y)
    return shape


COLORED = prefilter.Shape(color=(1, 2))
SIZES = "a whole number from 1 to 1048576 is needed"

ROWS = [
    ({"shapes": 3}, ["shapes: 3"]),
    ({"shapes": None}, ["shapes: None"]),
    ({"shapes": begun()}, ["shapes: "]),
    ({"shapes": [3]}, ["shapes: item 0 is int; Shape is needed"]),
    ({"shapes": [begun(), None]}, ["shapes: item 1 is NoneType; Shape is needed"]),
    (
        {"shapes": [begun(), COLORED]},
        ["shapes: shape 1 has 2 channels", "the first has 1", "the same number"],
    ),
    ({"shapes": [begun(), away(1.001e9, 0)]}, ["shapes: shape 1 has a point", "1e9 pixels away"]),
    ({"shapes": [away(0, -1.001e9)]}, ["shapes: shape 0 has a point", "1e9 pixels away"]),
    *(({"width": width}, [f"width: {width!r}", SIZES]) for width in (0, -3, 2.5, True, 2**21)),
    *(({"height": height}, [f"height: {height!r}", SIZES]) for height in (0, -1, "9", None)),
    ({"filter": "cubic"}, ["filter: 'cubic' is not one of", *prefilter.RASTER_FILTERS]),
    ({"filter": 3}, ["filter: 3; a name is needed"]),
    ({"method": "x"}, ["method: 'x'", "one of scanline, wavelet"]),
    ({"overlap": "x"}, ["overlap: 'x'", "one of add, cover"]),
    *(
        ({"dtype": dtype}, [f"dtype: {dtype!r}", "one of float32, uint8"])
        for dtype in ("float64", "x", None, "int8")
    ),
    ({"background": 3}, ["background: 3", NUMBERS]),
    ({"background": (NAN,)}, ["background: (nan,)", "finite"]),
    ({"background": (1, 2)}, ["background: 2 values; 1, as the shapes have"]),
    ({"threads": -1}, ["threads: -1", "0 meaning all processors"]),
    ({"threads": 1.5}, ["threads: 1.5", "0 meaning all processors"]),
    ({"progress": 3}, ["progress: 3", "a callable of one number"]),
]


@pytest.mark.parametrize(("arguments", "words"), ROWS)
def test_refusal_by_rasterize(arguments, words):
    good = {"shapes": [begun()], "width": 3, "height": 2}
    prefilter.rasterize(**good)
    with refused(words):
        prefilter.rasterize(**{**good, **arguments})


def test_an_image_beyond_memory_is_refused_before_it_is_made():
    with pytest.raises(MemoryError, match="width, height: an image of 1048576 x 1048576 pixels"):
        prefilter.rasterize([], 2**20, 2**20)


def test_what_is_allowed():
    """Numbers at their limits, and points in every way to give them."""
    shape = begun()
    shape.curve_to((2, 3), (4, 5))
    shape.curve_to([2, 3, 4, 5])
    shape.curve_to(*np.ones((60, 2), np.float32))
    shape.line_to(np.float32(1), np.int8(3))
    for weight in (1e-6, 1, np.float32(2), 1e6):
        shape.conic_to(1, 2, weight, 3, 4)
    shape.close()
    shape.close()
    shape.add_polygon(np.ones((1, 2), np.float32))
    shape.add_path("MLQCWZ", [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 0.5, 8, 8])
    shape.add_path("", [])
    away(1e9, -1e9)
    assert prefilter.rasterize([away(1e9, -1e9), shape], 2, 2).shape == (2, 2, 1)
