# SPDX-License-Identifier: GPL-3.0-or-later

"""The images that a command bakes without --image, and their files."""

import os
from collections.abc import Sequence

import bpy
from prefilter.workflows.files import patterns

from ..bridge import image_roles, meshes
from ..core.wording import listed
from . import file_names


def images_to_bake(objects: Sequence[bpy.types.Object]) -> tuple[list[bpy.types.Image], str]:
    """Returns the base color images of the objects' materials; if there are none, all their images.

    Returns:
        The images, and a line that explains the choice; empty for a single image.

    Raises:
        ValueError: The materials show no image.
    """
    used = meshes.images_of_objects(objects)
    if not used:
        raise ValueError("--image: needed, because the meshes use no image")
    shown_by = meshes.materials_of_objects(objects)
    colors = [
        image
        for image in used
        if any(image_roles.has_base_color_of(material, image) for material in shown_by)
    ]
    chosen = colors or used
    if len(used) == 1:
        return used, ""
    kind = "base colors" if colors else "all images, as none is a base color"
    line = f"Without --image: {kind}, {listed(image.name for image in chosen)}"
    left_out = [image.name for image in used if image not in chosen]
    return chosen, f"{line}; not {listed(left_out)}" if left_out else line


def output_paths(path: str, images: Sequence[bpy.types.Image]) -> list[str]:
    """Returns the file of each image, with the image names inserted if there are several."""
    if len(images) == 1 or not path:
        return [path] * len(images)
    stem, extension = os.path.splitext(path)
    text = f"{patterns.literal(stem)}.{file_names.PLACE}{patterns.literal(extension)}"
    return file_names.paths(file_names.Pattern(text), images)
