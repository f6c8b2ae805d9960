# SPDX-License-Identifier: GPL-3.0-or-later

"""The add-on and the package have the same defaults."""

import inspect

import prefilter
import pytest

# Values of settings that correspond to omitted arguments of the package.
ABSENT = {
    "levels": (0, None),
    "roughness": ("", None),
    "trim": (0.0, None),
    "memory_limit": (0, None),
    "classes": ("", None),
    "box": ((0.0,) * 6, None),
    "background": ("transparent", None),
    "table": ("", None),
    "target": ("filter", None),
    # Without a thickness, occupancies are exact.
    "thickness": (1.5, 0.0),
}


def defaults(function):
    parameters = inspect.signature(function).parameters.values()
    return {one.name: one.default for one in parameters if one.default is not one.empty}


@pytest.mark.parametrize(
    ("settings", "function", "least"),
    [
        ("textures.choices.Settings", prefilter.mipmaps, 5),
        ("textures.choices.Settings", prefilter.normal_mipmaps, 3),
        ("textures.choices.Settings", prefilter.keep_coverage, 2),
        ("shapes.choices.RasterizeSettings", prefilter.rasterize, 3),
        ("points.choices.ScanSettings", prefilter.reconstruct, 8),
        ("points.choices.ScanSettings", prefilter.reconstruct_file, 8),
        ("images.choices.ResizeSettings", prefilter.resize, 3),
        ("images.choices.ResampleSettings", prefilter.resample, 4),
        ("images.choices.TableSettings", prefilter.SamplingTable.build, 7),
        ("voxels.choices.VoxelSettings", prefilter.voxelize, 2),
        ("voxels.choices.VoxelSettings", prefilter.Octree.contour, 2),
    ],
)
def test_defaults_agree(addon, settings, function, least):
    module, _, name = settings.rpartition(".")
    declared = getattr(addon(module), name)()
    compared = 0
    for parameter, default in defaults(function).items():
        # Blender knows more about these: the material, the content of the image, and that people
        # look at the triangles.
        if parameter in {"wrap", "bounds", "adaptivity"}:
            continue
        # Automatic, the resolution has no depth.
        if parameter == "depth" and getattr(declared, "resolution", "") == "auto":
            assert default is None
            compared += 1
            continue
        for field in (parameter, f"use_{parameter}"):
            if hasattr(declared, field):
                value = getattr(declared, field)
                found = ABSENT.get(field, ())
                assert (value, default) == found if found else value == default, field
                compared += 1
    assert compared >= least


def test_the_format_of_texture_files(addon):
    expected = addon("textures.choices").Settings().texture_format
    for write in (prefilter.write_dds, prefilter.write_ktx2):
        assert defaults(write)["format"] == expected
