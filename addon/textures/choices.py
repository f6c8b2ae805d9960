# SPDX-License-Identifier: GPL-3.0-or-later

"""Options of bakes, previews and error plots."""

from dataclasses import dataclass

from prefilter.options.textures import (
    BOUNDS,
    CONTENTS,
    EFFORTS,
    FILTERS,
    FITTED_FILTERS,
    LOOKUPS,
    OBJECTS,
    READERS,
    ROUGHNESS_CHANNELS,
    SEAM_FILTERS,
    SUPERCOMPRESSIONS,
    TEXTURE_FORMATS,
    TEXTURE_SPACE_FILTERS,
    WRAPS,
    WRAPS_V,
    Settings,
)

from ..core.choices import Choice
from ..core.options import number, one_of, switch, text

__all__ = (
    "BOUNDS",
    "CONTENTS",
    "EFFORTS",
    "FILE_FORMATS",
    "FILTERS",
    "FITTED_FILTERS",
    "LEVEL_CHOICES",
    "LOOKUPS",
    "MODEL_OBJECTS",
    "MODEL_RESULTS",
    "NOT_OF_MODELS",
    "OBJECTS",
    "READERS",
    "REMOVED",
    "RESULTS",
    "ROUGHNESS_CHANNELS",
    "SEAM_FILTERS",
    "SUPERCOMPRESSIONS",
    "TEXTURE_FORMATS",
    "TEXTURE_SPACE_FILTERS",
    "WRAPS",
    "WRAPS_V",
    "ModelSettings",
    "PlotSettings",
    "Preferences",
    "PreviewSettings",
    "RemoveSettings",
    "ResultSettings",
    "Settings",
)

MODEL_OBJECTS = {
    "auto": Choice("Automatic", "The selected meshes, or all visible ones where none is selected"),
    "scene": Choice("Scene", "All visible meshes of the scene"),
    "selected": Choice("Selected", "The selected meshes"),
}
RESULTS = {
    "preview": Choice(
        "Preview", "Draw the levels in the Image editor, in place of the image; nothing is kept"
    ),
    "images": Choice(
        "Images",
        "Keep each level as a packed image named after the image, with .mip01, .mip02 and so on",
    ),
    "file": Choice("File", "Write all levels to a texture file"),
}
MODEL_RESULTS = {
    "images": RESULTS["images"],
    "file": Choice("Files", "Write the levels of each image to a texture file of its own"),
}
FILE_FORMATS = {
    "ktx2": Choice("KTX 2", "For engines and web viewers"),
    "dds": Choice("DDS", "For engines"),
    "exr": Choice("OpenEXR", "For renderers: tiled, scene-linear half floats"),
    "tx": Choice("TX", "For renderers: tiled TIFF with the stored values of the image"),
    "tif": Choice("TIFF", "Like TX, with the extension .tif"),
    "png": Choice("PNG", "One file per level"),
}


@dataclass(frozen=True)
class ResultSettings:
    """The destination of an image's levels; commands infer it from other flags."""

    result: str = one_of("images", "Result", "What to do with the levels", RESULTS, flag="")
    file_format: str = one_of(
        "ktx2", "Format", "File format", FILE_FORMATS, flag="", preference="file_format"
    )


NOT_OF_MODELS = frozenset(
    {
        *("content", "threshold", "roughness", "roughness_channel", "roughness_filepath"),
        *("objects", "levels", "use_images", "filepath"),
    }
)
"""The fields of `Settings` that a model bake determines itself, or replaces by others."""


@dataclass(frozen=True)
class ModelSettings:
    """Which images of a model to bake, and where to put them; used together with `Settings`."""

    objects: str = one_of(
        "auto",
        "Objects",
        "Objects whose images are baked, and whose surfaces decide how much each texel counts",
        MODEL_OBJECTS,
        flag="",
    )
    material: str = text(
        "",
        "Material",
        "Bake only the images of this material. Leave empty for those of all materials",
        metavar="NAME",
        flag_description="with --all, bake only the images of this material",
    )
    result: str = one_of("file", "Result", "What to do with the levels", MODEL_RESULTS, flag="")
    folder: str = text(
        "//mipmaps/",
        "Folder",
        "Folder for the files, one per image and named after it. It is created if it is missing",
        subtype="DIR_PATH",
        flag="",
    )
    file_format: str = one_of(
        "ktx2",
        "Format",
        "Format of the files in the folder",
        FILE_FORMATS,
        flag="--format",
        metavar="FORMAT",
        flag_description="with --all, the files in the folder of --output",
        preference="file_format",
    )


@dataclass(frozen=True)
class Preferences:
    """Defaults in the preferences."""

    file_format: str = one_of(
        ModelSettings.file_format,
        "File Format",
        "Default format of the files that bakes write",
        FILE_FORMATS,
    )


REMOVED = {
    "preview": Choice("Preview", "The levels that the editors draw"),
    "images": Choice("Images", "The level images; their users then use the image itself"),
    "cache": Choice(
        "Texture Cache",
        "The files in Cycles' texture cache that have baked levels. Cycles generates its "
        "own again; this cannot be undone",
    ),
}


@dataclass(frozen=True)
class RemoveSettings:
    """Options of `prefilter.remove_levels`."""

    kinds: tuple[str, ...] = one_of(("preview", "images"), "Levels", "What to remove", REMOVED)
    use_all: bool = switch(
        False, "All Images", "Remove the levels of all images in this file, not just one"
    )


LEVEL_CHOICES = {
    "distance": Choice(
        "Distance", "The levels that a GPU reads there, and as if the object were farther away"
    ),
    "level": Choice("Mip Value", "One level everywhere"),
}


@dataclass(frozen=True)
class PreviewSettings:
    """Options of previews, in addition to those of a bake."""

    compare: str = one_of(
        "box", "Compare With", "The filter on the left of the wipe", FILTERS, flag=""
    )
    choice: str = one_of(
        "distance", "Levels by", "Which level each pixel of a 3D view shows", LEVEL_CHOICES, flag=""
    )
    distance: float = number(
        1.0,
        "Times as Far",
        "How many times as far away as they are objects get the levels of",
        low=1.0,
        high=1024.0,
        display={"soft_max": 64.0, "precision": 1, "step": 100},
        flag="",
    )


@dataclass(frozen=True)
class PlotSettings:
    """Options of error plots; the default filters are those of figure 7.7."""

    filters: tuple[str, ...] = one_of(
        ("pam-bilinear", "pam-trilinear", "pam-box", "box"),
        "Filters",
        "The filters to compare",
        FILTERS,
        flag_description="The filters to compare; by default without pam-trilinear for --reader "
        "srgb-after",
        metavar="FILTER",
    )
