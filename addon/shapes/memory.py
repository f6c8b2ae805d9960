# SPDX-License-Identifier: GPL-3.0-or-later

"""How an image was made, which the image remembers, so that it can be made again in place."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..core.options import declared
from .choices import RasterizeSettings


@dataclass(frozen=True)
class Request:
    """What to make an image of.

    Attributes:
        source: "curves", "uv" or "svg".
        objects: The curves and texts, that which is seen along its Z axis first; or the mesh.
        filepath: The absolute path of the SVG file.
    """

    source: str
    objects: Sequence[bpy.types.Object] = ()
    filepath: str = ""


def remember(
    image: bpy.types.Image, source: str, names: Sequence[str], settings: RasterizeSettings
) -> None:
    """Keeps with an image what it was made of and how; names of objects that are gone are left out.

    A path in the folder of the .blend file is kept relative to that.
    """
    kept = image.prefilter_drawn
    for name, _, option in declared(RasterizeSettings):
        if option.label:
            setattr(kept, name, getattr(settings, name))
    kept.source = source
    if source == "svg":
        kept.filepath = _relative(settings.filepath)
    kept.objects.clear()
    for name in names:
        obj = bpy.data.objects.get(name)
        if obj is not None:
            kept.objects.add().obj = obj
    kept.is_drawn = True


def is_drawn(image: bpy.types.Image | None) -> bool:
    """Tells whether an image remembers how it was made."""
    return image is not None and image.prefilter_drawn.is_drawn


def recall(image: bpy.types.Image) -> tuple[Request, RasterizeSettings, list[str]]:
    """Returns what an image was made of, how, and warnings of what is gone.

    Raises:
        ValueError: All of it is gone.
    """
    kept = image.prefilter_drawn
    settings = kept.to_settings()
    found = [entry.obj for entry in kept.objects]
    # An object that was deleted stays in the file for as long as the image knows it.
    objects = [obj for obj in found if obj is not None and obj.users_collection]
    if kept.source != "svg" and not objects:
        raise ValueError(f"image '{image.name}': the objects that it shows are gone")
    gone = len(found) - len(objects)
    warnings = []
    if gone:
        what = "1 object that the image showed is" if gone == 1 else f"{gone} objects are"
        warnings.append(f"{what} gone")
    return Request(kept.source, objects, settings.filepath), settings, warnings


def _relative(path: str) -> str:
    if not bpy.data.is_saved:
        return path
    try:
        relative = bpy.path.relpath(path)
    except ValueError:  # Another drive.
        return path
    return path if relative.startswith("//..") else relative
