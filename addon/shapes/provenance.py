# SPDX-License-Identifier: GPL-3.0-or-later

"""The inputs of a rasterized image, stored with the image so that it can be updated in place."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..core.options import declared
from ..core.wording import Sentence
from .choices import RasterizeSettings
from .views import PlanePose


@dataclass(frozen=True)
class Request:
    """The shapes to rasterize.

    Attributes:
        source: "curves", "uv" or "svg".
        objects: The curves and texts, the first of which may define the view; or the mesh.
        filepath: The absolute path of the SVG file.
    """

    source: str
    objects: Sequence[bpy.types.Object] = ()
    filepath: str = ""


def store_request(
    image: bpy.types.Image,
    source: str,
    names: Sequence[str],
    settings: RasterizeSettings,
    pose: PlanePose | None,
) -> None:
    """Stores the inputs of an image with it, without deleted objects.

    Paths in the folder of the .blend file are stored relative to it.
    """
    stored = image.prefilter_drawn
    for name, _, option in declared(RasterizeSettings):
        if option.label:
            setattr(stored, name, getattr(settings, name))
    stored.source = source
    if source == "svg":
        stored.filepath = _relative(settings.filepath)
    stored.objects.clear()
    for name in names:
        obj = bpy.data.objects.get(name)
        if obj is not None:
            stored.objects.add().obj = obj
    stored.has_place = pose is not None
    if pose is not None:
        stored.rotation = pose.rotation
        stored.box = pose.box.ravel().tolist()
    stored.is_drawn = True


def is_drawn(image: bpy.types.Image | None) -> bool:
    """Returns whether an image was made by Rasterize."""
    return image is not None and image.prefilter_drawn.is_drawn


def sources_of(image: bpy.types.Image) -> list[bpy.types.Object]:
    """Returns the objects that an image shows, in their order, without deleted ones.

    A deleted object stays in the file as long as the image references it.
    """
    objects = [entry.obj for entry in image.prefilter_drawn.objects]
    return [obj for obj in objects if obj is not None and obj.users_collection]


def latest_image() -> bpy.types.Image | None:
    """Returns the newest rasterized image."""
    drawn = [image for image in bpy.data.images if is_drawn(image)]
    return max(drawn, key=lambda image: image.session_uid, default=None)


def latest_image_of(obj: bpy.types.Object) -> bpy.types.Image | None:
    """Returns the newest image of an object, or of several of which it is the first."""
    drawn = [image for image in bpy.data.images if is_drawn(image) and _shows_first(image, obj)]
    return max(drawn, key=lambda image: image.session_uid, default=None)


def _shows_first(image: bpy.types.Image, obj: bpy.types.Object) -> bool:
    objects = image.prefilter_drawn.objects
    return len(objects) > 0 and objects[0].obj == obj


def load_request(image: bpy.types.Image) -> tuple[Request, RasterizeSettings, list[str]]:
    """Returns the inputs of an image, its settings, and warnings about deleted objects.

    Raises:
        ValueError: All objects were deleted.
    """
    stored = image.prefilter_drawn
    settings = stored.to_settings()
    objects = sources_of(image)
    if stored.source != "svg" and not objects:
        raise ValueError(Sentence("image '{}': the objects that it shows are gone", image.name))
    gone = len(stored.objects) - len(objects)
    warnings: list[str] = []
    if gone:
        text = "{} objects that the image showed are gone"
        if gone == 1:
            text = "1 object that the image showed is gone"
        warnings.append(Sentence(text, gone))
    return Request(stored.source, objects, settings.filepath), settings, warnings


def _relative(path: str) -> str:
    if not bpy.data.is_saved:
        return path
    try:
        relative = bpy.path.relpath(path)
    except ValueError:  # Another drive.
        return path
    return path if relative.startswith("//..") else relative
