# SPDX-License-Identifier: GPL-3.0-or-later

"""How an image was made, which the image remembers, so that it can be made again in place."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..core.options import declared
from ..core.wording import Sentence
from .choices import RasterizeSettings
from .framing import Place


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
    image: bpy.types.Image,
    source: str,
    names: Sequence[str],
    settings: RasterizeSettings,
    place: Place | None,
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
    kept.has_place = place is not None
    if place is not None:
        kept.rotation = place.rotation
        kept.box = place.box.ravel().tolist()
    kept.is_drawn = True


def is_drawn(image: bpy.types.Image | None) -> bool:
    """Tells whether an image remembers how it was made."""
    return image is not None and image.prefilter_drawn.is_drawn


def sources_of(image: bpy.types.Image) -> list[bpy.types.Object]:
    """Returns the objects that an image was made of and that are still there, the first first.

    An object that was deleted stays in the file for as long as the image knows it.
    """
    found = [entry.obj for entry in image.prefilter_drawn.objects]
    return [obj for obj in found if obj is not None and obj.users_collection]


def made_last() -> bpy.types.Image | None:
    """Returns the image that was made last."""
    drawn = [image for image in bpy.data.images if is_drawn(image)]
    return max(drawn, key=lambda image: image.session_uid, default=None)


def made_of(obj: bpy.types.Object) -> bpy.types.Image | None:
    """Returns the image that was made last of an object, and of others that were selected too."""
    found = [image for image in bpy.data.images if is_drawn(image) and _shows_first(image, obj)]
    return max(found, key=lambda image: image.session_uid, default=None)


def _shows_first(image: bpy.types.Image, obj: bpy.types.Object) -> bool:
    objects = image.prefilter_drawn.objects
    return len(objects) > 0 and objects[0].obj == obj


def recall(image: bpy.types.Image) -> tuple[Request, RasterizeSettings, list[str]]:
    """Returns what an image was made of, how, and warnings of what is gone.

    Raises:
        ValueError: All of it is gone.
    """
    kept = image.prefilter_drawn
    settings = kept.to_settings()
    objects = sources_of(image)
    if kept.source != "svg" and not objects:
        raise ValueError(Sentence("image '{}': the objects that it shows are gone", image.name))
    gone = len(kept.objects) - len(objects)
    warnings: list[str] = []
    if gone:
        text = "{} objects that the image showed are gone"
        if gone == 1:
            text = "1 object that the image showed is gone"
        warnings.append(Sentence(text, gone))
    return Request(kept.source, objects, settings.filepath), settings, warnings


def _relative(path: str) -> str:
    if not bpy.data.is_saved:
        return path
    try:
        relative = bpy.path.relpath(path)
    except ValueError:  # Another drive.
        return path
    return path if relative.startswith("//..") else relative
