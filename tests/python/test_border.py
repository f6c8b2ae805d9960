# SPDX-License-Identifier: GPL-3.0-or-later

"""Messages of the package's argument checks, each once: shapes, types, names, and numbers.

test_bad_inputs.py tests that functions check their arguments.
"""

import numpy as np
import pytest
from prefilter._border import arguments, arrays, input, samples
from refusals import AXES, NAN, NUMBERS, TEXELS, THREADS, refused

BYTES = np.zeros((4, 4, 3), np.uint8)
FLOATS = np.zeros((4, 4, 3), np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
CORNERS = "(2, 3, 2) for the triangles' corners or (6, 2) for the vertices is needed"
ARRAY = ("points", 3)

# A check, its arguments, and the words its message must hold.
ROWS = [
    *(
        (arrays.as_image, ("image", image), ["image: ", *words])
        for image, words in (
            (FLOATS[0, 0], ["shape (3,)", AXES]),
            (FLOATS[None], ["shape (1, 4, 4, 3)", AXES]),
            ([], ["shape (0,)", AXES]),
            (BYTES[:0], ["shape (0, 4, 3) holds no pixels", "at least one is needed"]),
            ([[]], ["shape (1, 0) holds no pixels", "at least one is needed"]),
            ([[1.0], [1.0, 2.0]], ["found no array", "inhomogeneous"]),
            *(
                (FLOATS.astype(dtype), [f"dtype {dtype}", TEXELS])
                for dtype in ("int8", "int16", "int64", "uint32", "complex64", "object")
            ),
            (None, ["dtype object", TEXELS]),
            ("image.png", ["dtype <U9", TEXELS]),
            ([[2**70]], ["dtype object", TEXELS]),
            (
                [[0, 1], [255, 1]],
                ["a list of whole numbers, among them 255", "only 0 and 1 are allowed"],
            ),
            ([[0, -1]], ["a list of whole numbers, among them -1", "arrays of uint8"]),
        )
    ),
    *(
        (arrays.as_floats, ("points", points, ARRAY, float), ["points: ", *words])
        for points, words in (
            (FLOATS[0, :, :2], ["shape (4, 2)", "(points, 3) is needed"]),
            ([], ["shape (0,)", "(points, 3) is needed"]),
            ([[1.0], [1.0, 2.0]], ["found no array", "inhomogeneous"]),
            ("abc", ["dtype <U3", NUMBERS]),
            (None, ["dtype object", NUMBERS]),
            (np.ones((9, 3), bool), ["dtype bool", NUMBERS]),
            (np.ones((9, 3), complex), ["dtype complex128", NUMBERS]),
        )
    ),
    *(
        (arrays.as_indices, ("triangles", triangles, ("triangles", 3)), ["triangles: ", *words])
        for triangles, words in (
            (TRIANGLES[:, :2], ["shape (2, 2)", "(triangles, 3) is needed"]),
            ([], ["shape (0,)", "(triangles, 3) is needed"]),
            ([[0, 1, 2.5]], ["dtype float64", "integers are needed"]),
            (TRIANGLES > 0, ["dtype bool", "integers are needed"]),
            (TRIANGLES.astype(np.uint64) + 2**63, ["found 9223372036854775811", "63 bits"]),
        )
    ),
    *(
        (arrays.as_labels, ("labels", labels, 2, "triangles"), ["labels: ", *words])
        for labels, words in (
            (np.zeros(2), ["dtype float64", "integers are needed"]),
            (np.arange(3), ["found 3 for 2 triangles", "one each"]),
            (np.array([[0, 1]]), ["shape (1, 2)", "(triangles,) is needed"]),
            (np.arange(2) + 2**31, ["found 2147483648 to 2147483649", "32 bits"]),
        )
    ),
    *(
        (arrays.as_corner_uvs, ("uvs", uvs, TRIANGLES, 6, float), ["uvs: ", *words])
        for uvs, words in (
            (np.zeros((1, 3, 2)), ["shape (1, 3, 2)", CORNERS]),
            (np.zeros((5, 2)), ["shape (5, 2)", CORNERS]),
            (np.zeros((6, 3)), ["shape (6, 3)", CORNERS]),
            (np.zeros((6, 2), complex), ["dtype complex128", NUMBERS]),
            (None, ["dtype object", NUMBERS]),
        )
    ),
    *(
        (arrays.as_threads, (threads,), [f"threads: {threads!r}", THREADS])
        for threads in (-1, 1.5, "a", True)
    ),
    *(
        (arguments.as_name, ("filter", name), [f"filter: {name!r}", "a name is needed"])
        for name in (3, None)
    ),
    (arguments.as_one_of, ("kind", "d", ("a", "b")), ["kind: 'd' is not one of a, b"]),
    (arguments.is_srgb, ("gamma",), ["encoding: 'gamma' is not one of linear, srgb"]),
    *(
        (arguments.as_wrap, (wrap,), [f"wrap: {wrap!r}", "a pair of names for u and v, is needed"])
        for wrap in (("clamp", "clamp", "clamp"), ("clamp",), ("clamp", 3), None, 5)
    ),
    *(
        (arguments.as_bounds, (bounds,), ["bounds: ", "pair (low, high) of numbers"])
        for bounds in ((0.0,), 5, ("a", "b"), (1j, None))
    ),
    *(
        (
            arguments.as_progress,
            (progress,),
            [f"progress: {progress!r}", "a callable of one number"],
        )
        for progress in (5, "a")
    ),
    *(
        (arguments.as_level_count, (levels,), [f"levels: {levels}", "number of at least 1"])
        for levels in (0, -2, 2.5, True)
    ),
    *(
        (arguments.as_size, ("width", size), [f"width: {size!r}", "from 1 to 1048576 is needed"])
        for size in (0, -3, 2**20 + 1, 2.0, True, NAN, 10**30, "9", None)
    ),
    *(
        (arguments.as_number, ("trim", number), [f"trim: {number!r}", "a number is needed"])
        for number in ("1", True, None, [0.5])
    ),
    *(
        (arguments.as_int, ("depth", depth, "allowed"), [f"depth: {depth!r}; allowed"])
        for depth in (True, 2.5, "9", None, 10**30)
    ),
    (input.as_path, (3,), ["path: 3", "the path of a file is needed"]),
    *(
        (samples.as_pyramid, (levels,), ["levels: ", *words])
        for levels, words in (
            (FLOATS, ["a ndarray", "a list of arrays is needed"]),
            (None, ["a NoneType", "a list of arrays is needed"]),
            ([FLOATS[0, 0]], ["level 0: shape (3,)", AXES]),
            ([FLOATS.astype(np.int64)], ["level 0: dtype int64", TEXELS]),
            ([FLOATS, FLOATS[:2, :2, :2]], ["level 1 has 2 channels of float32", "3 of float32"]),
            ([FLOATS, BYTES[:2, :2]], ["level 1 has 3 channels of uint8", "3 of float32"]),
        )
    ),
    *(
        (samples.as_scales, (scales, 3), ["scales: ", *words])
        for scales, words in (
            (np.ones(2), ["shape (2,)", "(3,) is needed"]),
            (np.ones((3, 1)), ["shape (3, 1)", "(3,) is needed"]),
            ("1", ["dtype <U1", "numbers"]),
            (None, ["dtype object", "numbers"]),
        )
    ),
]


@pytest.mark.parametrize(("check", "given", "words"), ROWS)
def test_refusal(check, given, words):
    with refused(words):
        check(*given)
