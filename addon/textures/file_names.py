# SPDX-License-Identifier: GPL-3.0-or-later

"""File names for the levels of several images: unique, and never the source file of an image."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
from prefilter.files.file_names import identities
from prefilter.workflows.files import patterns, target_files

from ..bridge import images
from ..core.file_names import clean_name
from . import udim
from .choices import FILE_FORMATS

NAME = "name"
"""The name of the placeholder for image names."""
PLACE = target_files.NAME_PLACEHOLDER
"""The placeholder for image names, as it is written in paths."""


@dataclass(frozen=True)
class Pattern:
    """A pattern for the paths of files.

    Attributes:
        text: A path that contains `PLACE`; empty for no files.
    """

    text: str

    @classmethod
    def of(cls, output: str, extension: str) -> "Pattern":
        """Returns the pattern of a user's path.

        Args:
            output: A path that contains `PLACE`; or a file, to whose stem the image name is added;
                or a folder, which may be missing. Empty for no files.
            extension: The extension of files in a folder.
        """
        if not output:
            return cls("")
        stem, own_extension = os.path.splitext(output)
        if patterns.has(output, NAME):
            return cls(output if is_texture(output) else f"{output}{extension}")
        if is_texture(output) and not os.path.isdir(output):
            return cls(f"{stem}.{PLACE}{own_extension}")
        return cls(os.path.join(output, f"{PLACE}{extension}"))

    @classmethod
    def in_folder(cls, folder: str, extension: str) -> "Pattern":
        """Returns the pattern of files in a folder; of no files if the folder is empty."""
        name = f"{PLACE}{extension}"
        return cls(os.path.join(patterns.literal(folder), name) if folder else "")

    @property
    def extension(self) -> str:
        """The extension of all files, in lower case."""
        return os.path.splitext(self.text)[1].lower()


def is_texture(path: str) -> bool:
    """Returns whether a path has the extension of a texture file."""
    return os.path.splitext(path)[1].lower() in target_files.EXTENSIONS


def format_of(path: str) -> str:
    """Returns the key of `choices.FILE_FORMATS` for a path's extension; empty for none."""
    extension = os.path.splitext(path)[1].lower().removeprefix(".")
    extension = {"tiff": "tif"}.get(extension, extension)
    return extension if extension in FILE_FORMATS else ""


def name_of(image: bpy.types.Image) -> str:
    """Returns the file name for an image, without extension.

    Characters other than letters, digits and dashes become "_"; an extension such as .png and the
    number of a UDIM tile are removed.
    """
    base, extension = os.path.splitext(image.name)
    name = base if extension.lower() in bpy.path.extensions_image else image.name
    numbers = [str(number) for number in images.tile_numbers(image)]
    for tile in ("<UDIM>", "<UVTILE>", *numbers) if numbers else ():
        name = name.removesuffix(tile)
    return clean_name(name.rstrip("._-") or image.name)


def paths(
    pattern: Pattern,
    chosen: Sequence[bpy.types.Image],
    sources: Iterable[Path] = (),
    parts: Sequence[str] = (),
) -> list[str]:
    """Returns the path for each image; for tiled images, see `udim.paths`.

    A number is added to a name that is taken by another image, ignoring case, or by a source file.

    Args:
        pattern: The pattern of the paths.
        chosen: The images.
        sources: More files that must not be overwritten, besides those of all images.
        parts: The part of each image, or empty; see `plan.Item`.
    """
    if not pattern.text:
        return [""] * len(chosen)
    taken = {identity for path in (*sources, *source_files()) for identity in identities(path)}
    chosen_paths: list[str] = []
    for image, part in zip(chosen, parts or [""] * len(chosen), strict=True):
        name, number = f"{name_of(image)}_{part}" if part else name_of(image), 1
        while True:
            numbered = name if number == 1 else f"{name}_{number}"
            path = patterns.filled(pattern.text, {NAME: numbered})
            files = _written(path, images.tile_numbers(image))
            own = {identity for file in files for identity in identities(file)}
            if taken.isdisjoint(own):
                break
            number += 1
        taken |= own
        chosen_paths.append(path)
    return chosen_paths


def _written(path: str, tiles: Sequence[int]) -> Iterator[Path]:
    """Yields the files that a bake to a path may write."""
    for tile_path in udim.paths(path, tiles):
        yield from target_files.files_of(Path(os.path.realpath(tile_path)))


def source_files() -> Iterator[Path]:
    """Yields the source files of all images of this .blend file."""
    for image in bpy.data.images:
        path = bpy.path.abspath(image.filepath, library=image.library)
        if image.source == "TILED":
            for number in images.tile_numbers(image):
                yield images.tile_path(image, number)
        elif path:
            yield Path(path)
