# SPDX-License-Identifier: GPL-3.0-or-later

"""UDIM images: which part of the surface lies in each tile, and the bakes of all tiles as one."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge import meshes
from ..bridge.images import Picture
from ..core.jobs import Progress, parts
from ..core.outcome import Outcome
from ..core.wording import listed
from .bake import Bake, write_all
from .choices import TEXTURE_SPACE_FILTERS, Settings

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Tile:
    """What a tile is baked from.

    Attributes:
        picture: Its pixels.
        found: The part of the surface that lies in it, in the unit square.
        target: The file to write, if there is one.
    """

    picture: Picture
    found: meshes.ImageSurfaces
    target: Path | None


class TiledBake:
    """The bakes of the tiles of a UDIM image, as one; it is used like a `Bake`."""

    def __init__(self, image_name: str, bakes: Sequence[Bake], warnings: list[str]) -> None:
        """Takes the bakes over, of one tile at least; use `reading.read`."""
        self.image_name = image_name
        self.warnings = warnings
        self._bakes = bakes

    @property
    def picture(self) -> Picture:
        """The pixels of the first tile that is baked."""
        return self._bakes[0].picture

    @property
    def objects(self) -> Sequence[str]:
        """The name of the object of each surface in any tile."""
        return [name for one in self._bakes for name in one.objects]

    @property
    def tile_count(self) -> int:
        """How many tiles are baked."""
        return len(self._bakes)

    def compute(self, progress: Progress) -> None:
        """Computes tile by tile; see `Bake.compute`."""
        try:
            for one, part in zip(self._bakes, parts(progress, len(self._bakes)), strict=True):
                one.compute(part)
        except BaseException:
            self.discard()
            raise

    def write(self) -> Outcome:
        """Writes all tiles, once everything is staged; see `Bake.write`."""
        outcomes = write_all(self._bakes)
        for outcome in outcomes:
            self.warnings.extend(outcome.warnings)
        names = [name for outcome in outcomes for name in outcome.images]
        summary = f"{outcomes[0].summary}, and likewise its other tiles, {len(outcomes)} in all"
        return replace(
            outcomes[0],
            summary=outcomes[0].summary if len(outcomes) == 1 else summary,
            images=names,
            files=[path for outcome in outcomes for path in outcome.files],
            warnings=list(dict.fromkeys(self.warnings)),
            notes=[note for outcome in outcomes for note in outcome.notes],
        )

    def let_pixels_go(self) -> None:
        """See `Bake.let_pixels_go`."""
        for one in self._bakes:
            one.let_pixels_go()

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for one in self._bakes:
            one.discard()


class Parts:
    """The parts of surfaces that lie in tiles; each is cut out once, whatever uses it."""

    def __init__(self) -> None:
        """Starts without any."""
        # With the surface, which keeps its identity from becoming another's.
        self._bounds: dict[int, tuple[prefilter.Surface, FloatArray, FloatArray]] = {}
        self._parts: dict[tuple[int, int], prefilter.Surface | None] = {}

    def inside(self, found: meshes.ImageSurfaces, number: int) -> meshes.ImageSurfaces:
        """Returns what lies in a tile, with the names of its objects, in the unit square."""
        inside = meshes.ImageSurfaces()
        for surface, name in zip(found.surfaces, found.objects, strict=True):
            part = self._part(surface, number)
            if part is not None:
                inside.surfaces.append(part)
                inside.objects.append(name)
        return inside

    def _part(self, surface: prefilter.Surface, number: int) -> prefilter.Surface | None:
        if id(surface) not in self._bounds:
            uvs = surface.uvs
            self._bounds[id(surface)] = surface, uvs.min(axis=(0, 1)), uvs.max(axis=(0, 1))
        _, low, high = self._bounds[id(surface)]
        corner = np.array(((number - 1001) % 10, (number - 1001) // 10))
        if np.any(high < corner) or np.any(low > corner + 1):
            return None
        key = id(surface), number
        if key not in self._parts:
            self._parts[key] = surface.udim_tile(number)
        return self._parts[key]


def tiles(
    image_name: str,
    pictures: Sequence[Picture],
    numbers: Sequence[int],
    found: meshes.ImageSurfaces,
    settings: Settings,
    targets: Sequence[Path],
) -> tuple[list[Tile], list[str]]:
    """Returns the tiles that some of the surface lies in, and warnings of the others.

    Args:
        image_name: The name of the tiled image.
        pictures: Of each tile.
        numbers: Of each tile.
        found: The surfaces on all of the tiles.
        settings: What to bake.
        targets: The file of each tile; empty for none.

    Raises:
        ValueError: The surface lies in none of the tiles.
    """
    chosen, warnings = [], list(found.problems)
    parts = Parts()
    for index, (picture, number) in enumerate(zip(pictures, numbers, strict=True)):
        inside = parts.inside(found, number)
        # A lookup past the edge of a tile is one in the next.
        inside.extensions = ["EXTEND"]
        area = sum(part.area for part in inside.surfaces)
        if area == 0 and settings.filter not in TEXTURE_SPACE_FILTERS:
            warnings.append(f"tile {number} is left out: no surface lies in it")
            continue
        chosen.append(Tile(picture, inside, targets[index] if targets else None))
    if not chosen:
        raise ValueError(
            f"image '{image_name}': no surface lies in its tiles, {listed(map(str, numbers))}"
        )
    return chosen, warnings


def paths(path: str, tiles: Sequence[int]) -> list[str]:
    """Returns the file of each tile: with its number for <UDIM>, or else before the extension."""
    if not path or not tiles:
        return [path] if path else []
    if "<UDIM>" not in path:
        stem, extension = os.path.splitext(path)
        path = f"{stem}.<UDIM>{extension}"
    return [path.replace("<UDIM>", str(number)) for number in tiles]
