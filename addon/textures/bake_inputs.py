# SPDX-License-Identifier: GPL-3.0-or-later

"""The inputs of a bake, copied from Blender and checked."""

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import bpy
from prefilter.workflows.files import engines, target_files
from prefilter.workflows.textures import checks, contents
from prefilter.workflows.textures.checks import RoughnessOutput
from prefilter.workflows.textures.outputs import Outputs

from ..bridge import image_roles, images, meshes
from ..bridge.images import Picture
from ..core.operator_hooks import run_steps
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
        problems: Why matching faces cannot be used; empty if no face matches.
    """

    def __init__(self, message: str, problems: Sequence[str]) -> None:
        """Stores the message and the problems."""
        super().__init__(message)
        self.problems = list(problems)


@dataclass(frozen=True)
class Request:
    """A request for a bake.

    Attributes:
        image: Level 0.
        objects: The objects on which to look for the image.
        settings: The settings of the bake.
        depsgraph: The evaluated dependency graph.
        all_faces: See `meshes.image_surfaces`.
        needs_surface: Whether a surface is required even if the filter needs none.
        roughness_texture_format: The texel format of the roughness file; empty for the default of
            `checks`.
        may_lose_channels: See `engines.checked`.
        writes_image: Whether the image itself is baked; otherwise only the roughness that belongs
            to this normal map, on the surfaces that show the roughness.
        pictures: Pixels read earlier, by the full names of their images.
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
        """Returns the pixels of an image without tiles."""
        return self.pictures.get(image.name_full) or images.read(image)


@dataclass(frozen=True)
class Level0:
    """The pixels and the content of an image.

    Attributes:
        numbers: The numbers of its tiles; empty for an image without tiles.
        pictures: The pixels of its tiles, or of the image.
        targets: The files of the tiles, or of the image; empty for no file.
        content: Its content, a key of `choices.CONTENTS` except "auto".
        threshold: The threshold of a cut-out's alpha test.
        is_encoded: Whether the color space of the image is nonlinear.
        notes: Remarks about the content for the user.
    """

    numbers: list[int]
    pictures: list[Picture]
    targets: list[Path]
    content: str
    threshold: float
    is_encoded: bool
    notes: tuple[str, ...] = ()


def read(request: Request) -> Bake | udim.TiledBake:
    """Copies all inputs of a bake from Blender.

    Raises:
        ValueError: There is nothing to bake, or the image or a mesh is unfit.
        OSError: The file of the settings cannot be written.
    """
    return run_steps(read_steps(request))


def read_steps(request: Request) -> Generator[float, None, Bake | udim.TiledBake]:
    """Does the same as `read` in steps: the images, then frame by frame.

    Between steps the scene may be at another frame; the end of the generator, or closing it, sets
    it back. Nothing else may change the scene meanwhile.

    Yields:
        The fraction done.

    Returns:
        The bake.
    """
    check(request.settings)
    level_0 = read_level_0(request)
    yield 0.0
    request = with_format(request, level_0)
    notes = [*level_0.notes, *file_notes(request, level_0)]
    rough = read_roughness(request, level_0)
    notes += roughness_file_notes(request, rough)
    yield 0.0
    surfaces = yield from read_surfaces(request)
    bake = create_bake(request, level_0, rough, surfaces)
    bake.warnings.extend(notes + usage_warnings(request, level_0, rough))
    return bake


def read_level_0(request: Request) -> Level0:
    """Copies the image, and checks it against the settings."""
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
    content, threshold, notes = settings.content, settings.threshold, list[str]()
    if content == "auto":
        item = plan.describe_image(image, used_by)
        decision = decisions.decide_content(item, pictures[0])
        content, threshold = decision.content, item.threshold
        notes += [f"image '{image.name}' {decision.note}"] if decision.note else []
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
    return Level0(numbers, pictures, targets, content, threshold, is_encoded, tuple(notes))


def with_format(request: Request, level_0: Level0) -> Request:
    """Returns the request with a certain texel format instead of "blocks"."""
    if request.settings.texture_format != "blocks":
        return request
    chosen = checks.suitable_blocks(level_0.pictures, level_0.content)
    settings = replace(request.settings, texture_format=chosen)
    return replace(request, settings=settings, may_lose_channels=True)


def file_notes(request: Request, level_0: Level0) -> list[str]:
    """Returns notes on image contents that the files cannot store; raises ValueError if important
    ones would be lost."""
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


def roughness_file_notes(request: Request, rough: RoughnessOutput) -> list[str]:
    """Returns the same notes for the roughness file."""
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
    """Copies the surfaces that show the image, one frame per step."""
    settings = request.settings
    image = request.image if request.writes_image else images.find(settings.roughness)
    surfaces = yield from frames.surfaces_over_frames(
        image, request.objects, settings, request.depsgraph, all_faces=request.all_faces
    )
    needs_surface = request.needs_surface or settings.filter not in TEXTURE_SPACE_FILTERS
    if needs_surface and not surfaces.surfaces:
        message = _no_surface(image, request.objects, settings.objects, surfaces.problems)
        raise NoSurfaceError(message, surfaces.problems)
    if settings.importance and surfaces.surfaces and not any(s.area for s in surfaces.surfaces):
        raise ValueError(
            f"Importance: '{settings.importance}' is 0 wherever objects "
            f"{listed(dict.fromkeys(surfaces.objects))} use the image"
        )
    return surfaces


def create_bake(
    request: Request, level_0: Level0, rough: RoughnessOutput, surfaces: meshes.ImageSurfaces
) -> Bake | udim.TiledBake:
    """Returns the bake of the inputs."""
    content, pictures = level_0.content, level_0.pictures
    settings = replace(request.settings, threshold=level_0.threshold)
    if level_0.numbers:
        tiles, warnings = udim.tiles(
            request.image.name, pictures, level_0.numbers, surfaces, settings, level_0.targets
        )
        bakes = [
            Bake(
                on_surfaces(tile.picture, tile.surfaces, settings, content),
                Outputs(tile.target),
                may_skip=request.may_skip,
            )
            for tile in tiles
        ]
        return udim.TiledBake(request.image.name, bakes, warnings)
    target = level_0.targets[0] if level_0.targets else None
    outputs = Outputs(target, rough.roughness, rough.target, request.writes_image)
    source = on_surfaces(pictures[0], surfaces, settings, content)
    return Bake(source, outputs, may_skip=request.may_skip)


def read_roughness(request: Request, level_0: Level0) -> RoughnessOutput:
    """Copies the roughness of a normal map, and checks it against the settings."""
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
    """Returns warnings about settings that do not suit the image or each other."""
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
    names = ", ".join(f"'{obj.name}' ({obj.type.lower()})" for obj in objects)
    if not names:
        none = "object is selected" if choice == "selected" else "visible object uses it"
        return f"{start}; no {none}"
    return f"{start}; no material on a face of a mesh uses it, among {names}"
