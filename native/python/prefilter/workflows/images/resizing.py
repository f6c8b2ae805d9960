# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing an image."""

from pathlib import Path
from typing import Any, cast

import prefilter

from ...options.images import FILTERS, ResizeSettings
from ..picture import FloatArray, Picture, Texels, light_or_bytes
from ..progress import Progress
from ..wording import Sentence
from .new_picture import Bytes, Keep, NewPicture


class Resizing(NewPicture):
    """The resizing of one image."""

    def __init__(
        self,
        picture: Picture,
        settings: ResizeSettings,
        *,
        target: Path | None = None,
        keep: Keep | None = None,
    ) -> None:
        """Takes the inputs.

        Args:
            picture: The image.
            settings: The size, the filter, and more.
            target: See `NewPicture`.
            keep: See `NewPicture`.
        """
        super().__init__(picture, settings, target=target, keep=keep)
        self.new_size = settings.new_size(*self.old_size)

    @property
    def suffix(self) -> str:
        """The new size."""
        return f"{self.new_size[0]}x{self.new_size[1]}"

    @property
    def summary(self) -> str:
        """Summary of the operation, for the user."""
        return Sentence(
            "Resized '{}' from {} x {} to {} x {} pixels with {}",
            *(self.picture.name, *self.old_size, *self.new_size),
            Sentence(FILTERS[self._settings.filter].label),
        )

    def filtered(self, linear: FloatArray, progress: Progress) -> FloatArray:
        """Returns the pixels of the new image."""
        resized: FloatArray = self._resized(linear, None, progress)
        return resized

    def filtered_bytes(self, progress: Progress) -> Bytes | None:
        """Returns the pixels of the new image as bytes."""
        texels, encoding = light_or_bytes(self.picture)
        resized: Bytes = self._resized(texels, encoding, progress)
        return resized

    def _resized(self, texels: Texels, encoding: str | None, progress: Progress) -> Any:
        settings = self._settings
        return prefilter.resize(
            texels,
            *self.new_size,
            filter=settings.filter,
            constrained=settings.use_constrained or not self.picture.is_float,
            ringing=settings.ringing,
            wrap=settings.wrap,
            premultiplied=not self.picture.alpha_is_straight,
            encoding=cast("Any", encoding),
            progress=progress,
            threads=settings.threads,
        )
