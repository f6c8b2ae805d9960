# SPDX-License-Identifier: GPL-3.0-or-later

"""Suggestions for the setting Importance."""

import bpy


def suggested_names(self: object, context: bpy.types.Context, typed: str) -> list[str]:
    """Returns the vertex groups and attributes of all meshes; Blender filters them by `typed`."""
    from ..bridge.attributes import names_of_weights

    del self, typed
    depsgraph = context.view_layer.depsgraph
    names: dict[str, None] = {}
    for obj in context.view_layer.objects:
        if obj.type != "MESH":
            continue
        # Geometry nodes may add attributes.
        for source in (obj,) if depsgraph is None else (obj, obj.evaluated_get(depsgraph)):
            names.update(dict.fromkeys(names_of_weights(source)))
    return list(names)
