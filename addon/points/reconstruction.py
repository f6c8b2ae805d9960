# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstruction of objects' points in three steps: read, compute, write."""

import dataclasses
import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge import new_meshes
from ..bridge.color_materials import show_attribute
from ..bridge.kept_sources import keep
from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_points import OFFSET, kept_offset
from ..bridge.points import PointAttribute, Points, read_points
from ..bridge.target_frame import TargetFrame, find_object
from ..core.jobs import Progress, go_on
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from .choices import ScanSettings
from .surface import (
    Look,
    contour,
    directions,
    labeled,
    oddities,
    openings,
    options,
    reconstruct,
    summarize,
    support_layers,
)

_CHANNELS = ("red", "green", "blue", "alpha")
_CONFIDENCE = "confidence"
"""Attribute with the weights of points."""

# Seconds, measured once on two cores; only their ratios matter.
_CONSTANT = 0.01
_PER_POINT = {"haar": 0.15e-6, "d4": 0.45e-6}
_PER_TRIANGLE = {"haar": 1.1e-6, "d4": 2.7e-6}
_FITTING = 0.2e-6
_TRIANGLES_OF_CUBE = 5.5
"""Typical number of triangles of a solid, divided by the square of the cells per side."""
_TRIANGLES_PER_POINT = 5.5
_TRIANGLES_PER_POINT_AUTO = 1.6
"""Typical number of triangles per point at the automatic depth: 1 to 4 points per cell face."""


@dataclass(frozen=True)
class Load:
    """Amount of work, from which its duration is estimated.

    Attributes:
        points: Number of points.
        extent: Longest side of the box around them.
    """

    points: int
    extent: float

    def seconds(self, settings: ScanSettings) -> float:
        """Estimated duration on two cores, in seconds; 0 for settings that will be refused."""
        depth: float = settings.depth
        per_point = _TRIANGLES_PER_POINT
        if settings.resolution == "auto":
            depth, per_point = prefilter.MAX_DEPTH, _TRIANGLES_PER_POINT_AUTO
        elif settings.resolution == "size":
            depth = math.log2(max(self.extent / settings.voxel_size, 2.0))
            if depth > prefilter.MAX_DEPTH:
                return 0.0
        triangles = min(_TRIANGLES_OF_CUBE * 4.0**depth, per_point * self.points)
        per_triangle = _PER_TRIANGLE[settings.wavelet] + (_FITTING if settings.use_fit else 0.0)
        return _CONSTANT + _PER_POINT[settings.wavelet] * self.points + per_triangle * triangles


class ObjectsReconstruction:
    """Reconstructs the surface of the points of objects, as a new object.

    `read` and `write` run on the main thread; `compute` uses no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self, frame: TargetFrame, names: list[str], read: list[Points], settings: ScanSettings
    ) -> None:
        """Keeps copied points; use `ObjectsReconstruction.read`."""
        self.load = Load(
            sum(len(points.positions) for points in read),
            max((_extent(points.positions) for points in read), default=0.0),
        )
        self.offset: NDArray[np.float64] = np.zeros(3)
        """Offset that was subtracted from the points to move them near the origin."""
        self._frame = frame
        self._names = names
        self._read = read
        self.settings = settings
        self._warnings: list[str] = []
        self._notes: list[str] = []
        self._surface: prefilter.Reconstruction | None = None
        self._contour: new_meshes.Contour | None = None

    @property
    def has_colors(self) -> bool:
        """Whether the surface has colors."""
        return self._contour is not None and bool(self._contour.active[COLOR])

    @classmethod
    def read(
        cls,
        objects: Sequence[bpy.types.Object],
        active: bpy.types.Object | None,
        settings: ScanSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> "ObjectsReconstruction":
        """Copies the points out of Blender.

        Args:
            objects: Objects with points.
            active: The object that the surface is placed beside; the first one if it is not one of
                the objects.
            settings: The settings.
            depsgraph: The evaluated dependency graph.

        Raises:
            ValueError: There is no object, or one cannot be reconstructed.
        """
        check(settings)
        if not objects:
            raise ValueError(Sentence("no object is selected that has points and no faces"))
        if settings.points == "delete":
            for obj in objects:
                new_meshes.check_editable(obj)
        beside = active if active in objects else objects[0]
        frame = TargetFrame.beside(beside, depsgraph)
        read = read_points(objects, depsgraph, frame.origin)
        names = [obj.name for obj in objects]
        if not read:
            text = "object {}: no points" if len(names) == 1 else "objects {}: no points"
            raise ValueError(Sentence(text, listed(names)))
        work = cls(frame, names, read, settings)
        work.offset = kept_offset(beside)
        return work

    def scans(self) -> list["prefilter.ScanPoints"]:
        """Returns the points relative to the object of the surface, along the axes of the world."""
        transferred = _transferred(self._read)
        return [_scan(points, transferred, self.settings) for points in self._read]

    def scans_in_place(self) -> list["prefilter.ScanPoints"]:
        """Returns the points before they were moved near the origin."""
        frame = self._frame.origin + self.offset
        return [
            dataclasses.replace(
                scan,
                positions=scan.positions + frame,
                viewpoint=None if scan.viewpoint is None else scan.viewpoint + frame,
            )
            for scan in self.scans()
        ]

    def compute(self, progress: Progress) -> None:
        """Reconstructs the surface.

        Raises:
            ValueError: There is none, or cells are too small.
            MemoryError: The result does not fit into memory.
            prefilter.Cancelled: `progress` returned False.
        """
        names = list(dict.fromkeys(each.name for each in self._read if each.normals is None))
        if names:
            self._notes.append(Sentence("normals were estimated for {}", listed(names)))
        transferred = _transferred(self._read)
        surface = reconstruct(self.scans(), self.settings, progress)
        self._warnings.extend(oddities(surface.report, self._frame.origin.tolist()))
        self._notes.extend(directions(surface.report))
        self._notes.extend(openings(surface.report))
        self._surface = surface
        look = self._look(surface, transferred)
        self._contour = contour(surface, self._frame, look, self.settings)
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the surface's mesh in steps, before `write` shows it."""
        assert self._contour is not None
        yield from new_meshes.making_mesh(self._contour)

    def write(self) -> Outcome:
        """Adds the object; hides or deletes the points if so chosen.

        Raises:
            ValueError: An object is gone.
        """
        assert self._surface is not None
        assert self._contour is not None
        beside = find_object(self._frame.name)
        objects = [find_object(name) for name in self._names]
        name = f"{beside.name}.surface"
        mesh = new_meshes.new_mesh(name, self._contour)
        show_attribute(mesh, self._contour.active[COLOR])
        made = new_meshes.new_object_beside(beside, mesh, ".surface")
        if OFFSET in beside:
            made[OFFSET] = list(beside[OFFSET])
        bpy.context.view_layer.objects.active = made
        for obj in objects:
            obj.select_set(False)
            if self.settings.points == "hide":
                obj.hide_set(True)
                obj.hide_render = True
            elif self.settings.points == "delete":
                bpy.data.objects.remove(obj)
        if self.settings.points != "delete":
            keep(made, objects)
        return Outcome(
            Sentence("Reconstructed '{}' from {}", made.name, summarize(self._surface.report)),
            objects=[made.name],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Removes a mesh that was made and is not shown."""
        if self._contour is not None:
            new_meshes.forget_mesh(self._contour)

    def _look(
        self, surface: "prefilter.Reconstruction", transferred: dict[str, PointAttribute]
    ) -> Look:
        """Attributes of the surface, with materials and colors of the active object if possible."""
        first = next((each for each in self._read if each.name == self._frame.name), self._read[0])
        colored = next((each for each in (first, *self._read) if each.active_color), first)
        return Look(
            [
                *(_layer(name, each.data_type, surface) for name, each in transferred.items()),
                *support_layers(surface, transferred),
            ],
            colored.active_color,
            colored.render_color,
            first.materials,
        )


class ObjectsStreaming:
    """Writes the surface of objects that were moved near the origin, in their original position.

    The target is a .ply file.
    """

    def __init__(self, work: ObjectsReconstruction, target: Path) -> None:
        """Keeps copied points, and the target."""
        self._work = work
        self._target = target
        self._report: prefilter.ReconstructionReport | None = None

    def compute(self, progress: Progress) -> None:
        """Writes the file.

        Raises:
            ValueError: There is no surface.
            OSError: The file cannot be written.
        """
        with labeled():
            self._report = prefilter.reconstruct_file(
                self._work.scans_in_place(),
                self._target,
                progress=progress,
                **options(self._work.settings),
            )

    def write(self) -> Outcome:
        """Returns the outcome."""
        assert self._report is not None
        return Outcome(
            Sentence("Reconstructed '{}' from {}", self._target.name, summarize(self._report)),
            files=[str(self._target)],
            warnings=oddities(self._report),
            notes=[*directions(self._report), *openings(self._report)],
        )

    def discard(self) -> None:
        """Does nothing: the library leaves nothing beside the target."""


def _extent(positions: NDArray[np.float64]) -> float:
    """Longest side of the box around the finite points; 0 without any."""
    finite = positions[np.isfinite(positions).all(axis=1)]
    return float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0


def _transferred(parts: Sequence[Points]) -> dict[str, PointAttribute]:
    """Attributes of all parts by name; the first one of a name determines its type."""
    attributes: dict[str, PointAttribute] = {}
    for part in parts:
        for name, attribute in part.attributes.items():
            attributes.setdefault(name, attribute)
    return attributes


def _columns(name: str, width: int) -> list[str]:
    """The library's names for the components of an attribute."""
    return [name] if width == 1 else [f"{name}.{channel}" for channel in _CHANNELS]


def _scan(
    points: Points, transferred: dict[str, PointAttribute], settings: ScanSettings
) -> "prefilter.ScanPoints":
    attributes: dict[str, NDArray[np.uint8 | np.float32]] = {}
    for name, like in transferred.items():
        width = like.values.shape[1]
        own = points.attributes.get(name)
        if own is not None and own.values.shape[1] == width:
            attributes |= dict(zip(_columns(name, width), own.values.T, strict=True))
        elif name == _CONFIDENCE:
            attributes[name] = np.ones(len(points.positions), np.float32)
    has_weights = _CONFIDENCE in transferred and transferred[_CONFIDENCE].data_type == "FLOAT"
    weights = attributes[_CONFIDENCE].astype(np.float32, copy=False) if has_weights else None
    viewpoint = points.viewpoint
    if viewpoint is None and settings.direction == "viewpoint":
        viewpoint = points.scan_origin
    return prefilter.ScanPoints(
        points.positions,
        points.normals,
        weights,
        attributes,
        viewpoint,
        is_from_above=points.is_from_above,
    )


def _layer(name: str, data_type: str, surface: "prefilter.Reconstruction") -> NewLayer:
    columns = _columns(name, 1 if data_type == "FLOAT" else len(_CHANNELS))
    values = np.stack([surface.attributes[column] for column in columns], axis=1)
    return NewLayer(ATTRIBUTE if data_type == "FLOAT" else COLOR, name, data_type, "POINT", values)
