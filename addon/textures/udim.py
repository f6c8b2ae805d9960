# SPDX-License-Identifier: GPL-3.0-or-later

"""UDIM images: one bake per tile, and all of them as one bake."""

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
    """The inputs of a tile's bake.

    Attributes:
        picture: Its pixels.
        surfaces: The part of the surfaces that lies in it, in the unit square.
        target: The file to write; None for no file.
    """

    picture: Picture
    surfaces: meshes.ImageSurfaces
    target: Path | None


class TiledBake:
    """The bakes of a UDIM image's tiles, with the interface of a `Bake`."""

    def __init__(self, image_name: str, bakes: Sequence[Bake], warnings: list[str]) -> None:
        """Stores the bakes, at least one; use `bake_inputs.read`."""
        self.image_name = image_name
        self.warnings = warnings
        self._bakes = bakes

    @property
    def picture(self) -> Picture:
        """The pixels of the first baked tile."""
        return self._bakes[0].picture

    @property
    def objects(self) -> Sequence[str]:
        """The name of each surface's object, over all tiles."""
        return [name for bake in self._bakes for name in bake.objects]

    @property
    def is_up_to_date(self) -> bool:
        """Whether all tiles are up to date; see `Bake.is_up_to_date`."""
        return all(bake.is_up_to_date for bake in self._bakes)

    @property
    def files(self) -> list[Path]:
        """See `Bake.files`."""
        return [path for bake in self._bakes for path in bake.files]

    @property
    def tile_count(self) -> int:
        """The number of baked tiles."""
        return len(self._bakes)

    def compute(self, progress: Progress) -> None:
        """Computes tile by tile; see `Bake.compute`."""
        try:
            for bake, part in zip(self._bakes, parts(progress, len(self._bakes)), strict=True):
                bake.compute(part)
        except BaseException:
            self.discard()
            raise

    @property
    def staged_files(self) -> Sequence[StagedFile]:
        """The finished files of all tiles, beside their targets."""
        return [file for bake in self._bakes for file in bake.staged_files]

    def stage_images(self) -> None:
        """See `Bake.stage_images`."""
        for bake in self._bakes:
            bake.stage_images()

    def write(self) -> Outcome:
        """Writes all tiles or none; see `Bake.write`."""
        return write_all([self])[0]

    def finish(self) -> Outcome:
        """See `Bake.finish`."""
        outcomes = [bake.finish() for bake in self._bakes]
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
        for bake in self._bakes:
            bake.release_pixels()

    def discard(self) -> None:
        """Deletes staged files and images that were not put into place."""
        for bake in self._bakes:
            bake.discard()


def tiles(
    image_name: str,
    pictures: Sequence[Picture],
    numbers: Sequence[int],
    surfaces: meshes.ImageSurfaces,
    settings: Settings,
    targets: Sequence[Path],
) -> tuple[list[Tile], list[str]]:
    """Returns the tiles that contain part of the surfaces, and warnings about the others.

    Args:
        image_name: The name of the tiled image.
        pictures: The pixels of each tile.
        numbers: The number of each tile.
        surfaces: The surfaces on all tiles.
        settings: The settings of the bake.
        targets: The file of each tile; empty for no files.

    Raises:
        ValueError: No tile contains part of the surfaces.
    """
    chosen, warnings = [], list(surfaces.problems)
    tile_surfaces = TileSurfaces()
    for index, (picture, number) in enumerate(zip(pictures, numbers, strict=True)):
        inside = tile_surfaces.inside(surfaces, number)
        # A lookup beyond the edge of a tile reads the next tile.
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
    """Returns the file of each tile: its number replaces <UDIM>, or precedes the extension."""
    if not path or not tiles:
        return [path] if path else []
    if "<UDIM>" not in path:
        stem, extension = os.path.splitext(path)
        path = f"{stem}.<UDIM>{extension}"
    return [path.replace("<UDIM>", str(number)) for number in tiles]
