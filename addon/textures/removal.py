# SPDX-License-Identifier: GPL-3.0-or-later

"""Removal of levels: previews, level images, and levels in Cycles' texture cache."""

from collections.abc import Collection, Iterable
from contextlib import suppress

import bpy

from ..bridge import level_images
from ..bridge.files import tx
from ..core import scene_cache
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, together
from .view import preview


def has_levels(image: bpy.types.Image | None) -> bool:
    """Returns whether an image has a preview or level images."""
    if image is None:
        return False
    return preview.find(image) is not None or bool(level_images.levels_of(image))


def remove(images: Iterable[bpy.types.Image], kinds: Collection[str]) -> Outcome:
    """Removes the levels of images.

    Args:
        images: The images; level images among them are ignored.
        kinds: Keys of `choices.REMOVED`.

    Raises:
        ValueError: There is nothing to remove.
        OSError: A file cannot be removed.
    """
    own = [image for image in images if not level_images.is_level(image)]
    results: list[str] = []
    previews = [image for image in own if preview.find(image) is not None]
    if "preview" in kinds and previews:
        for image in previews:
            preview.drop(image)
        results.append(counted(previews, "preview"))
    levels = [(image, level) for image in own for level in level_images.levels_of(image)]
    if "images" in kinds and levels:
        for image, level in levels:
            level.user_remap(image)
            bpy.data.images.remove(level)
        results.append(counted(levels, "level image"))
    if "cache" in kinds:
        files = [path for image in own for path in _removed_from_cache(image)]
        if files:
            results.append(Sentence("{} of the texture cache", counted(files, "file")))
    if not results:
        subject = f"image '{own[0].name}' has no" if len(own) == 1 else "no image has"
        raise ValueError(f"{subject} levels to remove")
    return Outcome(Sentence("Removed {}", together(results)))


def _removed_from_cache(image: bpy.types.Image) -> list[str]:
    removed: list[str] = []
    # Images without a file, for which `tx.sources` raises, are not in the cache.
    with suppress(ValueError):
        for source in tx.sources(image).values():
            removed += [str(path) for path in tx.remove_baked(source)]
    scene_cache.clear_all()
    return removed
