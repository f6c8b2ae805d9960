# SPDX-License-Identifier: GPL-3.0-or-later

"""What is done with the images of a job: decided by nodes and pixels, before anything is baked."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
from prefilter.workflows.mipmaps import contents, lookups, stretching

from ...bridge import images
from ...bridge.images import Picture
from ...core.wording import counted
from ..choices import FILTERS, Settings
from . import decisions, node_texels
from .plan import Item, Job, image_of, said_of
from .table import Row


@dataclass(frozen=True)
class Pair:
    """The images of a job.

    Attributes:
        image: The one that its item names.
        other: What belongs to it: the roughness of a normal map, or the normal map of a roughness;
            None for most images.
        is_normal_map: Whether `other` is the roughness.
    """

    image: bpy.types.Image
    other: bpy.types.Image | None
    is_normal_map: bool

    @property
    def normal_map(self) -> bpy.types.Image | None:
        """The normal map, if there is one with a roughness."""
        return self.image if self.is_normal_map else self.other

    @property
    def rough(self) -> bpy.types.Image | None:
        """The roughness, if there is a normal map with it."""
        return self.other if self.is_normal_map or self.other is None else self.image

    @property
    def fits(self) -> bool:
        """Whether both can be baked together: they have pixels, and equally many."""
        if self.other is None:
            return True
        return tuple(self.image.size) == tuple(self.other.size) and bool(self.image.size[0])


@dataclass(frozen=True)
class Prepared:
    """What is to be done with the images of a job.

    Attributes:
        picture: The pixels of the image, or of its first tile.
        file: The file of the image; empty for none.
        settings: What is to be baked.
        texture_format: That of the file of the image.
        roughness_texture_format: That of the file of the roughness; empty for none.
        rows: What is said of each image that is baked.
        notes: Names of images with why one is taken for something else than the nodes say, and
            what these do to it.
        pictures: What was read of images without tiles, by their full names.
    """

    picture: Picture
    file: str
    settings: Settings
    texture_format: str
    roughness_texture_format: str
    rows: list[Row]
    notes: list[tuple[str, str]]
    pictures: dict[str, Picture]

    @property
    def target(self) -> Path | None:
        """The file of the image."""
        return _target(self.file)


def pair_of(job: Job) -> Pair:
    """Returns the images of a job."""
    partner = job.roughness.key if job.roughness is not None else job.normal_map
    other = image_of(partner) if partner else None
    return Pair(image_of(job.item.full_name), other, job.roughness is not None)


def parted(job: Job, pair: Pair) -> list[Job]:
    """Returns the jobs that bake the images of one by themselves."""
    rough, normal_map = pair.rough, pair.normal_map
    assert rough is not None
    assert normal_map is not None
    note = f"does not compensate for '{normal_map.name}', "
    if normal_map.size[0]:
        note += f"whose size is {_size(normal_map)}, and its own {_size(rough)}"
    else:
        note += "which has no pixels"
    item = job.roughness or job.item
    alone = Job(replace(item, notes=(*item.notes, note)))
    return [Job(job.item), alone] if job.roughness is not None else [alone]


def prepared(job: Job, pair: Pair, settings: Settings, files: Mapping[str, str]) -> Prepared:
    """Reads the image, and decides what is done with it.

    Args:
        job: What is baked at once.
        pair: Its images.
        settings: What to do with all images of the model.
        files: The path of each image, by its full name; empty for none.
    """
    item, file = job.item, files[job.item.key]
    read: dict[str, Picture] = {}
    picture = _first(pair.image, read)
    picture, told = _with_nodes(item, pair.image, picture, read, settings)
    decision = decisions.decided(item, picture)
    picture = contents.as_content(picture, decision.content)
    chosen = _format(settings, item, picture, decision.content, file)
    own = replace(
        settings,
        content=decision.content,
        threshold=item.threshold,
        texture_format=chosen,
        filepath=file,
    )
    row = _row(item, pair.image, decision.content, own, picture, file, chosen)
    own = lookups.resolved(own)
    notes = [(item.image, text) for text in (decision.note, *told) if text]
    made = Prepared(picture, file, own, chosen, "", [row], notes, read)
    return made if pair.rough is None else _with_roughness(made, job, pair, settings, files)


def _with_roughness(
    made: Prepared, job: Job, pair: Pair, settings: Settings, files: Mapping[str, str]
) -> Prepared:
    """Returns what is to be done with a normal map together with its roughness."""
    assert pair.rough is not None
    assert pair.normal_map is not None
    item = job.roughness or job.item
    file = files[item.key]
    picture, notes = made.picture, made.notes
    if pair.is_normal_map:
        picture = _first(pair.rough, made.pictures)
        picture, told = _with_nodes(item, pair.rough, picture, made.pictures, settings)
        notes = [*notes, *((item.image, text) for text in told)]
    else:
        normals = _first(pair.normal_map, made.pictures)
        said = said_of(pair.normal_map, [bpy.data.materials[name] for name in item.materials])
        _with_nodes(said, pair.normal_map, normals, made.pictures, settings)
    chosen = _format(settings, item, picture, "data", file)
    compensates = f"its levels compensate for detail lost in the levels of '{pair.normal_map.name}'"
    row = made.rows[0]
    if pair.is_normal_map:
        rough_row = _row(item, pair.rough, "data", made.settings, picture, file, chosen)
        # Where one is stretched so is the other.
        sides = max(row.sides, rough_row.sides)
        rows = [
            replace(row, sides=sides),
            replace(rough_row, sides=sides, remarks=(compensates,)),
        ]
    else:
        rows = [replace(row, remarks=(compensates,))]
    own = replace(
        made.settings,
        content="normal",
        filepath=made.file if pair.is_normal_map else "",
        roughness=pair.rough.name,
        roughness_channel=item.roughness_channel,
        roughness_filepath=file,
    )
    return replace(made, settings=own, roughness_texture_format=chosen, rows=rows, notes=notes)


def _with_nodes(
    item: Item,
    image: bpy.types.Image,
    picture: Picture,
    read: dict[str, Picture],
    settings: Settings,
) -> tuple[Picture, list[str]]:
    """Applies nodes to a picture for a file, in `read` too, and returns what is said of it.

    Level images stay before the nodes, and tiles are left as they are.
    """
    if settings.use_images:
        return picture, []
    if image.name_full not in read:
        return picture, node_texels.told_of_tiles(item, image)
    read[image.name_full], told = node_texels.with_nodes(item, image, picture)
    return read[image.name_full], told


def _row(
    item: Item,
    image: bpy.types.Image,
    content: str,
    settings: Settings,
    picture: Picture,
    file: str,
    texture_format: str,
) -> Row:
    target, (height, width, _) = _target(file), picture.shape
    size = stretching.size_for(picture, target, texture_format)
    return Row(
        image.name,
        _size(image),
        item.objects,
        content,
        item.uses,
        FILTERS[settings.filter].label,
        decisions.shown_format(picture, target, texture_format),
        file,
        size if settings.use_multiples_of_4 else (width, height),
        tuple(images.tile_numbers(image)),
    )


def _format(settings: Settings, item: Item, picture: Picture, content: str, file: str) -> str:
    if settings.texture_format not in decisions.BY_CONTENT:
        return settings.texture_format
    return decisions.texture_format(item, picture, content, _target(file))


def _target(file: str) -> Path | None:
    return Path(file) if file else None


def _first(image: bpy.types.Image, read: dict[str, Picture]) -> Picture:
    """Returns the pixels of an image, or of its first tile that can be read.

    `read` gets those of an image without tiles.
    """
    numbers = images.tile_numbers(image)
    if numbers:
        return images.read_tile(image, numbers[0])
    read[image.name_full] = images.read(image)
    return read[image.name_full]


def _size(image: bpy.types.Image) -> str:
    width, height = image.size
    tiles = images.tile_numbers(image)
    count = f"{counted(tiles, 'tile')}, " if tiles else ""
    return f"{count}{width} x {height}"
