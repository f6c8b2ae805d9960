# SPDX-License-Identifier: GPL-3.0-or-later

"""Baking PAM into Cycles' texture cache in three steps: read, compute anywhere, write.

The operator and the command are two ways to call this. Every image of a scene is baked at once;
what cannot be weighed by a surface keeps the levels that Blender made, and a warning says why.
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

# Images of up to so many texels are baked at the same time, each in a thread of its own: within one
# threads would wait for each other more than they work.
_MOST_SMALL_TEXELS = 1 << 21
_CYCLES = "CYCLES"
_CONSTANT, _UP_TO_DATE = "constant", "up to date"
"""Why files stay as they are."""
_MADE = 0.2  # What the progress is once Blender has made its cache files.


@dataclass
class _Worn:
    """An image file on its surfaces.

    Attributes:
        names: Of the image, and those that share its cache file.
        source: What the cache file is made from.
        surfaces: Where it is worn, in the unit square if the file is a UDIM tile.
        objects: The name of the object of each surface.
        extensions: What Image Texture nodes do outside of the image.
        obstacle: Why its levels are to stay as Blender makes them, or empty.
        alpha_covers: Whether a material takes its alpha for coverage, whatever the alpha mode.
    """

    names: list[str]
    source: tx.Source
    surfaces: list[prefilter.Surface] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    obstacle: str = ""
    alpha_covers: bool = False

    def share(self, other: "_Worn") -> None:
        """Adds the surfaces of an image with the same cache file."""
        self.names.extend(other.names)
        self.surfaces.extend(other.surfaces)
        self.objects.extend(other.objects)
        self.extensions.extend(other.extensions)
        self.obstacle = self.obstacle or other.obstacle
        self.alpha_covers = self.alpha_covers or other.alpha_covers

    @property
    def who(self) -> str:
        """What to call it in a message."""
        return f"image '{self.names[0]}'"


class CacheBake:
    """One bake of a scene.

    `CacheBake.read` and `write` belong on the main thread; `compute` touches no Blender data and
    runs on any thread. No levels are replaced before all are computed.
    """

    def __init__(self, scene: str, worn: list[_Worn], warnings: list[str], threads: int) -> None:
        """Keeps copies of what was read; use `CacheBake.read`."""
        self.warnings = warnings
        self.notes: list[str] = []
        self._scene = scene
        self._worn = worn
        self._threads = threads
        self._staged: list[tuple[_Worn, StagedFile]] = []
        self._left: Counter[str] = Counter()
        self._is_part = False
        self.may_skip = False
        """Whether files are left alone that were made of the same; files then keep of what."""

    @classmethod
    def read(
        cls,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        *,
        unpack: bool = False,
        threads: int = 0,
    ) -> "CacheBake":
        """Copies everything that the bake needs out of Blender.

        Args:
            scene: The scene that is rendered.
            depsgraph: The evaluated dependency graph.
            unpack: Whether to unpack packed images first, beside the .blend file.
            threads: How many threads to use; 0 for all.

        Raises:
            ValueError: No image can be baked; the message says why, in a line an image.
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
        files: dict[bpy.types.Image, dict[int | None, tx.Source]] = {}
        for image in viewers:
            try:
                if unpack and image.packed_files:
                    names = listed(path.name for path in packed.unpack(image))
                    notes.append(Sentence("image '{}': unpacked into {}", image.name, names))
                files[image] = tx.sources(image)
            except (ValueError, OSError) as error:
                warnings.append(reason(error))
        users = {image: viewers[image].objects for image in files if not viewers[image].others}
        found = meshes.surfaces_of_images(users, depsgraph)
        parts = TileSurfaces()
        worn: list[_Worn] = []
        for image, sources in files.items():
            surfaces = found.get(image, meshes.ImageSurfaces())
            if isinstance(surfaces, ValueError):
                warnings.append(str(surfaces))
                continue
            warnings.extend(f"image '{image.name}': {problem}" for problem in surfaces.problems)
            worn.extend(_on_surfaces(image.name, sources, viewers[image], surfaces, parts))
        if not worn:
            raise ValueError(_nothing(scene, warnings))
        made = cls(scene.name, worn, list(dict.fromkeys(warnings)), threads)
        made.notes = notes
        return made

    @property
    def tasks(self) -> dict[Path, list[str]]:
        """The names of the images by the file that they are read from.

        Those of one file may share a cache file, those of two never do.
        """
        found: dict[Path, list[str]] = {}
        for worn in self._worn:
            found.setdefault(worn.source.path, []).extend(worn.names)
        return found

    def keep(self, files: Collection[Path]) -> None:
        """Leaves all images out but those that are read from some files, as a part of the work."""
        self._worn = [worn for worn in self._worn if worn.source.path in files]
        self._is_part = True

    def compute(self, progress: Progress) -> None:
        """Lets Blender make the cache files, and stages those with other levels.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: No image can be baked.
            OSError: A file cannot be written.
        """
        try:
            shared = self._make(share(progress, 0.0, _MADE))
            self._bake(shared, share(progress, _MADE, 1.0))
            if not (self._staged or self._left or self._is_part):
                reasons = "\n".join(self.warnings)
                raise ValueError(f"scene '{self._scene}': no image could be baked\n{reasons}")
            go_on(progress, 1.0)
        except BaseException:
            self.discard()
            raise

    def write(self) -> Outcome:
        """Puts the files into place, and turns the scene's texture cache on.

        Raises:
            OSError: A file cannot be put into place; nothing was written then.
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
        states.look_again()
        return Outcome(self._summary(), files=written, warnings=self.warnings, notes=self.notes)

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for _, staged in self._staged:
            staged.discard()

    def _make(self, progress: Progress) -> dict[Path, _Worn]:
        """Makes the cache files; images that share one are joined."""
        made: dict[int, Path | OSError] = {}

        def make(index: int, advance: Progress) -> None:
            go_on(advance, 0.0)
            try:
                made[index] = path = tx.make(self._worn[index].source)
            except OSError as error:
                made[index] = error
            else:
                tx.check(self._worn[index].source, path)
            go_on(advance, 1.0)

        # Blender's maker is not said to bear several calls at once.
        works = [partial(make, index) for index in range(len(self._worn))]
        at_once(works, progress, threads=1)
        shared: dict[Path, _Worn] = {}
        for index, worn in enumerate(self._worn):
            path = made[index]
            if isinstance(path, OSError):
                self.warnings.append(f"{worn.who}: {path}")
            elif path in shared:
                shared[path].share(worn)
            else:
                shared[path] = worn
        return shared

    def _bake(self, shared: Mapping[Path, _Worn], progress: Progress) -> None:
        """Stages the files: many small ones at the same time, large ones each with all threads."""
        problems: dict[int, str] = {}
        staged: dict[int, StagedFile] = {}

        def bake(index: int, path: Path, worn: _Worn, threads: int, advance: Progress) -> None:
            go_on(advance, 0.0)
            try:
                if worn.obstacle:
                    raise ValueError(f"{worn.who}: {worn.obstacle}")
                file = _staged(tx.read(path), worn, advance, threads, may_skip=self.may_skip)
            except ValueError as error:
                problems[index] = f"{error}; it keeps Blender's levels"
            else:
                if isinstance(file, str):
                    left.append(file)
                else:
                    staged[index] = file

        left: list[str] = []
        small: list[Callable[[Progress], None]] = []
        large: list[Callable[[Progress], None]] = []
        for index, (path, worn) in enumerate(shared.items()):
            if not worn.obstacle and tx.texel_count(path) > _MOST_SMALL_TEXELS:
                large.append(partial(bake, index, path, worn, self._threads))
            else:
                small.append(partial(bake, index, path, worn, 1))
        end = len(small) / max(len(shared), 1)
        try:
            at_once(small, share(progress, 0.0, end), self._threads)
            at_once(large, share(progress, end, 1.0), threads=1)
        finally:
            users = list(shared.values())
            self._staged = [(users[index], staged[index]) for index in sorted(staged)]
            self._left.update(left)
            self.warnings.extend(problems[index] for index in sorted(problems))

    def _summary(self) -> str:
        names = {name for worn, _ in self._staged for name in worn.names}
        objects = {name for worn, _ in self._staged for name in worn.objects}
        done = Sentence(
            "Baked PAM into the texture cache of {} ({}), over {}",
            *(counted(names, "image"), counted(self._staged, "file"), counted(objects, "object")),
        )
        if self._left[_CONSTANT]:
            constant = self._left[_CONSTANT]
            done = Sentence("{}; {} of one color stay as they are", done, constant)
        if self._left[_UP_TO_DATE]:
            done = joined("; ", [done, f"{self._left[_UP_TO_DATE]} up to date"])
        return done


def _on_surfaces(
    name: str,
    sources: dict[int | None, tx.Source],
    seen: rendered.Viewers,
    found: meshes.ImageSurfaces,
    parts: TileSurfaces,
) -> list[_Worn]:
    """Returns the files of an image with their surfaces; an image with an obstacle has none."""
    obstacle = "; ".join(seen.others)
    worn = []
    for number, source in sources.items():
        one = _Worn(
            [name if number is None else f"{name}, tile {number}"],
            source,
            extensions=list(found.extensions),
            obstacle=obstacle,
            alpha_covers=seen.alpha_covers,
        )
        inside = found if number is None else parts.inside(found, number)
        one.surfaces.extend(inside.surfaces)
        one.objects.extend(inside.objects)
        if not obstacle and not sum(part.area for part in one.surfaces):
            one.obstacle = "no surface of the scene lies in it"
        worn.append(one)
    return worn


def _staged(
    texture: tx.Texture, worn: _Worn, progress: Progress, threads: int, *, may_skip: bool
) -> StagedFile | str:
    """Stages a file, or returns why it stays as it is."""
    if texture.is_constant:
        return _CONSTANT
    wrap = _wrap(worn)
    number = _made_of(texture, worn, wrap) if may_skip else ""
    if number and texture.made_of == number:
        return _UP_TO_DATE
    try:
        levels = _levels(texture, worn, wrap, progress, threads)
    except ValueError as error:
        raise ValueError(f"{worn.who}: {error}") from error
    return tx.stage(texture, levels, partial(go_on, progress, 1.0), made_of=number)


def _made_of(texture: tx.Texture, worn: _Worn, wrap: str) -> str:
    """Returns a number, as text, of all that the levels are made of."""
    arrays: list[NDArray[Any]] = [texture.stored]
    for surface in worn.surfaces:
        arrays += [surface.positions, surface.triangles, surface.uvs, surface.areas]
    flags = [texture.is_encoded, texture.is_float, worn.alpha_covers, worn.source.is_data]
    return up_to_date.fingerprint_of(
        arrays, {"wrap": wrap, "flags": flags, "alpha": worn.source.alpha_is_associated}
    )


def _levels(
    texture: tx.Texture,
    worn: _Worn,
    wrap: str,
    progress: Progress,
    threads: int,
) -> list[FloatArray]:
    """Returns levels 1, 2, ... as the file stores them."""
    stored = texture.stored
    is_opaque = stored.shape[2] == 4 and bool(np.all(stored[..., 3] == 1))
    if is_opaque:
        stored = np.ascontiguousarray(stored[..., :3])
    is_associated = stored.shape[2] == 4 and worn.source.alpha_is_associated
    covers = stored.shape[2] == 4 and worn.alpha_covers and not worn.source.is_data
    fit = partial(
        prefilter.coarser_levels,
        surface=worn.surfaces,
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


def _wrap(worn: _Worn) -> str:
    """Returns the wrap mode of the nodes; where they differ it matters only beyond the edges.

    Raises:
        ValueError: It matters, and they differ or mirror the image.
    """
    modes = list(dict.fromkeys(worn.extensions))
    if (len(modes) > 1 or "MIRROR" in modes) and not _is_inside(worn.surfaces):
        raise ValueError(
            f"{worn.who}: some UVs lie outside the image, where Image Texture nodes extend "
            f"it by {', '.join(modes)}"
        )
    return materials.WRAP_OF_EXTENSION[modes[0]]


def _is_inside(surfaces: Iterable[prefilter.Surface]) -> bool:
    return all(np.all((surface.uvs >= 0) & (surface.uvs <= 1)) for surface in surfaces)


def _nothing(scene: bpy.types.Scene, warnings: Sequence[str]) -> str:
    start = f"scene '{scene.name}': found no image texture to bake"
    if warnings:
        return "\n".join([start, *dict.fromkeys(warnings)])
    names = listed(obj.name for obj in scene.objects if obj.type == "MESH")
    if not names:
        return f"{start}; it has no mesh"
    return f"{start}; no material on a mesh that is rendered has one, among {names}"
