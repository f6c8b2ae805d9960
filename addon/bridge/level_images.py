# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels of an image as image datablocks."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from .images import FloatArray, Picture
from .new_images import new_packed, suffixed

_SOURCE_KEY = "prefilter_level_of"
_MAX_LEVELS = 31


@dataclass(frozen=True)
class StagedLevels:
    """Finished level images that have not replaced earlier ones yet.

    Attributes:
        picture: Level 0.
        images: Levels 1, 2, ...
    """

    picture: Picture
    images: list[bpy.types.Image]

    def commit(self) -> list[str]:
        """Renames the images, and replaces those of an earlier bake.

        Returns:
            The names of the images. A name that another image has gets a number appended.
        """
        made_before = _earlier_levels(self.picture)
        for number, image in enumerate(self.images, start=1):
            image[_SOURCE_KEY] = self.picture.full_name
            _replace(made_before.pop(number, []), image)
            image.name = level_name(self.picture.name, number)
        for deeper, *twins in made_before.values():
            _replace(twins, deeper)
        return [image.name for image in self.images]

    def discard(self) -> None:
        """Removes the images."""
        for image in self.images:
            bpy.data.images.remove(image)
        self.images.clear()


def stage_levels(picture: Picture, levels: Sequence[FloatArray]) -> StagedLevels:
    """Makes packed image datablocks of levels, to be named `<image>.mip01`, `<image>.mip02` ...

    Images of an earlier bake are replaced in the materials that use them. Deeper levels of an
    earlier bake are kept. All images have a fake user, as Blender does not save unused datablocks.

    A byte level has the picture's color space, and straight alpha if the picture's is
    Premultiplied. A float level is scene-linear (or data, like the picture), with associated alpha.
    Only these formats survive packing, saving and loading: Blender's packing does not convert
    colors, but its loading does.

    Args:
        picture: Level 0.
        levels: Levels 1, 2, ... in the encoding of `picture.texels`.

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
    """Returns the name of a level's image; a base name that is too long is cut, with a hash."""
    return suffixed(image_name, f"mip{number:02d}")


def is_level(image: bpy.types.Image) -> bool:
    """Whether an image is a level that a bake made."""
    return image.get(_SOURCE_KEY) is not None


def source_of_level(image: bpy.types.Image | None) -> bpy.types.Image | None:
    """Returns the image that a level was made from; None if it is gone."""
    name = image.get(_SOURCE_KEY) if image is not None else None
    return next((other for other in bpy.data.images if other.name_full == name), None)


def levels_of(image: bpy.types.Image) -> list[bpy.types.Image]:
    """Returns the levels that bakes made of an image."""
    return [
        level
        for level in bpy.data.images
        if level.library is None and level.get(_SOURCE_KEY) == image.name_full
    ]


def _earlier_levels(picture: Picture) -> dict[int, list[bpy.types.Image]]:
    """Level images of earlier bakes of a picture, by level, ordered by name."""
    numbers = {level_name(picture.name, number): number for number in range(1, _MAX_LEVELS)}
    levels: dict[int, list[bpy.types.Image]] = {}
    for image in bpy.data.images:
        name = _unnumbered(image.name)
        is_ours = image.library is None and image.get(_SOURCE_KEY) == picture.full_name
        if is_ours and name in numbers:
            levels.setdefault(numbers[name], []).append(image)
    return levels


def _unnumbered(name: str) -> str:
    """Removes the number that Blender appends to a name that is taken."""
    return re.sub(r"\.\d{3,}$", "", name)


def _replace(earlier: Sequence[bpy.types.Image], image: bpy.types.Image) -> None:
    for other in earlier:
        other.user_remap(image)
        bpy.data.images.remove(other)
