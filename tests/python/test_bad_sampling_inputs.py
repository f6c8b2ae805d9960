# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input of what takes samples of images, as in test_bad_inputs.py."""

import numpy as np
import prefilter
import pytest
from refusals import AXES, NAN, NUMBERS, TEXELS, THREADS, WRAPS, changed, check_refusal
from scenes import random_image

IMAGE = random_image(0, 16, 16, 3)
TENT = prefilter.SamplingTable.standard("tent", 4)
TENT_LEVELS = prefilter.sampling_levels(IMAGE, "tent")

FUNCTIONS = {
    "sample": (
        prefilter.sample,
        {"levels": TENT_LEVELS, "table": TENT, "coordinates": np.zeros((3, 2)), "scales": 1.5},
    ),
    "sample_exact": (
        prefilter.sample_exact,
        {"image": IMAGE, "coordinates": np.zeros((3, 2)), "scales": 1.5},
    ),
    "sample_ewa": (
        prefilter.sample_ewa,
        {"image": IMAGE, "coordinates": np.zeros((3, 2)), "jacobians": np.ones((3, 2, 2))},
    ),
    "sample_anisotropic": (
        prefilter.sample_anisotropic,
        {
            "levels": TENT_LEVELS,
            "table": TENT,
            "coordinates": np.zeros((3, 2)),
            "jacobians": np.ones((3, 2, 2)),
        },
    ),
    **{
        function.__name__: (
            function,
            {
                "levels": TENT_LEVELS,
                "table": TENT,
                "coordinates": np.zeros((3, 2)),
                "scales": 1.5,
                "numbers": np.zeros(3),
            },
        )
        for function in (prefilter.sample_stochastic, prefilter.pick_texels)
    },
    "resample": (
        prefilter.resample,
        {"image": IMAGE, "transform": np.eye(3), "width": 4, "height": 4},
    ),
    "sampling_levels": (prefilter.sampling_levels, {"image": IMAGE}),
}

ROWS = [
    *(
        ("sample", arguments, words)
        for arguments, words in (
            ({"levels": IMAGE}, ["levels: a ndarray", "a list of arrays is needed"]),
            ({"levels": []}, ["levels: there are none"]),
            (
                {"levels": [IMAGE, IMAGE[:4, :8]]},
                ["levels: level 1 has 8 x 4 texels", "half as many", "16 x 16"],
            ),
            (
                {"levels": [IMAGE, IMAGE[:8, :8, :2]]},
                ["levels: level 1 has 2 channels of float32", "3 of float32"],
            ),
            (
                {"levels": [IMAGE, np.zeros((8, 8, 3), np.uint8)]},
                ["levels: level 1 has 3 channels of uint8", "3 of float32"],
            ),
            ({"levels": [IMAGE[0, 0]]}, ["levels: level 0: shape (3,)", AXES]),
            ({"levels": [IMAGE.astype(np.int64)]}, ["levels: level 0: dtype int64", TEXELS]),
            ({"table": "bilinear"}, ["table: 'bilinear'", "a SamplingTable is needed"]),
            ({"table": None}, ["table: None", "or 'trilinear'"]),
            (
                {"table": prefilter.SamplingTable.standard("box", 4)},
                ["table: it reproduces 'box'", "filtered by 'tent'"],
            ),
            (
                {"levels": prefilter.mipmaps(IMAGE, filter="box")},
                ["table: it reproduces 'tent'", "filtered by 'box'"],
            ),
            ({"coordinates": np.zeros(2)}, ["coordinates: shape (2,)", "(samples, 2) is needed"]),
            ({"coordinates": np.zeros((3, 3))}, ["coordinates: shape (3, 3)"]),
            ({"coordinates": np.zeros((3, 2), bool)}, ["coordinates: dtype bool", NUMBERS]),
            (
                {"coordinates": changed(np.zeros((3, 2)), (2, 1), NAN)},
                ["coordinates: found nan in row 2", "finite"],
            ),
            ({"coordinates": np.full((3, 2), -np.inf)}, ["coordinates: found -inf in row 0"]),
            ({"scales": np.ones(2)}, ["scales: shape (2,)", "(3,) is needed"]),
            ({"scales": np.ones((3, 1))}, ["scales: shape (3, 1)", "(3,) is needed"]),
            ({"scales": "1"}, ["scales: dtype <U1", "numbers"]),
            ({"scales": None}, ["scales: dtype object", "numbers"]),
            ({"scales": -1.0}, ["scales: found -1", "at least 0"]),
            ({"scales": [1.0, NAN, 1.0]}, ["scales: found nan at 1", "at least 0"]),
            ({"scales": np.inf}, ["scales: found inf", "finite"]),
            ({"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
            ({"progress": 1}, ["progress: 1", "a callable"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        (function, arguments, words)
        for function in (
            "sample_exact",
            "sample_ewa",
            "sample_anisotropic",
            "sample_stochastic",
            "pick_texels",
        )
        for arguments, words in (
            ({"coordinates": np.zeros(2)}, ["coordinates: shape (2,)", "(samples, 2) is needed"]),
            ({"coordinates": np.zeros((3, 2), bool)}, ["coordinates: dtype bool", NUMBERS]),
            (
                {"coordinates": changed(np.zeros((3, 2)), (1, 0), np.inf)},
                ["coordinates: found inf in row 1", "finite numbers are needed"],
            ),
            ({"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
            ({"progress": 1}, ["progress: 1", "a callable"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        (function, arguments, words)
        for function in ("sample_exact", "sample_stochastic", "pick_texels")
        for arguments, words in (
            ({"scales": [1.0, 2.0]}, ["scales: shape (2,)", "(3,) is needed"]),
            ({"scales": -1}, ["scales: found -1 at 0", "at least 0 are needed"]),
            ({"scales": [1.0, NAN, 1.0]}, ["scales: found nan at 1", "at least 0 are needed"]),
            ({"scales": [1.0, 1.0, np.inf]}, ["scales: found inf at 2", "finite numbers"]),
            ({"scales": "wide"}, ["scales: dtype <U4", "numbers are needed"]),
        )
    ),
    *(
        (function, arguments, words)
        for function in ("sample_ewa", "sample_anisotropic")
        for arguments, words in (
            ({"jacobians": np.eye(2)}, ["jacobians: shape (2, 2)", "(3, 2, 2) is needed"]),
            (
                {"jacobians": changed(np.ones((3, 2, 2)), (2, 0, 1), NAN)},
                ["jacobians: found nan in that of sample 2", "finite numbers are needed"],
            ),
        )
    ),
    *(
        (function, arguments, words)
        for function in ("sample_exact", "sample_ewa")
        for arguments, words in (
            ({"image": IMAGE[0, 0]}, ["image: shape (3,)", AXES]),
            ({"image": IMAGE[:, :0]}, ["image: shape (16, 0, 3)", "at least one"]),
            (
                {"image": changed(IMAGE, (2, 3, 1), NAN)},
                ["image: the texel in row 2, column 3 holds nan in channel 1", "at most 1e30"],
            ),
        )
    ),
    ("sample_exact", {"filter": "tents"}, ["filter: 'tents' is not one of box, tent"]),
    *(
        (function, arguments, words)
        for function in ("sample_anisotropic", "sample_stochastic", "pick_texels")
        for arguments, words in (
            ({"levels": []}, ["levels: there are none"]),
            ({"table": "linear"}, ["table: 'linear'", "a SamplingTable is needed"]),
            (
                {"levels": prefilter.sampling_levels(IMAGE, "box")},
                ["table: it reproduces 'tent'", "filtered by 'box'"],
            ),
        )
    ),
    *(
        (function, {"max_probes": count}, [f"max_probes: {count}", "from 1 to 256 is needed"])
        for function in ("sample_anisotropic", "resample")
        for count in (0, 257, 2.5, True, 10**30)
    ),
    *(
        (function, arguments, words)
        for function in ("sample_stochastic", "pick_texels")
        for arguments, words in (
            ({"numbers": 0.5}, ["numbers: shape ()", "(3,) is needed"]),
            ({"numbers": np.zeros(2)}, ["numbers: shape (2,)", "(3,) is needed"]),
            (
                {"numbers": np.array([0.0, 1.0, 0.5])},
                ["numbers: found 1 at 1", "numbers from 0 to below 1 are needed"],
            ),
            (
                {"numbers": np.array([NAN, 0.0, 0.5])},
                ["numbers: found nan at 0", "from 0 to below"],
            ),
        )
    ),
    *(
        ("resample", arguments, words)
        for arguments, words in (
            ({"image": IMAGE[0, 0]}, ["image: shape (3,)", AXES]),
            ({"image": np.zeros((4, 4, 3), np.int64)}, ["image: dtype int64", TEXELS]),
            ({"image": changed(IMAGE, (2, 3, 1), NAN)}, ["image: the texel in row 2, column 3"]),
            ({"transform": np.eye(4)}, ["transform: shape (4, 4)", "(3, 3) or (2, 3) is needed"]),
            ({"transform": "turn"}, ["transform: dtype <U4", "numbers are needed"]),
            (
                {"transform": changed(np.eye(3), (0, 2), np.inf)},
                ["transform: found inf", "finite numbers are needed"],
            ),
            ({"width": 0}, ["width: 0", f"from 1 to {2**20} is needed"]),
            ({"height": 2**20 + 1}, [f"height: {2**20 + 1}", f"from 1 to {2**20} is needed"]),
            ({"filter": "tents"}, ["filter: 'tents' is not one of box, tent"]),
            ({"filter": "tents", "table": "trilinear"}, ["filter: 'tents' is not one of box"]),
            ({"table": "bilinear"}, ["table: 'bilinear'", "a SamplingTable is needed"]),
            ({"table": TENT, "exact": True}, ["table: <SamplingTable", "None is needed"]),
            (
                {"exact": True, "max_probes": 4},
                ["max_probes: 4 with exact and filter 'lanczos2'", "1 is needed", "'gaussian'"],
            ),
            ({"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
            ({"progress": 1}, ["progress: 1", "a callable"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
    *(
        ("sampling_levels", arguments, words)
        for arguments, words in (
            ({"image": IMAGE[0, 0]}, ["image: shape (3,)", AXES]),
            ({"image": np.zeros((4, 4, 3), np.int64)}, ["image: dtype int64", TEXELS]),
            ({"image": IMAGE[:0]}, ["image: shape (0, 16, 3)", "at least one"]),
            ({"image": changed(IMAGE, (2, 3, 1), NAN)}, ["image: the texel in row 2, column 3"]),
            (
                {"image": changed(np.zeros((4, 4, 9)), (2, 3, 7), np.inf)},
                ["image: the texel in row 2, column 3", "inf in channel 7", "at most 1e30"],
            ),
            ({"filter": "tent-covered"}, ["filter: 'tent-covered' is not one of box, tent"]),
            ({"filter": None}, ["filter: None", "a name is needed"]),
            ({"wrap": "mirror"}, ["wrap: 'mirror'", WRAPS]),
            ({"levels": 0}, ["levels: 0", "at least 1 is needed, or None"]),
            ({"levels": 6}, ["levels: 6", "16 x 16 texels has 1 to 5"]),
            ({"progress": 1}, ["progress: 1", "a callable"]),
            ({"threads": -1}, ["threads: -1", THREADS]),
        )
    ),
]


@pytest.mark.parametrize(("function", "arguments", "words"), ROWS)
def test_refusal(function, arguments, words):
    check_refusal(FUNCTIONS[function], arguments, words)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_the_other_arguments_of_the_rows_are_good(function):
    call, good = FUNCTIONS[function]
    call(**good)


def test_every_function_has_rows():
    assert {row[0] for row in ROWS} == set(FUNCTIONS)
