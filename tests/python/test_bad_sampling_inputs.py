# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input to functions that sample images, in rows as in test_bad_inputs.py."""

import numpy as np
import prefilter
import pytest
from refusals import NAN, changed, check_refusal
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
            ({"levels": []}, ["levels: there are none"]),
            (
                {"levels": [IMAGE, IMAGE[:4, :8]]},
                ["levels: level 1 has 8 x 4 texels", "half as many", "16 x 16"],
            ),
            ({"table": "bilinear"}, ["table: 'bilinear'", "a SamplingTable is needed"]),
            ({"table": None}, ["table: None", "or 'trilinear'"]),
            (
                {"table": prefilter.SamplingTable.standard("box", 4)},
                ["table: it is for levels of 'box'", "filtered by 'tent'"],
            ),
            (
                {"levels": prefilter.mipmaps(IMAGE, filter="box")},
                ["table: it is for levels of 'tent'", "filtered by 'box'"],
            ),
            ({"coordinates": np.full((3, 2), NAN)}, ["coordinates: found nan in row 0"]),
            ({"scales": -1.0}, ["scales: found -1", "at least 0"]),
            ({"scales": [1.0, NAN, 1.0]}, ["scales: found nan at 1", "at least 0"]),
            ({"scales": np.inf}, ["scales: found inf", "finite"]),
        )
    ),
    *(
        (
            function,
            {"image": changed(IMAGE, (2, 3, 1), NAN)},
            ["image: the texel in row 2, column 3 holds nan in channel 1", "at most 1e30"],
        )
        for function in ("sample_exact", "sample_ewa", "resample", "sampling_levels")
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
                ["table: it is for levels of 'tent'", "filtered by 'box'"],
            ),
        )
    ),
    *(
        (function, {"max_probes": 257}, ["max_probes: 257", "from 1 to 256 is needed"])
        for function in ("sample_anisotropic", "resample")
    ),
    *(
        ("resample", arguments, words)
        for arguments, words in (
            ({"transform": np.eye(4)}, ["transform: shape (4, 4)", "(3, 3) or (2, 3) is needed"]),
            ({"transform": "turn"}, ["transform: dtype <U4", "numbers are needed"]),
            (
                {"transform": changed(np.eye(3), (0, 2), np.inf)},
                ["transform: found inf", "finite numbers are needed"],
            ),
            ({"filter": "tents"}, ["filter: 'tents' is not one of box, tent"]),
            ({"filter": "tents", "table": "trilinear"}, ["filter: 'tents' is not one of box"]),
            ({"table": "bilinear"}, ["table: 'bilinear'", "a SamplingTable is needed"]),
            ({"table": TENT, "exact": True}, ["table: <SamplingTable", "None is needed"]),
            (
                {"exact": True, "max_probes": 4},
                ["max_probes: 4 with exact and filter 'lanczos2'", "1 is needed", "'gaussian'"],
            ),
        )
    ),
    *(
        ("sampling_levels", arguments, words)
        for arguments, words in (
            (
                {"image": changed(np.zeros((4, 4, 9)), (2, 3, 7), np.inf)},
                ["image: the texel in row 2, column 3", "inf in channel 7", "at most 1e30"],
            ),
            ({"filter": "tent-covered"}, ["filter: 'tent-covered' is not one of box, tent"]),
            ({"levels": 6}, ["levels: 6", "16 x 16 texels has 1 to 5"]),
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
