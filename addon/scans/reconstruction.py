# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of selected points in three steps: read from Blender, compute, write to Blender."""

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
from ..bridge.place import Place, still_there
from ..bridge.points import Carried, Points, read_points
from ..core.jobs import Progress, go_on
from ..core.options import check
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from .choices import ScanSettings
from .surface import (
    Look,
    Surface,
    contour,
    directions,
    labeled,
    oddities,
    openings,
    options,
    reconstructed,
    told,
)

_CHANNELS = ("red", "green", "blue", "alpha")
_CONFIDENCE = "confidence"
"""The attribute that says how much each point counts."""

# What a load takes in seconds, as measured once on two cores; ratios are what counts.
_ALWAYS = 0.01
_PER_POINT = {"haar": 0.15e-6, "d4": 0.45e-6}
_PER_TRIANGLE = {"haar": 1.1e-6, "d4": 2.7e-6}
_FITTING = 0.2e-6
_TRIANGLES_OF_CUBE = 5.5
"""How many triangles there are in unit cells where the points are those of a solid, about."""
_TRIANGLES_PER_POINT = 5.5
_TRIANGLES_PER_CARRIED_POINT = 1.6
"""Where the depth is the one that points carry, about: one to four points a face of a cell."""


@dataclass(frozen=True)
class Load:
    """What decides how long points take.

    Attributes:
        points: How many there are.
        extent: The longest side of the box around them.
    """

    points: int
    extent: float

    def seconds(self, settings: ScanSettings) -> float:
        """Returns about how long it takes on two cores; settings that are refused take none."""
        depth: float = settings.depth
        per_point = _TRIANGLES_PER_POINT
        if settings.resolution == "auto":
            depth, per_point = prefilter.MAX_DEPTH, _TRIANGLES_PER_CARRIED_POINT
        elif settings.resolution == "size":
            depth = math.log2(max(self.extent / settings.voxel_size, 2.0))
            if depth > prefilter.MAX_DEPTH:
                return 0.0
        triangles = min(_TRIANGLES_OF_CUBE * 4.0**depth, per_point * self.points)
        per_triangle = _PER_TRIANGLE[settings.wavelet] + (_FITTING if settings.use_fit else 0.0)
        return _ALWAYS + _PER_POINT[settings.wavelet] * self.points + per_triangle * triangles


class Reconstruction:
    """The points of objects as one cloud, and its surface as a new object.

    `read` and `write` belong on the main thread; `compute` touches no Blender data and runs on any
    thread. Nothing is written before everything is computed.
    """

    def __init__(
        self, place: Place, names: list[str], read: list[Points], settings: ScanSettings
    ) -> None:
        """Keeps copies of what was read; use `Reconstruction.read`."""
        self.load = Load(
            sum(len(points.positions) for points in read),
            max((_extent(points.positions) for points in read), default=0.0),
        )
        self.offset: NDArray[np.float64] = np.zeros(3)
        """By how much the points were moved to be near the origin."""
        self._place = place
        self._names = names
        self._read = read
        self.settings = settings
        self._warnings: list[str] = []
        self._notes: list[str] = []
        self._surface: Surface | None = None
        self._contour: new_meshes.Contour | None = None

    @property
    def has_colors(self) -> bool:
        """Whether there are colors to be seen."""
        return self._contour is not None and bool(self._contour.active[COLOR])

    @classmethod
    def read(
        cls,
        objects: Sequence[bpy.types.Object],
        active: bpy.types.Object | None,
        settings: ScanSettings,
        depsgraph: bpy.types.Depsgraph,
    ) -> "Reconstruction":
        """Copies everything that the work needs out of Blender.

        Args:
            objects: What has the points.
            active: The one of them whose space the surface is in; if it is none of them, the first.
            settings: What to do.
            depsgraph: The evaluated dependency graph.

        Raises:
            ValueError: There is no object, or one is unfit.
        """
        check(settings)
        if not objects:
            raise ValueError(Sentence("no object is selected that has points and no faces"))
        if settings.points == "delete":
            for obj in objects:
                new_meshes.check_editable(obj)
        beside = active if active in objects else objects[0]
        place = Place.beside(beside, depsgraph)
        read = read_points(objects, depsgraph, place.origin)
        names = [obj.name for obj in objects]
        if not read:
            text = "object {}: no points" if len(names) == 1 else "objects {}: no points"
            raise ValueError(Sentence(text, listed(names)))
        made = cls(place, names, read, settings)
        made.offset = kept_offset(beside)
        return made

    def scans(self) -> list["prefilter.ScanPoints"]:
        """Returns the points, relative to the place of the surface, along the axes of the world."""
        carried = _carried(self._read)
        return [_scan(one, carried, self.settings) for one in self._read]

    def scans_in_place(self) -> list["prefilter.ScanPoints"]:
        """Returns the points where they were before they were moved near the origin."""
        place = self._place.origin + self.offset
        return [
            dataclasses.replace(
                scan,
                positions=scan.positions + place,
                viewpoint=None if scan.viewpoint is None else scan.viewpoint + place,
            )
            for scan in self.scans()
        ]

    def compute(self, progress: Progress) -> None:
        """Reconstructs the surface.

        Raises:
            ValueError: There is none, or cells are too small.
            MemoryError: The result does not fit into memory.
            prefilter.Cancelled: `progress` has said so.
        """
        without = list(dict.fromkeys(one.name for one in self._read if one.normals is None))
        if without:
            self._notes.append(Sentence("normals were estimated for {}", listed(without)))
        carried = _carried(self._read)
        surface = reconstructed(self.scans(), self.settings, progress)
        self._warnings.extend(oddities(surface.report, self._place.origin.tolist()))
        self._notes.extend(directions(surface.report))
        self._notes.extend(openings(surface.report))
        self._surface = surface
        look = self._look(surface, carried)
        self._contour = contour(surface, self._place, look, self.settings)
        go_on(progress, 1.0)
        self._read.clear()

    def build_steps(self) -> Generator[None, None, None]:
        """Makes the mesh that `write` shows, in steps."""
        assert self._contour is not None
        yield from new_meshes.making_mesh(self._contour)

    def write(self) -> Outcome:
        """Adds the object, and does with the points as was chosen.

        Raises:
            ValueError: An object is gone.
        """
        assert self._surface is not None
        assert self._contour is not None
        beside = still_there(self._place.name)
        objects = [still_there(name) for name in self._names]
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
            Sentence("Reconstructed '{}' from {}", made.name, told(self._surface.report)),
            objects=[made.name],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Removes a mesh that nothing shows."""
        if self._contour is not None:
            new_meshes.forget_mesh(self._contour)

    def _look(self, surface: Surface, carried: dict[str, Carried]) -> Look:
        """Returns what the surface has, with the active object's materials and colors if it can."""
        first = next((one for one in self._read if one.name == self._place.name), self._read[0])
        colored = next((one for one in (first, *self._read) if one.active_color), first)
        return Look(
            [
                *(_layer(name, one.data_type, surface) for name, one in carried.items()),
                *surface.support_layers(carried),
            ],
            colored.active_color,
            colored.render_color,
            first.materials,
        )


class ObjectsStreaming:
    """The points of objects that were moved near the origin, to a .ply file where they were."""

    def __init__(self, read: Reconstruction, target: Path) -> None:
        """Takes what was read, and what to write."""
        self._read = read
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
                self._read.scans_in_place(),
                self._target,
                progress=progress,
                **options(self._read.settings),
            )

    def write(self) -> Outcome:
        """Returns what was done."""
        assert self._report is not None
        return Outcome(
            Sentence("Reconstructed '{}' from {}", self._target.name, told(self._report)),
            files=[str(self._target)],
            warnings=oddities(self._report),
            notes=[*directions(self._report), *openings(self._report)],
        )

    def discard(self) -> None:
        """Does nothing: the library leaves nothing beside the target."""


def _extent(positions: NDArray[np.float64]) -> float:
    """Returns the longest side of the box around the points that are finite; 0 without any."""
    finite = positions[np.isfinite(positions).all(axis=1)]
    return float(np.ptp(finite, axis=0).max()) if len(finite) else 0.0


def _carried(parts: Sequence[Points]) -> dict[str, Carried]:
    """Returns for each attribute the first one of its name, whose kind the others must be of."""
    found: dict[str, Carried] = {}
    for part in parts:
        for name, one in part.attributes.items():
            found.setdefault(name, one)
    return found


def _columns(name: str, width: int) -> list[str]:
    """Returns what the library calls the numbers of an attribute."""
    return [name] if width == 1 else [f"{name}.{channel}" for channel in _CHANNELS]


def _scan(
    points: Points, carried: dict[str, Carried], settings: ScanSettings
) -> "prefilter.ScanPoints":
    attributes: dict[str, NDArray[np.uint8 | np.float32]] = {}
    for name, like in carried.items():
        width = like.values.shape[1]
        one = points.attributes.get(name)
        if one is not None and one.values.shape[1] == width:
            attributes |= dict(zip(_columns(name, width), one.values.T, strict=True))
        elif name == _CONFIDENCE:
            attributes[name] = np.ones(len(points.positions), np.float32)
    weighs = _CONFIDENCE in carried and carried[_CONFIDENCE].data_type == "FLOAT"
    weights = attributes[_CONFIDENCE].astype(np.float32, copy=False) if weighs else None
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


def _layer(name: str, data_type: str, surface: Surface) -> NewLayer:
    columns = _columns(name, 1 if data_type == "FLOAT" else len(_CHANNELS))
    values = np.stack([surface.attributes[column] for column in columns], axis=1)
    return NewLayer(ATTRIBUTE if data_type == "FLOAT" else COLOR, name, data_type, "POINT", values)
