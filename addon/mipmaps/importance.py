# SPDX-License-Identifier: GPL-3.0-or-later

"""What the setting Importance may name: for the menu of the field."""

import bpy


def suggested_names(self: object, context: bpy.types.Context, typed: str) -> list[str]:
    """Returns the vertex groups and attributes of all meshes; Blender picks those that fit."""
    from ..bridge.attributes import names_of_weights

    del self, typed
    depsgraph = context.view_layer.depsgraph
    found: dict[str, None] = {}
    for obj in context.view_layer.objects:
        if obj.type != "MESH":
            continue
        # Geometry nodes may add some.
        for one in (obj,) if depsgraph is None else (obj, obj.evaluated_get(depsgraph)):
            found.update(dict.fromkeys(names_of_weights(one)))
    return list(found)
