"""The levels of an image as image datablocks."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from .images import FloatArray, Picture
from .new_images import new_packed, suffixed

_SOURCE_KEY = "prefilter_level_of"


@dataclass(frozen=True)
class StagedLevels:
    """Level images that are finished, and replace none yet.

    Attributes:
        picture: Level 0.
        images: Levels 1, 2, ...
    """

    picture: Picture
    images: list[bpy.types.Image]

    def commit(self) -> list[str]:
        """Gives the images their names, and puts each in the place of that of an earlier bake.

        Returns:
            The names of the images. One that belongs to another image gets a number behind it.
        """
        for number, image in enumerate(self.images, start=1):
            name = level_name(self.picture.name, number)
            earlier = _earlier_level(name, self.picture)
            image[_SOURCE_KEY] = self.picture.full_name
            if earlier is not None:
                earlier.user_remap(image)
                bpy.data.images.remove(earlier)
            image.name = name
        return [image.name for image in self.images]

    def discard(self) -> None:
        """Removes the images."""
        for image in self.images:
            bpy.data.images.remove(image)
        self.images.clear()


def stage_levels(picture: Picture, levels: Sequence[FloatArray]) -> StagedLevels:
    """Makes packed image datablocks of levels, to be named `<image>.mip1`, `<image>.mip2` ...

    An image of an earlier bake is replaced, so that materials that showed it show the new one.
    Deeper levels of an earlier bake are left as they are. Every image keeps a fake user, as Blender
    saves no unused datablock.

    A byte level has the picture's colour space, and straight alpha where the picture's is
    Premultiplied. A float level is scene-linear (or data, like the picture), with associated alpha.
    Only these survive packing, saving and loading: Blender's packing does not convert colours, and
    its loading does.

    Args:
        picture: Level 0.
        levels: Levels 1, 2, ... in the encoding of `picture.stored`.

    Raises:
        OSError: A level cannot be made; no image is left behind.
    """
    staged = StagedLevels(picture, [])
    try:
        for number, level in enumerate(levels, start=1):
            name = level_name(picture.name, number)
            staged.images.append(new_packed(name, picture, level))
    except RuntimeError as error:
        staged.discard()
        raise OSError(f"image '{picture.name}': cannot make level {number}: {error}") from error
    except BaseException:
        staged.discard()
        raise
    return staged


def level_name(image_name: str, number: int) -> str:
    """Returns the name of the image that holds a level.

    A base that is too long is cut, and gets a hash of what it was.
    """
    return suffixed(image_name, f"mip{number}")


def _earlier_level(name: str, picture: Picture) -> bpy.types.Image | None:
    """Returns the image of that name, or of that name and a number, that a bake made before."""
    form = re.compile(re.escape(name) + r"(\.\d{3,})?")
    found = [
        image
        for image in bpy.data.images
        if image.library is None
        and form.fullmatch(image.name)
        and image.get(_SOURCE_KEY) == picture.full_name
    ]
    return min(found, key=lambda image: image.name, default=None)
