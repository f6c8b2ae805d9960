# SPDX-License-Identifier: GPL-3.0-or-later

"""`reconstruct_file` in steps that several machines run in parallel, with files between them."""

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
from .directions import as_orientation
from .reconstruction import CHECKS, ReconstructionReport, fill_in
from .sources import Cloud, joined_cloud

STEPS = ("measure", "count", "merge", "part", "join")
"""Steps in order; each needs all runs of the steps before it. "measure" and "count" have one run
per share of the points, "part" one per part of the surface."""

_MAGIC = b"REFSTEP1"
_CHECKSUM_SIZE = 8


class Steps:
    """Reconstruction of files of points in steps.

    Results of steps are files in a folder. They stay valid while the settings and the names, sizes
    and times of the point files stay the same.
    """

    def __init__(
        self,
        sources: Sequence[Path],
        folder: Path,
        parts: int,
        settings: Mapping[str, Any],
    ) -> None:
        """Prepares the steps; reads no points yet.

        Args:
            sources: Files of points, all with normals.
            folder: Folder of the steps' results, which is created if missing.
            parts: Number of parts that the surface is made in.
            settings: All options of `reconstruct_file`, by name.

        Raises:
            ValueError: Files are to be aligned.
            OSError: A file is missing, or the folder cannot be created.
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
        """Number of runs of a step, which may be done in parallel.

        Raises:
            ValueError: A file is damaged, or has no normals.
            OSError: A file cannot be read.
        """
        if step == "part":
            return self._parts
        return self._shares if step in ("measure", "count") else 1

    def file(self, step: str, number: int) -> Path:
        """Path of the result of a run."""
        return self._folder / f"{step}.{number + 1}-of-{self.count(step)}.prefilter"

    def is_done(self, step: str, number: int) -> bool:
        """Whether a run's result exists and belongs to these files and settings."""
        head = b"".join(map(_framed, (_KINDS[step], self._work.encode())))
        try:
            with self.file(step, number).open("rb") as file:
                start = file.read(len(_MAGIC) + len(head) + 2 * _CHECKSUM_SIZE)
        except OSError:
            return False
        return start.startswith(_MAGIC) and _first_two_arrays(start[len(_MAGIC) :]) == (
            _KINDS[step],
            self._work.encode(),
        )

    def run(self, step: str, number: int, progress: ProgressCallback | None) -> None:
        """Runs a step other than "join".

        Raises:
            ValueError: As `reconstruct`, or a file has no normals.
            OSError: A result of an earlier step is missing or damaged, or a file cannot be written.
            Cancelled: `progress` returned False.
        """
        cloud, options = self._cloud_and_options()
        if isinstance(cloud.points, _native.JoinedPoints) and step in ("measure", "count"):
            cloud.points.choose_share(number)
        recover(self._folder)
        _native.reconstruct_step(
            step, cloud.points, number, self._files(), options, as_progress(progress)
        )

    def join(
        self, target: str | os.PathLike[str], progress: ProgressCallback | None
    ) -> ReconstructionReport:
        """Runs the last step: writes the surface to a .ply file. Raises the errors of `run`."""
        output = as_target(target)
        cloud, options = self._cloud_and_options()
        recover(output.parent)
        report = ReconstructionReport()
        findings = _native.join_steps(
            cloud.points, self._files(), os.fsencode(output), options, as_progress(progress)
        )
        fill_in(report, findings, cloud)
        return report

    @functools.cached_property
    def _cloud(self) -> Cloud:
        orientation = as_orientation(self._settings["direction"], self._settings["viewpoint"])
        choice = as_choice(*(self._settings[name] for name in ("classes", "returns", "box")))
        threads = self._settings["threads"]
        sources = list(self.sources)
        return joined_cloud(sources, orientation, None, threads, choice, must_have_normals=True)

    @property
    def _shares(self) -> int:
        points = self._cloud.points
        return points.share_count if isinstance(points, _native.JoinedPoints) else 1

    def _cloud_and_options(self) -> tuple[Cloud, _native.ReconstructOptions]:
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
        files = []
        for path in self.sources:
            status = path.stat()
            files.append([path.name, status.st_size, int(status.st_mtime)])
        decisive = {
            name: value
            for name, value in self._settings.items()
            if name not in ("threads", "memory_limit")
        }
        text = json.dumps([_native.VERSION, files, self._parts, decisive], default=str)
        return hashlib.sha256(text.encode()).hexdigest()


_KINDS = {"measure": b"measure", "count": b"counts", "merge": b"cells", "part": b"part"}
"""Kind that the file of each step names in its head; see io/archive.h."""


def _framed(text: bytes) -> bytes:
    return len(text).to_bytes(8, "little") + text


def _first_two_arrays(data: bytes) -> tuple[bytes, ...]:
    """The first two arrays of a file, without their checksums."""
    arrays = []
    for _ in range(2):
        size = int.from_bytes(data[:8], "little")
        arrays.append(data[8 : 8 + size])
        data = data[8 + size + _CHECKSUM_SIZE :]
    return tuple(arrays)
