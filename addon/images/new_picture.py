# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading of source images and writing of resized or resampled ones."""

import bpy
from prefilter.workflows.images.new_picture import NewPicture

from ..bridge import derived, images
from ..bridge.images import FloatArray, Picture
from ..core.outcome import Outcome
from ..core.wording import Sentence


def read(image: bpy.types.Image) -> Picture:
    """Copies an image's pixels; raises ValueError if it has none, or has tiles."""
    images.check_untiled(image)
    return images.read(image)


def keep(work: NewPicture, stored: FloatArray, *, in_place: bool = False) -> Outcome:
    """Makes an image.

    Args:
        work: The work that computed the pixels.
        stored: The pixels, encoded like those of the old image.
        in_place: Whether all users of the old image use the new one instead.

    Raises:
        OSError: The image cannot be made.
    """
    image = derived.write_picture(work.picture, work.suffix, stored, like_source=True)
    if in_place:
        images.find(work.picture.name).user_remap(image)
    return Outcome(Sentence("{}: '{}'", work.summary, image.name), images=[image.name])
