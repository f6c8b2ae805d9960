# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of PAM into Cycles' texture cache: read, computed on any thread, and written.

Both the operator and the command use it. It bakes all images of a scene; an image without a usable
surface keeps Blender's levels, with a warning.
"""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, cast

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.workflows import up_to_date

from ..bridge import materials, meshes, packed, rendered
from ..bridge.files import tx
from ..bridge.files.staging import StagedFile, commit_all
from ..bridge.images import FloatArray, automatic_bounds, capped
from ..bridge.tile_surfaces import TileSurfaces
from ..core.alpha import associated, unassociated
from ..core.jobs import Progress, at_once, go_on, share
from ..core.outcome import Outcome, reason
from ..core.translations import marked
from ..core.wording import Sentence, counted, joined, listed
from . import states

NEEDED = marked("Blender 5.2 LTS or later with Cycles is needed, for its texture cache")

# Images up to this size are baked in parallel, each in one thread; several threads per image would
# mostly wait for each other.
_MOST_SMALL_TEXELS = 1 << 21
_CYCLES = "CYCLES"
_CONSTANT, _UP_TO_DATE = "constant", "up to date"
"""Reasons why files are left alone."""
_MADE = 0.2  # The progress after Blender has made its cache files.


@dataclass
class _CacheFile:
    """A cache file of an image, with the surfaces that show it.

    Attributes:
        names: The names of the images that share it.
        source: The source file.
        surfaces: The surfaces, in the unit square if the file is a UDIM tile.
        objects: The name of each surface's object.
        extensions: The extension modes of the Image Texture nodes.
        obstacle: Why it has to keep Blender's levels; empty if it need not.
        alpha_covers: Whether a material uses its alpha as coverage, whatever the alpha mode.
    """

    names: list[str]
    source: tx.Source
    surfaces: list[prefilter.Surface] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    obstacle: str = ""
    alpha_covers: bool = False

    def merge(self, other: "_CacheFile") -> None:
        """Adds the surfaces of another image with the same cache file."""
        self.names.extend(other.names)
        self.surfaces.extend(other.surfaces)
        self.objects.extend(other.objects)
        self.extensions.extend(other.extensions)
        self.obstacle = self.obstacle or other.obstacle
        self.alpha_covers = self.alpha_covers or other.alpha_covers

    @property
    def title(self) -> str:
        """Its name in messages."""
        return f"image '{self.names[0]}'"


class CacheBake:
    """One bake of a scene.

    `read` and `write` run on the main thread; `compute` uses no Blender data and runs on any
    thread. No levels are replaced before all are computed.
    """

    def __init__(
        self, scene: str, files: list[_CacheFile], warnings: list[str], threads: int
    ) -> None:
        """Stores copies of the inputs; use `CacheBake.read`."""
        self.warnings = warnings
        self.notes: list[str] = []
        self._scene = scene
        self._files = files
        self._threads = threads
        self._staged: list[tuple[_CacheFile, StagedFile]] = []
        self._left_alone: Counter[str] = Counter()
        self._is_part = False
        self.may_skip = False
        """Whether to leave files alone that were made from the same inputs; files then store a
        fingerprint of their inputs."""

    @classmethod
    def read(
        cls,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        *,
        unpack: bool = False,
        threads: int = 0,
    ) -> "CacheBake":
        """Copies all inputs from Blender.

        Args:
            scene: The scene to render.
            depsgraph: The evaluated dependency graph.
            unpack: Whether to unpack packed images first, beside the .blend file.
            threads: The number of threads; 0 for all.

        Raises:
            ValueError: No image can be baked; the message has one line per image.
            OSError: This Blender has no texture cache.
        """
        if not tx.is_available():
            raise OSError(Sentence(NEEDED))
        warnings: list[str] = []
        notes: list[str] = []
        if scene.render.engine != _CYCLES:
            text = (
                "scene '{}' is not rendered by Cycles, and only Cycles reads the texture cache: "
                "set Render Engine to Cycles"
            )
            warnings.append(Sentence(text, scene.name))
        viewers = rendered.viewers(scene, depsgraph)
        sources_of: dict[bpy.types.Image, dict[int | None, tx.Source]] = {}
        for image in viewers:
            try:
                if unpack and image.packed_files:
                    names = listed(path.name for path in packed.unpack(image))
                    notes.append(Sentence("image '{}': unpacked into {}", image.name, names))
                sources_of[image] = tx.sources(image)
            except (ValueError, OSError) as error:
                warnings.append(reason(error))
        users = {image: viewers[image].objects for image in sources_of if not viewers[image].others}
        surfaces_of = meshes.surfaces_of_images(users, depsgraph)
        tile_surfaces = TileSurfaces()
        files: list[_CacheFile] = []
        for image, sources in sources_of.items():
            surfaces = surfaces_of.get(image, meshes.ImageSurfaces())
            if isinstance(surfaces, ValueError):
                warnings.append(str(surfaces))
                continue
            warnings.extend(f"image '{image.name}': {problem}" for problem in surfaces.problems)
            files.extend(_cache_files(image.name, sources, viewers[image], surfaces, tile_surfaces))
        if not files:
            raise ValueError(_no_image_message(scene, warnings))
        bake = cls(scene.name, files, list(dict.fromkeys(warnings)), threads)
        bake.notes = notes
        return bake

    @property
    def tasks(self) -> dict[Path, list[str]]:
        """The names of images by their source file.

        Images with the same source file may share a cache file; others never do.
        """
        names: dict[Path, list[str]] = {}
        for file in self._files:
            names.setdefault(file.source.path, []).extend(file.names)
        return names

    def keep(self, sources: Collection[Path]) -> None:
        """Limits the bake to images with certain source files, as one task of several."""
        self._files = [file for file in self._files if file.source.path in sources]
        self._is_part = True

    def compute(self, progress: Progress) -> None:
        """Lets Blender make the cache files, and stages them with new levels.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: No image can be baked.
            OSError: A file cannot be written.
        """
        try:
            shared = self._make(share(progress, 0.0, _MADE))
            self._bake(shared, share(progress, _MADE, 1.0))
            if not (self._staged or self._left_alone or self._is_part):
                reasons = "\n".join(self.warnings)
                raise ValueError(f"scene '{self._scene}': no image could be baked\n{reasons}")
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def write(self) -> Outcome:
        """Puts the files into place, and turns on the scene's texture cache.

        Raises:
            OSError: A file cannot be put into place; then nothing is written.
        """
        files = [staged for _, staged in self._staged]
        try:
            commit_all(files)
        finally:
            self.discard()
        written = [str(staged.target) for staged in files]
        scene = bpy.data.scenes.get(self._scene)
        if scene is not None:
            scene.render.use_texture_cache = True
        states.refresh()
        return Outcome(self._summary(), files=written, warnings=self.warnings, notes=self.notes)

    def discard(self) -> None:
        """Deletes staged files that were not put into place."""
        for _, staged in self._staged:
            staged.discard()

    def _make(self, progress: Progress) -> dict[Path, _CacheFile]:
        """Lets Blender make the cache files, and merges images that share one."""
        results: dict[int, Path | OSError] = {}

        def make(index: int, advance: Progress) -> None:
            go_on(advance, 0.0)
            try:
                results[index] = path = tx.make(self._files[index].source)
            except OSError as error:
                results[index] = error
            else:
                tx.check(self._files[index].source, path)
            go_on(advance, 1.0)

        # Blender does not document that its function may be called in parallel.
        works = [partial(make, index) for index in range(len(self._files))]
        at_once(works, progress, threads=1)
        files: dict[Path, _CacheFile] = {}
        for index, file in enumerate(self._files):
            path = results[index]
            if isinstance(path, OSError):
                self.warnings.append(f"{file.title}: {path}")
            elif path in files:
                files[path].merge(file)
            else:
                files[path] = file
        return files

    def _bake(self, files: Mapping[Path, _CacheFile], progress: Progress) -> None:
        """Stages the files: small ones in parallel, large ones each with all threads."""
        problems: dict[int, str] = {}
        staged: dict[int, StagedFile] = {}
        left_alone: list[str] = []

        def bake(index: int, path: Path, file: _CacheFile, threads: int, advance: Progress) -> None:
            go_on(advance, 0.0)
            try:
                if file.obstacle:
                    raise ValueError(f"{file.title}: {file.obstacle}")
                result = _stage(tx.read(path), file, advance, threads, may_skip=self.may_skip)
            except ValueError as error:
                problems[index] = f"{error}; it keeps Blender's levels"
            else:
                if isinstance(result, str):
                    left_alone.append(result)
                else:
                    staged[index] = result

        small: list[Callable[[Progress], None]] = []
        large: list[Callable[[Progress], None]] = []
        for index, (path, file) in enumerate(files.items()):
            if not file.obstacle and tx.texel_count(path) > _MOST_SMALL_TEXELS:
                large.append(partial(bake, index, path, file, self._threads))
            else:
                small.append(partial(bake, index, path, file, 1))
        end = len(small) / max(len(files), 1)
        try:
            at_once(small, share(progress, 0.0, end), self._threads)
            at_once(large, share(progress, end, 1.0), threads=1)
        finally:
            in_order = list(files.values())
            self._staged = [(in_order[index], staged[index]) for index in sorted(staged)]
            self._left_alone.update(left_alone)
            self.warnings.extend(problems[index] for index in sorted(problems))

    def _summary(self) -> str:
        names = {name for file, _ in self._staged for name in file.names}
        objects = {name for file, _ in self._staged for name in file.objects}
        summary = Sentence(
            "Baked PAM into the texture cache of {} ({}), over {}",
            *(counted(names, "image"), counted(self._staged, "file"), counted(objects, "object")),
        )
        if self._left_alone[_CONSTANT]:
            constant = self._left_alone[_CONSTANT]
            summary = Sentence("{}; {} of one color stay as they are", summary, constant)
        if self._left_alone[_UP_TO_DATE]:
            summary = joined("; ", [summary, f"{self._left_alone[_UP_TO_DATE]} up to date"])
        return summary


def _cache_files(
    name: str,
    sources: dict[int | None, tx.Source],
    viewers: rendered.Viewers,
    surfaces: meshes.ImageSurfaces,
    tile_surfaces: TileSurfaces,
) -> list[_CacheFile]:
    """Returns the cache files of an image with their surfaces."""
    obstacle = "; ".join(viewers.others)
    files = []
    for number, source in sources.items():
        file = _CacheFile(
            [name if number is None else f"{name}, tile {number}"],
            source,
            extensions=list(surfaces.extensions),
            obstacle=obstacle,
            alpha_covers=viewers.alpha_covers,
        )
        inside = surfaces if number is None else tile_surfaces.inside(surfaces, number)
        file.surfaces.extend(inside.surfaces)
        file.objects.extend(inside.objects)
        if not obstacle and not sum(surface.area for surface in file.surfaces):
            file.obstacle = "no surface of the scene lies in it"
        files.append(file)
    return files


def _stage(
    texture: tx.Texture, file: _CacheFile, progress: Progress, threads: int, *, may_skip: bool
) -> StagedFile | str:
    """Stages a file with new levels, or returns the reason for leaving it alone."""
    if texture.is_constant:
        return _CONSTANT
    wrap = _wrap(file)
    fingerprint = _fingerprint(texture, file, wrap) if may_skip else ""
    if fingerprint and texture.made_of == fingerprint:
        return _UP_TO_DATE
    try:
        levels = _levels(texture, file, wrap, progress, threads)
    except ValueError as error:
        raise ValueError(f"{file.title}: {error}") from error
    return tx.stage(texture, levels, partial(go_on, progress, 1.0), made_of=fingerprint)


def _fingerprint(texture: tx.Texture, file: _CacheFile, wrap: str) -> str:
    """Returns a fingerprint of all inputs of the levels."""
    arrays: list[NDArray[Any]] = [texture.stored]
    for surface in file.surfaces:
        arrays += [surface.positions, surface.triangles, surface.uvs, surface.areas]
    flags = [texture.is_encoded, texture.is_float, file.alpha_covers, file.source.is_data]
    return up_to_date.fingerprint_of(
        arrays, {"wrap": wrap, "flags": flags, "alpha": file.source.alpha_is_associated}
    )


def _levels(
    texture: tx.Texture,
    file: _CacheFile,
    wrap: str,
    progress: Progress,
    threads: int,
) -> list[FloatArray]:
    """Returns levels 1, 2, ... as the file stores them."""
    stored = texture.stored
    is_opaque = stored.shape[2] == 4 and bool(np.all(stored[..., 3] == 1))
    if is_opaque:
        stored = np.ascontiguousarray(stored[..., :3])
    is_associated = stored.shape[2] == 4 and file.source.alpha_is_associated
    covers = stored.shape[2] == 4 and file.alpha_covers and not file.source.is_data
    fit = partial(
        prefilter.coarser_levels,
        surface=file.surfaces,
        wrap=cast("Any", wrap),
        premultiplied=is_associated or not covers,
        progress=progress,
        threads=threads,
    )
    if texture.is_encoded:
        straight = unassociated(stored) if is_associated else stored
        levels = [
            prefilter.to_srgb(level, threads=threads)
            for level in fit(
                prefilter.to_linear(straight, threads=threads),
                premultiplied=not (is_associated or covers),
                reader="srgb-after",
            )
        ]
        if is_associated:
            levels = [associated(level) for level in levels]
    elif texture.is_float:
        levels = fit(stored, bounds=automatic_bounds(stored, is_associated=is_associated))
        if is_associated:
            levels = [capped(level, stored) for level in levels]
        elif covers:
            for level in levels:
                np.minimum(level[..., 3], 1, out=level[..., 3])
    else:
        levels = fit(stored)
    if is_opaque:
        levels = [np.pad(level, ((0, 0), (0, 0), (0, 1)), constant_values=1) for level in levels]
    return levels


def _wrap(file: _CacheFile) -> str:
    """Returns the wrap mode of the nodes, which affects only UVs outside the image.

    Raises:
        ValueError: Some UVs are outside, and the nodes disagree or mirror the image.
    """
    modes = list(dict.fromkeys(file.extensions))
    if (len(modes) > 1 or "MIRROR" in modes) and not _is_inside(file.surfaces):
        raise ValueError(
            f"{file.title}: some UVs lie outside the image, where Image Texture nodes extend "
            f"it by {', '.join(modes)}"
        )
    return materials.WRAP_OF_EXTENSION[modes[0]]


def _is_inside(surfaces: Iterable[prefilter.Surface]) -> bool:
    return all(np.all((surface.uvs >= 0) & (surface.uvs <= 1)) for surface in surfaces)


def _no_image_message(scene: bpy.types.Scene, warnings: Sequence[str]) -> str:
    start = f"scene '{scene.name}': found no image texture to bake"
    if warnings:
        return "\n".join([start, *dict.fromkeys(warnings)])
    names = listed(obj.name for obj in scene.objects if obj.type == "MESH")
    if not names:
        return f"{start}; it has no mesh"
    return f"{start}; no material on a mesh that is rendered has one, among {names}"
