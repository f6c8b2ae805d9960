# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of points in files, without objects of them: from file to file, or in memory."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray

from ..bridge.files import scenes
from ..bridge.new_meshes import Contour, new_mesh
from ..bridge.place import Place
from ..bridge.points import Carried, Points
from ..core.jobs import Progress, share
from ..core.jobs import parts as steps_of
from ..core.outcome import Outcome
from ..core.wording import listed
from .choices import ScanSettings
from .cloud import CONFIDENCE, Surface, oddities, options, reconstructed, told

SOURCES = prefilter.POINT_EXTENSIONS
STREAMED_TARGET = ".ply"

_READ = 0.2
"""What the progress is once files are read."""
_COLOR = "Col"
"""What Blender's imports call the colours of points."""
_CHANNELS = ("red", "green", "blue")
_ALPHA = "alpha"
_FAR = 1e3
"""From so many times their extent away, points are kept relative to an origin near them."""


class Streaming:
    """A file of points to a file of their surface, without loading either."""

    def __init__(self, source: Path, target: Path, settings: ScanSettings) -> None:
        """Takes what to read, what to write, and how; a depth, not a voxel size."""
        self._source = source
        self._target = target
        self._settings = settings
        self._report: prefilter.ReconstructionReport | None = None

    def compute(self, progress: Progress) -> None:
        """Writes the file.

        Raises:
            ValueError: The source is damaged, or has no surface.
            OSError: A file cannot be read or written.
        """
        self._report = prefilter.reconstruct_file(
            self._source,
            self._target,
            depth=self._settings.depth,
            progress=progress,
            **options(self._settings),
        )

    def write(self) -> Outcome:
        """Returns what was done."""
        assert self._report is not None
        return Outcome(
            f"Reconstructed '{self._target.name}' from {told(self._report)}",
            files=[str(self._target)],
            warnings=oddities(self._report),
        )

    def discard(self) -> None:
        """Does nothing: the library leaves nothing beside the target."""


class FilesReconstruction:
    """Files of points as one cloud, and its surface as an object in an empty scene, then a file."""

    def __init__(self, sources: Sequence[Path], target: Path, settings: ScanSettings) -> None:
        """Takes what to read, what to write, and how."""
        self._sources = sources
        self._target = target
        self._settings = settings
        self._origin: NDArray[np.float64] = np.zeros(3)
        self._surface: Surface | None = None
        self._contour: Contour | None = None

    def compute(self, progress: Progress) -> None:
        """Reads the points and reconstructs their surface.

        Raises:
            ValueError: A source is damaged, or there is no surface.
            OSError: A source cannot be read.
            MemoryError: The points or the surface do not fit into memory.
        """
        steps = steps_of(share(progress, 0.0, _READ), len(self._sources))
        read = [_read(path, step) for path, step in zip(self._sources, steps, strict=True)]
        self._origin = _origin_of(read)
        for points in read:
            points.positions[:] -= self._origin
            if points.viewpoint is not None:
                points.viewpoint[:] -= self._origin
        self._surface = reconstructed(read, self._settings, share(progress, _READ, 1.0))
        source = next((one for one in read if one.active_color), read[0])
        place = Place(source.name, self._origin, np.eye(3))
        self._contour = self._surface.contour(place, source, self._settings)

    def write(self) -> Outcome:
        """Makes an object and writes it to the target.

        Raises:
            OSError: The file cannot be written.
        """
        assert self._surface is not None
        assert self._contour is not None
        bpy.ops.wm.read_homefile(use_empty=True)
        name = self._sources[0].stem
        made = bpy.data.objects.new(name, new_mesh(name, self._contour))
        made.matrix_world = Matrix.Translation(self._origin)
        bpy.context.scene.collection.objects.link(made)
        bpy.context.view_layer.update()
        scenes.save(self._target, [made.name])
        several = len(self._sources) > 1
        return Outcome(
            f"Reconstructed '{self._target.name}' from {told(self._surface.report)}",
            objects=[made.name],
            files=[str(self._target)],
            warnings=oddities(self._surface.report),
            notes=[f"read {listed(path.name for path in self._sources)}"] if several else [],
        )

    def discard(self) -> None:
        """Does nothing: nothing is staged."""


def _read(path: Path, progress: Progress) -> Points:
    """Reads a file, with the normals that it tells in one way or another."""
    found = prefilter.read_points(path, progress=share(progress, 0.0, 0.5))
    if found.normals is None:
        told = prefilter.file_normals(path, found, progress=share(progress, 0.5, 1.0))
        if told is not None:
            normals, weights = told
            found = replace(found, normals=normals.astype(np.float32), weights=weights)
    return _points(found, path.stem)


def _points(read: "prefilter.ScanPoints", name: str) -> Points:
    """Returns what a file has, as Blender's imports name it."""
    attributes = {}
    values = dict(read.attributes)
    if all(channel in values for channel in _CHANNELS):
        channels = [values.pop(channel) for channel in _CHANNELS]
        is_byte = all(channel.dtype == np.uint8 for channel in channels)
        alpha = values.pop(_ALPHA, None)
        scale = np.float32(255.0 if is_byte else 1.0)
        opaque = np.ones(len(read.positions), np.float32)
        rgb = np.stack(channels, axis=1) / scale
        color = np.concatenate(
            [
                prefilter.to_linear(rgb[None])[0] if is_byte else rgb,
                (opaque if alpha is None else alpha / scale)[:, None],
            ],
            axis=1,
        ).astype(np.float32)
        attributes[_COLOR] = Carried("BYTE_COLOR" if is_byte else "FLOAT_COLOR", color)
    if read.weights is not None:
        attributes[CONFIDENCE] = Carried("FLOAT", read.weights[:, None])
    for key, numbers in values.items():
        attributes[key] = Carried("FLOAT", numbers[:, None].astype(np.float32))
    shown = _COLOR if _COLOR in attributes else ""
    return Points(
        read.positions,
        read.normals,
        attributes,
        name,
        active_color=shown,
        render_color=shown,
        viewpoint=read.viewpoint,
    )


def _origin_of(read: Sequence[Points]) -> NDArray[np.float64]:
    """Returns the middle of points that are far away, as seen from the origin; else the origin."""
    finite = [points.positions[np.isfinite(points.positions).all(axis=1)] for points in read]
    finite = [positions for positions in finite if len(positions)]
    if not finite:
        return np.zeros(3)
    low = np.min([positions.min(axis=0) for positions in finite], axis=0)
    high = np.max([positions.max(axis=0) for positions in finite], axis=0)
    middle = (low + high) / 2
    is_far = float(np.abs(middle).max()) > _FAR * float((high - low).max())
    return np.round(middle) if is_far else np.zeros(3)
