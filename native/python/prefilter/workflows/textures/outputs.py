# SPDX-License-Identifier: GPL-3.0-or-later

"""Outputs of a bake: files of levels, and the summary for the user."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path

from ...files.staging import StagedFile
from ...options.textures import CONTENTS, FILTERS, Settings
from ..files import engines, textures
from ..picture import FloatArray, Picture, encoded, in_rec709, scene_linear
from ..up_to_date import fingerprint_of
from ..wording import Sentence, counted, joined, together
from . import lookups
from .contents import Roughness
from .source import Source


@dataclass(frozen=True)
class Outputs:
    """Outputs of a bake other than level images.

    Attributes:
        target: The file of the levels; None for none.
        roughness: The roughness whose levels are baked too; None for none.
        roughness_target: The file of its levels; None for none.
        writes_image: Whether the image's own levels are written, not only those of its roughness.
    """

    target: Path | None
    roughness: Roughness | None = None
    roughness_target: Path | None = None
    writes_image: bool = True

    @property
    def targets(self) -> list[Path]:
        """The files."""
        return [target for target in (self.target, self.roughness_target) if target is not None]


_IRRELEVANT_SETTINGS = (
    "filepath",
    "roughness_filepath",
    "roughness",
    "threads",
    "use_images",
    "levels",
)
"""Settings that do not affect the contents of the files."""


def inputs_fingerprint(source: Source, outputs: Outputs) -> str:
    """Returns the fingerprint of all inputs of the files; see `up_to_date`."""
    chosen = asdict(source.settings)
    for name in _IRRELEVANT_SETTINGS:
        chosen.pop(name, None)
    arrays, pictures = [source.picture.texels], [_attributes(source.picture)]
    for surface in source.surfaces:
        arrays += [surface.positions, surface.triangles, surface.uvs, surface.areas]
    rough = outputs.roughness
    if rough is not None:
        arrays.append(rough.picture.texels)
        pictures += [_attributes(rough.picture), {"of": rough.channels, "as": rough.texture_format}]
    inputs = {
        "settings": chosen,
        "content": source.content,
        "wrap": source.wrap,
        "objects": list(source.objects),
        "pictures": pictures,
        "targets": [target is not None for target in (outputs.target, outputs.roughness_target)],
    }
    return fingerprint_of(arrays, inputs)


def _attributes(picture: Picture) -> dict[str, str]:
    """Returns all attributes of a picture except its texels and names."""
    return {
        attribute.name: str(getattr(picture, attribute.name))
        for attribute in fields(picture)
        if attribute.name not in {"name", "full_name", "texels", "ocio_config"}
    }


def stage_files(
    source: Source,
    outputs: Outputs,
    levels: list[FloatArray],
    roughness_levels: list[FloatArray],
    *,
    check: Callable[[], None],
    metadata: Mapping[str, str] | None = None,
) -> Iterator[tuple[list[StagedFile], list[FloatArray]]]:
    """Stages the files of an image, then those of its roughness, if there is one.

    Yields the files of each, and its levels as level images store them.
    """
    stage = partial(
        _stage_file, settings=source.settings, wrap=source.wrap, check=check, metadata=metadata
    )
    yield stage(source.picture, levels, outputs.target, source.settings.texture_format)
    if outputs.roughness is not None:
        picture, texture_format = outputs.roughness.picture, outputs.roughness.texture_format
        yield stage(picture, roughness_levels, outputs.roughness_target, texture_format)


def _stage_file(
    picture: Picture,
    levels: list[FloatArray],
    target: Path | None,
    texture_format: str,
    *,
    settings: Settings,
    wrap: tuple[str, str],
    check: Callable[[], None],
    metadata: Mapping[str, str] | None,
) -> tuple[list[StagedFile], list[FloatArray]]:
    """Stages the file of an image; returns it with the levels as level images store them."""
    stored: list[FloatArray] = []
    if settings.use_images or (target is not None and textures.keeps_encoding(target)):
        stored = [encoded(picture, level, check) for level in levels]
    files: list[StagedFile] = []
    threads = settings.threads
    if target is not None and engines.is_for_engines(target):
        linear = scene_linear(picture, check)
        files += engines.stage(
            target,
            picture,
            [in_rec709(picture, level, check) for level in (linear, *levels)],
            [picture.stored, *stored],
            texture_format,
            check,
            effort=settings.effort,
            supercompression=settings.supercompression,
            quality=settings.quality,
            metadata=metadata,
            threads=threads,
        )
    elif target is not None:
        files.append(
            textures.stage(
                target, picture, levels, stored, wrap, check, metadata=metadata, threads=threads
            )
        )
    return files, stored[: settings.levels - 1 if settings.levels else None]


def summary(
    source: Source, outputs: Outputs, names: Sequence[str] = (), frames: Sequence[int] = ()
) -> str:
    """Returns a line with the image, its objects, and the images and files of its levels."""
    name, settings = source.image_name, source.settings
    baked = Sentence("Baked '{}'", name)
    if not outputs.writes_image:
        assert outputs.roughness is not None
        rough = outputs.roughness.picture.name
        baked = Sentence("Baked '{}', the roughness of '{}',", rough, name)
    elif source.content not in {"color", "data"}:
        label = Sentence(CONTENTS[source.content].label)
        baked = Sentence("Baked '{}' as {}", name, label)
    parts = [Sentence("{} with {}", baked, Sentence(FILTERS[settings.filter].label))]
    if source.objects:
        parts.append(Sentence("over {}", counted(set(source.objects), "object")))
        if frames:
            parts.append(Sentence("at {}", counted(frames, "frame")))
    if source.footprint:
        parts.append(lookups.described(source.footprint, fits=source.fits_views))
    results: list[str] = [counted(names, "level image")] if names else []
    results += map(textures.display_name, outputs.targets)
    if not results:
        return Sentence("{}; it has no further level", joined(" ", parts))
    return joined(" ", [*parts, Sentence("into {}", together(results))])
