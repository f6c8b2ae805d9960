# SPDX-License-Identifier: GPL-3.0-or-later

"""Import of files of points in two steps: read the files, make the objects."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from prefilter.workflows.points import as_classes, has_connections, rounding_warning

from ..bridge.layers import ATTRIBUTE, NewLayer
from ..bridge.new_points import Cloud, new_points, scene_offset, spacing
from ..bridge.units import length
from ..core.jobs import Progress, share
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, amount, counted
from .choices import ImportSettings
from .files import attribute_layers, offset_warning

_CONFIDENCE = "confidence"
_MAX_STEP_SPACINGS = 0.25
"""Rounding step of coordinates, in point spacings, above which a warning is given."""


class PointsImport:
    """Imports files of points, each as an object, all relative to one offset."""

    def __init__(self, sources: Sequence[Path], settings: ImportSettings) -> None:
        """Keeps sources and settings; raises ValueError for a wrong setting."""
        check(settings)
        self._sources = sources
        self._settings = settings
        self._clouds: list[Cloud] = []
        self._warnings: list[str] = []
        self._notes: list[str] = []

    @property
    def has_colors(self) -> bool:
        """Whether points have colors."""
        return any(cloud.color for cloud in self._clouds)

    def compute(self, progress: Progress) -> None:
        """Reads the files.

        Raises:
            ValueError: A file is damaged, has another format, or has no points.
            OSError: A file cannot be read.
            MemoryError: The points do not fit into memory.
            prefilter.Cancelled: `progress` returned False.
        """
        count = len(self._sources)
        for k, path in enumerate(self._sources):
            self._clouds.append(self._read(path, share(progress, k / count, (k + 1) / count)))

    def write(self) -> Outcome:
        """Makes the objects, selects them, and makes the first one active."""
        corners = np.concatenate(
            [
                np.stack([cloud.positions.min(axis=0), cloud.positions.max(axis=0)])
                for cloud in self._clouds
            ]
        )
        offset = scene_offset(corners)
        for obj in bpy.context.selected_objects:
            obj.select_set(False)
        objects = [new_points(cloud, offset) for cloud in self._clouds]
        for obj in objects:
            obj.select_set(True)
        bpy.context.view_layer.objects.active = objects[0]
        if offset.any():
            self._warnings.append(offset_warning(offset))
        self._warnings += [
            rounding_warning(length(step))
            for step in dict.fromkeys(map(_merging_step, self._clouds))
            if step > 0.0
        ]
        points = sum(len(cloud.positions) for cloud in self._clouds)
        files = f"'{self._sources[0].name}'" if len(objects) == 1 else counted(objects, "file")
        return Outcome(
            Sentence("Imported {} from {}", amount(points, "point"), files),
            objects=[obj.name for obj in objects],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Releases the points."""
        self._clouds.clear()

    def _read(self, path: Path, progress: Progress) -> Cloud:
        scan = self._points(path, progress)
        is_finite = np.asarray(np.isfinite(scan.positions).all(axis=1))
        unfit = int(np.count_nonzero(~is_finite))
        if unfit == len(is_finite):
            raise ValueError(Sentence("'{}': no points", path.name))
        if unfit:
            text = "'{}': left out, because they have no finite position: {}"
            self._notes.append(Sentence(text, path.name, amount(unfit, "point")))
        layers = attribute_layers(scan.attributes, len(is_finite))
        if scan.weights is not None:
            weights = np.asarray(scan.weights, np.float32)[:, None]
            layers.append(NewLayer(ATTRIBUTE, _CONFIDENCE, "FLOAT", "POINT", weights))
        viewpoint = scan.viewpoint
        return Cloud(
            path.stem,
            scan.positions[is_finite],
            None if scan.normals is None else scan.normals[is_finite],
            [replace(layer, values=layer.values[is_finite]) for layer in layers],
            viewpoint[is_finite] if viewpoint is not None and viewpoint.ndim == 2 else viewpoint,
            scan.is_from_above,
        )

    def _points(self, path: Path, progress: Progress) -> "prefilter.ScanPoints":
        """Reads the points of a file; derives normals from its grid or faces if it has none."""
        most = self._settings.most_points
        classes, returns = as_classes(self._settings.classes), self._settings.returns
        # Grids and faces index points of the whole file.
        is_whole = has_connections(path)
        try:
            scan = prefilter.read_points(
                path,
                most=most or None,
                classes=None if is_whole else classes,
                returns="all" if is_whole else returns,
                progress=share(progress, 0.0, 0.7),
            )
            derived = None
            if scan.normals is None and scan.stride == 1 and is_whole:
                derived = prefilter.file_normals(path, scan, progress=share(progress, 0.7, 1.0))
        except MemoryError as error:
            raise MemoryError(f"{error}; a lower value of Most Points keeps fewer") from error
        self._warnings += scan.warnings
        if scan.stride > 1:
            text = "'{}': one of {} points was kept, as Most Points is {}"
            self._warnings.append(Sentence(text, path.name, scan.stride, most))
        if derived is not None:
            scan = replace(scan, normals=derived[0], weights=derived[1])
        if is_whole:
            scan = prefilter.choose_points(scan, classes=classes, returns=returns)
        return scan


def _merging_step(cloud: Cloud) -> float:
    """Rounding step of coordinates in the file if it is large beside the spacing; else 0."""
    step = float(prefilter.float_step(cloud.positions))
    return step if step > _MAX_STEP_SPACINGS * spacing(cloud.positions) else 0.0
