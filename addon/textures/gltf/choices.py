# SPDX-License-Identifier: GPL-3.0-or-later

"""Options for the textures of glTF exports and imports."""

from dataclasses import dataclass

from ...core.choices import Choice
from ...core.options import number, one_of, switch
from ..choices import EFFORTS, SUPERCOMPRESSIONS

FALLBACKS = {
    "none": Choice("None", "Readers need the extension KHR_texture_basisu"),
    "picture": Choice(
        "PNG or JPEG",
        "A picture beside each texture, for readers without KHR_texture_basisu: JPEG where the "
        "image is a JPEG file, else PNG",
    ),
}


TEXTURE_FORMATS = {
    "uastc": Choice("UASTC", "Close to the image"),
    "etc1s": Choice("ETC1S", "Files several times smaller, coarser; normal maps stay UASTC"),
}


@dataclass(frozen=True)
class GltfSettings:
    """Options for the textures of a glTF export."""

    use_mipmaps: bool = switch(
        False,
        "Prefilter Mipmaps",
        "Export textures as KTX 2 files with mipmaps fitted to the exported surfaces",
        flag="",
    )
    texture_format: str = one_of(
        "uastc",
        "Format",
        "Texel format of the KTX 2 files; loaders transcode it to one that the device supports",
        TEXTURE_FORMATS,
        flag="",
    )
    effort: str = one_of(
        "normal",
        "Effort",
        "How long to search for compressed blocks that are close to the image",
        EFFORTS,
        flag="",
    )
    supercompression: str = one_of(
        "zstd",
        "Compression",
        "Supercompression: KTX 2 files in UASTC are compressed once more, on top of the format",
        SUPERCOMPRESSIONS,
        flag="",
    )
    quality: int = number(
        192,
        "ETC1S Quality",
        "1 makes the smallest files, 255 those closest to the image",
        low=1,
        high=255,
        flag="",
    )
    fallback: str = one_of(
        "none",
        "Fallback",
        "Images that other readers show in place of KTX 2 files",
        FALLBACKS,
        metavar="KIND",
        flag_description="With a .glb or .gltf file as --output, the images that other readers "
        "show in place of KTX 2 files",
    )


@dataclass(frozen=True)
class GltfImportSettings:
    """Options for the KTX 2 files of a glTF import."""

    keep_levels: bool = switch(
        False,
        "Keep Levels",
        "Import the mipmaps of KTX 2 textures as images too, to compare them with others",
        flag="",
    )
