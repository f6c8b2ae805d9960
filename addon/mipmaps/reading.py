# SPDX-License-Identifier: GPL-3.0-or-later

"""The first step of a bake: everything that it needs is copied out of Blender, and checked."""

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import prefilter

from ..bridge import image_roles, images, meshes
from ..bridge.files import engines, textures
from ..bridge.images import Picture
from ..core.doing import read_at_once
from ..core.options import check
from ..core.wording import Sentence, listed
from . import blocks, contents, frames, udim
from .bake import Bake, Outputs
from .choices import TEXTURE_SPACE_FILTERS, Settings
from .source import on_surfaces, reads_encoded


class NoSurfaceError(ValueError):
    """No face shows the image.

    Attributes:
        problems: Why faces that would do not count; empty if there are none.
    """

    def __init__(self, message: str, problems: Sequence[str]) -> None:
        """Takes the message, and the reasons in it."""
        super().__init__(message)
        self.problems = list(problems)


@dataclass(frozen=True)
class Request:
    """What is to be baked, and on what.

    Attributes:
        image: Level 0.
        objects: The objects to look for the image on.
        settings: What to bake.
        depsgraph: The evaluated dependency graph.
        all_faces: See `meshes.image_surfaces`.
        needs_surface: Whether a surface is needed for any filter.
        roughness_texture_format: That of the file of the roughness; by default `roughness_format`.
        may_lose_channels: See `engines.checked`.
        writes_image: Whether the image itself is baked; else only the roughness that it is the
            normal map of, for the surfaces of that.
    """

    image: bpy.types.Image
    objects: Sequence[bpy.types.Object]
    settings: Settings
    depsgraph: bpy.types.Depsgraph
    all_faces: bool = False
    needs_surface: bool = False
    roughness_texture_format: str = ""
    may_lose_channels: bool = False
    writes_image: bool = True


@dataclass(frozen=True)
class Level0:
    """What was read of an image.

    Attributes:
        numbers: Of its tiles; none for an image without.
        pictures: Of its tiles, or the one of an image without.
        targets: The files of the tiles, or of the image; none for no file.
        content: What it holds, a key of `choices.CONTENTS` and not "auto".
        is_encoded: Whether the image is to be decoded, whatever it holds.
    """

    numbers: list[int]
    pictures: list[Picture]
    targets: list[Path]
    content: str
    is_encoded: bool


@dataclass(frozen=True)
class Rough:
    """The roughness of a normal map.

    Attributes:
        roughness: What was read of it; None for none.
        target: Its file; None for none.
    """

    roughness: contents.Roughness | None = None
    target: Path | None = None


def read(request: Request) -> Bake | udim.TiledBake:
    """Copies everything that the bake needs out of Blender.

    Raises:
        ValueError: There is nothing to bake, or the image or a mesh is unfit.
        OSError: The file of the settings cannot be written.
    """
    return read_at_once(reading(request))


def reading(request: Request) -> Generator[float, None, Bake | udim.TiledBake]:
    """Does what `read` does, in steps: the images, then frame after frame.

    The scene is at other frames in between; closing the generator takes it back, as its end
    does. Nothing else may change meanwhile.

    Yields:
        The fraction done.

    Returns:
        The bake.
    """
    check(request.settings)
    level_0 = read_level_0(request)
    yield 0.0
    request = with_format(request, level_0)
    told = told_of_files(request, level_0)
    rough = read_roughness(request, level_0)
    told += told_of_roughness(request, rough)
    yield 0.0
    found = yield from read_surfaces(request)
    job = bake_of(request, level_0, rough, found)
    job.warnings.extend(told + odd_uses(request, level_0, rough))
    return job


def read_level_0(request: Request) -> Level0:
    """Copies the image, and checks what its settings say of it."""
    image, settings = request.image, request.settings
    numbers = images.tile_numbers(image)
    targets = [textures.check_target(path) for path in udim.paths(settings.filepath, numbers)]
    if not targets and not settings.use_images and request.writes_image:
        raise ValueError(Sentence("nothing to write: choose level images or a file"))
    pictures = [images.read_tile(image, number) for number in numbers] or [images.read(image)]
    for picture in pictures:
        _check_levels(picture, settings.levels)
    used_by = meshes.materials_of_objects(request.objects)
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
            f"Roughness: '{settings.roughness}' cannot be used, because '{image.name}' has "
            "UDIM tiles"
        )
    return Level0(numbers, pictures, targets, content, is_encoded)


def with_format(request: Request, level_0: Level0) -> Request:
    """Returns the request with a format of texels in the place of "blocks"."""
    if request.settings.texture_format != "blocks":
        return request
    chosen = _blocks(level_0.pictures, level_0.content)
    settings = replace(request.settings, texture_format=chosen)
    return replace(request, settings=settings, may_lose_channels=True)


def told_of_files(request: Request, level_0: Level0) -> list[str]:
    """Returns what the files cannot hold of the image; raises ValueError where that is too much."""
    settings = request.settings
    threshold = settings.threshold if level_0.content == "cutout" else None
    return [
        note
        for picture, target in zip(level_0.pictures, level_0.targets, strict=False)
        for note in engines.checked(
            picture,
            target,
            settings.texture_format,
            threshold,
            may_lose_channels=request.may_lose_channels,
        )
    ]


def told_of_roughness(request: Request, rough: Rough) -> list[str]:
    """Returns the same of the file of the roughness."""
    if rough.roughness is None:
        return []
    return engines.checked(
        rough.roughness.picture,
        rough.target,
        rough.roughness.texture_format,
        may_lose_channels=request.may_lose_channels,
    )


def read_surfaces(request: Request) -> Generator[float, None, meshes.ImageSurfaces]:
    """Copies the surfaces that show the image, in steps of a frame."""
    settings = request.settings
    image = request.image if request.writes_image else images.find(settings.roughness)
    found = yield from frames.surfaces_over(
        image, request.objects, settings, request.depsgraph, all_faces=request.all_faces
    )
    needs_surface = request.needs_surface or settings.filter not in TEXTURE_SPACE_FILTERS
    if needs_surface and not found.surfaces:
        message = _no_surface(image, request.objects, settings.objects, found.problems)
        raise NoSurfaceError(message, found.problems)
    if settings.importance and found.surfaces and not any(s.area for s in found.surfaces):
        raise ValueError(
            f"Importance: '{settings.importance}' is 0 wherever objects "
            f"{listed(dict.fromkeys(found.objects))} use the image"
        )
    return found


def bake_of(
    request: Request, level_0: Level0, rough: Rough, found: meshes.ImageSurfaces
) -> Bake | udim.TiledBake:
    """Returns the bake of what was read."""
    settings, content, pictures = request.settings, level_0.content, level_0.pictures
    if level_0.numbers:
        tiles, warnings = udim.tiles(
            request.image.name, pictures, level_0.numbers, found, settings, level_0.targets
        )
        bakes = [
            Bake(on_surfaces(one.picture, one.found, settings, content), Outputs(one.target))
            for one in tiles
        ]
        return udim.TiledBake(request.image.name, bakes, warnings)
    target = level_0.targets[0] if level_0.targets else None
    outputs = Outputs(target, rough.roughness, rough.target, request.writes_image)
    return Bake(on_surfaces(pictures[0], found, settings, content), outputs)


def odd_uses(request: Request, level_0: Level0, rough: Rough) -> list[str]:
    """Returns warnings of settings that do not go with the image, or with each other."""
    settings, picture, told = request.settings, level_0.pictures[0], []
    if level_0.content == "normal" and level_0.is_encoded:
        told.append(
            f"image '{request.image.name}' has the color space {picture.colorspace}; "
            "shaders read normals correctly only in Non-Color"
        )
    if settings.reader != "linear":
        told.extend(_odd_readers(picture, level_0.targets))
        if settings.lookups in {"one-lookup", "anisotropic", "views"} and reads_encoded(picture):
            told.append(
                "Lookups: readers of encoded texels are always supersampled, so "
                f"'{picture.name}' is baked for that"
            )
    if settings.roughness and rough.roughness is None:
        told.append(
            f"Roughness: '{settings.roughness}' is not used, because '{request.image.name}' "
            "is not a normal map"
        )
    return told


def _blocks(pictures: Sequence[Picture], content: str) -> str:
    """Returns the format that suits an image; of several tiles, one that suits them all."""
    return blocks.suiting_all(
        blocks.suiting(one, content, reads_alpha=one.shape[2] == 4) for one in pictures
    )


def _odd_readers(picture: Picture, targets: Sequence[Path]) -> list[str]:
    """Returns warnings where nothing that is baked is read as encoded."""
    if not reads_encoded(picture):
        return [
            f"Reader: '{picture.name}' is not an 8-bit sRGB image, so it is read as linear light"
        ]
    return [
        f"Reader: '{target}' is read as linear light, but its levels are for encoded texels"
        for target in targets
        if target.suffix.lower() in {".exr", ".dds", ".ktx2"}
    ]


def _check_levels(picture: Picture, levels: int) -> None:
    height, width = picture.shape[:2]
    full = max(width, height).bit_length()
    if levels > full:
        raise ValueError(f"Levels: found {levels}; an image of {width} x {height} has 1 to {full}")


def read_roughness(request: Request, level_0: Level0) -> Rough:
    """Copies the roughness of a normal map, and checks what its settings say of it."""
    settings = request.settings
    if not settings.roughness:
        if settings.roughness_filepath:
            raise ValueError(Sentence("Roughness File: choose a Roughness image too"))
        return Rough()
    if level_0.content != "normal":
        if settings.content == "auto":
            return Rough()
        raise ValueError(
            f"Roughness: '{settings.roughness}' needs a normal map, and the content is "
            f"'{level_0.content}'"
        )
    if not settings.use_images and not settings.roughness_filepath:
        raise ValueError(
            Sentence("nothing to write the roughness to: choose level images or a Roughness File")
        )
    target = None
    if settings.roughness_filepath:
        target = textures.check_target(settings.roughness_filepath)
        if target in level_0.targets:
            raise ValueError(f"Roughness File: '{target}' is the file of the normal map")
    picture = images.read(images.find(settings.roughness))
    contents.check_roughness(level_0.pictures[0], picture)
    chosen = request.roughness_texture_format or roughness_format(settings, picture)
    linear = images.scene_linear(picture)
    return Rough(contents.Roughness(picture, linear, settings.roughness_channel, chosen), target)


def roughness_format(settings: Settings, picture: Picture) -> str:
    """Returns the format of the roughness file: that of the normal map, unless channels lack."""
    chosen = prefilter.TEXEL_FORMATS.get(settings.texture_format)
    if chosen is None or chosen.channels > 2:
        return settings.texture_format
    if settings.roughness_channel == "all":
        return "bc4" if chosen.is_in_dds else "eac-r11"
    if chosen.is_in_dds:
        return "bc7"
    return "etc2-rgba" if picture.stored.shape[2] == 4 else "etc2-rgb"


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
