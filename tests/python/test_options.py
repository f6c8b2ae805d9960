# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of the native module: each can be set, and defaults equal the package's."""

import inspect

import pytest
from prefilter import _native
from prefilter._border.samples import SAMPLE_CHECKS
from prefilter.images import cutouts, mipmaps, normal_maps, resizing
from prefilter.meshes import solids, surface
from prefilter.points import reconstruction
from prefilter.sampling import (
    anisotropic,
    exact,
    levels,
    resampling,
    samples,
    sampling_table,
    stochastic,
)
from prefilter.shapes import rasterization, shape
from prefilter.voxels import contours, octree

OPTIONS = [
    (mipmaps.mipmaps, _native.MipmapOptions, mipmaps._CHECKS),
    (mipmaps.coarser_levels, _native.MipmapOptions, mipmaps._CHECKS),
    (normal_maps.normal_mipmaps, _native.NormalMipmapOptions, normal_maps._CHECKS),
    (cutouts.keep_coverage, _native.CoverageOptions, cutouts._CHECKS),
    (solids.as_solid, _native.SolidOptions, solids._CHECKS),
    (resizing.resize, _native.ResizeOptions, resizing._CHECKS),
    (levels.sampling_levels, _native.SamplingLevelsOptions, levels._CHECKS),
    (samples.sample, _native.SampleOptions, SAMPLE_CHECKS),
    (stochastic.sample_stochastic, _native.SampleOptions, SAMPLE_CHECKS),
    (stochastic.pick_texels, _native.SampleOptions, SAMPLE_CHECKS),
    (anisotropic.sample_anisotropic, _native.AnisotropicOptions, anisotropic._CHECKS),
    (exact.sample_exact, _native.ExactOptions, exact._CHECKS),
    (exact.sample_ewa, _native.EllipticalOptions, SAMPLE_CHECKS),
    (resampling.resample, _native.ResampleOptions, resampling._CHECKS),
    (sampling_table.SamplingTable.build, _native.TableShape, sampling_table._CHECKS),
    (rasterization.rasterize, _native.RasterOptions, rasterization._CHECKS),
    (shape.Shape.stroked, _native.StrokeOptions, shape._STROKE_CHECKS),
    (surface.Surface.from_subdivision, _native.SubdivisionOptions, surface._SUBDIVISION_CHECKS),
    (contours.contour, _native.ContourOptions, contours._CHECKS),
    (octree.Octree.contour, _native.ContourOptions, octree._CONTOUR_CHECKS),
    (octree.Octree.traced_contour, _native.ContourOptions, contours.CLEANUP_CHECKS),
    (octree.Octree.quad_contour, _native.ContourOptions, octree._QUAD_CHECKS),
    (reconstruction.reconstruct, _native.ReconstructOptions, reconstruction.CHECKS),
    (reconstruction.reconstruct_file, _native.ReconstructOptions, reconstruction.CHECKS),
]
# The package's functions set these themselves.
INTERNAL = {"are_sides_known", "check_normals", "folder", "grid", "slices", "support"}


def options_of(kind: type) -> set[str]:
    return {name for name, member in vars(kind).items() if isinstance(member, property)}


@pytest.mark.parametrize(("function", "kind", "checks"), OPTIONS)
def test_defaults_are_those_of_the_library(function, kind, checks):
    options, parameters = kind(), inspect.signature(function).parameters
    for name, check in checks.items():
        default = parameters[name].default
        if default is not inspect.Parameter.empty and vars(kind)[name].fget is not None:
            assert getattr(options, name) == check(default), name


@pytest.mark.parametrize(("function", "kind", "checks"), OPTIONS)
def test_every_option_is_an_argument(function, kind, checks):
    if function is octree.Octree.traced_contour:  # by "sharp" alone
        assert options_of(kind) - checks.keys() == {"interpolant", "isovalue"}
    elif function is octree.Octree.quad_contour:  # no cleanup, and 1/2
        assert options_of(kind) - checks.keys() == {"adaptivity", "cleanup", "isovalue"}
    else:
        assert options_of(kind) - INTERNAL == checks.keys()
