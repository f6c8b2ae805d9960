# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points as objects, in two steps: read the files, make the objects."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from prefilter.workflows.scans import as_classes, has_connections, rounding_warning

from ..bridge.layers import ATTRIBUTE, NewLayer
from ..bridge.new_points import Cloud, new_points, scene_offset, spacing
from ..bridge.units import length
from ..core.jobs import Progress, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, amount, counted
from .choices import ImportSettings
from .files import attribute_layers, moved

_CONFIDENCE = "confidence"
_COARSE = 0.25
"""Of how far points are apart: coordinates of larger steps are those of other points, too."""


class PointsImport:
    """Files of points, each as an object; all of them relative to one offset."""

    def __init__(self, sources: Sequence[Path], settings: ImportSettings) -> None:
        """Takes what to read, and how; raises ValueError where that is not allowed."""
        check(settings)
        self._sources = sources
        self._settings = settings
        self._clouds: list[Cloud] = []
        self._warnings: list[str] = []
        self._notes: list[str] = []

    @property
    def has_colors(self) -> bool:
        """Whether there are colors to be seen."""
        return any(cloud.color for cloud in self._clouds)

    def compute(self, progress: Progress) -> None:
        """Reads the files.

        Raises:
            ValueError: A file is damaged, is of another kind, or has no points.
            OSError: A file cannot be read.
            MemoryError: The points do not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        count = len(self._sources)
        for k, path in enumerate(self._sources):
            self._clouds.append(self._read(path, share(progress, k / count, (k + 1) / count)))

    def write(self) -> Outcome:
        """Makes the objects, which are then the selected ones, the first of them active."""
        everywhere = np.concatenate(
            [
                np.stack([one.positions.min(axis=0), one.positions.max(axis=0)])
                for one in self._clouds
            ]
        )
        offset = scene_offset(everywhere)
        for obj in bpy.context.selected_objects:
            obj.select_set(False)
        made = [new_points(cloud, offset) for cloud in self._clouds]
        for obj in made:
            obj.select_set(True)
        bpy.context.view_layer.objects.active = made[0]
        if offset.any():
            self._warnings.append(moved(offset))
        self._warnings += [
            rounding_warning(length(step))
            for step in dict.fromkeys(map(_merging_step, self._clouds))
            if step > 0.0
        ]
        points = sum(len(cloud.positions) for cloud in self._clouds)
        from_files = f"'{self._sources[0].name}'" if len(made) == 1 else counted(made, "file")
        return Outcome(
            Sentence("Imported {} from {}", amount(points, "point"), from_files),
            objects=[obj.name for obj in made],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Lets go of what was read."""
        self._clouds.clear()

    def _read(self, path: Path, progress: Progress) -> Cloud:
        found = self._points(path, progress)
        is_finite = np.asarray(np.isfinite(found.positions).all(axis=1))
        unfit = int(np.count_nonzero(~is_finite))
        if unfit == len(is_finite):
            raise ValueError(Sentence("'{}': no points", path.name))
        if unfit:
            text = "'{}': left out, because they have no finite position: {}"
            self._notes.append(Sentence(text, path.name, amount(unfit, "point")))
        layers = attribute_layers(found.attributes, len(is_finite))
        if found.weights is not None:
            weights = np.asarray(found.weights, np.float32)[:, None]
            layers.append(NewLayer(ATTRIBUTE, _CONFIDENCE, "FLOAT", "POINT", weights))
        viewpoint = found.viewpoint
        return Cloud(
            path.stem,
            found.positions[is_finite],
            None if found.normals is None else found.normals[is_finite],
            [replace(one, values=one.values[is_finite]) for one in layers],
            viewpoint[is_finite] if viewpoint is not None and viewpoint.ndim == 2 else viewpoint,
            found.is_from_above,
        )

    def _points(self, path: Path, progress: Progress) -> "prefilter.ScanPoints":
        """Returns the points of a file, with the normals that a grid or faces in it tell."""
        most = self._settings.most_points
        classes, returns = as_classes(self._settings.classes), self._settings.returns
        # A grid and faces name points of the whole file.
        is_whole = has_connections(path)
        try:
            found = prefilter.read_points(
                path,
                most=most or None,
                classes=None if is_whole else classes,
                returns="all" if is_whole else returns,
                progress=share(progress, 0.0, 0.7),
            )
            told = None
            if found.normals is None and found.stride == 1 and is_whole:
                told = prefilter.file_normals(path, found, progress=share(progress, 0.7, 1.0))
        except MemoryError as error:
            raise MemoryError(f"{error}; a lower value of Most Points keeps fewer") from error
        self._warnings += found.warnings
        if found.stride > 1:
            text = "'{}': one of {} points was kept, as Most Points is {}"
            self._warnings.append(Sentence(text, path.name, found.stride, most))
        if told is not None:
            found = replace(found, normals=told[0], weights=told[1])
        if is_whole:
            found = prefilter.choose_points(found, classes=classes, returns=returns)
        return found


def _merging_step(cloud: Cloud) -> float:
    """Returns what coordinates were rounded to in the file, if that is much; else 0."""
    step = float(prefilter.float_step(cloud.positions))
    return step if step > _COARSE * spacing(cloud.positions) else 0.0
