# SPDX-License-Identifier: GPL-3.0-or-later

"""Resampling an image: scaling, rotating, pinning corners, or rectifying."""

from pathlib import Path
from typing import Any, cast

import prefilter

from ...options.images import METHODS, SUFFIXES, TABLE_FILTERS, ResampleSettings
from ..picture import FloatArray, Picture, with_coverage
from ..progress import Progress
from ..wording import Sentence, joined
from .new_picture import Keep, NewPicture
from .placement import mean_footprint, placement

_RADII = {filter.name: filter.radius for filter in prefilter.PIXEL_FILTERS}
_PER_PIXEL, _PER_WEIGHT = 8.0, 0.2  # Cost of the exact filter, in texels read.
_PER_TEXEL = 8.0  # Cost of making mipmaps, in texels read per texel.
_DONE = {
    "affine": Sentence("Scaled and rotated '{}' to {} x {} pixels with {}"),
    "corners": Sentence("Pinned '{}' to {} x {} pixels with {}"),
    "rectify": Sentence("Rectified '{}' to {} x {} pixels with {}"),
}


class Resampling(NewPicture):
    """The resampling of one image."""

    def __init__(
        self,
        picture: Picture,
        settings: ResampleSettings,
        *,
        target: Path | None = None,
        keep: Keep | None = None,
    ) -> None:
        """Takes the inputs.

        Args:
            picture: The image.
            settings: The transform, the filter, and more.
            target: See `NewPicture`.
            keep: See `NewPicture`.

        Raises:
            ValueError: The settings make the image flat, fold it, or make it too large.
        """
        if settings.wrap == "border":
            picture = with_coverage(picture)
        super().__init__(picture, settings, target=target, keep=keep)
        self._placement = placement(settings, *self.old_size)

    @property
    def suffix(self) -> str:
        """The kind of transform."""
        return SUFFIXES[self._settings.warp]

    @property
    def summary(self) -> str:
        """Summary of the operation, for the user."""
        settings = self._settings
        means = [METHODS[settings.method].label]
        if settings.method != "table":
            means.insert(0, TABLE_FILTERS[settings.filter].label)
        size = self._placement.width, self._placement.height
        labels = joined(", ", [Sentence(label) for label in means])
        return Sentence(_DONE[settings.warp], self.picture.name, *size, labels)

    def filtered(self, linear: FloatArray, progress: Progress) -> FloatArray:
        """Returns the pixels of the new image."""
        settings = self._settings
        table = _table(settings)
        filter = table.filter if isinstance(table, prefilter.SamplingTable) else settings.filter
        return prefilter.resample(
            linear,
            self._placement.transform,
            self._placement.width,
            self._placement.height,
            table=table,
            filter=cast("Any", filter),
            exact=settings.method == "exact",
            max_probes=settings.max_probes if filter == "gaussian" else 1,
            wrap=settings.wrap,
            premultiplied=not self.picture.alpha_is_straight,
            progress=progress,
            threads=settings.threads,
        )


def load(label: str, path: str) -> "prefilter.SamplingTable":
    """Loads a table.

    Raises:
        ValueError: No file is named, or it holds no table.
        OSError: It cannot be read.
    """
    if not path:
        raise ValueError(f"{label}: no file is named")
    try:
        return prefilter.SamplingTable.load(path)
    except ValueError as error:
        raise ValueError(f"{label}: {error}") from error


def effort(settings: ResampleSettings, width: int, height: int) -> float:
    """Estimates how many texels are read to resample an image of this size.

    Raises:
        ValueError: The settings make it flat, fold it, or make it too large.
    """
    placed = placement(settings, width, height)
    pixels = placed.width * placed.height
    if settings.method == "exact":
        reach = 2.0 * _RADII[settings.filter]
        return pixels * (
            _PER_PIXEL + _PER_WEIGHT * reach**2 * mean_footprint(placed, width, height)
        )
    texels = int(settings.method) if settings.method.isdigit() else 8
    probes = settings.max_probes if settings.filter == "gaussian" else 1
    return pixels * texels * probes + _PER_TEXEL * width * height


def _table(settings: ResampleSettings) -> "prefilter.SamplingTable | str | None":
    if settings.method == "exact":
        return None
    if settings.method == "trilinear":
        return "trilinear"
    if settings.method == "table":
        return load("Table", settings.table)
    return prefilter.SamplingTable.standard(
        cast("Any", settings.filter), texels=int(settings.method)
    )
