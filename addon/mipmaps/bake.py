# SPDX-License-Identifier: GPL-3.0-or-later

"""Baking mipmaps: what `reading` has read is computed anywhere, and then written to Blender.

The operator and the command are two ways to call this.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import prefilter

from ..bridge import images, materials, meshes
from ..bridge.files import engines, textures
from ..bridge.files.staging import StagedFile, commit_all
from ..bridge.images import FloatArray, Picture
from ..bridge.level_images import StagedLevels, level_name, stage_levels
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from ..core.wording import counted, listed
from . import contents, frames, lookups, seams
from .choices import CONTENTS, FILTERS, SEAM_FILTERS, Settings

_FILTERED = 0.9  # What the progress is once the levels are filtered.
_FIRST_FILTERED = 0.6  # The same where they are then compared with others.
_LIMITS = {"unit": (0.0, 1.0), "positive": (0.0, None), "none": None}


class Bake:
    """One bake.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    Nothing is written before everything is computed.
    """

    def __init__(
        self,
        picture: Picture,
        found: meshes.ImageSurfaces,
        settings: Settings,
        target: Path | None,
        content: str,
        roughness: contents.Roughness | None = None,
        roughness_target: Path | None = None,
        *,
        writes_image: bool = True,
    ) -> None:
        """Keeps copies of what was read; use `reading.read`.

        `writes_image` is whether its levels are written, too, and not only those of its roughness.
        """
        self.warnings = list(found.problems)
        self._notes: list[str] = []
        self._picture = picture
        self._surfaces = found.surfaces
        self._objects = found.objects
        self._settings = settings
        self._target = target
        self._wrap = self._choose_wrap(found.extensions)
        self._content = content
        self._roughness = roughness
        self._roughness_target = roughness_target
        self._writes_image = writes_image
        self._levels: list[FloatArray] = []
        self._roughness_levels: list[FloatArray] = []
        self._staged: list[StagedFile] = []
        self._staged_levels: list[StagedLevels] = []

    @property
    def image_name(self) -> str:
        """The name of the image that is baked."""
        return self._picture.name

    @property
    def picture(self) -> Picture:
        """The pixels of the image that is baked."""
        return self._picture

    @property
    def settings(self) -> Settings:
        """What to bake."""
        return self._settings

    @property
    def surfaces(self) -> Sequence[prefilter.Surface]:
        """The surfaces that the image is mapped on."""
        return self._surfaces

    @property
    def objects(self) -> Sequence[str]:
        """The name of the object that each surface comes from."""
        return self._objects

    @property
    def wrap(self) -> tuple[str, str]:
        """What lookups read outside of the image along u and v."""
        return self._wrap

    @property
    def threads(self) -> int:
        """How many threads to use; 0 for all."""
        return self._settings.threads

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The finished files, beside their targets."""
        return self._staged

    @property
    def reader(self) -> str:
        """How the levels are looked up, as `prefilter.mipmaps` names it."""
        return self._settings.reader if reads_encoded(self._picture) else "linear"

    def linear(self, progress: Progress) -> FloatArray:
        """Returns the image's scene-linear values; raises what `compute` does."""
        return images.scene_linear(self._picture, partial(go_on, progress, 0.0))

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
        """Returns scene-linear levels with any filter; raises what `compute` does.

        Args:
            linear: What `linear` returned.
            filter: A key of `FILTERS`.
            progress: Called with the fraction done.
            levels: How many, the image itself included; None for all.
            seam_budget: See `prefilter.mipmaps`; None for that of the settings.
            footprint: See `prefilter.mipmaps`; None for that of the settings.
        """
        if seam_budget is None:
            seam_budget = self._settings.seam_budget / 100.0
        if footprint is None:
            footprint = lookups.footprint(self._settings, filter, self.reader)
        with self.naming_objects():
            return prefilter.mipmaps(
                linear,
                self._surfaces or None,
                filter=filter,
                wrap=self._wrap,
                bounds=self._bounds(linear),
                levels=levels,
                premultiplied=not self._picture.alpha_is_straight,
                reader=self.reader,
                seam_budget=seam_budget,
                footprint=footprint,
                progress=progress,
                threads=self._settings.threads,
            )

    @contextmanager
    def naming_objects(self) -> Iterator[None]:
        """Puts objects in the place of surfaces in the library's messages."""
        try:
            yield
        except ValueError as error:
            raise ValueError(_naming_objects(str(error), self._objects)) from error

    def compute(self, progress: Progress) -> None:
        """Filters, encodes and stages the file.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
            OSError: The file cannot be written.
        """
        go_on(progress, 0.0)
        with self.naming_objects():
            end = _FIRST_FILTERED if self._heeds_seams() else _FILTERED
            levels, rough = self._filtered(share(progress, 0.0, end))
            if self._heeds_seams():
                self._compare_seams(levels, share(progress, end, _FILTERED))
        check = partial(go_on, progress, _FILTERED)
        try:
            self._levels = self._stage(
                self._picture, levels, self._target, self._settings.texture_format, check
            )
            if self._roughness is not None:
                self._roughness_levels = self._stage(
                    self._roughness.picture,
                    rough,
                    self._roughness_target,
                    self._roughness.texture_format,
                    check,
                )
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def _filtered(self, progress: Progress) -> tuple[list[FloatArray], list[FloatArray]]:
        """Returns the levels above 0, scene-linear, of the image and of its roughness."""
        settings = self._settings
        to_file = self._target is not None or self._roughness_target is not None
        options: dict[str, Any] = {
            "filter": settings.filter,
            "wrap": self._wrap,
            "levels": None if to_file else settings.levels or None,
            "threads": settings.threads,
            "footprint": self._footprint,
        }
        surfaces = self._surfaces or None
        if self._content == "normal":
            levels, rough = contents.normal_levels(
                self.linear(progress), surfaces, self._roughness, progress, **options
            )
            return levels[1:], rough[1:]
        options["reader"] = self.reader
        options["seam_budget"] = settings.seam_budget / 100.0
        if self._content == "cutout":
            linear = self.linear(progress)
            levels = contents.cutout_levels(
                self._picture,
                linear,
                surfaces,
                self._bounds(linear),
                settings.threshold,
                progress,
                **options,
            )
            return levels[1:], []
        texels, encoding = images.light_or_bytes(self._picture, partial(go_on, progress, 0.0))
        levels = contents.plain_levels(
            self._picture,
            texels,
            surfaces,
            self._bounds(texels),
            progress,
            encoding=encoding,
            **options,
        )
        return levels, []

    @property
    def _footprint(self) -> float:
        return lookups.footprint(self._settings, self._settings.filter, self.reader)

    def _heeds_seams(self) -> bool:
        return (
            self._settings.seam_budget > 0.0
            and self._settings.filter in SEAM_FILTERS
            and self._content in {"color", "data"}
        )

    def _compare_seams(self, levels: list[FloatArray], progress: Progress) -> None:
        """Notes the contrast across seams of the levels, and of levels that do not heed them."""
        others = self.filtered(
            self.linear(progress),
            self._settings.filter,
            share(progress, 0.0, 0.8),
            levels=len(levels) + 1,
            seam_budget=0.0,
        )
        without, weighed = (
            prefilter.seam_contrast(made, self._surfaces, wrap=self._wrap, progress=part)
            for made, part in (
                (others[1:], share(progress, 0.8, 0.9)),
                (levels, share(progress, 0.9, 1.0)),
            )
        )
        note = seams.note(self.image_name, without.tolist(), weighed.tolist())
        if note:
            self._notes.append(note)

    def _stage(
        self,
        picture: Picture,
        levels: list[FloatArray],
        target: Path | None,
        texture_format: str,
        check: Callable[[], None],
    ) -> list[FloatArray]:
        """Stages a file of the image and its levels; returns these as level images hold them."""
        stored: list[FloatArray] = []
        if self._settings.use_images or (target is not None and textures.is_stored(target)):
            stored = [images.encoded(picture, level, check) for level in levels]
        threads = self._settings.threads
        if target is not None and engines.is_for_engines(target):
            linear = images.scene_linear(picture, check)
            self._staged += engines.stage(
                target,
                picture,
                [linear, *levels],
                [picture.stored, *stored],
                texture_format,
                check,
                supercompression=self._settings.supercompression,
                threads=threads,
            )
        elif target is not None:
            self._staged.append(
                textures.stage(target, picture, levels, stored, self._wrap, check, threads=threads)
            )
        return stored[: self._settings.levels - 1 if self._settings.levels else None]

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
        pairs = [(self._picture, self._levels)] if self._writes_image else []
        if self._roughness is not None:
            pairs.append((self._roughness.picture, self._roughness_levels))
        try:
            for picture, levels in pairs if self._settings.use_images else ():
                self._staged_levels.append(stage_levels(picture, levels))
        except BaseException:
            self.discard()
            raise

    def finish(self) -> Outcome:
        """Puts the level images into place; the files are there already."""
        names: list[str] = []
        for staged in self._staged_levels:
            made = staged.commit()
            names += made
            base = staged.picture.name
            if any(name != level_name(base, i) for i, name in enumerate(made, start=1)):
                self.warnings.append(f"the level images are named {listed(made)}")
        self._staged_levels.clear()
        self.discard()
        targets = (self._target, self._roughness_target)
        return Outcome(
            self._summary(names),
            images=names,
            files=[str(target) for target in targets if target is not None],
            warnings=self.warnings,
            notes=self._notes,
        )

    def let_pixels_go(self) -> None:
        """Frees the memory of what is in staged files; of level images nothing is left."""
        nothing = np.empty((0, 0, 4), np.float32)
        self._picture = replace(self._picture, texels=nothing)
        if self._roughness is not None:
            picture = replace(self._roughness.picture, texels=nothing)
            self._roughness = replace(self._roughness, picture=picture, linear=nothing)
        self._surfaces = []
        self._levels, self._roughness_levels = [], []

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for file in self._staged:
            file.discard()
        for levels in self._staged_levels:
            levels.discard()
        self._staged.clear()
        self._staged_levels.clear()

    def _choose_wrap(self, extensions: Sequence[str]) -> tuple[str, str]:
        wrap = self._settings.wrap
        if wrap == "auto":
            wrap = "repeat"
            if extensions:
                wrap = materials.WRAP_OF_EXTENSION[extensions[0]]
                if len(extensions) > 1 or extensions[0] == "MIRROR":
                    self.warnings.append(
                        f"Image Texture nodes extend the image by {', '.join(extensions)}; "
                        f"filtered as '{wrap}'"
                    )
        wrap_v = self._settings.wrap_v
        return wrap, wrap if wrap_v == "same" else wrap_v

    def _bounds(self, texels: images.Texels) -> tuple[float | None, float | None] | None:
        if self._settings.bounds != "auto":
            return _LIMITS[self._settings.bounds]
        if texels.dtype == np.uint8:
            return _LIMITS["unit"]
        return images.automatic_bounds(texels, is_integer=self._picture.is_integer)

    def _summary(self, names: Sequence[str]) -> str:
        baked = f"Baked '{self.image_name}'"
        if not self._writes_image:
            assert self._roughness is not None
            baked = f"Baked '{self._roughness.picture.name}', the roughness of '{self.image_name}',"
        elif self._content not in {"color", "data"}:
            baked += f" as {CONTENTS[self._content].label}"
        parts = [f"{baked} with {FILTERS[self._settings.filter].label}"]
        if self._objects:
            parts.append(f"over {counted(set(self._objects), 'object')}")
            if self._settings.use_frames:
                parts.append(f"at {counted(frames.chosen(self._settings), 'frame')}")
        if self._footprint:
            parts.append(lookups.described(self._footprint))
        results = []
        if names:
            results.append(counted(names, "level image"))
        targets = (self._target, self._roughness_target)
        results += [textures.shown(target) for target in targets if target is not None]
        parts.append(f"into {' and '.join(results)}" if results else "; it has no further level")
        return " ".join(parts)


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


def reads_encoded(picture: Picture) -> bool:
    """Tells whether there are renderers that interpolate the picture's texels as encoded."""
    return picture.encoding is images.Encoding.SRGB and not picture.is_float


def roughness_format(settings: Settings, picture: Picture) -> str:
    """Returns the format of the roughness file: that of the normal map, unless channels lack."""
    if settings.texture_format in {"eac-r11", "eac-rg11"}:
        if settings.roughness_channel == "all":
            return "eac-r11"
        return "etc2-rgba" if picture.stored.shape[2] == 4 else "etc2-rgb"
    if settings.texture_format not in {"bc4", "bc5"}:
        return settings.texture_format
    if settings.roughness_channel == "all":
        return "bc4"
    return "bc7"


def _naming_objects(message: str, objects: Sequence[str]) -> str:
    """Returns a message of the library, with objects in the place of its surfaces."""
    one = re.match(r"surface (\d+)\b", message)
    if one and int(one[1]) < len(objects):
        return f"object '{objects[int(one[1])]}'{message[one.end() :]}"
    if message.startswith("surface:") and objects:
        names = list(dict.fromkeys(objects))
        noun = "object" if len(names) == 1 else "objects"
        return f"{noun} {listed(names)}: {message.removeprefix('surface:').lstrip()}"
    return message
