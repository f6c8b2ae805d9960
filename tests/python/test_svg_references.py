# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings of resvg's test suite, compared with its images."""

from pathlib import Path

import numpy as np
import prefilter
import pytest
from drawings import image

RESVG = Path(__file__).resolve().parents[3] / "shared" / "data" / "svg" / "resvg"
# resvg does not know `fr` or percentages for alpha there, and allows a focus outside of its circle.
THEIR_OWN = {"fr=0.2", "fr=0.5", "fr=0.7", "rgba-0-127-0-50percent"}
# Drawn differently from SVG 2 and browsers if a gradient is invalid.
THEIR_OWN |= {"invalid-gradientTransform", "invalid-FuncIRI-with-a-fallback-color"}
THEIR_OWN |= {"invalid-FuncIRI-with-a-currentColor-fallback"}


def test_reference_images():
    pillow = pytest.importorskip("PIL.Image")
    paths = sorted(RESVG.rglob("*.svg"))
    if not paths:
        pytest.skip(f"{RESVG} is not there")
    compared = 0
    for path in paths[::4]:
        drawing = prefilter.read_svg(path, light="srgb")
        if any(warning.kind == "unsupported" for warning in drawing.warnings):
            continue
        with pillow.open(path.with_suffix(".png")) as file:
            theirs = np.asarray(file.convert("RGBA"), np.float64) / 255
        theirs[..., :3] *= theirs[..., 3:]
        height, width = theirs.shape[:2]
        ours = image(drawing.shapes_for(width, height), width, height)[::-1]
        difference = np.abs(ours - theirs).mean() * 255
        assert difference < 2 or path.stem in THEIR_OWN, (path.stem, difference)
        compared += 1
    assert compared > 50
