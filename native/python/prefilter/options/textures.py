# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for baking mipmap levels."""

from dataclasses import dataclass

import prefilter

from .. import _native
from .filters import LABELS
from .options import Choice, number, one_of, switch, text, threads

_PAM = {
    "pam-bilinear": Choice(
        "PAM Bilinear",
        "Parameterization-aware mipmaps (PAM): best fit over the surface, for readers that "
        "interpolate between texels",
    ),
    "pam-trilinear": Choice(
        "PAM Trilinear",
        "Best fit of all levels together: least error for one trilinear lookup per pixel",
    ),
    "pam-box": Choice("PAM Box", "Average of the surface under each texel"),
}
_LEAST_SQUARES = {
    "ls-bilinear": Choice(
        "Least Squares",
        "Best fit over the whole image, for tiled textures and those that many meshes share. Needs "
        "no mesh",
    ),
}
_COVERED = "-covered"


def _kernel_choice(name: str) -> Choice:
    """Returns the label and description of a filter that weighs all its texels alike."""
    kernel = name.removesuffix(_COVERED)
    label = LABELS[kernel]
    if name == kernel:
        return Choice(label, f"{label} over all texels, whether a face uses them or not")
    return Choice(f"{label}, Covered", f"{label} over the texels that a face touches")


_FITS = _PAM | _LEAST_SQUARES
FILTERS = _FITS | {
    filter.name: _kernel_choice(filter.name)
    for filter in sorted(prefilter.MIPMAP_FILTERS, key=lambda filter: filter.needs_surface)
    if filter.name not in _FITS
}
TEXTURE_SPACE_FILTERS = frozenset(
    filter.name for filter in prefilter.MIPMAP_FILTERS if not filter.needs_surface
)
FITTED_FILTERS = frozenset(filter.name for filter in prefilter.MIPMAP_FILTERS if filter.is_fit)
"""Filters that depend on how the levels are looked up."""
SEAM_FILTERS = FITTED_FILTERS - TEXTURE_SPACE_FILTERS
"""Filters that take UV seams into account."""

_MODES = {
    "clamp": Choice("Clamp", "Extend edge pixels"),
    "repeat": Choice("Repeat", "The image tiles the plane"),
    "border": Choice("Border", "Black and transparent"),
}
WRAPS = {
    "auto": Choice(
        "As in Material", "The extension mode of the Image Texture nodes that use the image"
    ),
    **_MODES,
}
WRAPS_V = {"same": Choice("Same as U", "The same as along U"), **_MODES}
BOUNDS = {
    "auto": Choice("Automatic", "0 to 1, extended where the image exceeds it"),
    "unit": Choice("0 to 1", "Values stay between 0 and 1"),
    "positive": Choice("0 and Up", "Values stay at or above 0"),
    "none": Choice("None", "Values may exceed the range of the image"),
}

READERS = {
    "linear": Choice(
        "Linear Light", "GPUs, and float textures everywhere: texels are decoded, then interpolated"
    ),
    "srgb-after": Choice(
        "Encoded",
        "Cycles on 8-bit sRGB images: encoded texels are interpolated, then decoded. Other images "
        "are always read as linear light",
    ),
}

LOOKUPS = {
    "auto": Choice("Automatic", "One Lookup a Pixel for DDS and KTX 2 files, else Supersampled"),
    "supersampled": Choice(
        "Supersampled",
        "Cycles, film: a pixel is the average of many lookups. Levels are fitted to the image "
        "itself",
    ),
    "one-lookup": Choice(
        "One Lookup a Pixel",
        "Games without anisotropic filtering: a pixel shows a single lookup. Levels are fitted to "
        "the image averaged over a pixel",
    ),
    "anisotropic": Choice(
        "Anisotropic",
        "Games with anisotropic filtering, which reads finer levels: levels are fitted to the "
        "image averaged over a wider area",
    ),
    "views": Choice(
        "Fit to Views",
        "Games: all levels are fitted to what pixels show of the model from all around, with and "
        "without anisotropic filtering. Takes several times as long. For color and data of one "
        "model; others get One Lookup a Pixel",
    ),
}

CONTENTS = {
    "auto": Choice(
        "Automatic",
        "Normal map or cut-out if nodes say so, data if the color space is Non-Color, otherwise "
        "color",
    ),
    "color": Choice("Color", "Filtered as light, with alpha as coverage"),
    "data": Choice(
        "Data", "Roughness, masks, packed channels: the stored values, each channel separately"
    ),
    "normal": Choice("Normal Map", "Filtered as vectors and renormalized"),
    "cutout": Choice(
        "Cut-Out", "Color whose alpha test keeps the same share of the surface at every level"
    ),
}
OBJECTS = {
    "all": Choice("All Users", "All visible objects of the scene that use the image"),
    "selected": Choice(
        "Selected", "The objects that use the image and are selected or in Edit Mode"
    ),
}


_LAYOUTS = _native.block_layouts()  # TEXEL_FORMATS would load numpy.


def _size(name: str) -> str:
    """Returns the size of a block format's texels in words, such as "half a byte per texel"."""
    columns, rows, block_bytes, _ = _LAYOUTS[name]
    size = block_bytes / (columns * rows)
    words = {0.25: "a quarter of a byte", 0.5: "half a byte", 1.0: "1 byte"}
    return f"{words.get(size, f'{size:.2g} bytes')} per texel"


TEXTURE_FORMATS = {
    "auto": Choice(
        "Automatic",
        "8-Bit for byte images, Half Float for float images. With Bake All Images, blocks "
        "that suit the content of each image",
    ),
    "blocks": Choice(
        "Blocks by Content",
        "Compressed blocks that suit the content of the image: BC7 for color, BC5 for "
        "normal maps, BC4 for grayscale data, BC6H for light beyond 1",
    ),
    "rgba8": Choice("8-Bit", "4 bytes per texel, uncompressed"),
    "rgba16f": Choice("Half Float", "Scene-linear, 8 bytes per texel, for high dynamic range"),
    "rgba32f": Choice("Float", "Scene-linear, 16 bytes per texel"),
    "bc1": Choice("BC1", f"Compressed color, {_size('bc1')}; alpha is 0 or 1"),
    "bc1-rgb": Choice("BC1 RGB", f"Compressed color without alpha, {_size('bc1-rgb')}"),
    "bc3": Choice("BC3", f"Compressed color and alpha, {_size('bc3')}"),
    "bc4": Choice("BC4", f"Compressed red channel, {_size('bc4')}: masks, roughness"),
    "bc5": Choice("BC5", f"Compressed red and green channels, {_size('bc5')}: normal maps"),
    "bc6h": Choice(
        "BC6H", f"Scene-linear, compressed, {_size('bc6h')}, for high dynamic range without alpha"
    ),
    "bc7": Choice(
        "BC7", f"Compressed color and alpha, {_size('bc7')}; closer to the image than BC1 and BC3"
    ),
    # Formats from here on need KTX 2.
    "etc2-rgb": Choice(
        "ETC2 RGB", f"Phones, even old ones: color without alpha, {_size('etc2-rgb')}"
    ),
    "etc2-rgba": Choice(
        "ETC2 RGBA", f"Phones, even old ones: color and alpha, {_size('etc2-rgba')}"
    ),
    "eac-r11": Choice(
        "EAC R11", f"Phones, even old ones: red channel, {_size('eac-r11')}: masks, roughness"
    ),
    "eac-rg11": Choice(
        "EAC RG11",
        f"Phones, even old ones: red and green channels, {_size('eac-rg11')}: normal maps",
    ),
    "astc-4x4": Choice(
        "ASTC 4x4",
        f"Phones and tablets: color and alpha, {_size('astc-4x4')}; also for normal maps",
    ),
    "astc-6x6": Choice("ASTC 6x6", f"Phones and tablets: color and alpha, {_size('astc-6x6')}"),
    "astc-8x8": Choice("ASTC 8x8", f"Phones and tablets: color and alpha, {_size('astc-8x8')}"),
    "astc-4x4-hdr": Choice(
        "ASTC 4x4 HDR", f"Scene-linear, {_size('astc-4x4-hdr')}, for phones that support ASTC HDR"
    ),
    "astc-6x6-hdr": Choice(
        "ASTC 6x6 HDR", f"Scene-linear, {_size('astc-6x6-hdr')}, for phones that support ASTC HDR"
    ),
    "uastc": Choice(
        "UASTC", f"Web: {_size('uastc')}; loaders transcode it to a format that the device supports"
    ),
    "etc1s": Choice(
        "ETC1S", "Web: the smallest files, for color; loaders transcode it as UASTC, and coarser"
    ),
}
EFFORTS = {
    "fast": Choice("Fast", "For trying things out: coarser, in a fraction of the time"),
    "normal": Choice("Normal", "Close to the best; levels of up to 64 x 64 texels get the best"),
    "best": Choice("Best", "For releases: closest to the image, takes many times as long"),
}
SUPERCOMPRESSIONS = {
    "none": Choice("None", "Readers upload the levels as they are"),
    "zstd": Choice("Zstandard", "Smaller files without loss; readers decompress the levels first"),
}
ROUGHNESS_CHANNELS = {
    "all": Choice("All", "The whole image holds roughness"),
    "red": Choice("Red", "The red channel holds roughness"),
    "green": Choice("Green", "The green channel holds roughness, as in glTF files"),
    "blue": Choice("Blue", "The blue channel holds roughness"),
}


@dataclass(frozen=True)
class Settings:
    """What to bake and where to put it."""

    filter: str = one_of(
        "pam-bilinear",
        "Filter",
        "How the texels of a level are computed from the image",
        FILTERS,
        metavar="FILTER",
    )
    reader: str = one_of(
        "linear",
        "Reader",
        "How renderers will read the levels. PAM Bilinear fits them to that; the preview and the "
        "error plot show the result",
        READERS,
        metavar="READER",
    )
    lookups: str = one_of(
        "auto",
        "Lookups",
        "How many lookups renderers average per pixel. Used by the fitted filters with the "
        "reader Linear Light",
        LOOKUPS,
        metavar="LOOKUPS",
    )
    wrap: str = one_of(
        "auto", "Wrap U", "What lookups outside the image return along U", WRAPS, metavar="MODE"
    )
    wrap_v: str = one_of(
        "same", "Wrap V", "What lookups outside the image return along V", WRAPS_V, metavar="MODE"
    )
    content: str = one_of(
        "auto",
        "Content",
        "The kind of data in the image, which decides how its levels are made",
        CONTENTS,
        metavar="CONTENT",
    )
    threshold: float = number(
        0.5,
        "Threshold",
        "Alpha at or above this is visible",
        low=0.0,
        high=1.0,
        is_above=True,
        subtype="FACTOR",
        metavar="ALPHA",
    )
    roughness: str = text(
        "",
        "Roughness",
        "Roughness image of the same surface; its levels compensate for detail lost in normal map "
        "levels. Leave empty for none",
        flag_description="Roughness image of the same surface, whose levels compensate for detail "
        "lost in normal map levels: its name in the file, or the path of a picture file",
        metavar="NAME",
    )
    roughness_channel: str = one_of(
        "all",
        "Channel",
        "Channel of the roughness image that holds roughness; the others are filtered as data",
        ROUGHNESS_CHANNELS,
        metavar="CHANNEL",
    )
    bounds: str = one_of(
        "auto",
        "Value Range",
        "Range of the texels of every level, in scene-linear values",
        BOUNDS,
        metavar="RANGE",
    )
    levels: int = number(
        0,
        "Levels",
        "Number of levels, including the image itself; 0 makes all. Files always get all levels",
        low=0,
        display={"soft_max": 16},
        metavar="N",
    )
    objects: str = one_of(
        "all",
        "Objects",
        "Objects whose surfaces decide how much each texel counts",
        OBJECTS,
        flag="",
    )
    importance: str = text(
        "",
        "Importance",
        "Vertex group or attribute that makes texels count more: areas are multiplied by it. "
        "Leave empty for none",
        metavar="NAME",
    )
    seam_budget: float = number(
        0.0,
        "Seams",
        "How much the error of a level may rise to hide UV seams: 0 ignores seams, 1 hides most of "
        "them in fine levels. For PAM Bilinear and PAM Trilinear",
        low=0.0,
        high=100.0,
        subtype="PERCENTAGE",
        display={"soft_max": 5.0, "precision": 1},
        flag="--seams",
        metavar="PERCENT",
    )
    use_subdivision_limit: bool = switch(
        True,
        "Subdivision Limit",
        "Treat objects whose last modifier is a Catmull-Clark subdivision as their smooth "
        "limit surface",
    )
    use_frames: bool = switch(
        False,
        "Frame Range",
        "Average over frames of the animation instead of using only the current one",
        flag="",
    )
    frame_start: int = number(1, "Start", "The first frame of the average", flag="")
    frame_end: int = number(250, "End", "The last frame of the average", flag="")
    frame_step: int = number(1, "Step", "Step between the frames of the average", low=1, flag="")
    use_images: bool = switch(True, "", "Keep each level as a packed image", flag="")
    filepath: str = text(
        "",
        "File",
        "File for all levels; its extension is that of the format. If empty, it is named "
        "after the image and written beside the .blend file",
        subtype="FILE_PATH",
        flag="--output",
        flag_description="File for all levels: .exr, .tif or .tx for renderers, .dds or "
        ".ktx2 for engines; .png makes NAME.00.png, NAME.01.png, ...",
        metavar="FILE",
    )
    roughness_filepath: str = text(
        "",
        "Roughness File",
        "File for the levels of the roughness image. If empty, it is named after the image and "
        "written beside the .blend file",
        subtype="FILE_PATH",
        flag="--roughness-output",
        flag_description="File for the levels of the roughness image, like --output",
        metavar="FILE",
    )
    texture_format: str = one_of(
        "auto",
        "Texture Format",
        "Texel format of DDS and KTX 2 files",
        TEXTURE_FORMATS,
        metavar="FORMAT",
    )
    effort: str = one_of(
        "normal",
        "Effort",
        "How long to search for compressed blocks that are close to the image",
        EFFORTS,
        metavar="EFFORT",
    )
    supercompression: str = one_of(
        "none",
        "Compression",
        "Supercompression: KTX 2 files are compressed once more, on top of the texture format",
        SUPERCOMPRESSIONS,
        metavar="SCHEME",
    )
    quality: int = number(
        192,
        "ETC1S Quality",
        "1 makes the smallest files, 255 those closest to the image",
        low=1,
        high=255,
        flag_description="Quality of the texture format etc1s: 1 makes the smallest files, 255 "
        "those closest to the image",
        metavar="N",
    )
    use_multiples_of_4: bool = switch(
        True,
        "Multiples of 4",
        "Stretch images whose sides are no multiples of 4, which readers of BC, UASTC and ETC1S "
        "need",
    )
    threads: int = threads()
