# SPDX-License-Identifier: GPL-3.0-or-later

"""Results have the types that type checkers tell: mypy checks this module too."""

from typing import Any, assert_type

import numpy as np
import numpy.typing as npt
from prefilter import FilteredLevels, coarser_levels, mipmaps

BYTES: npt.NDArray[np.uint8] = np.zeros((2, 2), np.uint8)
WORDS: npt.NDArray[np.uint16] = np.zeros((2, 2), np.uint16)
DOUBLES: npt.NDArray[np.float64] = np.zeros((2, 2))


def test_levels_have_the_type_of_the_image() -> None:
    of_bytes = mipmaps(BYTES, filter="box")
    assert_type(of_bytes, FilteredLevels[np.uint8])
    assert of_bytes[1].dtype == np.uint8
    of_words = mipmaps(image=WORDS, filter="box")
    assert_type(of_words, FilteredLevels[np.uint16])
    assert of_words[1].dtype == np.uint16
    of_doubles = mipmaps(DOUBLES, None, filter="box", levels=2)
    assert_type(of_doubles, FilteredLevels[np.float32])
    assert of_doubles[1].dtype == np.float32
    of_numbers = mipmaps([[0.0, 1.0]], filter="box")
    assert_type(of_numbers, FilteredLevels[Any])
    assert of_numbers[1].dtype == np.float32


def test_coarser_levels_are_floats() -> None:
    levels = coarser_levels(BYTES, filter="box")
    assert_type(levels, FilteredLevels[np.float32])
    assert levels[0].dtype == np.float32
