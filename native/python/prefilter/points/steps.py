# SPDX-License-Identifier: GPL-3.0-or-later

"""`reconstruct_file` in steps that machines do side by side, each with files of its own."""

import functools
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .. import _native
from .._border.arguments import ProgressCallback, as_progress, set_options
from ..files.replacing import recover
from ..files.staging import as_target
from .choice import as_choice
from .directions import as_wanted
from .reconstruction import CHECKS, ReconstructionReport, fill_in
from .sources import Cloud, joined_cloud

STEPS = ("measure", "count", "merge", "part", "join")
"""In their order: "measure" and "count" do each share of the points by itself, "part" each part of
the surface; each needs all of those before it."""

_MAGIC = b"REFSTEP1"
_SUM = 8


class Steps:
    """The surface of files of points, in steps.

    What steps leave for each other is kept in a folder, and not made again while the files of
    points, by their names, sizes and times, and the settings stay.
    """

    def __init__(
        self,
        sources: Sequence[Path],
        folder: Path,
        parts: int,
        settings: Mapping[str, Any],
    ) -> None:
        """Takes what to do.

        Args:
            sources: The files, which all have normals.
            folder: It is made if it is missing.
            parts: How many the surface is made in.
            settings: All options of `reconstruct_file`, by their names.

        Raises:
            ValueError: Files are to be aligned.
            OSError: A file is not there, or the folder cannot be made.
        """
        if settings["align"] is not False:
            raise ValueError("align: not allowed in steps; align the files before")
        self.sources = sources
        self._settings = settings
        self._folder = folder
        self._parts = parts
        folder.mkdir(parents=True, exist_ok=True)
        self._work = self._fingerprint()

    def count(self, step: str) -> int:
        """Returns how many runs of a step there are, which may be done side by side.

        Raises:
            ValueError: A file is damaged, or has no normals.
            OSError: A file cannot be read.
        """
        if step == "part":
            return self._parts
        return self._shares if step in ("measure", "count") else 1

    def file(self, step: str, number: int) -> Path:
        """Returns what a run of a step leaves."""
        return self._folder / f"{step}.{number + 1}-of-{self.count(step)}.prefilter"

    def is_done(self, step: str, number: int) -> bool:
        """Tells whether that is there, of the same files and settings."""
        head = b"".join(map(_framed, (_KINDS[step], self._work.encode())))
        try:
            with self.file(step, number).open("rb") as file:
                start = file.read(len(_MAGIC) + len(head) + 2 * _SUM)
        except OSError:
            return False
        return start.startswith(_MAGIC) and _without_sums(start[len(_MAGIC) :]) == (
            _KINDS[step],
            self._work.encode(),
        )

    def run(self, step: str, number: int, progress: ProgressCallback | None) -> None:
        """Does a run of a step but the last.

        Raises:
            ValueError: As `reconstruct`, or a file has no normals.
            OSError: A file of an earlier step is missing or damaged, or cannot be written.
            Cancelled: `progress` returned False.
        """
        cloud, options = self._begun()
        if isinstance(cloud.points, _native.JoinedPoints) and step in ("measure", "count"):
            cloud.points.choose_share(number)
        recover(self._folder)
        told = as_progress(progress)
        _native.reconstruct_step(step, cloud.points, number, self._files(), options, told)

    def join(
        self, target: str | os.PathLike[str], progress: ProgressCallback | None
    ) -> ReconstructionReport:
        """Does the last step: writes the surface to a .ply file. Raises what `run` does."""
        place = as_target(target)
        cloud, options = self._begun()
        recover(place.parent)
        report = ReconstructionReport()
        found = _native.join_steps(
            cloud.points, self._files(), os.fsencode(place), options, as_progress(progress)
        )
        fill_in(report, found, cloud)
        return report

    @functools.cached_property
    def _cloud(self) -> Cloud:
        wanted = as_wanted(self._settings["direction"], self._settings["viewpoint"])
        choice = as_choice(*(self._settings[name] for name in ("classes", "returns", "box")))
        threads = self._settings["threads"]
        sources = list(self.sources)
        return joined_cloud(sources, wanted, None, threads, choice, must_have_normals=True)

    @property
    def _shares(self) -> int:
        points = self._cloud.points
        return points.share_count if isinstance(points, _native.JoinedPoints) else 1

    def _begun(self) -> tuple[Cloud, _native.ReconstructOptions]:
        options = set_options(_native.ReconstructOptions(), CHECKS, self._settings)
        options.folder = os.fsencode(self._folder)
        options.support = True
        options.are_sides_known = self._cloud.are_sides_known
        return self._cloud, options

    def _files(self) -> _native.StepFiles:
        def all_of(step: str) -> list[bytes]:
            return [os.fsencode(self.file(step, number)) for number in range(self.count(step))]

        return _native.StepFiles(
            self._work,
            all_of("measure"),
            all_of("count"),
            os.fsencode(self.file("merge", 0)),
            all_of("part"),
        )

    def _fingerprint(self) -> str:
        read = []
        for path in self.sources:
            status = path.stat()
            read.append([path.name, status.st_size, int(status.st_mtime)])
        decisive = {
            name: value
            for name, value in self._settings.items()
            if name not in ("threads", "memory_limit")
        }
        said = json.dumps([_native.VERSION, read, self._parts, decisive], default=str)
        return hashlib.sha256(said.encode()).hexdigest()


_KINDS = {"measure": b"measure", "count": b"counts", "merge": b"cells", "part": b"part"}
"""What the files of steps call themselves; see io/archive.h."""


def _framed(text: bytes) -> bytes:
    return len(text).to_bytes(8, "little") + text


def _without_sums(data: bytes) -> tuple[bytes, ...]:
    """Returns the first two arrays of a file."""
    found = []
    for _ in range(2):
        size = int.from_bytes(data[:8], "little")
        found.append(data[8 : 8 + size])
        data = data[8 + size + _SUM :]
    return tuple(found)
