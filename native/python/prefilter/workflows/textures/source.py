# SPDX-License-Identifier: GPL-3.0-or-later

"""An image on its surfaces, independent of Blender: the input of filtering, on any thread."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, cast

import numpy as np

import prefilter

from ...options.textures import Settings
from .. import picture as images
from ..picture import FloatArray, Picture
from ..progress import Progress, go_on, share
from ..wording import listed
from . import lookups

_LIMITS = {"unit": (0.0, 1.0), "positive": (0.0, None), "none": None}


@dataclass
class Source:
    """An image and the surfaces that it is mapped on, without Blender data.

    Attributes:
        picture: The pixels of the image.
        surfaces: The surfaces.
        objects: The name of the object that each surface comes from.
        settings: The settings of the bake.
        content: A key of `choices.CONTENTS`, except "auto".
        wrap: Wrap modes along u and v.
        warnings: Warnings for the user.
    """

    picture: Picture
    surfaces: list[prefilter.Surface]
    objects: Sequence[str]
    settings: Settings
    content: str
    wrap: tuple[str, str]
    warnings: list[str] = field(default_factory=list)

    @property
    def image_name(self) -> str:
        """The name of the image."""
        return self.picture.name

    @property
    def threads(self) -> int:
        """How many threads to use; 0 for all."""
        return self.settings.threads

    @property
    def reader(self) -> str:
        """How the levels are looked up, as `prefilter.mipmaps` names it."""
        return self.settings.reader if reads_encoded(self.picture) else "linear"

    @property
    def footprint(self) -> float:
        """The width of a pixel in texels of a level, as `prefilter.mipmaps` takes it."""
        return self.footprint_of(self.settings.filter)

    @property
    def fits_views(self) -> bool:
        """Whether levels are fitted to views of the objects."""
        return lookups.fits_views(self.settings, self.content, self.reader, self.objects)

    def footprint_of(self, filter: str) -> float:
        """Returns `footprint` for another filter."""
        if self.fits_views and filter == self.settings.filter:
            return lookups.BEFORE_VIEWS
        return lookups.footprint(self.settings, filter, self.reader)

    def bounds(self, texels: images.Texels) -> tuple[float | None, float | None] | None:
        """Returns the allowed range of the levels of texels."""
        if self.settings.bounds != "auto":
            return _LIMITS[self.settings.bounds]
        if texels.dtype == np.uint8:
            return _LIMITS["unit"]
        is_associated = self.picture.alpha_is_associated
        return images.automatic_bounds(texels, is_associated=is_associated)

    def capped(self, levels: list[FloatArray], linear: FloatArray) -> list[FloatArray]:
        """Limits levels 1 and up where `bounds` leaves associated alpha without an upper limit."""
        if self.settings.bounds != "auto" or not self.picture.alpha_is_associated:
            return levels
        return [images.capped(level, linear) for level in levels]

    def linear(self, progress: Progress) -> FloatArray:
        """Returns the image's scene-linear values; raises what `filtered` does."""
        return images.scene_linear(self.picture, partial(go_on, progress, 0.0))

    def filtered(
        self,
        linear: FloatArray,
        filter: str,
        progress: Progress,
        *,
        levels: int | None = None,
        seam_budget: float | None = None,
        footprint: float | None = None,
    ) -> list[FloatArray]:
        """Returns scene-linear levels with any filter.

        Args:
            linear: The result of `linear`.
            filter: A key of `FILTERS`.
            progress: Called with the fraction done.
            levels: How many, including the image itself; None for all.
            seam_budget: See `prefilter.mipmaps`; None for that of the settings.
            footprint: See `prefilter.mipmaps`; None for that of the settings.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
        """
        fits = self.fits_views and filter == self.settings.filter
        fits = fits and seam_budget is None and footprint is None
        if seam_budget is None:
            seam_budget = self.settings.seam_budget / 100.0
        if footprint is None:
            footprint = self.footprint_of(filter)
        with self.naming_objects():
            result: list[FloatArray] = prefilter.mipmaps(
                linear,
                self.surfaces or None,
                filter=cast("Any", filter),
                wrap=cast("Any", self.wrap),
                bounds=self.bounds(linear),
                levels=levels,
                premultiplied=not self.picture.alpha_is_straight,
                reader=cast("Any", self.reader),
                seam_budget=seam_budget,
                footprint=footprint,
                progress=share(progress, 0.0, 0.2) if fits else progress,
                threads=self.settings.threads,
            )
        if fits:
            result = self.fitted_to_views(result, self.bounds(linear), share(progress, 0.2, 1.0))
        return [*result[:1], *self.capped(result[1:], linear)]

    def fitted_to_views(
        self,
        levels: list[FloatArray],
        bounds: tuple[float | None, float | None] | None,
        progress: Progress,
    ) -> list[FloatArray]:
        """Returns levels, including level 0, fitted to views from an initial guess."""
        with self.naming_objects():
            return prefilter.fit_to_views(
                levels,
                self.surfaces,
                wrap=cast("Any", self.wrap),
                bounds=bounds,
                premultiplied=not self.picture.alpha_is_straight,
                progress=progress,
                threads=self.settings.threads,
            )

    @contextmanager
    def naming_objects(self) -> Iterator[None]:
        """A context in which error messages name objects instead of surfaces."""
        try:
            yield
        except ValueError as error:
            raise ValueError(_naming_objects(str(error), self.objects)) from error

    def release_pixels(self) -> None:
        """Frees the memory of the image and of the surfaces."""
        self.picture = without_pixels(self.picture)
        self.surfaces = []


def without_pixels(picture: Picture) -> Picture:
    """Returns the picture without the memory of its pixels."""
    return replace(picture, texels=np.empty((0, 0, 4), np.float32))


def reads_encoded(picture: Picture) -> bool:
    """Tells whether some renderers interpolate the picture's texels in encoded form."""
    return picture.encoding is images.Encoding.SRGB and not picture.is_float


def _naming_objects(message: str, objects: Sequence[str]) -> str:
    """Replaces surfaces by objects in an error message of the library."""
    match = re.match(r"surface (\d+)\b", message)
    if match and int(match[1]) < len(objects):
        return f"object '{objects[int(match[1])]}'{message[match.end() :]}"
    if message.startswith("surface:") and objects:
        names = list(dict.fromkeys(objects))
        noun = "object" if len(names) == 1 else "objects"
        return f"{noun} {listed(names)}: {message.removeprefix('surface:').lstrip()}"
    return message
