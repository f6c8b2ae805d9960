# SPDX-License-Identifier: GPL-3.0-or-later

"""The inputs of `bake` and `plot`: a file with objects, and images that they use."""

import argparse
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace

import bpy
from prefilter.workflows.files import target_files

from ...bridge import images, meshes
from ...bridge.files import scenes
from ...core import command
from ...core.flags import given
from ...core.wording import either
from .. import default_images, users
from ..choices import Settings

WANTED = "mesh object"


def add_arguments(parser: argparse.ArgumentParser, more: str = "") -> None:
    """Adds the arguments; `more` is appended to the help of --image."""
    parser.add_argument("file", metavar="FILE", help=f"a file: {either(scenes.SOURCES)}")
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh object or collection instance that counts; repeat for several (default: all "
        "visible ones that use the image)",
    )
    parser.add_argument(
        "--image",
        metavar="NAME",
        help=f"the image: its name in the file, or the path of a picture file{more}",
    )


def objects_of(options: argparse.Namespace) -> list[bpy.types.Object]:
    (objects,) = scenes.load([options.file], meshes.may_show_image, WANTED)
    return scenes.chosen(objects, options.object, WANTED)


def users_of(
    image: bpy.types.Image,
    objects: list[bpy.types.Object],
    names: Sequence[str],
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns the objects that use the image, or all if the user named them or none uses it.

    Returns:
        The objects, and warnings.
    """
    if names:
        return objects, []
    shown, warnings = users.users_of(image, bpy.context)
    return [obj for obj in objects if obj in shown] or objects, warnings


def fit_to_files(options: argparse.Namespace, settings: Settings, paths: Iterable[str]) -> Settings:
    """Resets settings from a preset that do not apply to the formats of `paths`.

    Settings given by flags stay, so that they can be refused.
    """
    flags = given(options, Settings)
    if "texture_format" not in flags and not any(map(target_files.has_formats, paths)):
        settings = replace(settings, texture_format="auto")
    if "effort" not in flags and not any(map(target_files.has_formats, paths)):
        settings = replace(settings, effort="normal")
    if "supercompression" not in flags and not any(map(target_files.has_supercompression, paths)):
        settings = replace(settings, supercompression="none")
    return settings


def images_of(
    name: str | None, objects: Sequence[bpy.types.Object], content: str
) -> tuple[list[bpy.types.Image], bool]:
    """Returns the images to bake, and whether --image is a picture file."""
    if name is None:
        chosen, line = default_images.images_to_bake(objects)
        if line:
            command.print_line(line)
        return chosen, False
    if name not in bpy.data.images and os.path.isfile(name):
        return [images.load("--image", name, is_data=content in {"normal", "data"})], True
    return [images.find(name)], False
