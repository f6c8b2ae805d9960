# SPDX-License-Identifier: GPL-3.0-or-later

"""Prefilter: images and shapes filtered for the surface that uses them.

Arrays are numpy or nested lists of real numbers; images and occupancies come out as float32,
positions as float64. Images have shape (height, width, channels) or (height, width), row 0 at v = 0
(the bottom row, as in Blender and OpenGL); uint8 and uint16 stand for a 255th and a 65535th. Bad
arguments raise ValueError, with a message that names the argument, what was found and what is
allowed.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .version import VERSION

if TYPE_CHECKING:
    from ._native import Cancelled
    from ._svg.warnings import SvgWarning
    from .anisotropic_sampling import sample_anisotropic
    from .charts import uv_charts
    from .color import to_linear, to_srgb
    from .contours import contour
    from .cutout import keep_coverage
    from .exact_sampling import sample_ewa, sample_exact
    from .filtered_levels import SAMPLING_FILTERS, FilteredLevels, sampling_levels
    from .measures import MeshMeasures, measure_mesh
    from .memory import available_memory
    from .mipmap import (
        MIPMAP_FILTERS,
        MipmapFilter,
        coarser_levels,
        mipmap_error,
        mipmaps,
        seam_contrast,
    )
    from .nearest import CornerPoints, NearestPoints, corner_points, nearest_points
    from .normals import normal_mipmaps
    from .points import estimate_normals, grid_normals, mesh_normals
    from .reconstruction import ReconstructionReport, file_normals, reconstruct, reconstruct_file
    from .resampling import resample
    from .resizing import RESIZE_FILTERS, resize
    from .sampling import sample
    from .sampling_tables import SamplingTable, TableSection
    from .scan_files import POINT_EXTENSIONS, ScanPoints, read_points
    from .shapes import RASTER_FILTERS, Shape, rasterize
    from .solid import ClosedMesh, close_holes
    from .solid_meshes import SolidMesh, as_solid
    from .stochastic_sampling import PickedTexels, pick_texels, sample_stochastic
    from .surface import Surface
    from .svg import SvgDrawing, read_svg
    from .texture_use import fill_transparent, fill_unused, texel_weights
    from .textures.exr import write_exr
    from .textures.texture_files import write_dds, write_ktx2
    from .voxel import MAX_DEPTH, Octree, TracedContour, cube_around, voxelize

__version__ = VERSION

__all__ = [
    "MAX_DEPTH",
    "MIPMAP_FILTERS",
    "POINT_EXTENSIONS",
    "RASTER_FILTERS",
    "RESIZE_FILTERS",
    "SAMPLING_FILTERS",
    "Cancelled",
    "ClosedMesh",
    "CornerPoints",
    "FilteredLevels",
    "MeshMeasures",
    "MipmapFilter",
    "NearestPoints",
    "Octree",
    "PickedTexels",
    "ReconstructionReport",
    "SamplingTable",
    "ScanPoints",
    "Shape",
    "SolidMesh",
    "Surface",
    "SvgDrawing",
    "SvgWarning",
    "TableSection",
    "TracedContour",
    "as_solid",
    "available_memory",
    "close_holes",
    "coarser_levels",
    "contour",
    "corner_points",
    "cube_around",
    "estimate_normals",
    "file_normals",
    "fill_transparent",
    "fill_unused",
    "grid_normals",
    "keep_coverage",
    "measure_mesh",
    "mesh_normals",
    "mipmap_error",
    "mipmaps",
    "nearest_points",
    "normal_mipmaps",
    "pick_texels",
    "rasterize",
    "read_points",
    "read_svg",
    "reconstruct",
    "reconstruct_file",
    "resample",
    "resize",
    "sample",
    "sample_anisotropic",
    "sample_ewa",
    "sample_exact",
    "sample_stochastic",
    "sampling_levels",
    "seam_contrast",
    "texel_weights",
    "to_linear",
    "to_srgb",
    "uv_charts",
    "voxelize",
    "write_dds",
    "write_exr",
    "write_ktx2",
]

# Modules are imported when one of their names is first used: Blender imports the package at every
# start, and most sessions use little of it.
_HOMES = {
    "_native": "Cancelled",
    "_svg.warnings": "SvgWarning",
    "anisotropic_sampling": "sample_anisotropic",
    "charts": "uv_charts",
    "color": "to_linear to_srgb",
    "contours": "contour",
    "cutout": "keep_coverage",
    "exact_sampling": "sample_ewa sample_exact",
    "filtered_levels": "SAMPLING_FILTERS FilteredLevels sampling_levels",
    "measures": "MeshMeasures measure_mesh",
    "memory": "available_memory",
    "mipmap": "MIPMAP_FILTERS MipmapFilter coarser_levels mipmap_error mipmaps seam_contrast",
    "nearest": "CornerPoints NearestPoints corner_points nearest_points",
    "normals": "normal_mipmaps",
    "points": "estimate_normals grid_normals mesh_normals",
    "reconstruction": "ReconstructionReport file_normals reconstruct reconstruct_file",
    "resampling": "resample",
    "resizing": "RESIZE_FILTERS resize",
    "sampling": "sample",
    "sampling_tables": "SamplingTable TableSection",
    "scan_files": "POINT_EXTENSIONS ScanPoints read_points",
    "shapes": "RASTER_FILTERS Shape rasterize",
    "solid": "ClosedMesh close_holes",
    "solid_meshes": "SolidMesh as_solid",
    "stochastic_sampling": "PickedTexels pick_texels sample_stochastic",
    "surface": "Surface",
    "svg": "SvgDrawing read_svg",
    "texture_use": "fill_transparent fill_unused texel_weights",
    "textures.exr": "write_exr",
    "textures.texture_files": "write_dds write_ktx2",
    "voxel": "MAX_DEPTH Octree TracedContour cube_around voxelize",
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
