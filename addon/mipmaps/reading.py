# SPDX-License-Identifier: GPL-3.0-or-later

"""The first step of a bake: everything that it needs is copied out of Blender, and checked."""

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy
from prefilter.workflows.files import engines, target_files
from prefilter.workflows.mipmaps import checks, contents
from prefilter.workflows.mipmaps.checks import RoughnessOutput
from prefilter.workflows.mipmaps.outputs import Outputs

from ..bridge import image_roles, images, meshes
from ..bridge.images import Picture
from ..core.doing import read_at_once
from ..core.options import check
from ..core.wording import Sentence, listed
from . import frames, udim
from .bake import Bake
from .choices import TEXTURE_SPACE_FILTERS, Settings
from .model import decisions, plan
from .source import on_surfaces


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
        roughness_texture_format: That of the file of the roughness; by default that of `checks`.
        may_lose_channels: See `engines.format_warnings`.
        writes_image: Whether the image itself is baked; else only the roughness that it is the
            normal map of, for the surfaces of that.
        pictures: What was read of images before, by their full names.
        may_skip: See `Bake`.
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
    pictures: Mapping[str, Picture] = field(default_factory=dict)
    may_skip: bool = False

    def picture_of(self, image: bpy.types.Image) -> Picture:
        """The pixels of an image without tiles."""
        return self.pictures.get(image.name_full) or images.read(image)


@dataclass(frozen=True)
class Level0:
    """What was read of an image.

    Attributes:
        numbers: Of its tiles; none for an image without.
        pictures: Of its tiles, or the one of an image without.
        targets: The files of the tiles, or of the image; none for no file.
        content: What it holds, a key of `choices.CONTENTS` and not "auto".
        threshold: Of the alpha test of a cut-out.
        is_encoded: Whether the image is to be decoded, whatever it holds.
        told: What a user should know of the content.
    """

    numbers: list[int]
    pictures: list[Picture]
    targets: list[Path]
    content: str
    threshold: float
    is_encoded: bool
    told: tuple[str, ...] = ()


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
    told = [*level_0.told, *told_of_files(request, level_0)]
    rough = read_roughness(request, level_0)
    told += told_of_roughness(request, rough)
    yield 0.0
    found = yield from read_surfaces(request)
    job = bake_of(request, level_0, rough, found)
    job.warnings.extend(told + usage_warnings(request, level_0, rough))
    return job


def read_level_0(request: Request) -> Level0:
    """Copies the image, and checks what its settings say of it."""
    image, settings = request.image, request.settings
    numbers = images.tile_numbers(image)
    targets = [target_files.check_target(path) for path in udim.paths(settings.filepath, numbers)]
    if not targets and not settings.use_images and request.writes_image:
        raise ValueError(Sentence("nothing to write: choose level images or a file"))
    pictures = [images.read_tile(image, number) for number in numbers]
    pictures = pictures or [request.picture_of(image)]
    for picture in pictures:
        _check_levels(picture, settings.levels)
    used_by = meshes.materials_of_objects(request.objects)
    if any(image_roles.has_alpha_of(material, image) for material in used_by):
        pictures = [replace(picture, covers=True) for picture in pictures]
    content, threshold, told = settings.content, settings.threshold, list[str]()
    if content == "auto":
        item = plan.said_of(image, used_by)
        decision = decisions.decided(item, pictures[0])
        content, threshold = decision.content, item.threshold
        told += [f"image '{image.name}' {decision.note}"] if decision.note else []
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
    return Level0(numbers, pictures, targets, content, threshold, is_encoded, tuple(told))


def with_format(request: Request, level_0: Level0) -> Request:
    """Returns the request with a format of texels in the place of "blocks"."""
    if request.settings.texture_format != "blocks":
        return request
    chosen = checks.suitable_blocks(level_0.pictures, level_0.content)
    settings = replace(request.settings, texture_format=chosen)
    return replace(request, settings=settings, may_lose_channels=True)


def told_of_files(request: Request, level_0: Level0) -> list[str]:
    """Returns what the files cannot hold of the image; raises ValueError where that is too much."""
    settings = request.settings
    threshold = level_0.threshold if level_0.content == "cutout" else None
    return [
        note
        for picture, target in zip(level_0.pictures, level_0.targets, strict=False)
        for note in engines.format_warnings(
            picture,
            target,
            settings.texture_format,
            threshold,
            may_lose_channels=request.may_lose_channels,
            is_stretched=settings.use_multiples_of_4,
        )
    ]


def told_of_roughness(request: Request, rough: RoughnessOutput) -> list[str]:
    """Returns the same of the file of the roughness."""
    if rough.roughness is None:
        return []
    return engines.format_warnings(
        rough.roughness.picture,
        rough.target,
        rough.roughness.texture_format,
        may_lose_channels=request.may_lose_channels,
        is_stretched=request.settings.use_multiples_of_4,
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
    request: Request, level_0: Level0, rough: RoughnessOutput, found: meshes.ImageSurfaces
) -> Bake | udim.TiledBake:
    """Returns the bake of what was read."""
    content, pictures = level_0.content, level_0.pictures
    settings = replace(request.settings, threshold=level_0.threshold)
    if level_0.numbers:
        tiles, warnings = udim.tiles(
            request.image.name, pictures, level_0.numbers, found, settings, level_0.targets
        )
        bakes = [
            Bake(
                on_surfaces(one.picture, one.found, settings, content),
                Outputs(one.target),
                may_skip=request.may_skip,
            )
            for one in tiles
        ]
        return udim.TiledBake(request.image.name, bakes, warnings)
    target = level_0.targets[0] if level_0.targets else None
    outputs = Outputs(target, rough.roughness, rough.target, request.writes_image)
    source = on_surfaces(pictures[0], found, settings, content)
    return Bake(source, outputs, may_skip=request.may_skip)


def read_roughness(request: Request, level_0: Level0) -> RoughnessOutput:
    """Copies the roughness of a normal map, and checks what its settings say of it."""
    settings = request.settings
    return checks.roughness_of(
        settings,
        level_0.pictures[0],
        level_0.content,
        level_0.targets,
        lambda: request.picture_of(images.find(settings.roughness)),
        request.roughness_texture_format,
    )


def usage_warnings(request: Request, level_0: Level0, rough: RoughnessOutput) -> list[str]:
    """Returns warnings of settings that do not go with the image, or with each other."""
    return checks.usage_warnings(
        request.settings,
        level_0.pictures[0],
        level_0.content,
        level_0.targets,
        rough,
        is_encoded=level_0.is_encoded,
    )


def _check_levels(picture: Picture, levels: int) -> None:
    height, width = picture.shape[:2]
    full = max(width, height).bit_length()
    if levels > full:
        raise ValueError(f"Levels: found {levels}; an image of {width} x {height} has 1 to {full}")


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
