# SPDX-License-Identifier: GPL-3.0-or-later

"""Materials and 3D views that show a color attribute."""

import bpy

_MARK = "prefilter_color_attribute"
"""The property of a material that names the attribute it was made for."""


def show_attribute(data: bpy.types.Mesh | bpy.types.PointCloud, attribute: str) -> None:
    """Gives a mesh or a point cloud without materials one that shows a color attribute."""
    if attribute and not any(data.materials):
        data.materials.clear()
        data.materials.append(material_of(attribute))


def material_of(attribute: str) -> bpy.types.Material:
    """Returns the material that shows a color attribute, which objects share; made if missing."""
    for material in bpy.data.materials:
        if material.library is None and material.get(_MARK) == attribute:
            return material
    made = bpy.data.materials.new(f"Color of {attribute}")
    made[_MARK] = attribute
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    # Scanned colors already include the lighting.
    surface.inputs["Roughness"].default_value = 1.0
    surface.inputs["Specular IOR Level"].default_value = 0.0
    color = tree.nodes.new("ShaderNodeAttribute")
    color.attribute_name = attribute
    color.location = (surface.location.x - 220, surface.location.y)
    tree.links.new(color.outputs["Color"], surface.inputs["Base Color"])
    return made


def show_in_views(
    context: bpy.types.Context, *, are_points: bool = False, kind: str = "VERTEX"
) -> bool:
    """Makes 3D views in Solid mode show attributes or textures, if they show material colors.

    Args:
        context: The context, whose window has the views.
        are_points: Whether points are to be shown, for which Solid mode has no colors: switches to
            Material Preview.
        kind: Color of Solid mode: "VERTEX" for color attributes, or "TEXTURE".

    Returns:
        Whether a view has changed.
    """
    if bpy.app.background or context.window is None:
        return False
    changed = False
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D":
            continue
        shading = area.spaces.active.shading
        if shading.type == "SOLID" and are_points:
            shading.type = "MATERIAL"
        elif shading.type == "SOLID" and shading.color_type == "MATERIAL":
            shading.color_type = kind
        else:
            continue
        changed = True
    return changed
