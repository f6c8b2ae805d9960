# SPDX-License-Identifier: GPL-3.0-or-later

"""Trimming of reconstructed surfaces, by their attributes 'distance' and 'density'."""

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ..bridge import attributes, new_meshes
from ..bridge.layers import ATTRIBUTE, COLOR, NewLayer
from ..bridge.solids import MaterialKey
from ..core.options import check
from ..core.wording import Sentence
from .choices import TrimSettings

_SUPPORT = ("distance", "density")
_COLORS = frozenset({"BYTE_COLOR", "FLOAT_COLOR"})


def may_be_trimmed(obj: bpy.types.Object | None) -> bool:
    """Whether an object has a mesh with the attributes for trimming."""
    return (
        obj is not None
        and obj.type == "MESH"
        and len(obj.data.polygons) > 0
        and all(_has_attribute(obj.data, name) for name in _SUPPORT)
    )


def trim(obj: bpy.types.Object, settings: TrimSettings) -> float:
    """Trims the mesh of an object where points are far away; returns the share that was cut.

    Vertex attributes of numbers and colors are preserved.

    Raises:
        ValueError: The mesh cannot be cut, or nothing would be left.
    """
    check(settings)
    new_meshes.check_editable(obj)
    mesh: bpy.types.Mesh = obj.data
    if not attributes.is_triangulated(mesh):
        raise ValueError(Sentence("object '{}' has faces that are not triangles", obj.name))
    preserved = [attribute for attribute in mesh.attributes if _is_preserved(attribute)]
    columns = [attributes.values_of(attribute) for attribute in preserved]
    # Densities are in world space.
    matrix = np.array(obj.matrix_world)
    positions = attributes.positions(mesh) @ matrix[:3, :3].T
    faces = attributes.corner_vertices(mesh).reshape(-1, 3)
    distance, density = (attributes.values_of(mesh.attributes[name])[:, 0] for name in _SUPPORT)
    trimmed = prefilter.trim(
        positions,
        faces,
        distance,
        density,
        attributes=np.concatenate(columns, axis=1) if columns else None,
        limit=settings.limit,
        hole=settings.hole,
        island=settings.island,
    )
    if not len(trimmed.triangles):
        raise ValueError(Sentence("nothing of object '{}' would be left", obj.name))
    if not trimmed.cut and len(trimmed.triangles) == len(faces):
        return 0.0
    layers = _layers(preserved, columns, trimmed)
    local = trimmed.positions @ np.linalg.inv(matrix[:3, :3]).T
    contour = _contour(mesh, local, trimmed, layers)
    new_meshes.replace_data(obj, new_meshes.new_mesh(mesh.name, contour))
    return trimmed.cut


def _contour(
    mesh: bpy.types.Mesh,
    positions: NDArray[np.float64],
    trimmed: "prefilter.TrimmedSurface",
    layers: list[NewLayer],
) -> new_meshes.Contour:
    local = positions.astype(np.float32)
    colors = mesh.color_attributes
    render = colors[colors.render_color_index].name if len(colors) else ""
    is_smooth = len(mesh.polygons) > 0 and mesh.polygons[0].use_smooth
    return new_meshes.Contour(
        local,
        trimmed.triangles,
        [MaterialKey.of(material) for material in mesh.materials],
        layers=layers,
        active={COLOR: colors.active_color.name if colors.active_color is not None else ""},
        rendered={COLOR: render},
        sharp_angle=np.pi if is_smooth else None,
        edges=prefilter.mesh_edges(local, trimmed.triangles),
    )


def _layers(
    preserved: list[bpy.types.Attribute],
    columns: list[NDArray[np.float32]],
    trimmed: "prefilter.TrimmedSurface",
) -> list[NewLayer]:
    layers = []
    first = 0
    for attribute, old in zip(preserved, columns, strict=True):
        assert trimmed.attributes is not None
        width = old.shape[1]
        values = trimmed.attributes[:, first : first + width]
        kind = COLOR if attribute.data_type in _COLORS else ATTRIBUTE
        layers.append(NewLayer(kind, attribute.name, attribute.data_type, "POINT", values))
        first += width
    for name, values in zip(_SUPPORT, (trimmed.distance, trimmed.density), strict=True):
        layers.append(NewLayer(ATTRIBUTE, name, "FLOAT", "POINT", values[:, None]))
    return layers


def _has_attribute(mesh: bpy.types.Mesh, name: str) -> bool:
    attribute = mesh.attributes.get(name)
    return attribute is not None and attribute.domain == "POINT" and attribute.data_type == "FLOAT"


def _is_preserved(attribute: bpy.types.Attribute) -> bool:
    return (
        attribute.domain == "POINT"
        and attribute.data_type in {"FLOAT", *_COLORS}
        and attributes.is_free(attribute)
        and attribute.name not in _SUPPORT
    )
