# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing an image."""

from pathlib import Path

import prefilter

from ..bridge.images import FloatArray, Picture
from ..core.jobs import Progress
from ..core.wording import Sentence
from .choices import FILTERS, ResizeSettings
from .new_picture import NewPicture


class Resizing(NewPicture):
    """One image of another size."""

    def __init__(
        self,
        picture: Picture,
        settings: ResizeSettings,
        *,
        target: Path | None = None,
        in_place: bool = False,
    ) -> None:
        """Keeps what was read.

        Args:
            picture: The image.
            settings: The size, the filter, and more.
            target: A file to write; None for a new image datablock.
            in_place: Whether whatever uses the image then uses the new one.
        """
        super().__init__(picture, target=target, in_place=in_place)
        self.new_size = settings.new_size(*self.old_size)
        self._settings = settings

    @property
    def suffix(self) -> str:
        """The size."""
        return f"{self.new_size[0]}x{self.new_size[1]}"

    @property
    def summary(self) -> str:
        """What is done to the image, for the user."""
        return Sentence(
            "Resized '{}' from {} x {} to {} x {} pixels with {}",
            *(self._picture.name, *self.old_size, *self.new_size),
            Sentence(FILTERS[self._settings.filter].label),
        )

    def filtered(self, linear: FloatArray, progress: Progress) -> FloatArray:
        """Returns the pixels of the new image."""
        settings = self._settings
        return prefilter.resize(
            linear,
            *self.new_size,
            filter=settings.filter,
            constrained=settings.use_constrained or not self._picture.is_float,
            wrap=settings.wrap,
            premultiplied=not self._picture.alpha_is_straight,
            progress=progress,
            threads=settings.threads,
        )
