# SPDX-License-Identifier: GPL-3.0-or-later

"""An image on its surfaces in Blender: what levels are computed of, on any thread."""

from collections.abc import Sequence

from prefilter.workflows.mipmaps.source import Source, reads_encoded, without_pixels

from ..bridge import materials, meshes
from ..bridge.images import Picture
from .choices import Settings

__all__ = ("Source", "chosen_wrap", "on_surfaces", "reads_encoded", "without_pixels")


def on_surfaces(
    picture: Picture, found: meshes.ImageSurfaces, settings: Settings, content: str
) -> Source:
    """Returns an image on what was found of its surfaces."""
    wrap, told = chosen_wrap(settings, found.extensions)
    warnings = [*found.problems, *told]
    return Source(picture, found.surfaces, found.objects, settings, content, wrap, warnings)


def chosen_wrap(settings: Settings, extensions: Sequence[str]) -> tuple[tuple[str, str], list[str]]:
    """Returns the wrap mode along u and v, and a warning where nodes do not agree on it.

    Args:
        settings: What a user has chosen.
        extensions: What Image Texture nodes do outside of the image, that of most faces first.
    """
    wrap, told = settings.wrap, []
    if wrap == "auto":
        wrap = materials.WRAP_OF_EXTENSION[extensions[0]] if extensions else "repeat"
        if len(extensions) > 1 or "MIRROR" in extensions[:1]:
            told.append(
                f"Image Texture nodes extend the image by {', '.join(extensions)}; "
                f"filtered as '{wrap}'"
            )
    return (wrap, wrap if settings.wrap_v == "same" else settings.wrap_v), told
