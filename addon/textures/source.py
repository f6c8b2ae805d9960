# SPDX-License-Identifier: GPL-3.0-or-later

"""An image with its surfaces, the input of all computations of levels."""

from collections.abc import Sequence

from prefilter.workflows.textures.source import Source, reads_encoded, without_pixels

from ..bridge import materials, meshes
from ..bridge.images import Picture
from .choices import Settings

__all__ = ("Source", "on_surfaces", "reads_encoded", "resolve_wrap", "without_pixels")


def on_surfaces(
    picture: Picture, surfaces: meshes.ImageSurfaces, settings: Settings, content: str
) -> Source:
    """Returns an image with its surfaces."""
    wrap, wrap_warnings = resolve_wrap(settings, surfaces.extensions)
    warnings = [*surfaces.problems, *wrap_warnings]
    return Source(picture, surfaces.surfaces, surfaces.objects, settings, content, wrap, warnings)


def resolve_wrap(
    settings: Settings, extensions: Sequence[str]
) -> tuple[tuple[str, str], list[str]]:
    """Returns the wrap modes along u and v, and a warning if Image Texture nodes disagree.

    Args:
        settings: The user's choice.
        extensions: The extension modes of the nodes, most frequent first.
    """
    wrap, warnings = settings.wrap, []
    if wrap == "auto":
        wrap = materials.WRAP_OF_EXTENSION[extensions[0]] if extensions else "repeat"
        if len(extensions) > 1 or "MIRROR" in extensions[:1]:
            warnings.append(
                f"Image Texture nodes extend the image by {', '.join(extensions)}; "
                f"filtered as '{wrap}'"
            )
    return (wrap, wrap if settings.wrap_v == "same" else settings.wrap_v), warnings
