# SPDX-License-Identifier: GPL-3.0-or-later

"""Images that are made of others: what is read of Blender for that, and what becomes of it."""

import bpy
from prefilter.workflows.resampling.new_picture import NewPicture

from ..bridge import derived, images
from ..bridge.images import FloatArray, Picture
from ..core.outcome import Outcome
from ..core.wording import Sentence


def read(image: bpy.types.Image) -> Picture:
    """Copies an image's pixels; raises ValueError where it has none, or several tiles."""
    images.check_untiled(image)
    return images.read(image)


def keep(work: NewPicture, stored: FloatArray, *, in_place: bool = False) -> Outcome:
    """Makes an image.

    Args:
        work: What has made the pixels.
        stored: They, as the old image stores its own.
        in_place: Whether whatever uses the old image then uses the new one.

    Raises:
        OSError: It cannot be made.
    """
    image = derived.write_picture(work.picture, work.suffix, stored, like_source=True)
    if in_place:
        images.find(work.picture.name).user_remap(image)
    return Outcome(Sentence("{}: '{}'", work.summary, image.name), images=[image.name])
