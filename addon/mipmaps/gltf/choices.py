# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user may set for the textures of a glTF export."""

from dataclasses import dataclass

from ...core.choices import Choice
from ...core.options import one_of, switch
from ..choices import SUPERCOMPRESSIONS

FALLBACKS = {
    "none": Choice("None", "Readers need the extension KHR_texture_basisu"),
    "picture": Choice(
        "PNG or JPEG",
        "A picture beside each texture, for readers without KHR_texture_basisu: JPEG where the "
        "image is a JPEG file, else PNG",
    ),
}


@dataclass(frozen=True)
class GltfSettings:
    """How the textures of a glTF export are written."""

    use_mipmaps: bool = switch(
        False,
        "Prefilter Mipmaps",
        "Export textures as KTX 2 files (UASTC) with mipmaps fitted to the exported surfaces",
        flag="",
    )
    supercompression: str = one_of(
        "zstd",
        "Compression",
        "Supercompression: KTX 2 files are compressed once more, on top of the texture format",
        SUPERCOMPRESSIONS,
        flag="",
    )
    fallback: str = one_of(
        "none", "Fallback", "What other readers show in place of KTX 2 files", FALLBACKS, flag=""
    )
