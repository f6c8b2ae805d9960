# SPDX-License-Identifier: GPL-3.0-or-later

"""Prepares the images of a job: reads their pixels, and decides how to bake them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
from prefilter.workflows.textures import contents, lookups, stretching

from ...bridge import images
from ...bridge.images import Picture
from ...core.wording import counted
from ..choices import FILTERS, Settings
from . import decisions, node_texels
from .plan import Item, Job, describe_image, image_of
from .table import Row


@dataclass(frozen=True)
class ImagePair:
    """The images of a job.

    Attributes:
        image: The image of its item.
        other: The roughness of a normal map, or the normal map of a roughness; None for most
            images.
        is_normal_map: Whether `image` is the normal map, and `other` its roughness.
    """

    image: bpy.types.Image
    other: bpy.types.Image | None
    is_normal_map: bool

    @property
    def normal_map(self) -> bpy.types.Image | None:
        """The normal map of a pair."""
        return self.image if self.is_normal_map else self.other

    @property
    def rough(self) -> bpy.types.Image | None:
        """The roughness of a pair."""
        return self.other if self.is_normal_map or self.other is None else self.image

    @property
    def fits(self) -> bool:
        """Whether both can be baked together: they have pixels, and the same size."""
        if self.other is None:
            return True
        return tuple(self.image.size) == tuple(self.other.size) and bool(self.image.size[0])


@dataclass(frozen=True)
class PreparedJob:
    """The images of a job, ready to be baked.

    Attributes:
        picture: The pixels of the image, or of its first tile.
        file: The file of the image; empty for none.
        settings: The settings of the bake.
        texture_format: The texel format of the image's file.
        roughness_texture_format: The texel format of the roughness's file; empty for none.
        rows: A description of each image's bake.
        notes: Pairs of an image's name and a remark about its content or its nodes.
        pictures: The pixels of images without tiles, by their full names.
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


def image_pair(job: Job) -> ImagePair:
    """Returns the images of a job."""
    partner = job.roughness.key if job.roughness is not None else job.normal_map
    other = image_of(partner) if partner else None
    return ImagePair(image_of(job.item.full_name), other, job.roughness is not None)


def split_job(job: Job, pair: ImagePair) -> list[Job]:
    """Returns the jobs that bake the images of a pair separately."""
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


def prepare(job: Job, pair: ImagePair, settings: Settings, files: Mapping[str, str]) -> PreparedJob:
    """Reads the image, and decides how to bake it.

    Args:
        job: The job.
        pair: Its images.
        settings: The settings for all images of the model.
        files: The path of each image by its key; empty for none.
    """
    item, file = job.item, files[job.item.key]
    pictures: dict[str, Picture] = {}
    picture = _read_first(pair.image, pictures)
    picture, node_notes = _apply_nodes(item, pair.image, picture, pictures, settings)
    decision = decisions.decide_content(item, picture)
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
    notes = [(item.image, text) for text in (decision.note, *node_notes) if text]
    prepared = PreparedJob(picture, file, own, chosen, "", [row], notes, pictures)
    if pair.rough is None:
        return prepared
    return _with_roughness(prepared, job, pair, settings, files)


def _with_roughness(
    prepared: PreparedJob, job: Job, pair: ImagePair, settings: Settings, files: Mapping[str, str]
) -> PreparedJob:
    """Adds the other image of a pair to a prepared job."""
    assert pair.rough is not None
    assert pair.normal_map is not None
    item = job.roughness or job.item
    file = files[item.key]
    picture, notes, pictures = prepared.picture, prepared.notes, prepared.pictures
    if pair.is_normal_map:
        picture = _read_first(pair.rough, pictures)
        picture, node_notes = _apply_nodes(item, pair.rough, picture, pictures, settings)
        notes = [*notes, *((item.image, text) for text in node_notes)]
    else:
        normals = _read_first(pair.normal_map, pictures)
        users = [bpy.data.materials[name] for name in item.materials]
        normal_item = describe_image(pair.normal_map, users)
        _apply_nodes(normal_item, pair.normal_map, normals, pictures, settings)
    chosen = _format(settings, item, picture, "data", file)
    compensates = f"its levels compensate for detail lost in the levels of '{pair.normal_map.name}'"
    row = prepared.rows[0]
    if pair.is_normal_map:
        rough_row = _row(item, pair.rough, "data", prepared.settings, picture, file, chosen)
        # If one is stretched, so is the other.
        sides = max(row.sides, rough_row.sides)
        rows = [
            replace(row, sides=sides),
            replace(rough_row, sides=sides, remarks=(compensates,)),
        ]
    else:
        rows = [replace(row, remarks=(compensates,))]
    own = replace(
        prepared.settings,
        content="normal",
        filepath=prepared.file if pair.is_normal_map else "",
        roughness=pair.rough.name,
        roughness_channel=item.roughness_channel,
        roughness_filepath=file,
    )
    return replace(prepared, settings=own, roughness_texture_format=chosen, rows=rows, notes=notes)


def _apply_nodes(
    item: Item,
    image: bpy.types.Image,
    picture: Picture,
    pictures: dict[str, Picture],
    settings: Settings,
) -> tuple[Picture, list[str]]:
    """Applies shader nodes to a picture for a file; returns it with notes, and updates `pictures`.

    Nodes are not applied to level images, which stay before them, and to tiles.
    """
    if settings.use_images:
        return picture, []
    if image.name_full not in pictures:
        return picture, node_texels.tile_notes(item, image)
    pictures[image.name_full], notes = node_texels.apply_nodes(item, image, picture)
    return pictures[image.name_full], notes


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


def _read_first(image: bpy.types.Image, pictures: dict[str, Picture]) -> Picture:
    """Reads the pixels of an image, or of its first readable tile.

    Stores the pixels of an image without tiles in `pictures`.
    """
    numbers = images.tile_numbers(image)
    if numbers:
        return images.read_tile(image, numbers[0])
    pictures[image.name_full] = images.read(image)
    return pictures[image.name_full]


def _size(image: bpy.types.Image) -> str:
    width, height = image.size
    tiles = images.tile_numbers(image)
    count = f"{counted(tiles, 'tile')}, " if tiles else ""
    return f"{count}{width} x {height}"
