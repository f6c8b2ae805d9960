# SPDX-License-Identifier: GPL-3.0-or-later

"""The work of the command `mipmaps`: from a picture and meshes to a file of levels."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from ..files.staging import StagedFile, commit_all
from ..options.textures import Settings
from ..workflows import mesh_files, picture_files
from ..workflows.files import engines, target_files, textures
from ..workflows.outcome import Outcome
from ..workflows.picture import Encoding, Picture
from ..workflows.progress import Progress, go_on, share
from ..workflows.textures import checks, contents, levels, stretching
from ..workflows.textures.outputs import Outputs, stage_files, summary
from ..workflows.textures.source import Source
from . import color_arguments

_FILTERED = 0.9  # Progress once the levels are filtered.


class LevelsFile:
    """Computes the levels of one texture and writes them to a file."""

    def __init__(
        self,
        source: Source,
        outputs: Outputs,
        warnings: list[str],
        metadata: Mapping[str, str] | None = None,
    ) -> None:
        """Takes the inputs, and key-value pairs to store in KTX 2 files."""
        self._metadata = metadata
        self._source = source
        self._outputs = outputs
        self._warnings = warnings
        self._notes: list[str] = []
        self._staged: list[StagedFile] = []

    def compute(self, progress: Progress) -> None:
        """Filters, encodes and stages the files.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
            OSError: A file cannot be written.
        """
        source = self._source
        go_on(progress, 0.0)
        outputs, notes = stretching.stretch(source, self._outputs, progress)
        roughness = outputs.roughness
        self._notes += notes
        image_levels, roughness_levels, note = levels.filtered(
            source, roughness, share(progress, 0.0, _FILTERED), all_levels=True
        )
        self._notes += [note] if note else []
        check = partial(go_on, progress, _FILTERED)
        for files, _ in stage_files(
            source, outputs, image_levels, roughness_levels, check=check, metadata=self._metadata
        ):
            self._staged += files
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the files into place: all, or none."""
        commit_all(self._staged)
        return Outcome(
            summary(self._source, self._outputs),
            files=[str(path) for path in self._outputs.targets],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Removes staged files that were not put into place."""
        for file in self._staged:
            file.discard()


def read(
    texture: str,
    meshes: Sequence[str],
    objects: Sequence[str],
    settings: Settings,
    metadata: Mapping[str, str] | None,
    options: argparse.Namespace,
) -> LevelsFile:
    """Reads the files and checks them against the settings.

    Raises:
        OSError: A file cannot be read or written.
        ValueError: A file does not fit the settings.
    """
    target = target_files.check_target(settings.filepath)
    is_data = settings.content in {"normal", "data"}
    picture = picture_files.read(
        "TEXTURE",
        texture,
        is_data=is_data,
        colorspace=options.colorspace,
        keeps_bytes=textures.keeps_encoding(target),
        turns=not meshes,
    )
    content = settings.content
    if content == "auto":
        content = "data" if picture.is_data else "color"
    is_encoded = picture.encoding is not Encoding.NONE
    picture = contents.as_content(picture, content)
    if content == "cutout":
        contents.check_cutout(picture)
    blocks = settings.texture_format == "blocks"
    if blocks:
        block_format = checks.suitable_blocks([picture], content)
        settings = replace(settings, texture_format=block_format)
    threshold = settings.threshold if content == "cutout" else None
    if not _holds_all_colors(picture, target, settings.texture_format):
        color_arguments.check_range("TEXTURE", picture, target, options)
    warnings = [*picture.reading_warnings, *_orientation_warnings(picture)]
    warnings += engines.format_warnings(
        picture,
        target,
        settings.texture_format,
        threshold,
        may_lose_channels=blocks,
        is_stretched=settings.use_multiples_of_4,
    )
    read_rough = partial(_read_roughness, settings, turns=not meshes)
    rough = checks.roughness_of(settings, picture, content, [target], read_rough)
    if rough.roughness is not None:
        warnings += engines.format_warnings(
            rough.roughness.picture,
            rough.target,
            rough.roughness.texture_format,
            may_lose_channels=blocks,
            is_stretched=settings.use_multiples_of_4,
        )
    warnings += checks.usage_warnings(
        settings, picture, content, [target], rough, is_encoded=is_encoded
    )
    outputs = Outputs(target, rough.roughness, rough.target)
    parts = mesh_files.select(mesh_files.read("MESH", meshes), objects)
    return LevelsFile(
        _on_meshes(parts, settings, picture, content, warnings), outputs, warnings, metadata
    )


def _on_meshes(
    parts: Sequence[mesh_files.NamedMesh],
    settings: Settings,
    picture: Picture,
    content: str,
    warnings: list[str],
) -> Source:
    """Returns the picture on its surfaces; prepends warnings about these to `warnings`."""
    surfaces, names, without = mesh_files.surfaces(parts)
    wrap = "repeat" if settings.wrap == "auto" else settings.wrap
    wraps = (wrap, wrap if settings.wrap_v == "same" else settings.wrap_v)
    warnings[:0] = without
    return Source(picture, surfaces, names, settings, content, wraps)


def _holds_all_colors(picture: Picture, target: Path, texture_format: str) -> bool:
    """Tells whether a file holds colors below 0 and above 1."""
    if engines.is_for_engines(target):
        return engines.keeps_range(picture, target, texture_format)
    return picture.is_float


def _orientation_warnings(picture: Picture) -> list[str]:
    """Returns a warning if the file's EXIF orientation is ignored."""
    if picture.orientation == 1:
        return []
    return [
        f"TEXTURE: '{picture.name}' has the orientation {picture.orientation} of EXIF, which is "
        f"left out, as UV maps in Blender and glTF refer to rows as they are stored; turn the "
        f"picture where the mesh was made for it upright"
    ]


def _read_roughness(settings: Settings, *, turns: bool) -> Picture:
    return picture_files.read("--roughness", settings.roughness, is_data=True, turns=turns)
