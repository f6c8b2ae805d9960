# SPDX-License-Identifier: GPL-3.0-or-later

"""The files of several images: each has a name of its own, and none is the source of an image."""

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
"""The placeholder for the name of an image in a path."""
PLACE = target_files.NAME_PLACEHOLDER
"""What stands for the name of an image in a path."""


@dataclass(frozen=True)
class Pattern:
    """Where files go.

    Attributes:
        text: A path with `PLACE` in it; empty for no files.
    """

    text: str

    @classmethod
    def of(cls, output: str, extension: str) -> "Pattern":
        """Returns the pattern of a path that a user gives.

        Args:
            output: A path with `PLACE` in it; or a file, whose extension then follows the name of
                the image; or a folder, which need not be there. Empty for no files.
            extension: That of files in a folder.
        """
        if not output:
            return cls("")
        stem, ending = os.path.splitext(output)
        if patterns.has(output, NAME):
            return cls(output if is_texture(output) else f"{output}{extension}")
        if is_texture(output) and not os.path.isdir(output):
            return cls(f"{stem}.{PLACE}{ending}")
        return cls(os.path.join(output, f"{PLACE}{extension}"))

    @classmethod
    def in_folder(cls, folder: str, extension: str) -> "Pattern":
        """Returns the pattern of files in a folder; of none if that is empty."""
        place = f"{PLACE}{extension}"
        return cls(os.path.join(patterns.literal(folder), place) if folder else "")

    @property
    def extension(self) -> str:
        """The ending of all files, in lower case."""
        return os.path.splitext(self.text)[1].lower()


def is_texture(path: str) -> bool:
    """Tells whether a path has the extension of a texture file."""
    return os.path.splitext(path)[1].lower() in target_files.EXTENSIONS


def format_of(path: str) -> str:
    """Returns the key of `choices.FILE_FORMATS` that the ending of a path says; empty for none."""
    ending = os.path.splitext(path)[1].lower().removeprefix(".")
    ending = {"tiff": "tif"}.get(ending, ending)
    return ending if ending in FILE_FORMATS else ""


def name_of(image: bpy.types.Image) -> str:
    """Returns what files of an image are called.

    What is no letter, digit or dash becomes "_"; an ending such as .png, and the place of the
    number of a UDIM tile, are left out.
    """
    base, ending = os.path.splitext(image.name)
    name = base if ending.lower() in bpy.path.extensions_image else image.name
    numbers = [str(number) for number in images.tile_numbers(image)]
    for place in ("<UDIM>", "<UVTILE>", *numbers) if numbers else ():
        name = name.removesuffix(place)
    return clean_name(name.rstrip("._-") or image.name)


def paths(
    pattern: Pattern,
    chosen: Sequence[bpy.types.Image],
    sources: Iterable[Path] = (),
    parts: Sequence[str] = (),
) -> list[str]:
    """Returns the path for each image; of tiled images, see `udim.paths`.

    A name that is taken, by letters in upper or lower case, or by a file that something is read
    from, gets a number.

    Args:
        pattern: Where files go.
        chosen: The images.
        sources: More files that must not be written, beside those of all images.
        parts: Which part of an image each is, or empty; see `plan.Item`.
    """
    if not pattern.text:
        return [""] * len(chosen)
    taken = {one for path in (*sources, *source_files()) for one in identities(path)}
    found: list[str] = []
    for image, part in zip(chosen, parts or [""] * len(chosen), strict=True):
        name, number = f"{name_of(image)}_{part}" if part else name_of(image), 1
        while True:
            numbered = name if number == 1 else f"{name}_{number}"
            path = patterns.filled(pattern.text, {NAME: numbered})
            files = _written(path, images.tile_numbers(image))
            own = {one for file in files for one in identities(file)}
            if taken.isdisjoint(own):
                break
            number += 1
        taken |= own
        found.append(path)
    return found


def _written(path: str, tiles: Sequence[int]) -> Iterator[Path]:
    """Yields the files that a bake to a path writes, or may write."""
    for one in udim.paths(path, tiles):
        yield from target_files.files_of(Path(os.path.realpath(one)))


def source_files() -> Iterator[Path]:
    """Yields the files that the images of this .blend file are read from."""
    for image in bpy.data.images:
        path = bpy.path.abspath(image.filepath, library=image.library)
        if image.source == "TILED":
            for number in images.tile_numbers(image):
                yield images.tile_path(image, number)
        elif path:
            yield Path(path)
