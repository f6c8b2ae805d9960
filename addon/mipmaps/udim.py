# SPDX-License-Identifier: GPL-3.0-or-later

"""UDIM images: a bake a tile, and all of them as one."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..bridge import meshes
from ..bridge.files.staging import StagedFile
from ..bridge.images import Picture
from ..bridge.tile_surfaces import TileSurfaces
from ..core.jobs import Progress, parts
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from .bake import Bake, write_all
from .choices import TEXTURE_SPACE_FILTERS, Settings


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
    def is_up_to_date(self) -> bool:
        """Whether all tiles are; see `Bake.is_up_to_date`."""
        return all(one.is_up_to_date for one in self._bakes)

    @property
    def files(self) -> list[Path]:
        """See `Bake.files`."""
        return [path for one in self._bakes for path in one.files]

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

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The files of all tiles, to be renamed into place."""
        return [file for one in self._bakes for file in one.staged_files]

    def stage_images(self) -> None:
        """See `Bake.stage_images`."""
        for one in self._bakes:
            one.stage_images()

    def write(self) -> Outcome:
        """Writes all tiles, once everything is staged; see `Bake.write`."""
        return write_all([self])[0]

    def finish(self) -> Outcome:
        """See `Bake.finish`."""
        outcomes = [one.finish() for one in self._bakes]
        for outcome in outcomes:
            self.warnings.extend(outcome.warnings)
        names = [name for outcome in outcomes for name in outcome.images]
        text = "{}, and likewise its other tiles, {} in all"
        summary = Sentence(text, outcomes[0].summary, len(outcomes))
        return replace(
            outcomes[0],
            summary=outcomes[0].summary if len(outcomes) == 1 else summary,
            images=names,
            files=[path for outcome in outcomes for path in outcome.files],
            warnings=list(dict.fromkeys(self.warnings)),
            notes=[note for outcome in outcomes for note in outcome.notes],
        )

    def release_pixels(self) -> None:
        """See `Bake.release_pixels`."""
        for one in self._bakes:
            one.release_pixels()

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for one in self._bakes:
            one.discard()


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
    surfaces = TileSurfaces()
    for index, (picture, number) in enumerate(zip(pictures, numbers, strict=True)):
        inside = surfaces.inside(found, number)
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
