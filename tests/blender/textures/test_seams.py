# SPDX-License-Identifier: GPL-3.0-or-later

"""The report of a bake on UV seams: the contrast across them, compared to the library's."""

import re

import bpy
import numpy as np
import prefilter
import pytest
import scenes


def contrasts(note):
    found = re.findall(r"(\d+): (\S+) > (\S+?)(?:,|$)", note)
    assert [int(level) for level, _, _ in found] == list(range(1, len(found) + 1))
    return np.array([[float(before), float(after)] for _, before, after in found]).T


PERIOD = 0.3


@pytest.fixture
def paint():
    """Two squares side by side; the second one is a period of the stripes higher in the image."""
    rows = (np.arange(64) + 0.5) / 64
    random = np.random.default_rng(0)
    waves = sum(
        random.normal() * np.sin(2 * np.pi * (k * rows / PERIOD + random.random()))
        for k in range(1, 5)
    )
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.1 * waves[:, None, None]
    image = scenes.image("Paint", pixels, colorspace="Non-Color", is_float=True)
    mesh = bpy.data.meshes.new("Sheet")
    corners = [(x, y, 0) for x in range(3) for y in range(2)]
    mesh.from_pydata(corners, [], [(0, 2, 3, 1), (2, 4, 5, 3)])
    places = [
        (0.05, 0),
        (0.45, 0),
        (0.45, 1),
        (0.05, 1),
        (0.55, 1),
        (0.95, 1),
        (0.95, 2),
        (0.55, 2),
    ]
    uvs = [(u, 0.1 + PERIOD * v) for u, v in places]
    mesh.uv_layers.new().uv.foreach_set("vector", np.ravel(uvs))
    mesh.materials.append(scenes.material("Stripes", image))
    sheet = bpy.data.objects.new("Sheet", mesh)
    bpy.context.collection.objects.link(sheet)
    return image, sheet


@pytest.mark.parametrize("filter", ["pam-bilinear", "pam-trilinear"])
def test_seams_are_compared(bake, addon, paint, filter):
    image, sheet = paint
    outcome = bake(image, [sheet], filter=filter, seam_budget=1.0)
    (note,) = outcome.notes
    assert "'Paint'" in note
    without, weighed = contrasts(note)
    assert len(without) == 6
    assert (weighed[1:] <= without[1:]).all()
    assert weighed[2] < 0.7 * without[2]

    surface = addon("bridge.meshes").image_surfaces([sheet], image, scenes.depsgraph()).surfaces
    for budget, found in ((0.0, without), (0.01, weighed)):
        levels = prefilter.mipmaps(
            scenes.pixels("Paint")[..., :3].copy(),
            surface,
            filter=filter,
            wrap="repeat",
            bounds=(0, 1),
            premultiplied=True,
            seam_budget=budget,
        )
        expected = prefilter.seam_contrast(levels[1:], surface, wrap="repeat")
        np.testing.assert_allclose(found, expected, rtol=6e-3, atol=1e-6)


def test_no_report_without_the_setting_or_a_seam(bake, paint):
    image, sheet = paint
    assert bake(image, [sheet]).notes == []
    assert bake(image, [sheet], filter="pam-box", seam_budget=1.0).notes == []
    quad = scenes.textured_quad(image)
    assert bake(image, [quad], seam_budget=1.0).notes == []


def test_the_comparison_can_be_cancelled(bake, paint):
    image, sheet = paint
    told = []

    def progress(done):
        told.append(done)
        return done < 0.7

    with pytest.raises(prefilter.Cancelled):
        bake(image, [sheet], seam_budget=1.0, progress=progress)
    assert told == sorted(told)
    assert "Paint.mip01" not in bpy.data.images
