# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes to an image in three steps: read from Blender, compute, write to Blender or to a file."""

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
from .framing import Place
from .memory import Request, remember
from .sources import curves_source, svg_source, uv_source

# What a load takes in seconds, as measured once on two cores; ratios are what counts.
_ALWAYS = 0.005
_PER_PIXEL = 30e-9


@dataclass(frozen=True)
class Load:
    """What decides how long an image takes.

    Attributes:
        pixels: How many it had.
        settings: What it was made with.
    """

    pixels: int
    settings: RasterizeSettings

    def seconds(self, settings: RasterizeSettings) -> float:
        """Returns about how long it takes with other settings."""
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
        return _ALWAYS + _PER_PIXEL * count


class Rasterization:
    """An image of shapes: a new one, one that is made again in place, or a file.

    `read` and `write` belong on the main thread; `compute` touches no Blender data and runs on any
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
        """Keeps copies of what was read; use `Rasterization.read`."""
        self.warnings = warnings
        self.load: Load | None = None
        self.metadata: Mapping[str, str] | None = None
        """What a file is to keep, by keys."""
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
        self._place: Place | None = None

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
        """Copies everything that the work needs out of Blender.

        Args:
            request: What to make an image of.
            settings: How.
            context: The scene and the dependency graph.
            image: The image that is made again; None for a new one.
            target: A path of `pictures.ENDINGS` for a file instead.

        Raises:
            ValueError: There is nothing to draw, or a setting is not allowed.
            OSError: There is no such SVG file.
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

    def inputs(self) -> str | None:
        """Returns a number of what was read, and of how it is drawn; None where it may not be all.

        Raises:
            OSError: A file cannot be read.
        """
        return self._source.inputs(self._settings)

    def compute(self, progress: Progress) -> None:
        """Draws the shapes.

        Raises:
            ValueError: There are none, or they do not fit the settings.
            MemoryError: The image does not fit into memory.
            OSError: A file cannot be read or written.
            prefilter.Cancelled: `progress` has said so.
        """
        settings = self._settings
        drawn, made = rasterizing.rasterized(
            self._source, settings, share(progress, 0.0, 0.9), is_straight=self._is_straight()
        )
        self.warnings.extend(drawn.warnings)
        go_on(progress, 0.9)
        if self._target is None:
            self._drawing = pixels.drawing(made, settings)
        else:
            self._staged = stage(self._target, made, settings, self.metadata)
        self._size, self._place = (drawn.width, drawn.height), drawn.place
        self.load = Load(drawn.width * drawn.height, settings)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the image into Blender, or the file into place.

        Raises:
            ValueError: The image that was to be made again is gone.
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
        remember(image, self._kind, self._names, self._settings, self._place)
        refit(image)
        done = Sentence("Rasterized '{}': {} x {} pixels", image.name, *self._size)
        if self._image_uid is not None:
            done = Sentence("Updated '{}': {} x {} pixels", image.name, *self._size)
        return Outcome(done, images=[image.name], warnings=self.warnings)

    def discard(self) -> None:
        """Removes what was staged."""
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
