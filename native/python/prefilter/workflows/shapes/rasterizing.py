# SPDX-License-Identifier: GPL-3.0-or-later

"""Rasterizing shapes into pixels, and into files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

import prefilter

from ...files import staging
from ...options.options import check
from ...options.shapes import RasterizeSettings
from ..outcome import Outcome
from ..progress import Progress, go_on, share
from ..wording import Sentence
from . import pixels
from .layers import PlacedShapes, Source

_READ, _DRAWN = 0.1, 2 / 3
"""Progress once the shapes exist, and once they are drawn."""


def rasterized(
    source: Source, settings: RasterizeSettings, progress: Progress, *, is_straight: bool
) -> tuple[PlacedShapes, pixels.Pixels]:
    """Draws shapes.

    Raises:
        ValueError: There are no shapes, or they do not fit the settings.
        MemoryError: The image does not fit into memory.
        OSError: A file cannot be read.
        prefilter.Cancelled: `progress` returned False.
    """
    drawn = source.drawn(settings, share(progress, 0.0, _READ))
    raster: Any
    if drawn.draw is not None:
        raster = drawn.draw(share(progress, _READ, _DRAWN))
    elif drawn.shapes:
        raster = prefilter.rasterize(
            drawn.shapes,
            drawn.width,
            drawn.height,
            filter=cast("Any", settings.filter),
            overlap=settings.overlap,
            progress=share(progress, _READ, _DRAWN),
            threads=settings.threads,
        )
    else:
        raster = np.zeros((drawn.height, drawn.width, 1), np.float32)
    image = pixels.finished(
        raster,
        drawn.color if drawn.shapes or drawn.draw else (1.0, 1.0, 1.0, 1.0),
        settings,
        light=drawn.light,
        is_straight=is_straight,
        progress=share(progress, _DRAWN, 1.0),
    )
    return drawn, image


def is_straight(target: Path, settings: RasterizeSettings) -> bool:
    """Tells whether a file's colors are not multiplied by alpha."""
    if settings.alpha != "auto":
        return settings.alpha == "straight"
    return target.suffix.lower() == ".png"


def summary(name: str, target: str, size: tuple[int, int]) -> str:
    """Returns a summary line."""
    return Sentence("Rasterized '{}' to '{}': {} x {} pixels", name, target, *size)


class RasterFile:
    """Rasterizes shapes into a file."""

    def __init__(
        self, source: Source, target: Path, settings: RasterizeSettings, warnings: list[str]
    ) -> None:
        """Takes the shapes, the file to write, the settings, and warnings to report."""
        check(settings)
        self.metadata: Mapping[str, str] | None = None
        """Key-value pairs to store in the file."""
        self._source = source
        self._target = target
        self._settings = settings
        self._warnings = warnings
        self._staged: staging.StagedFile | None = None
        self._done = ""

    def compute(self, progress: Progress) -> None:
        """Draws the shapes and stages the file; raises what `rasterized` does."""
        drawn, image = rasterized(
            self._source,
            self._settings,
            share(progress, 0.0, 0.9),
            is_straight=is_straight(self._target, self._settings),
        )
        go_on(progress, 0.9)
        self._warnings.extend(drawn.warnings)
        self._done = summary(self._source.name, str(self._target), (drawn.width, drawn.height))
        self._staged = pixels.stage(self._target, image, self._settings, self.metadata)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the file into place."""
        assert self._staged is not None
        self._staged.commit()
        return Outcome(self._done, files=[str(self._target)], warnings=self._warnings)

    def discard(self) -> None:
        """Removes the staged file if it was not put into place."""
        if self._staged is not None:
            self._staged.discard()
