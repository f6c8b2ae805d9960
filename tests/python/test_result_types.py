# SPDX-License-Identifier: GPL-3.0-or-later

"""Results have their annotated types: mypy checks this module too."""

import pickle
from typing import Any, assert_type

import numpy as np
import numpy.typing as npt
from prefilter import (
    FilteredLevels,
    Reconstruction,
    ReconstructionReport,
    ScanPoints,
    coarser_levels,
    mipmaps,
    reconstruct,
    resize,
)

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


CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def test_reconstruction_of_arrays() -> None:
    made = reconstruct(CORNERS, CORNERS, depth=3, watertight=True)
    assert_type(made, Reconstruction)
    assert_type(made.positions, npt.NDArray[np.float64])
    assert_type(made.triangles, npt.NDArray[np.int32])
    assert_type(made.support, dict[str, npt.NDArray[np.float32]] | None)
    assert_type(made.report, ReconstructionReport)
    positions, triangles = made
    assert positions is made.positions
    assert triangles is made.triangles
    assert made.attributes is None
    assert made.support is None
    assert made.report.triangles == len(triangles)


def test_reconstruction_of_scans_has_attributes_by_name() -> None:
    scan = ScanPoints(CORNERS, CORNERS, attributes={"height": np.ones(8, np.float32)})
    made = reconstruct(scan, depth=3, watertight=True)
    assert len(made) == 2
    assert made.attributes["height"].shape == (len(made.positions),)
    assert reconstruct(scan, depth=3, watertight=True, attributes=False).attributes is None


def test_reconstruction_unpacks_attributes_and_support_if_asked_for() -> None:
    scan = ScanPoints(CORNERS, CORNERS, attributes={"height": np.ones(8, np.float32)})
    _, _, by_name = reconstruct(scan, depth=3, watertight=True, attributes=True)
    assert by_name.keys() == {"height"}
    colors = np.ones((8, 3))
    positions, _, carried = reconstruct(
        CORNERS, CORNERS, attributes=colors, depth=3, watertight=True
    )
    assert carried.shape == (len(positions), 3)
    made = reconstruct(CORNERS, CORNERS, support=True, depth=3, watertight=True)
    assert set(made[2]) == {"distance", "density"}
    assert made[2] is made.support
    made = reconstruct(CORNERS, CORNERS, attributes=colors, support=True, depth=3, watertight=True)
    assert made[2] is made.attributes
    assert made[3] is made.support


def test_reconstruction_fills_in_the_report_that_is_passed() -> None:
    report = ReconstructionReport()
    made = reconstruct(CORNERS, CORNERS, depth=3, watertight=True, report=report)
    assert made.report is report
    assert report.points == 8


def test_reconstruction_can_be_pickled() -> None:
    made = reconstruct(CORNERS, CORNERS, support=True, depth=3, watertight=True)
    copy = pickle.loads(pickle.dumps(made))
    assert len(copy) == 3
    assert np.array_equal(copy.positions, made.positions)
    assert copy[2] is copy.support
    assert copy.report == made.report
