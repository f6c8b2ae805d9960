# SPDX-License-Identifier: GPL-3.0-or-later

"""Baking mipmaps: what `reading` has read is computed anywhere, and then written to Blender.

The operator and the command are two ways to call this.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from prefilter.workflows import outcome, up_to_date
from prefilter.workflows.mipmaps import levels, stretching
from prefilter.workflows.mipmaps.outputs import Outputs, inputs_fingerprint, stage_files, summary

from ..bridge.files.staging import StagedFile, commit_all
from ..bridge.images import FloatArray, Picture
from ..bridge.level_images import StagedLevels, level_name, stage_levels
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from . import frames
from .source import Source, without_pixels

_FILTERED = 0.9  # What the progress is once the levels are filtered.


class Bake:
    """One bake.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    Nothing is written before everything is computed.
    """

    def __init__(self, source: Source, outputs: Outputs, *, may_skip: bool = False) -> None:
        """Keeps copies of what was read; use `reading.read`.

        Args:
            source: The image on its surfaces.
            outputs: What is made of it.
            may_skip: Whether files are left alone that were made of the same; files then keep what
                they were made of.
        """
        self.source = source
        self.is_up_to_date = False
        """Whether `compute` has found that nothing is to be done."""
        self._may_skip = may_skip
        self._metadata: dict[str, str] | None = None
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
    def notes(self) -> Sequence[str]:
        """What is good to know of what was computed."""
        return self._notes

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The finished files, beside their targets."""
        return self._staged

    @property
    def files(self) -> list[Path]:
        """The files that there are once what was computed is written."""
        if self.is_up_to_date:
            return self._outputs.targets
        return [file.target for file in self._staged]

    def compute(self, progress: Progress) -> None:
        """Filters, encodes and stages the file.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
            OSError: The file cannot be written.
        """
        go_on(progress, 0.0)
        if self._may_skip:
            number = inputs_fingerprint(self.source, self._outputs)
            self.is_up_to_date = up_to_date.is_up_to_date(self._outputs.targets, number)
            self._metadata = {up_to_date.KEY: number}
        if self.is_up_to_date:
            go_on(progress, 1.0)
            return
        self._outputs, told = stretching.stretch(self.source, self._outputs, progress)
        self._notes += told
        made, rough, note = levels.filtered(
            self.source,
            self._outputs.roughness,
            share(progress, 0.0, _FILTERED),
            all_levels=bool(self._outputs.targets),
        )
        self._notes += [note] if note else []
        try:
            self._stage(made, rough, partial(go_on, progress, _FILTERED))
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def _stage(
        self, made: list[FloatArray], rough: list[FloatArray], check: Callable[[], None]
    ) -> None:
        """Stages the files, and keeps the levels as level images hold them."""
        own_levels = [self._levels, self._roughness_levels]
        found = stage_files(
            self.source, self._outputs, made, rough, check=check, metadata=self._metadata
        )
        for kept, (files, stored) in zip(own_levels, found, strict=False):
            self._staged += files
            kept[:] = stored

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
        if self.is_up_to_date:
            return Outcome(outcome.up_to_date(self._outputs.targets), warnings=self.warnings)
        names: list[str] = []
        for images in self._staged_levels:
            made = images.commit()
            names += made
            base = images.picture.name
            if any(name != level_name(base, i) for i, name in enumerate(made, start=1)):
                self.warnings.append(Sentence("the level images are named {}", listed(made)))
        self._staged_levels.clear()
        self.discard()
        return Outcome(
            summary(self.source, self._outputs, names, frames.averaged(self.source.settings)),
            images=names,
            files=[str(target) for target in self._outputs.targets],
            warnings=self.warnings,
            notes=self._notes,
        )

    def release_pixels(self) -> None:
        """Frees the memory of what is in staged files; of level images nothing is left."""
        self.source.release_pixels()
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
        for images in self._staged_levels:
            images.discard()
        self._staged.clear()
        self._staged_levels.clear()


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
