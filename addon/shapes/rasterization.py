# SPDX-License-Identifier: GPL-3.0-or-later

"""Rasterization of shapes: read from Blender, computed, and written to Blender or to a file."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
from prefilter.workflows.shapes import rasterizing
from prefilter.workflows.shapes.layers import Source
from prefilter.workflows.shapes.pixels import stage

from ..bridge import drawn_images
from ..bridge.files import staging
from ..core.jobs import Progress, go_on, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence
from . import pixels
from .choices import RasterizeSettings
from .decal import refit
from .provenance import Request, store_request
from .sources import curves_source, svg_source, uv_source
from .views import PlanePose

# Durations in seconds, measured on two cores; only their ratio matters.
_SECONDS_PER_IMAGE = 0.005
_SECONDS_PER_PIXEL = 30e-9


@dataclass(frozen=True)
class Load:
    """The size of a finished work, from which that of others is estimated.

    Attributes:
        pixels: The number of pixels.
        settings: The settings.
    """

    pixels: int
    settings: RasterizeSettings

    def seconds(self, settings: RasterizeSettings) -> float:
        """Estimates the duration with other settings."""
        before, now = self.settings, settings
        count = float(self.pixels)
        if now.resolution == "size":
            count = float(now.width * now.height)
        elif now.resolution != before.resolution:
            count = count if now.resolution == "density" else float(now.side**2)
        elif now.resolution == "density":
            count *= (now.density / before.density) ** 2
        else:
            count *= (now.side / before.side) ** 2
        return _SECONDS_PER_IMAGE + _SECONDS_PER_PIXEL * count


class Rasterization:
    """An image of shapes: a new image, an update in place, or a file.

    `read` and `write` run on the main thread; `compute` uses no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self,
        source: Source,
        request: Request,
        settings: RasterizeSettings,
        warnings: list[str],
        *,
        image: bpy.types.Image | None = None,
        target: Path | None = None,
    ) -> None:
        """Stores copies of the inputs; use `Rasterization.read`."""
        self.warnings = warnings
        self.load: Load | None = None
        self.metadata: Mapping[str, str] | None = None
        """Metadata to store in a file."""
        self._source = source
        self._kind = request.source
        self._names = [obj.name for obj in request.objects]
        self._settings = settings
        self._image_uid = image.session_uid if image is not None else None
        self._image_name = image.name if image is not None else settings.image_name or source.name
        self._target = target
        self._drawing: drawn_images.Drawing | None = None
        self._staged: staging.StagedFile | None = None
        self._size = (0, 0)
        self._pose: PlanePose | None = None

    @classmethod
    def read(
        cls,
        request: Request,
        settings: RasterizeSettings,
        context: bpy.types.Context,
        *,
        image: bpy.types.Image | None = None,
        target: Path | None = None,
    ) -> "Rasterization":
        """Copies all inputs from Blender.

        Args:
            request: The shapes.
            settings: The settings.
            context: The context with the scene and the dependency graph.
            image: The image to update; None for a new one.
            target: A file to write instead, with an extension in `pictures.ENDINGS`.

        Raises:
            ValueError: There is nothing to draw, or a setting is not allowed.
            OSError: The SVG file does not exist.
        """
        check(settings)
        settings = replace(settings, source=request.source, filepath=request.filepath)
        source: Source
        if request.source == "svg":
            source, warnings = svg_source(request.filepath)
        elif request.source == "uv":
            settings = replace(settings, color="mask")
            depsgraph = context.evaluated_depsgraph_get()
            source, warnings = uv_source(request.objects[0], settings, depsgraph)
        else:
            source, warnings = curves_source(
                request.objects,
                settings,
                context.scene,
                context.evaluated_depsgraph_get(),
            )
        return cls(source, request, settings, warnings, image=image, target=target)

    def fingerprint(self) -> str | None:
        """Returns a fingerprint of inputs and settings; None if some inputs are unknown.

        Raises:
            OSError: A file cannot be read.
        """
        return self._source.inputs(self._settings)

    def compute(self, progress: Progress) -> None:
        """Draws the shapes.

        Raises:
            ValueError: There are no shapes, or they do not suit the settings.
            MemoryError: The image does not fit into memory.
            OSError: A file cannot be read or written.
            prefilter.Cancelled: `progress` returned False.
        """
        settings = self._settings
        drawn, image_pixels = rasterizing.rasterized(
            self._source, settings, share(progress, 0.0, 0.9), is_straight=self._is_straight()
        )
        self.warnings.extend(drawn.warnings)
        go_on(progress, 0.9)
        if self._target is None:
            self._drawing = pixels.drawing(image_pixels, settings)
        else:
            self._staged = stage(self._target, image_pixels, settings, self.metadata)
        self._size, self._pose = (drawn.width, drawn.height), drawn.place
        self.load = Load(drawn.width * drawn.height, settings)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the image into Blender, or the file into place.

        Raises:
            ValueError: The image to update was deleted.
            OSError: Blender cannot take the pixels, or the file cannot be put into place.
        """
        if self._staged is not None:
            self._staged.commit()
            target = str(self._staged.target)
            return Outcome(
                rasterizing.summary(self._source.name, target, self._size),
                files=[target],
                warnings=self.warnings,
            )
        assert self._drawing is not None
        if self._image_uid is None:
            image = drawn_images.new_image(self._image_name, self._drawing)
        else:
            image = self._found_image()
            drawn_images.draw_into(image, self._drawing)
        store_request(image, self._kind, self._names, self._settings, self._pose)
        refit(image)
        summary = Sentence("Rasterized '{}': {} x {} pixels", image.name, *self._size)
        if self._image_uid is not None:
            summary = Sentence("Updated '{}': {} x {} pixels", image.name, *self._size)
        return Outcome(summary, images=[image.name], warnings=self.warnings)

    def discard(self) -> None:
        """Deletes the staged file."""
        if self._staged is not None:
            self._staged.discard()

    def _is_straight(self) -> bool:
        if self._target is not None:
            return rasterizing.is_straight(self._target, self._settings)
        if self._settings.alpha != "auto":
            return self._settings.alpha == "straight"
        return self._settings.pixel_type == "byte"

    def _found_image(self) -> bpy.types.Image:
        for image in bpy.data.images:
            if image.session_uid == self._image_uid:
                return image
        raise ValueError(f"image '{self._image_name}' is gone")
