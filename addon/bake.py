"""Baking mipmaps in three steps: read from Blender, compute anywhere, write to Blender.

The operator and the command are two ways to call this.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np
import prefilter

from .bridge import files, images, meshes
from .bridge.images import FloatArray, Picture
from .wording import listed

FAILURES = (ValueError, OSError, MemoryError)
"""What a bake raises for a reason that the user can act on."""

Progress = Callable[[float], bool]


class Choice(NamedTuple):
    """One value of an option, and how to present it."""

    label: str
    description: str


FILTERS = {
    "pam-bilinear": Choice(
        "PAM Bilinear", "Best fit over the surface, for readers that interpolate between texels"
    ),
    "pam-box": Choice("PAM Box", "Average of the surface under each texel"),
    "box": Choice("Box", "Average of four texels, whether a face uses them or not"),
    "tent": Choice("Tent", "Smoother than Box, whether a face uses the texels or not"),
    "lanczos3": Choice("Lanczos 3", "Sharper than Box, whether a face uses the texels or not"),
    "box-covered": Choice("Box, Covered Texels", "Box over the texels that a face touches"),
    "tent-covered": Choice("Tent, Covered Texels", "Tent over the texels that a face touches"),
    "lanczos3-covered": Choice(
        "Lanczos 3, Covered Texels", "Lanczos 3 over the texels that a face touches"
    ),
}
TEXTURE_SPACE_FILTERS = frozenset({"box", "tent", "lanczos3"})

_MODES = {
    "clamp": Choice("Clamp", "The border texels go on"),
    "repeat": Choice("Repeat", "The image tiles the plane"),
    "border": Choice("Border", "Black and transparent"),
}
WRAPS = {
    "auto": Choice("As in Material", "What the Image Texture nodes of the image say"),
    **_MODES,
}
WRAPS_V = {"same": Choice("Same as U", "The same as along U"), **_MODES}
BOUNDS = {
    "auto": Choice(
        "Automatic",
        "0 to 1 for byte images, 0 and up for float images; less a limit that the image passes",
    ),
    "unit": Choice("0 to 1", "Values stay between 0 and 1"),
    "positive": Choice("0 and Up", "Values stay at or above 0"),
    "none": Choice("None", "Values may leave the range of the image"),
}

_FILTERED = 0.9  # What the progress is once the levels are filtered.
_LIMITS = {"unit": (0.0, 1.0), "positive": (0.0, None), "none": None}
_WRAP_OF_EXTENSION = {
    "REPEAT": "repeat",
    "EXTEND": "clamp",
    "CLIP": "border",
    "MIRROR": "clamp",
}


@dataclass(frozen=True)
class Settings:
    """What to bake and where to put it.

    Attributes:
        filter: A key of `FILTERS`.
        wrap: A key of `WRAPS`: what lies outside of the image along u.
        wrap_v: A key of `WRAPS_V`: the same along v.
        bounds: A key of `BOUNDS`.
        levels: How many levels to make, the image itself included; 0 for all.
        use_images: Whether to write an image datablock for each level.
        filepath: A mip-mapped file to write; empty for none. It gets every level.
        threads: How many threads to use; 0 for all.
    """

    filter: str = "pam-bilinear"
    wrap: str = "auto"
    wrap_v: str = "same"
    bounds: str = "auto"
    levels: int = 0
    use_images: bool = True
    filepath: str = ""
    threads: int = 0


@dataclass(frozen=True)
class Outcome:
    """What a bake wrote, and what the user should know about it."""

    summary: str
    images: list[str]
    filepath: str
    warnings: list[str]


class Bake:
    """One bake.

    `Bake.read` and `write` belong on the main thread; `compute` touches no Blender data and runs on
    any thread. Nothing is written before everything is computed.
    """

    def __init__(
        self,
        picture: Picture,
        found: meshes.ImageSurfaces,
        settings: Settings,
        target: Path | None,
    ) -> None:
        """Keeps copies of what was read; use `Bake.read`."""
        self.warnings = list(found.problems)
        self._picture = picture
        self._surfaces = found.surfaces
        self._objects = found.objects
        self._settings = settings
        self._target = target
        self._wrap = self._choose_wrap(found.extensions)
        self._levels: list[FloatArray] = []
        self._staged: files.StagedFile | None = None

    @classmethod
    def read(
        cls,
        image: bpy.types.Image,
        objects: Sequence[bpy.types.Object],
        settings: Settings,
        depsgraph: bpy.types.Depsgraph,
        *,
        all_faces: bool = False,
        needs_surface: bool = False,
    ) -> "Bake":
        """Copies everything that the bake needs out of Blender.

        Args:
            image: Level 0.
            objects: The objects to look for the image on.
            settings: What to bake.
            depsgraph: The evaluated dependency graph.
            all_faces: See `meshes.image_surfaces`.
            needs_surface: Whether a surface is needed for any filter.

        Raises:
            ValueError: There is nothing to bake, or the image or a mesh is unfit.
            OSError: The file of the settings cannot be written.
        """
        target = files.check_target(settings.filepath) if settings.filepath else None
        if target is None and not settings.use_images:
            raise ValueError("nothing to write: neither level images nor a file are asked for")
        picture = images.read(image)
        _check_levels(picture, settings.levels)
        found = meshes.image_surfaces(objects, image, depsgraph, all_faces=all_faces)
        needs_surface = needs_surface or settings.filter not in TEXTURE_SPACE_FILTERS
        if needs_surface and not found.surfaces:
            raise ValueError(_no_surface(image, objects, found.problems))
        return cls(picture, found, settings, target)

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

    def linear(self, progress: Progress) -> FloatArray:
        """Returns the image's scene-linear values; raises what `compute` does."""
        return images.scene_linear(self._picture, partial(_go_on, progress, 0.0))

    def filtered(
        self,
        linear: FloatArray,
        filter: str,
        progress: Progress,
        *,
        levels: int | None = None,
    ) -> list[FloatArray]:
        """Returns scene-linear levels with any filter; raises what `compute` does.

        Args:
            linear: What `linear` returned.
            filter: A key of `FILTERS`.
            progress: Called with the fraction done.
            levels: How many, the image itself included; None for all.
        """
        with self.naming_objects():
            return prefilter.mipmaps(
                linear,
                self._surfaces or None,
                filter=filter,
                wrap=self._wrap,
                bounds=self._bounds(linear),
                levels=levels,
                premultiplied=not self._picture.alpha_is_straight,
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
        settings = self._settings
        linear = self.linear(progress)
        levels = self.filtered(
            linear,
            settings.filter,
            lambda fraction: progress(_FILTERED * fraction),
            levels=None if self._target is not None else settings.levels or None,
        )
        check = partial(_go_on, progress, _FILTERED)
        stored = [images.encoded(self._picture, level, check) for level in levels[1:]]
        stored.insert(0, self._picture.stored)
        if self._target is not None:
            levels[0] = linear
            self._staged = files.stage(
                self._target, self._picture, levels, stored, self._wrap, check
            )
        self._levels = stored[1 : settings.levels or None]
        try:
            _go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def write(self) -> Outcome:
        """Puts the file into place and writes the level images.

        Raises:
            OSError: The file cannot be put into place, or an image cannot be made; nothing was
                written then.
        """
        levels = self._levels if self._settings.use_images else []
        try:
            staged_levels = images.stage_levels(self._picture, levels)
            try:
                if self._staged is not None:
                    self._staged.commit()
            except BaseException:
                staged_levels.discard()
                raise
        finally:
            self.discard()
        names = staged_levels.commit()
        if any(name != f"{self.image_name}.mip{i}" for i, name in enumerate(names, start=1)):
            self.warnings.append(f"the level images are named {listed(names)}")
        return Outcome(self._summary(names), names, str(self._target or ""), self.warnings)

    def discard(self) -> None:
        """Removes what `compute` left on disk, if it was not written into place."""
        if self._staged is not None:
            self._staged.discard()
            self._staged = None

    def _choose_wrap(self, extensions: Sequence[str]) -> tuple[str, str]:
        wrap = self._settings.wrap
        if wrap == "auto":
            wrap = "repeat"
            if extensions:
                wrap = _WRAP_OF_EXTENSION[extensions[0]]
                if len(extensions) > 1 or extensions[0] == "MIRROR":
                    self.warnings.append(
                        f"Image Texture nodes extend the image by {', '.join(extensions)}; "
                        f"filtered as '{wrap}'"
                    )
        wrap_v = self._settings.wrap_v
        return wrap, wrap if wrap_v == "same" else wrap_v

    def _bounds(self, linear: FloatArray) -> tuple[float | None, float | None] | None:
        if self._settings.bounds != "auto":
            return _LIMITS[self._settings.bounds]
        finite = np.isfinite(linear)
        low = 0.0 if linear.min(where=finite, initial=0.0) >= 0.0 else None
        within_one = linear.max(where=finite, initial=0.0) <= 1.0
        high = 1.0 if not self._picture.is_float and within_one else None
        return low, high

    def _summary(self, names: Sequence[str]) -> str:
        parts = [f"Baked '{self.image_name}' with {FILTERS[self._settings.filter].label}"]
        if self._surfaces:
            parts.append(f"over {_count(set(self._objects), 'object')}")
        results = []
        if names:
            results.append(_count(names, "level image"))
        if self._target is not None:
            results.append(f"'{self._target}'")
        parts.append(f"into {' and '.join(results)}" if results else "; it has no further level")
        return " ".join(parts)


def bake(
    image: bpy.types.Image,
    objects: Sequence[bpy.types.Object],
    settings: Settings,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool = False,
    progress: Progress = lambda _: True,
) -> Outcome:
    """Bakes on the calling thread; see `Bake` for the steps, the arguments and what they raise."""
    job = Bake.read(image, objects, settings, depsgraph, all_faces=all_faces)
    job.compute(progress)
    return job.write()


def _check_levels(picture: Picture, levels: int) -> None:
    height, width = picture.stored.shape[:2]
    full = max(width, height).bit_length()
    if levels > full:
        raise ValueError(f"levels: found {levels}; an image of {width} x {height} has 1 to {full}")


def _go_on(progress: Progress, fraction: float) -> None:
    if not progress(fraction):
        raise prefilter.Cancelled("cancelled")


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


def _no_surface(
    image: bpy.types.Image, objects: Iterable[bpy.types.Object], problems: Sequence[str]
) -> str:
    start = f"image '{image.name}': no surface to bake for"
    if problems:
        return f"{start}; {'; '.join(problems)}"
    found = ", ".join(f"'{obj.name}' ({obj.type.lower()})" for obj in objects)
    if not found:
        return f"{start}; no object is selected"
    return f"{start}; no material on a face of a mesh uses it, among {found}"


def _count(things: Sized, noun: str) -> str:
    return f"{len(things)} {noun}{'' if len(things) == 1 else 's'}"
