# SPDX-License-Identifier: GPL-3.0-or-later

"""The first step of a bake: everything that it needs is copied out of Blender, and checked."""

from collections.abc import Generator, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import bpy

from ..bridge import image_roles, images, meshes
from ..bridge.files import engines, textures
from ..bridge.images import Picture
from ..core.options import check
from ..core.wording import listed
from . import blocks, contents, frames, udim
from .bake import Bake, reads_encoded, roughness_format
from .choices import TEXTURE_SPACE_FILTERS, Settings


class NoSurfaceError(ValueError):
    """No face shows the image.

    Attributes:
        problems: Why faces that would do not count; empty if there are none.
    """

    def __init__(self, message: str, problems: Sequence[str]) -> None:
        """Takes the message, and the reasons in it."""
        super().__init__(message)
        self.problems = list(problems)


def read(
    image: bpy.types.Image,
    objects: Sequence[bpy.types.Object],
    settings: Settings,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool = False,
    needs_surface: bool = False,
) -> Bake | udim.TiledBake:
    """Copies everything that the bake needs out of Blender.

    Args:
        image: Level 0.
        objects: The objects to look for the image on.
        settings: What to bake.
        depsgraph: The evaluated dependency graph.
        all_faces: See `meshes.image_surfaces`.
        needs_surface: Whether a surface is needed for any filter.

    Raises:
        ValueError: There is nothing to bake, or the image or a mesh is unfit.
        OSError: The file of the settings cannot be written.
    """
    steps = reading(
        image, objects, settings, depsgraph, all_faces=all_faces, needs_surface=needs_surface
    )
    while True:
        try:
            next(steps)
        except StopIteration as done:
            return done.value


def reading(
    image: bpy.types.Image,
    objects: Sequence[bpy.types.Object],
    settings: Settings,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool = False,
    needs_surface: bool = False,
    roughness_texture_format: str = "",
    may_lose_channels: bool = False,
    writes_image: bool = True,
) -> Generator[float, None, Bake | udim.TiledBake]:
    """Does what `read` does, in steps of a frame.

    The scene is at other frames in between; closing the generator takes it back, as its end
    does. Nothing else may change meanwhile.

    Args:
        image: See `read`, also for those that follow.
        objects: See above.
        settings: See above.
        depsgraph: See above.
        all_faces: See above.
        needs_surface: See above.
        roughness_texture_format: That of the file of the roughness; by default `roughness_format`.
        may_lose_channels: See `engines.checked`.
        writes_image: Whether the image itself is baked; else only the roughness that it is the
            normal map of, for the surfaces of that.

    Yields:
        The fraction done.

    Returns:
        The bake.
    """
    check(settings)
    numbers = images.tile_numbers(image)
    targets = [textures.check_target(path) for path in udim.paths(settings.filepath, numbers)]
    if not targets and not settings.use_images and writes_image:
        raise ValueError("nothing to write: neither level images nor a file are asked for")
    pictures = [images.read_tile(image, number) for number in numbers] or [images.read(image)]
    for picture in pictures:
        _check_levels(picture, settings.levels)
    used_by = meshes.materials_of_objects(objects)
    is_normal_map = any(image_roles.feeds_normal_map(material, image) for material in used_by)
    if any(image_roles.has_alpha_of(material, image) for material in used_by):
        pictures = [replace(picture, covers=True) for picture in pictures]
    content = contents.resolved(settings.content, pictures[0], is_normal_map=is_normal_map)
    is_encoded = pictures[0].encoding is not images.Encoding.NONE
    pictures = [contents.as_content(picture, content) for picture in pictures]
    if content == "cutout":
        for picture in pictures:
            contents.check_cutout(picture)
    if numbers and settings.roughness:
        raise ValueError(
            f"roughness: found '{settings.roughness}' for the tiled image '{image.name}'; it "
            f"goes with images of one tile"
        )
    threshold = settings.threshold if content == "cutout" else None
    if settings.texture_format == "blocks":
        may_lose_channels = True
        settings = replace(settings, texture_format=_blocks(pictures, content))
    checked = partial(engines.checked, may_lose_channels=may_lose_channels)
    told = [
        note
        for picture, target in zip(pictures, targets, strict=False)
        for note in checked(picture, target, settings.texture_format, threshold)
    ]
    roughness, roughness_target = _read_roughness(settings, content, pictures[0])
    if roughness is not None:
        chosen = roughness_texture_format or roughness_format(settings, roughness.picture)
        roughness = replace(roughness, texture_format=chosen)
        told += checked(roughness.picture, roughness_target, chosen)
    weighed = image if writes_image else images.find(settings.roughness)
    found = yield from frames.surfaces_over(
        weighed, objects, settings, depsgraph, all_faces=all_faces
    )
    needs_surface = needs_surface or settings.filter not in TEXTURE_SPACE_FILTERS
    if needs_surface and not found.surfaces:
        raise NoSurfaceError(
            _no_surface(weighed, objects, settings.objects, found.problems), found.problems
        )
    if settings.importance and found.surfaces and not any(s.area for s in found.surfaces):
        raise ValueError(
            f"importance: '{settings.importance}' is 0 wherever objects "
            f"{listed(dict.fromkeys(found.objects))} use the image"
        )
    job: Bake | udim.TiledBake
    if numbers:
        tiles, warnings = udim.tiles(image.name, pictures, numbers, found, settings, targets)
        bakes = [Bake(one.picture, one.found, settings, one.target, content) for one in tiles]
        job = udim.TiledBake(image.name, bakes, warnings)
    else:
        target = targets[0] if targets else None
        job = Bake(
            pictures[0],
            found,
            settings,
            target,
            content,
            roughness,
            roughness_target,
            writes_image=writes_image,
        )
    job.warnings.extend(told)
    if content == "normal" and is_encoded:
        job.warnings.append(
            f"image '{image.name}' has the color space {pictures[0].colorspace}; a shader "
            f"reads normals right in Non-Color only"
        )
    if settings.reader != "linear":
        job.warnings.extend(_odd_readers(pictures[0], targets))
        if settings.lookups in {"one-lookup", "anisotropic"} and reads_encoded(pictures[0]):
            job.warnings.append(
                f"lookups: readers of encoded texels are supersampled, so '{pictures[0].name}' is "
                f"baked for that"
            )
    if settings.roughness and roughness is None:
        job.warnings.append(
            f"roughness '{settings.roughness}' is left out: '{image.name}' is no normal map"
        )
    return job


def _blocks(pictures: Sequence[Picture], content: str) -> str:
    """Returns the format that suits an image; of several tiles, one that suits them all."""
    found = {blocks.suiting(one, content, reads_alpha=one.shape[2] == 4) for one in pictures}
    return next(one for one in ("rgba16f", "bc6h", "bc7", "bc5", "bc4") if one in found)


def _odd_readers(picture: Picture, targets: Sequence[Path]) -> list[str]:
    """Returns warnings where nothing that is baked is read as encoded."""
    if not reads_encoded(picture):
        return [f"reader: '{picture.name}' is no 8-bit sRGB image, so it is read as linear light"]
    return [
        f"reader: '{target}' is read as linear light, but its levels are for encoded texels"
        for target in targets
        if target.suffix.lower() in {".exr", ".dds", ".ktx2"}
    ]


def _check_levels(picture: Picture, levels: int) -> None:
    height, width = picture.shape[:2]
    full = max(width, height).bit_length()
    if levels > full:
        raise ValueError(f"levels: found {levels}; an image of {width} x {height} has 1 to {full}")


def _read_roughness(
    settings: Settings, content: str, picture: Picture
) -> tuple[contents.Roughness | None, Path | None]:
    """Returns the roughness of a normal map, and the file to write it to."""
    if not settings.roughness:
        if settings.roughness_filepath:
            raise ValueError("roughness file: needs the name of a roughness image, found none")
        return None, None
    if content != "normal":
        if settings.content == "auto":
            return None, None
        raise ValueError(
            f"roughness: found '{settings.roughness}' with the content '{content}'; it is for "
            f"normal maps only"
        )
    if not settings.use_images and not settings.roughness_filepath:
        raise ValueError(
            "nothing to write the roughness to: neither level images nor a roughness file are "
            "asked for"
        )
    target = None
    if settings.roughness_filepath:
        target = textures.check_target(settings.roughness_filepath)
        if settings.filepath and target == textures.check_target(settings.filepath):
            raise ValueError(f"roughness file: '{target}' is the file of the normal map")
    rough = images.read(images.find(settings.roughness))
    contents.check_roughness(picture, rough)
    linear = images.scene_linear(rough)
    return contents.Roughness(rough, linear, settings.roughness_channel), target


def _no_surface(
    image: bpy.types.Image,
    objects: Iterable[bpy.types.Object],
    choice: str,
    problems: Sequence[str],
) -> str:
    start = f"image '{image.name}': no surface to bake for"
    if problems:
        return f"{start}; {'; '.join(problems)}"
    found = ", ".join(f"'{obj.name}' ({obj.type.lower()})" for obj in objects)
    if not found:
        none = "object is selected" if choice == "selected" else "visible object uses it"
        return f"{start}; no {none}"
    return f"{start}; no material on a face of a mesh uses it, among {found}"
