# SPDX-License-Identifier: GPL-3.0-or-later

"""Removal of points from objects, and their world positions."""

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.wording import Sentence
from . import attributes
from .points import may_be_points

_POSITION = "position"


def may_lose_points(obj: bpy.types.Object) -> bool:
    """Whether an object has points of its own, not only from modifiers."""
    return may_be_points(obj) and _POSITION in obj.data.attributes


def check_editable(obj: bpy.types.Object) -> None:
    """Raises ValueError if points cannot be removed from an object."""
    if obj.data.library is not None or obj.library is not None:
        raise ValueError(Sentence("object '{}' is linked from another file", obj.name))
    if isinstance(obj.data, bpy.types.PointCloud) and not hasattr(obj.data, "resize"):
        raise ValueError(
            Sentence("object '{}': point clouds can be changed from Blender 5.0 on", obj.name)
        )


def world_positions(obj: bpy.types.Object) -> NDArray[np.float64]:
    """Returns the points, (n, 3), in world space."""
    local = attributes.values_of(obj.data.attributes[_POSITION]).astype(np.float64)
    matrix = np.array(obj.matrix_world, np.float64)
    with np.errstate(invalid="ignore"):  # Points that are not finite stay so.
        return np.asarray(local @ matrix[:3, :3].T + matrix[:3, 3])


def keep_points(obj: bpy.types.Object, kept: NDArray[np.bool_]) -> None:
    """Gives an object new data with only the kept points, and all their attributes.

    Other objects with the same data keep all points.
    """
    old = obj.data
    if isinstance(old, bpy.types.Mesh):
        new = _fewer_vertices(old, kept)
    else:
        new = old.copy()
        values = {each.name: attributes.values_of(each)[kept] for each in _transferable(new)}
        new.resize(int(kept.sum()))
        _write(new, values)
    name = old.name
    obj.data = new
    if old.users == 0:
        bpy.data.batch_remove([old])
        new.name = name
    new.update_tag()


def _fewer_vertices(old: bpy.types.Mesh, kept: NDArray[np.bool_]) -> bpy.types.Mesh:
    new = bpy.data.meshes.new(old.name)
    new.vertices.add(int(kept.sum()))
    for material in old.materials:
        new.materials.append(material)
    for key, value in old.items():
        new[key] = value
    transferred = _transferable(old)
    for attribute in transferred:
        if attribute.name not in new.attributes:
            new.attributes.new(attribute.name, attribute.data_type, "POINT")
    _write(new, {each.name: attributes.values_of(each)[kept] for each in transferred})
    colors = old.color_attributes
    if colors.active_color_name:
        new.color_attributes.active_color_name = colors.active_color_name
    if colors.render_color_index >= 0:
        rendered = colors[colors.render_color_index].name
        new.color_attributes.render_color_index = new.color_attributes.find(rendered)
    return new


def _transferable(data: bpy.types.ID) -> Sequence[bpy.types.Attribute]:
    return [
        each
        for each in data.attributes
        if each.domain == "POINT" and attributes.is_read(each) and not each.name.startswith(".")
    ]


def _write(data: bpy.types.ID, columns: dict[str, NDArray[np.generic]]) -> None:
    for name, values in columns.items():
        attributes.set_values(data.attributes[name], values)
