# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter filters images and shapes for the surfaces that use them.

Arrays are numpy or nested lists of real numbers; images and occupancies come out as float32,
positions as float64. Images have shape (height, width, channels) or (height, width), row 0 at v = 0
(the bottom row, as in Blender and OpenGL); uint8 and uint16 stand for a 255th and a 65535th. Bad
arguments raise ValueError, with a message that names the argument, the value and the allowed ones.
"""

from importlib import import_module
from typing import Any

from . import _native

# Modules are imported when one of their names is first used: Blender imports the package at every
# start, and most sessions use little of it. The stub lists the same names for type checkers.
_NAMES = {
    "._native": "Cancelled available_memory",
    ".images.color": "to_linear to_srgb",
    ".images.cutouts": "keep_coverage",
    ".images.filters": "MIPMAP_FILTERS MipmapFilter PIXEL_FILTERS PixelFilter",
    ".images.mipmaps": "coarser_levels mipmap_error mipmaps seam_contrast",
    ".images.normal_maps": "normal_mipmaps",
    ".images.resizing": "RESIZE_FILTERS resize",
    ".images.texture_use": "fill_transparent fill_unused texel_weights",
    ".images.views": "fit_to_views",
    ".meshes.charts": "uv_charts",
    ".meshes.edges": "MeshEdges mesh_edges",
    ".meshes.holes": "ClosedMesh close_holes",
    ".meshes.measures": "MeshMeasures measure_mesh self_intersections",
    ".meshes.nearest": "CornerPoints NearestPoints corner_points nearest_points",
    ".meshes.solids": "SolidMesh as_solid",
    ".meshes.surface": "Surface",
    ".meshes.topology": "MeshTopology mesh_topology",
    ".points.alignment": "ScanAlignment",
    ".points.choice": "choose_points",
    ".points.clouds": "align_scans find_outliers subsample_points",
    ".points.normals": "estimate_normals grid_normals mesh_normals",
    ".points.painting": "paint_texture",
    ".points.extensions": "POINT_EXTENSIONS",
    ".points.reconstruction": "Reconstruction ReconstructionReport reconstruct reconstruct_file",
    ".points.scan": "ScanPoints",
    ".points.scan_files": "float_step read_points",
    ".points.sources": "file_normals",
    ".points.trimming": "TrimmedSurface trim",
    ".sampling.anisotropic": "sample_anisotropic",
    ".sampling.exact": "sample_ewa sample_exact",
    ".sampling.levels": "FilteredLevels SAMPLING_FILTERS sampling_levels",
    ".sampling.resampling": "resample",
    ".sampling.samples": "sample",
    ".sampling.sampling_table": "SamplingTable TableSection",
    ".sampling.stochastic": "PickedTexels pick_texels sample_stochastic",
    ".shapes._svg.model.warnings": "SvgWarning",
    ".shapes.rasterization": "RASTER_FILTERS rasterize",
    ".shapes.shape": "Shape",
    ".shapes.svg": "SvgDrawing read_svg",
    ".shapes.svg_image": "rasterize_svg",
    ".textures.exr": "write_exr",
    ".textures.ktx2_reader": "Ktx2Info read_ktx2",
    ".textures.texel_formats": "TEXEL_FORMATS TexelFormat",
    ".textures.texture_files": "write_dds write_ktx2",
    ".voxels.contours": "contour",
    ".voxels.octree": "MAX_DEPTH Octree QuadContour TracedContour cube_around voxelize",
    ".voxels.thin_places": "ThinPlaces",
}
"""Public names by module, separated by spaces."""
_HOME_OF = {name: module for module, names in _NAMES.items() for name in names.split()}

__version__ = _native.VERSION
__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME_OF[name], __name__), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
