# SPDX-License-Identifier: GPL-3.0-or-later

"""Some points of an object that shows points: where they are, and the object with fewer of them."""

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.wording import Sentence
from . import attributes
from .points import may_be_points

_POSITION = "position"


def may_lose_points(obj: bpy.types.Object) -> bool:
    """Returns whether an object has points of its own, and not only by its modifiers."""
    return may_be_points(obj) and _POSITION in obj.data.attributes


def check_editable(obj: bpy.types.Object) -> None:
    """Raises ValueError where points cannot be taken from an object."""
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
    """Gives an object new data with some of its points, and all their attributes.

    Other objects with the same data keep all.
    """
    old = obj.data
    if isinstance(old, bpy.types.Mesh):
        made = _fewer_vertices(old, kept)
    else:
        made = old.copy()
        values = {one.name: attributes.values_of(one)[kept] for one in _read(made)}
        made.resize(int(kept.sum()))
        _write(made, values)
    name = old.name
    obj.data = made
    if old.users == 0:
        bpy.data.batch_remove([old])
        made.name = name
    made.update_tag()


def _fewer_vertices(old: bpy.types.Mesh, kept: NDArray[np.bool_]) -> bpy.types.Mesh:
    made = bpy.data.meshes.new(old.name)
    made.vertices.add(int(kept.sum()))
    for material in old.materials:
        made.materials.append(material)
    for key, value in old.items():
        made[key] = value
    read = _read(old)
    for one in read:
        if one.name not in made.attributes:
            made.attributes.new(one.name, one.data_type, "POINT")
    _write(made, {one.name: attributes.values_of(one)[kept] for one in read})
    colors = old.color_attributes
    if colors.active_color_name:
        made.color_attributes.active_color_name = colors.active_color_name
    if colors.render_color_index >= 0:
        rendered = colors[colors.render_color_index].name
        made.color_attributes.render_color_index = made.color_attributes.find(rendered)
    return made


def _read(data: bpy.types.ID) -> Sequence[bpy.types.Attribute]:
    return [
        one
        for one in data.attributes
        if one.domain == "POINT" and attributes.is_read(one) and not one.name.startswith(".")
    ]


def _write(data: bpy.types.ID, values: dict[str, NDArray[np.generic]]) -> None:
    for name, some in values.items():
        attributes.set_values(data.attributes[name], some)
