# SPDX-License-Identifier: GPL-3.0-or-later

"""Results have the types that type checkers tell: mypy checks this module too."""

import inspect
from typing import Any, assert_type

import numpy as np
import numpy.typing as npt
from prefilter import FilteredLevels, coarser_levels, mipmaps, reconstruct, resize
from prefilter.points import reconstruction

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


def test_resized_images_have_the_type_that_an_encoding_asks_for() -> None:
    of_bytes = resize(BYTES, 1, 1, encoding="srgb")
    assert_type(of_bytes, npt.NDArray[np.uint8])
    assert of_bytes.dtype == np.uint8
    of_words = resize(WORDS, 1, 1, encoding="linear")
    assert_type(of_words, npt.NDArray[np.uint16])
    assert of_words.dtype == np.uint16
    floats = resize(BYTES, 1, 1)
    assert_type(floats, npt.NDArray[np.float32])
    assert floats.dtype == np.float32


def test_a_surface_comes_with_what_was_asked_for() -> None:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    mesh = reconstruct(corners, corners, depth=3, watertight=True)
    assert_type(mesh, tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]])
    assert len(mesh) == 2
    colored = reconstruct(corners, corners, attributes=np.ones((8, 3)), depth=3, watertight=True)
    assert_type(colored[2], npt.NDArray[np.float32])
    assert colored[2].shape == (len(colored[0]), 3)
    supported = reconstruct(corners, corners, support=True, depth=3, watertight=True)
    assert_type(supported[2], dict[str, npt.NDArray[np.float32]])
    assert set(supported[2]) == {"distance", "density"}


def test_choices_are_those_of_the_function() -> None:
    told = inspect.signature(reconstruct).parameters
    apart = {"points", "normals", "attributes", "support"}
    assert set(reconstruction._Choices.__annotations__) == set(told) - apart
    for name, kind in reconstruction._Choices.__annotations__.items():
        assert told[name].annotation == kind, name
