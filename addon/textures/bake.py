# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of one image: computed on any thread from the inputs, then written to Blender.

Both the operator and the command use it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from prefilter.workflows import outcome, up_to_date
from prefilter.workflows.textures import levels, stretching
from prefilter.workflows.textures.outputs import Outputs, inputs_fingerprint, stage_files, summary

from ..bridge.files.staging import StagedFile, commit_all
from ..bridge.images import FloatArray, Picture
from ..bridge.level_images import StagedLevels, level_name, stage_levels
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from . import frames
from .source import Source, without_pixels

_FILTERED = 0.9  # The progress after filtering.


class Bake:
    """One bake.

    `write` runs on the main thread; `compute` uses no Blender data and runs on any thread. Nothing
    is written before everything is computed.
    """

    def __init__(self, source: Source, outputs: Outputs, *, may_skip: bool = False) -> None:
        """Stores copies of the inputs; use `bake_inputs.read`.

        Args:
            source: The image on its surfaces.
            outputs: The levels and files to make.
            may_skip: Whether to leave files alone that were made from the same inputs; files then
                store a fingerprint of their inputs.
        """
        self.source = source
        self.is_up_to_date = False
        """Whether `compute` found all files up to date."""
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
        """The name of the baked image."""
        return self.source.image_name

    @property
    def picture(self) -> Picture:
        """The pixels of the baked image."""
        return self.source.picture

    @property
    def objects(self) -> Sequence[str]:
        """The name of each surface's object."""
        return self.source.objects

    @property
    def notes(self) -> Sequence[str]:
        """Remarks about the computed levels."""
        return self._notes

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The finished files, beside their targets."""
        return self._staged

    @property
    def files(self) -> list[Path]:
        """The files that exist after `write`."""
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
            fingerprint = inputs_fingerprint(self.source, self._outputs)
            self.is_up_to_date = up_to_date.is_up_to_date(self._outputs.targets, fingerprint)
            self._metadata = {up_to_date.KEY: fingerprint}
        if self.is_up_to_date:
            go_on(progress, 1.0)
            return
        self._outputs, notes = stretching.stretch(self.source, self._outputs, progress)
        self._notes += notes
        color_levels, roughness_levels, note = levels.filtered(
            self.source,
            self._outputs.roughness,
            share(progress, 0.0, _FILTERED),
            all_levels=bool(self._outputs.targets),
        )
        self._notes += [note] if note else []
        try:
            check = partial(go_on, progress, _FILTERED)
            self._stage(color_levels, roughness_levels, check)
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def _stage(
        self,
        color_levels: list[FloatArray],
        roughness_levels: list[FloatArray],
        check: Callable[[], None],
    ) -> None:
        """Stages the files, and stores the levels for the level images."""
        results = stage_files(
            self.source,
            self._outputs,
            color_levels,
            roughness_levels,
            check=check,
            metadata=self._metadata,
        )
        own_levels = [self._levels, self._roughness_levels]
        for own, (files, stored) in zip(own_levels, results, strict=False):
            self._staged += files
            own[:] = stored

    def write(self) -> Outcome:
        """Puts the files into place and writes the level images.

        Raises:
            OSError: A file cannot be put into place, or an image cannot be made; then nothing is
                written.
        """
        return write_all([self])[0]

    def stage_images(self) -> None:
        """Makes the level images, without replacing earlier ones; a second call does nothing.

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
        """Puts the level images into place, after the files."""
        if self.is_up_to_date:
            return Outcome(outcome.up_to_date(self._outputs.targets), warnings=self.warnings)
        names: list[str] = []
        for images in self._staged_levels:
            new_names = images.commit()
            names += new_names
            base = images.picture.name
            if any(name != level_name(base, i) for i, name in enumerate(new_names, start=1)):
                self.warnings.append(Sentence("the level images are named {}", listed(new_names)))
        self._staged_levels.clear()
        self.discard()
        return Outcome(
            summary(
                self.source, self._outputs, names, frames.averaged_frames(self.source.settings)
            ),
            images=names,
            files=[str(target) for target in self._outputs.targets],
            warnings=self.warnings,
            notes=self._notes,
        )

    def release_pixels(self) -> None:
        """Frees the pixels and levels, which are in staged files and images by now."""
        self.source.release_pixels()
        rough = self._outputs.roughness
        if rough is not None:
            empty = without_pixels(rough.picture)
            rough = replace(rough, picture=empty, linear=np.empty((0, 0, 4), np.float32))
            self._outputs = replace(self._outputs, roughness=rough)
        self._levels, self._roughness_levels = [], []

    def discard(self) -> None:
        """Deletes staged files and images that were not put into place."""
        for file in self._staged:
            file.discard()
        for images in self._staged_levels:
            images.discard()
        self._staged.clear()
        self._staged_levels.clear()


class Writable(Protocol):
    """A computed bake, of an image or of all its tiles."""

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
    """Writes the results of bakes: all of them, or none.

    Raises:
        OSError: A file cannot be put into place, or an image cannot be made; then nothing is
            written, except files that the message names.
    """
    try:
        for bake in bakes:
            bake.stage_images()
        commit_all([file for bake in bakes for file in bake.staged_files])
    except BaseException:
        for bake in bakes:
            bake.discard()
        raise
    return [bake.finish() for bake in bakes]
