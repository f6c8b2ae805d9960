# SPDX-License-Identifier: GPL-3.0-or-later

"""Baking mipmaps: what `reading` has read is computed anywhere, and then written to Blender.

The operator and the command are two ways to call this.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np

from ..bridge import images
from ..bridge.files import engines, textures
from ..bridge.files.staging import StagedFile, commit_all
from ..bridge.images import FloatArray, Picture
from ..bridge.level_images import StagedLevels, level_name, stage_levels
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from ..core.wording import Sentence, counted, joined, listed, together
from . import frames, levels, lookups
from .choices import CONTENTS, FILTERS, Settings
from .contents import Roughness
from .source import Source, without_pixels

_FILTERED = 0.9  # What the progress is once the levels are filtered.
_FIRST_FILTERED = 0.6  # The same where they are then compared with others.


@dataclass(frozen=True)
class Outputs:
    """What a bake makes beside level images.

    Attributes:
        target: The file of the levels; None for none.
        roughness: The roughness whose levels are baked, too; None for none.
        roughness_target: The file of its levels; None for none.
        writes_image: Whether the image's own levels are written, and not only those of its
            roughness.
    """

    target: Path | None
    roughness: Roughness | None = None
    roughness_target: Path | None = None
    writes_image: bool = True

    @property
    def targets(self) -> list[Path]:
        """The files."""
        return [one for one in (self.target, self.roughness_target) if one is not None]


class Bake:
    """One bake.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    Nothing is written before everything is computed.
    """

    def __init__(self, source: Source, outputs: Outputs) -> None:
        """Keeps copies of what was read; use `reading.read`."""
        self.source = source
        self.warnings = source.warnings
        self._outputs = outputs
        self._notes: list[str] = []
        self._levels: list[FloatArray] = []
        self._roughness_levels: list[FloatArray] = []
        self._staged: list[StagedFile] = []
        self._staged_levels: list[StagedLevels] = []

    @property
    def image_name(self) -> str:
        """The name of the image that is baked."""
        return self.source.image_name

    @property
    def picture(self) -> Picture:
        """The pixels of the image that is baked."""
        return self.source.picture

    @property
    def objects(self) -> Sequence[str]:
        """The name of the object that each surface comes from."""
        return self.source.objects

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The finished files, beside their targets."""
        return self._staged

    def compute(self, progress: Progress) -> None:
        """Filters, encodes and stages the file.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
            OSError: The file cannot be written.
        """
        go_on(progress, 0.0)
        made, rough = self._filtered(progress)
        try:
            self._stage(made, rough, partial(go_on, progress, _FILTERED))
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def _filtered(self, progress: Progress) -> tuple[list[FloatArray], list[FloatArray]]:
        """Returns the levels of the image and of its roughness; notes what heeding seams did."""
        source, outputs = self.source, self._outputs
        heeds_seams = levels.heeds_seams(source)
        end = _FIRST_FILTERED if heeds_seams else _FILTERED
        with source.naming_objects():
            made, rough = levels.above_0(
                source,
                outputs.roughness,
                share(progress, 0.0, end),
                all_levels=bool(outputs.targets),
            )
            if heeds_seams:
                note = levels.seam_note(source, made, share(progress, end, _FILTERED))
                self._notes += [note] if note else []
        return made, rough

    def _stage(
        self, made: list[FloatArray], rough: list[FloatArray], check: Callable[[], None]
    ) -> None:
        """Stages the files, and keeps the levels as level images hold them."""
        source, outputs = self.source, self._outputs
        stage = partial(_staged, settings=source.settings, wrap=source.wrap, check=check)
        texture_format = source.settings.texture_format
        files, self._levels = stage(source.picture, made, outputs.target, texture_format)
        self._staged += files
        if outputs.roughness is not None:
            picture, texture_format = outputs.roughness.picture, outputs.roughness.texture_format
            target = outputs.roughness_target
            files, self._roughness_levels = stage(picture, rough, target, texture_format)
            self._staged += files

    def write(self) -> Outcome:
        """Puts the file into place and writes the level images.

        Raises:
            OSError: The file cannot be put into place, or an image cannot be made; nothing was
                written then.
        """
        return write_all([self])[0]

    def stage_images(self) -> None:
        """Makes the level images, which replace none yet; once is enough.

        Raises:
            OSError: An image cannot be made.
        """
        if self._staged_levels:
            return
        pairs = [(self.picture, self._levels)] if self._outputs.writes_image else []
        if self._outputs.roughness is not None:
            pairs.append((self._outputs.roughness.picture, self._roughness_levels))
        try:
            for picture, levels in pairs if self.source.settings.use_images else ():
                self._staged_levels.append(stage_levels(picture, levels))
        except BaseException:
            self.discard()
            raise

    def finish(self) -> Outcome:
        """Puts the level images into place; the files are there already."""
        names: list[str] = []
        for staged in self._staged_levels:
            made = staged.commit()
            names += made
            base = staged.picture.name
            if any(name != level_name(base, i) for i, name in enumerate(made, start=1)):
                self.warnings.append(Sentence("the level images are named {}", listed(made)))
        self._staged_levels.clear()
        self.discard()
        return Outcome(
            summary(self.source, self._outputs, names),
            images=names,
            files=[str(target) for target in self._outputs.targets],
            warnings=self.warnings,
            notes=self._notes,
        )

    def let_pixels_go(self) -> None:
        """Frees the memory of what is in staged files; of level images nothing is left."""
        self.source.let_pixels_go()
        rough = self._outputs.roughness
        if rough is not None:
            empty = without_pixels(rough.picture)
            rough = replace(rough, picture=empty, linear=np.empty((0, 0, 4), np.float32))
            self._outputs = replace(self._outputs, roughness=rough)
        self._levels, self._roughness_levels = [], []

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for file in self._staged:
            file.discard()
        for staged in self._staged_levels:
            staged.discard()
        self._staged.clear()
        self._staged_levels.clear()


def _staged(
    picture: Picture,
    made: list[FloatArray],
    target: Path | None,
    texture_format: str,
    *,
    settings: Settings,
    wrap: tuple[str, str],
    check: Callable[[], None],
) -> tuple[list[StagedFile], list[FloatArray]]:
    """Stages a file of an image and its levels; returns these as level images hold them, too."""
    stored: list[FloatArray] = []
    if settings.use_images or (target is not None and textures.is_stored(target)):
        stored = [images.encoded(picture, level, check) for level in made]
    files: list[StagedFile] = []
    threads = settings.threads
    if target is not None and engines.is_for_engines(target):
        linear = images.scene_linear(picture, check)
        files += engines.stage(
            target,
            picture,
            [linear, *made],
            [picture.stored, *stored],
            texture_format,
            check,
            supercompression=settings.supercompression,
            threads=threads,
        )
    elif target is not None:
        files.append(textures.stage(target, picture, made, stored, wrap, check, threads=threads))
    return files, stored[: settings.levels - 1 if settings.levels else None]


def summary(source: Source, outputs: Outputs, names: Sequence[str]) -> str:
    """Returns a line that says what was baked, over what, and into which images and files.

    Args:
        source: The image.
        outputs: What was to be made.
        names: The level images that were made.
    """
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
        if settings.use_frames:
            parts.append(Sentence("at {}", counted(frames.chosen(settings), "frame")))
    if source.footprint:
        parts.append(lookups.described(source.footprint, fits=source.fits_views))
    results: list[str] = [counted(names, "level image")] if names else []
    results += map(textures.shown, outputs.targets)
    if not results:
        return Sentence("{}; it has no further level", joined(" ", parts))
    return joined(" ", [*parts, Sentence("into {}", together(results))])


class Writable(Protocol):
    """A bake, of an image or of all of its tiles, that is computed."""

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """See `Bake.staged_files`."""

    def stage_images(self) -> None:
        """See `Bake.stage_images`."""

    def finish(self) -> Outcome:
        """See `Bake.finish`."""

    def discard(self) -> None:
        """See `Bake.discard`."""


def write_all(bakes: Sequence[Writable]) -> list[Outcome]:
    """Writes what bakes have computed: everything, or nothing.

    Raises:
        OSError: A file cannot be put into place, or an image cannot be made; nothing was written
            then, but for files that the message names.
    """
    try:
        for one in bakes:
            one.stage_images()
        commit_all([file for one in bakes for file in one.staged_files])
    except BaseException:
        for one in bakes:
            one.discard()
        raise
    return [one.finish() for one in bakes]
