"""Resampling an image: scaled, rotated, in perspective, or out of it."""

from pathlib import Path

import prefilter

from ..bridge import images
from ..bridge.images import FloatArray, Picture
from ..core.jobs import Progress
from .choices import METHODS, TABLE_FILTERS, ResampleSettings
from .new_picture import NewPicture
from .placement import placement, squeeze
from .sampling_tables import load

_SUFFIXES = {"affine": "transformed", "corners": "pinned", "rectify": "rectified"}
_RADII = {"box": 0.5, "tent": 1.0, "bspline2": 1.5, "lanczos3": 3.0}
_PER_TEXEL = 8.0  # What a texel costs that mipmaps are made of, in texels read.
_DONE = {"affine": "Scaled and rotated", "corners": "Pinned", "rectify": "Rectified"}


class Resampling(NewPicture):
    """One image in another place."""

    def __init__(
        self,
        picture: Picture,
        settings: ResampleSettings,
        *,
        target: Path | None = None,
        in_place: bool = False,
    ) -> None:
        """Keeps what was read.

        Args:
            picture: The image.
            settings: Where it goes, the filter, and more.
            target: A file to write; None for a new image datablock.
            in_place: Whether whatever uses the image then uses the new one.

        Raises:
            ValueError: The settings make the image flat, fold it, or make it too large.
        """
        if settings.wrap == "border":
            picture = images.with_coverage(picture)
        super().__init__(picture, target=target, in_place=in_place)
        self._settings = settings
        self._placement = placement(settings, *self.old_size)

    @property
    def suffix(self) -> str:
        """What has become of the image."""
        return _SUFFIXES[self._settings.warp]

    @property
    def summary(self) -> str:
        """What is done to the image, for the user."""
        settings = self._settings
        return (
            f"{_DONE[settings.warp]} '{self._picture.name}' to {self._placement.width} x "
            f"{self._placement.height} pixels with {TABLE_FILTERS[settings.filter].label}, "
            f"{METHODS[settings.method].label}"
        )

    def filtered(self, linear: FloatArray, progress: Progress) -> FloatArray:
        """Returns the pixels of the new image."""
        settings = self._settings
        table = _table(settings)
        own_filter = isinstance(table, prefilter.SamplingTable)
        return prefilter.resample(
            linear,
            self._placement.transform,
            self._placement.width,
            self._placement.height,
            table=table,
            filter=table.filter if own_filter else settings.filter,
            exact=settings.method == "exact",
            max_probes=settings.max_probes,
            wrap=settings.wrap,
            premultiplied=not self._picture.alpha_is_straight,
            progress=progress,
            threads=settings.threads,
        )


def effort(settings: ResampleSettings, width: int, height: int) -> float:
    """Returns about how many pixels are read for an image of this size.

    Raises:
        ValueError: The settings make it flat, fold it, or make it too large.
    """
    placed = placement(settings, width, height)
    made = placed.width * placed.height
    if settings.method == "exact":
        reach = 2.0 * _RADII.get(settings.filter, 2.0)
        return made * reach**2 * squeeze(placed)
    texels = int(settings.method) if settings.method.isdigit() else 8
    mipmaps = _PER_TEXEL * width * height
    return mipmaps + made * texels * settings.max_probes


def _table(settings: ResampleSettings) -> "prefilter.SamplingTable | str | None":
    if settings.method == "exact":
        return None
    if settings.method == "trilinear":
        return "trilinear"
    if settings.method == "table":
        return load("Table", settings.table)
    return prefilter.SamplingTable.standard(settings.filter, texels=int(settings.method))
