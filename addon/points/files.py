# SPDX-License-Identifier: GPL-3.0-or-later

"""Reconstruction from files of points to a file, without objects of the points."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray
from prefilter.workflows.points import outcome

from ..bridge.color_materials import show_attribute
from ..bridge.files import scenes
from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_meshes import Contour, new_mesh
from ..bridge.new_points import OFFSET, far_offset, layer_name, shown_offset
from ..bridge.target_frame import TargetFrame
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.outcome import Outcome
from ..core.wording import Sentence
from .choices import ScanSettings
from .surface import Look, contour, reconstruct, support_layers

_WITH_TRANSFORMS = frozenset({".glb", ".gltf", ".fbx"})
"""Formats that store the object's position separately, so that a rounded offset is exact."""

_COLOR = "Col"
"""Name of the color attribute in Blender's imports."""
_CHANNELS = ("red", "green", "blue")
_ALPHA = "alpha"


class FilesReconstruction:
    """Reconstructs the surface of files, as an object of an empty scene, and exports it."""

    def __init__(
        self,
        sources: Sequence[Path],
        target: Path,
        settings: ScanSettings,
        viewpoint: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Keeps sources, target and settings; for `viewpoint` see `prefilter.reconstruct`."""
        self._viewpoint = viewpoint
        self._sources = sources
        self._target = target
        self._settings = settings
        self._origin: NDArray[np.float64] = np.zeros(3)
        self._surface: prefilter.Reconstruction | None = None
        self._contour: Contour | None = None

    def compute(self, progress: Progress) -> None:
        """Reads the points and reconstructs their surface.

        Raises:
            ValueError: A source is damaged, or there is no surface.
            OSError: A source cannot be read.
            MemoryError: The points or the surface do not fit into memory.
        """
        surface = reconstruct(self._sources, self._settings, progress, self._viewpoint)
        self._origin = far_offset(surface.positions)
        surface.positions[:] -= self._origin
        frame = TargetFrame(self._sources[0].stem, self._origin, np.eye(3))
        self._contour = contour(surface, frame, _look(surface), self._settings)
        self._surface = surface

    def write(self) -> Outcome:
        """Makes an object and writes it to the target.

        Raises:
            OSError: The file cannot be written.
        """
        assert self._surface is not None
        assert self._contour is not None
        bpy.ops.wm.read_homefile(use_empty=True)
        name = self._sources[0].stem
        mesh = new_mesh(name, self._contour)
        show_attribute(mesh, self._contour.active[COLOR])
        obj = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(obj)
        bpy.context.view_layer.update()
        warnings = move_back(obj, self._origin, self._target)
        scenes.save(self._target, [obj.name])
        summary = outcome(self._sources, self._target, self._surface.report, length, [obj.name])
        return replace(summary, warnings=[*summary.warnings, *warnings])

    def discard(self) -> None:
        """Does nothing: nothing is staged."""


def offset_warning(offset: NDArray[np.float64]) -> str:
    """Warns that points were moved near the origin."""
    text = (
        "far from the origin: moved by the negative of ({}), which is kept as the custom "
        "property 'scan_offset'"
    )
    return Sentence(text, shown_offset(offset))


def move_back(obj: bpy.types.Object, offset: NDArray[np.float64], target: Path) -> list[str]:
    """Moves an object back from the origin if the target's format is precise enough.

    Returns:
        Warnings.
    """
    if not offset.any():
        return []
    ending = target.suffix.lower()
    if ending in _WITH_TRANSFORMS:
        obj.matrix_world = Matrix.Translation(offset) @ obj.matrix_world
        bpy.context.view_layer.update()  # Exporters use evaluated objects.
        return []
    obj[OFFSET] = offset.tolist()
    if ending == ".blend":
        return [offset_warning(offset)]
    text = (
        "'{}': far from the origin, where its format has too few digits; ({}) is to be added to "
        "its coordinates. A .ply file has enough"
    )
    return [Sentence(text, target.name, shown_offset(offset))]


def _look(surface: prefilter.Reconstruction) -> Look:
    """Attributes of the vertices, with the names of Blender's imports."""
    layers = attribute_layers(surface.attributes, len(surface.positions))
    layers += support_layers(surface, [layer.name for layer in layers])
    shown = next((layer.name for layer in layers if layer.kind == COLOR), "")
    return Look(layers, shown, shown)


def attribute_layers(
    attributes: Mapping[str, NDArray[np.uint8 | np.float32]], count: int
) -> list[NewLayer]:
    """Converts attributes of points or vertices to layers, with the names of Blender's imports."""
    values = dict(attributes)
    layers = []
    if all(channel in values for channel in _CHANNELS):
        channels = [values.pop(channel) for channel in _CHANNELS]
        is_byte = all(channel.dtype == np.uint8 for channel in channels)
        alpha = values.pop(_ALPHA, None)
        scale = np.float32(255.0 if is_byte else 1.0)
        rgb = np.stack(channels, axis=1) / scale
        linear = prefilter.to_linear(rgb[None])[0] if is_byte else rgb
        opaque = np.ones(count, np.float32)
        rgba = np.column_stack([linear, opaque if alpha is None else alpha / scale])
        kind = "BYTE_COLOR" if is_byte else "FLOAT_COLOR"
        layers.append(NewLayer(COLOR, _COLOR, kind, "POINT", rgba.astype(np.float32)))
    layers += [
        NewLayer(ATTRIBUTE, layer_name(name), "FLOAT", "POINT", numbers[:, None].astype(np.float32))
        for name, numbers in values.items()
    ]
    return layers
