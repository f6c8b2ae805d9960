# SPDX-License-Identifier: GPL-3.0-or-later

"""The surface of points in files, without objects of them: to a file of it, or of a scene."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from mathutils import Matrix
from numpy.typing import NDArray
from prefilter.workflows.scans import outcome

from ..bridge.color_materials import show_attribute
from ..bridge.files import scenes
from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.new_meshes import Contour, new_mesh
from ..bridge.new_points import OFFSET, far_offset, layer_name, shown_offset
from ..bridge.place import Place
from ..bridge.units import length
from ..core.jobs import Progress
from ..core.outcome import Outcome
from ..core.wording import Sentence
from .choices import ScanSettings
from .surface import Look, Surface, contour, reconstructed

SOURCES = prefilter.POINT_EXTENSIONS
_WITH_PLACES = frozenset({".glb", ".gltf", ".fbx"})
"""Files that keep the place of an object by itself: round numbers are exact there."""

_COLOR = "Col"
"""What Blender's imports call the colors of points."""
_CHANNELS = ("red", "green", "blue")
_ALPHA = "alpha"


class FilesReconstruction:
    """Files of points as one cloud, and its surface as an object in an empty scene, then a file."""

    def __init__(
        self,
        sources: Sequence[Path],
        target: Path,
        settings: ScanSettings,
        viewpoint: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Takes what to read, what to write, and how.

        `viewpoint`: see `prefilter.reconstruct`.
        """
        self._viewpoint = viewpoint
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
        surface = reconstructed(self._sources, self._settings, progress, self._viewpoint)
        self._origin = far_offset(surface.positions)
        surface.positions[:] -= self._origin
        place = Place(self._sources[0].stem, self._origin, np.eye(3))
        self._contour = contour(surface, place, _look(surface), self._settings)
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
        made = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(made)
        bpy.context.view_layer.update()
        warnings = place_back(made, self._origin, self._target)
        scenes.save(self._target, [made.name])
        found = outcome(self._sources, self._target, self._surface.report, length, [made.name])
        return replace(found, warnings=[*found.warnings, *warnings])

    def discard(self) -> None:
        """Does nothing: nothing is staged."""


def moved(offset: NDArray[np.float64]) -> str:
    """Returns that points were moved to be near the origin, as a warning."""
    text = (
        "far from the origin: moved by the negative of ({}), which is kept as the custom "
        "property 'scan_offset'"
    )
    return Sentence(text, shown_offset(offset))


def place_back(made: bpy.types.Object, offset: NDArray[np.float64], target: Path) -> list[str]:
    """Puts an object that was moved near the origin where it was, as far as a file can hold that.

    Returns:
        Warnings.
    """
    if not offset.any():
        return []
    ending = target.suffix.lower()
    if ending in _WITH_PLACES:
        made.matrix_world = Matrix.Translation(offset) @ made.matrix_world
        bpy.context.view_layer.update()  # exporters read what was evaluated
        return []
    made[OFFSET] = offset.tolist()
    if ending == ".blend":
        return [moved(offset)]
    text = (
        "'{}': far from the origin, where its format has too few digits; ({}) is to be added to "
        "its coordinates. A .ply file has enough"
    )
    return [Sentence(text, target.name, shown_offset(offset))]


def _look(surface: Surface) -> Look:
    """Returns what the vertices carry, as Blender's imports of files name it."""
    layers = attribute_layers(surface.attributes, len(surface.positions))
    layers += surface.support_layers([layer.name for layer in layers])
    shown = next((layer.name for layer in layers if layer.kind == COLOR), "")
    return Look(layers, shown, shown)


def attribute_layers(
    attributes: Mapping[str, NDArray[np.uint8 | np.float32]], count: int
) -> list[NewLayer]:
    """Returns what points or vertices carry, as Blender's imports of files name it."""
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
