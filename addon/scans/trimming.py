# SPDX-License-Identifier: GPL-3.0-or-later

"""A reconstructed surface, cut where its attributes say that points are far."""

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
    """Returns whether an object has a mesh that knows how far points are."""
    return (
        obj is not None
        and obj.type == "MESH"
        and len(obj.data.polygons) > 0
        and all(_is_known(obj.data, name) for name in _SUPPORT)
    )


def trim(obj: bpy.types.Object, settings: TrimSettings) -> float:
    """Gives an object the part of its mesh that is near points; returns the share that was cut.

    Attributes of vertices stay that are numbers or colors.

    Raises:
        ValueError: The mesh cannot be cut, or nothing would be left.
    """
    check(settings)
    new_meshes.check_editable(obj)
    mesh: bpy.types.Mesh = obj.data
    if not attributes.is_triangulated(mesh):
        raise ValueError(Sentence("object '{}' has faces that are not triangles", obj.name))
    kept = [one for one in mesh.attributes if _is_carried(one)]
    columns = [attributes.values_of(one) for one in kept]
    # Densities are those of the world.
    matrix = np.array(obj.matrix_world)
    placed = attributes.positions(mesh) @ matrix[:3, :3].T
    faces = attributes.corner_vertices(mesh).reshape(-1, 3)
    distance, density = (attributes.values_of(mesh.attributes[name])[:, 0] for name in _SUPPORT)
    made = prefilter.trim(
        placed,
        faces,
        distance,
        density,
        attributes=np.concatenate(columns, axis=1) if columns else None,
        limit=settings.limit,
        hole=settings.hole,
        island=settings.island,
    )
    if not len(made.triangles):
        raise ValueError(Sentence("nothing of object '{}' would be left", obj.name))
    if not made.cut and len(made.triangles) == len(faces):
        return 0.0
    layers = _layers(kept, columns, made)
    local = made.positions @ np.linalg.inv(matrix[:3, :3]).T
    new_meshes.replace_data(
        obj, new_meshes.new_mesh(mesh.name, _contour(mesh, local, made, layers))
    )
    return made.cut


def _contour(
    mesh: bpy.types.Mesh,
    positions: NDArray[np.float64],
    made: "prefilter.TrimmedSurface",
    layers: list[NewLayer],
) -> new_meshes.Contour:
    local = positions.astype(np.float32)
    colors = mesh.color_attributes
    render = colors[colors.render_color_index].name if len(colors) else ""
    is_smooth = len(mesh.polygons) > 0 and mesh.polygons[0].use_smooth
    return new_meshes.Contour(
        local,
        made.triangles,
        [MaterialKey.of(one) if one is not None else None for one in mesh.materials],
        layers=layers,
        active={COLOR: colors.active_color.name if colors.active_color is not None else ""},
        rendered={COLOR: render},
        sharp_angle=np.pi if is_smooth else None,
        edges=prefilter.mesh_edges(local, made.triangles),
    )


def _layers(
    kept: list[bpy.types.Attribute],
    columns: list[NDArray[np.float32]],
    made: "prefilter.TrimmedSurface",
) -> list[NewLayer]:
    layers = []
    first = 0
    for one, values in zip(kept, columns, strict=True):
        assert made.attributes is not None
        width = values.shape[1]
        found = made.attributes[:, first : first + width]
        kind = COLOR if one.data_type in _COLORS else ATTRIBUTE
        layers.append(NewLayer(kind, one.name, one.data_type, "POINT", found))
        first += width
    for name, values in zip(_SUPPORT, (made.distance, made.density), strict=True):
        layers.append(NewLayer(ATTRIBUTE, name, "FLOAT", "POINT", values[:, None]))
    return layers


def _is_known(mesh: bpy.types.Mesh, name: str) -> bool:
    one = mesh.attributes.get(name)
    return one is not None and one.domain == "POINT" and one.data_type == "FLOAT"


def _is_carried(one: bpy.types.Attribute) -> bool:
    is_number = one.data_type in {"FLOAT", *_COLORS}
    return (
        one.domain == "POINT" and is_number and attributes.is_free(one) and one.name not in _SUPPORT
    )
