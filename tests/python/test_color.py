# SPDX-License-Identifier: GPL-3.0-or-later

"""Color encodings against the standard's formulas."""

import numpy as np
import prefilter
import pytest


def decode(value: float) -> float:
    """The decoding of IEC 61966-2-1, in double precision."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def test_srgb_is_the_standard_curve():
    values = np.linspace(0, 1, 256)
    image = values.reshape(16, 16, 1).astype(np.float32)
    expected = np.array([decode(float(v)) for v in image.ravel()])
    assert np.abs(prefilter.to_linear(image).ravel() - expected).max() < 1e-6


def test_encoding_inverts_decoding():
    image = np.linspace(-1, 4, 480).reshape(10, 16, 3).astype(np.float32)
    assert np.abs(prefilter.to_srgb(prefilter.to_linear(image)) - image).max() < 1e-5


def test_alpha_stays():
    image = np.full((2, 2, 4), 0.5, np.float32)
    assert (prefilter.to_linear(image)[..., 3] == 0.5).all()
    assert (prefilter.to_srgb(image)[..., 3] == 0.5).all()
    assert prefilter.to_linear(image)[0, 0, 0] == pytest.approx(0.21404114, abs=1e-6)
