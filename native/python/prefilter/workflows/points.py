# SPDX-License-Identifier: GPL-3.0-or-later

"""Surface reconstruction from scans: settings, reports, and work from files to a file."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import prefilter

from ..options.points import ScanSettings
from ..points.scan_files import is_ply
from ..points.steps import Steps
from .outcome import Outcome
from .progress import Progress
from .wording import Sentence, amount, listed

STREAMED_TARGET = ".ply"

_LABELS = {
    "cell_size": "Voxel Size",
    "trim": "Trim",
    "adaptivity": "Adaptivity",
    "isovalue": "Iso-Value",
    "direction": "Normals",
    "spacing": "Spacing",
    "memory_limit": "Memory Limit",
}
_DIRECTIONS = {
    "given": Sentence("normals are as given"),
    "up": Sentence("normals point up"),
    "viewpoint": Sentence("normals point to the scanner"),
    "outward": Sentence("normals point outward"),
}
_DROPPED = {
    "not_finite": Sentence("left out, because they have no finite position: {}"),
    "huge": Sentence("left out, because their coordinates are 1e30 or more, unlike others: {}"),
    "weightless": Sentence("left out, because they have no weight: {}"),
    "normalless": Sentence("left out, because they have no normal: {}"),
}
_MOST_POSITIONS = 3
"""Largest number of positions of phantom points to list."""
_LAST_CLASS = 255
_USUAL_OUTLIERS = 1e-3
"""Share of outliers that is normal in any scan."""


class Streaming:
    """Reconstructs a surface from files of points to a file, without loading either."""

    def __init__(
        self,
        sources: Sequence[Path],
        target: Path,
        settings: ScanSettings,
        length: Callable[[float], str],
        viewpoint: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Takes the inputs.

        `length` formats a length for messages. `viewpoint`: see `prefilter.reconstruct`.
        """
        self._viewpoint = viewpoint
        self._sources = sources
        self._target = target
        self._settings = settings
        self._length = length
        self._report: prefilter.ReconstructionReport | None = None

    def compute(self, progress: Progress) -> None:
        """Writes the file.

        Raises:
            ValueError: A source is damaged, or has no surface.
            OSError: A file cannot be read or written.
        """
        with labeled():
            self._report = prefilter.reconstruct_file(
                list(self._sources),
                self._target,
                viewpoint=self._viewpoint,
                progress=progress,
                **options(self._settings),
            )

    def write(self) -> Outcome:
        """Returns the outcome."""
        assert self._report is not None
        return outcome(self._sources, self._target, self._report, self._length)

    def discard(self) -> None:
        """Does nothing: the library leaves no temporary files."""


class StepWork:
    """One run of a step of a reconstruction that is split into steps; see `Steps`."""

    def __init__(
        self, steps: Steps, name: str, number: int, target: Path, length: Callable[[float], str]
    ) -> None:
        """Takes the step, the number of its run, and the file that the last step writes."""
        self._steps = steps
        self._name = name
        self._number = number
        self._target = target
        self._length = length
        self._report: prefilter.ReconstructionReport | None = None

    def compute(self, progress: Progress) -> None:
        """Writes the file of the step; raises what `Streaming.compute` does."""
        with labeled():
            if self._name == "join":
                self._report = self._steps.join(self._target, progress)
            else:
                self._steps.run(self._name, self._number, progress)

    def write(self) -> Outcome:
        """Returns the outcome."""
        if self._report is not None:
            return outcome(self._steps.sources, self._target, self._report, self._length)
        path = self._steps.file(self._name, self._number)
        count = self._steps.count(self._name)
        summary = f"Step {self._name}, {self._number + 1} of {count}, into '{path}'"
        return Outcome(summary, files=[str(path)])

    def discard(self) -> None:
        """Does nothing: the library leaves no temporary files."""


@contextmanager
def labeled() -> Iterator[None]:
    """A context in which error messages call settings by their labels in panels."""
    try:
        yield
    except ValueError as error:
        message = str(error)
        for name, label in _LABELS.items():
            message = message.replace(f"{name}:", f"{label}:")
        raise ValueError(message) from error


def options(settings: ScanSettings) -> dict[str, Any]:
    """Returns the settings as keyword arguments of the library."""
    custom = settings.isovalue == "custom"
    size = settings.voxel_size if settings.resolution == "size" else None
    depth = settings.depth if settings.resolution == "depth" else None
    return {
        "depth": depth,
        "cell_size": size,
        "wavelet": settings.wavelet,
        "smooth": settings.use_smooth,
        "isovalue": settings.custom_isovalue if custom else settings.isovalue,
        "fit": settings.use_fit,
        "direction": settings.direction,
        "watertight": settings.use_watertight,
        "adaptivity": settings.adaptivity,
        "trim": settings.trim if settings.trim > 0.0 else None,
        "classes": as_classes(settings.classes),
        "returns": settings.returns,
        "box": (settings.box[:3], settings.box[3:]) if any(settings.box) else None,
        "align": settings.align_to if settings.use_align else False,
        "memory_limit": settings.memory_limit or None,
        "threads": settings.threads,
    }


def has_connections(path: Path) -> bool:
    """Returns whether a file's format may hold connections between points."""
    return is_ply(path)


def as_classes(text: str) -> list[int] | None:
    """Parses numbers of classes; None for an empty text. Raises ValueError for other text."""
    words = text.replace(",", " ").split()
    if not all(word.isdecimal() and int(word) <= _LAST_CLASS for word in words):
        raise ValueError(
            f"Classes: found '{text}'; whole numbers from 0 to {_LAST_CLASS} are needed, separated "
            "by commas"
        )
    return [int(word) for word in words] or None


def summary(report: "prefilter.ReconstructionReport", length: Callable[[float], str]) -> str:
    """Returns a summary of a reconstruction's numbers."""
    points, triangles = amount(report.points, "point"), amount(report.triangles, "triangle")
    cell = length(report.cell)
    return Sentence("{} at depth {}, in cells of {}: {}", points, report.depth, cell, triangles)


def rounding_warning(length: str) -> str:
    """Returns a warning that coordinates have been rounded to a length."""
    return Sentence(
        "coordinates were rounded to {} before they were read, as single precision does far from "
        "the origin: points are merged. Export the scan in double precision, or nearer the origin",
        length,
    )


def _phantom_warnings(
    report: "prefilter.ReconstructionReport", origin: Sequence[float]
) -> Iterator[str]:
    """Yields warnings about points left out because many share one position."""
    for position, count in report.phantoms[:_MOST_POSITIONS]:
        place = ", ".join(f"{x + o + 0.0:.6g}" for x, o in zip(position, origin, strict=True))
        text = (
            "left out, because they are all at one place, ({}), as scanners write where they saw "
            "nothing: {}"
        )
        yield Sentence(text, place, amount(count, "point"))
    if more := report.phantoms[_MOST_POSITIONS:]:
        points = amount(sum(count for _, count in more), "point")
        text = "left out, because they are at {} more such places: {}"
        yield Sentence(text, len(more), points)


def _contradiction_warnings(report: "prefilter.ReconstructionReport") -> Iterator[str]:
    """Yields warnings about given normals that contradict one another."""
    if report.is_contradictory:
        share = f"{report.contradiction:.2f}"
        if report.is_reoriented:
            text = (
                "given normals contradict those of near points ({} of them), and were turned to "
                "agree; check which way the surface faces"
            )
        else:
            text = (
                "given normals contradict those of near points ({} of them), and were kept; the "
                "setting Normals, Outward turns them"
            )
        yield Sentence(text, share)


def point_warnings(
    report: "prefilter.ReconstructionReport",
    length: Callable[[float], str],
    origin: Sequence[float] = (0.0, 0.0, 0.0),
) -> list[str]:
    """Returns warnings about the points.

    Args:
        report: The report on the surface.
        length: Formats a length for messages.
        origin: Position of the origin of the points' coordinates.
    """
    warnings: list[str] = [*report.warnings, *_phantom_warnings(report, origin)]
    for cause, dropped in _DROPPED.items():
        if count := report.causes.get(cause, 0):
            warnings.append(Sentence(dropped, amount(count, "point")))
    warnings += _contradiction_warnings(report)
    if report.strays:
        strays = amount(report.strays, "point")
        warnings.append(Sentence("left out, because they are far from all others: {}", strays))
    if report.outliers > _USUAL_OUTLIERS:
        outliers = f"{100.0 * report.outliers:.2g} %"
        text = (
            "left out as outliers, because they are sampled much more sparsely than the rest: "
            "{} of the points"
        )
        warnings.append(Sentence(text, outliers))
    if report.is_flipped:
        warnings.append(Sentence("most normals point inward; all were flipped"))
    if report.float_step:
        warnings.append(rounding_warning(length(report.float_step)))
    if report.is_room and "given" in report.directions:
        warnings.append(
            Sentence(
                "most normals point inward, as in a room, and were kept; the setting Normals, "
                "Outward flips them"
            )
        )
    return warnings


def directions(report: "prefilter.ReconstructionReport") -> list[str]:
    """Returns notes about the direction of normals."""
    notes: list[str] = [_DIRECTIONS[direction] for direction in report.directions]
    if report.estimated:
        text = "normals that are zero or no numbers were estimated: those of {}"
        notes.append(Sentence(text, amount(report.estimated, "point")))
    if report.origin == "scanner":
        notes.append(
            Sentence(
                "the origin was taken for the scanner's position, as rays from there meet the "
                "surface once; if that is wrong, set Normals to Outward or Up"
            )
        )
    elif report.origin == "either":
        notes.append(
            Sentence(
                "the points are around the origin, and were taken for an object that is seen from "
                "outside; for a room that is seen from the origin, set Normals to Viewpoint"
            )
        )
    return notes


def openings(report: "prefilter.ReconstructionReport") -> list[str]:
    """Returns notes about openings of the surface."""
    notes: list[str] = []
    if report.cut:
        cut = f"{100.0 * report.cut:.2g} %"
        notes.append(Sentence("cut, because no points are near: {} of the surface", cut))
    if report.islands:
        share = f"{100.0 * report.island_share:.2g} %"
        parts = amount(report.islands, "part")
        text = "left out, because they are small: {}, {} of the surface"
        notes.append(Sentence(text, parts, share))
    return notes


def outcome(
    sources: Sequence[Path],
    target: Path,
    report: "prefilter.ReconstructionReport",
    length: Callable[[float], str],
    objects: Sequence[str] = (),
) -> Outcome:
    """Returns the outcome for the user."""
    several = len(sources) > 1
    notes = [f"read {listed(path.name for path in sources)}"] if several else []
    if report.alignment is not None:
        before, after = length(report.alignment.before), length(report.alignment.after)
        notes.append(f"aligned the files: typically {after} apart, before {before}")
    return Outcome(
        Sentence("Reconstructed '{}' from {}", target.name, summary(report, length)),
        objects=list(objects),
        files=[str(target)],
        warnings=point_warnings(report, length),
        notes=[*notes, *directions(report), *openings(report)],
    )
