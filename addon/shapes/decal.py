# SPDX-License-Identifier: GPL-3.0-or-later

"""Decals: an image of shapes on a plane in their place, or over the base color of a material."""

from collections.abc import Sequence

import bpy
from mathutils import Matrix, Quaternion

from ..bridge import image_materials, units
from ..bridge.new_meshes import new_object_beside
from ..bridge.uv_layouts import has_uv_map
from ..core.outcome import Outcome
from ..core.translations import tr
from ..core.wording import Sentence, listed
from .choices import DecalSettings
from .provenance import sources_of

_MARK = "prefilter_decal_of"
"""The custom property of a plane's mesh with the name of its image."""
_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


def use_as_decal(
    image: bpy.types.Image, settings: DecalSettings, context: bpy.types.Context
) -> Outcome:
    """Puts a rasterized image on a plane or into a material.

    Raises:
        ValueError: There is no object, or no UV map, for it.
    """
    if settings.target == "material":
        return _into_material(image, context.active_object)
    return _onto_plane(image, settings, context)


def refit(image: bpy.types.Image) -> None:
    """Resizes the planes of an image, about their origin, to its present box."""
    if not image.prefilter_drawn.has_place:
        return
    for mesh in bpy.data.meshes:
        is_plane = len(mesh.vertices) == len(_CORNERS) and len(mesh.polygons) == 1
        if mesh.get(_MARK) == image.name_full and mesh.library is None and is_plane:
            _set_corners(mesh, image)


def _onto_plane(
    image: bpy.types.Image, settings: DecalSettings, context: bpy.types.Context
) -> Outcome:
    drawn = image.prefilter_drawn
    if drawn.source == "uv":
        raise ValueError(
            Sentence(
                "image '{}' shows a UV map, which is in no place; put it on a material", image.name
            )
        )
    if not drawn.has_place:
        raise ValueError(
            Sentence("image '{}': where it is is not known; press Update first", image.name)
        )
    sources = sources_of(image)
    plane = _new_plane(image, sources, context)
    matrix = _plane_matrix(sources[0], drawn.rotation) if sources else context.scene.cursor.matrix
    plane.matrix_world = matrix @ Matrix.Translation((0.0, 0.0, settings.offset))
    hidden = [obj for obj in sources if settings.use_hide and obj.visible_get()]
    for obj in hidden:
        obj.hide_set(True)
        obj.hide_render = True
    left, low, right, high = drawn.box
    size = f"{units.length(right - left)} x {units.length(high - low)}"
    summary = Sentence("Made '{}', a plane of {} with image '{}'", plane.name, size, image.name)
    if hidden:
        summary = Sentence("{}; hid {}", summary, listed(obj.name for obj in hidden))
    return Outcome(summary, objects=[plane.name], warnings=_warnings(image))


def _into_material(image: bpy.types.Image, obj: bpy.types.Object | None) -> Outcome:
    if not has_uv_map(obj):
        raise ValueError(tr("Make a mesh with a UV map the active object"))
    material = image_materials.put_over(obj, image, is_mask=_is_mask(image))
    summary = Sentence(
        "Put image '{}' over the base color of material '{}'", image.name, material.name
    )
    return Outcome(summary, warnings=_warnings(image))


def _new_plane(
    image: bpy.types.Image, sources: Sequence[bpy.types.Object], context: bpy.types.Context
) -> bpy.types.Object:
    """Creates and selects the plane."""
    mesh = bpy.data.meshes.new(f"{image.name}.decal")
    mesh.from_pydata([(0.0, 0.0, 0.0)] * len(_CORNERS), [], [range(len(_CORNERS))])
    mesh.uv_layers.new(name="UVMap").uv.foreach_set(
        "vector", [x for corner in _CORNERS for x in corner]
    )
    mesh[_MARK] = image.name_full
    _set_corners(mesh, image)
    mesh.materials.append(
        image_materials.material_of(image, is_mask=_is_mask(image), is_opaque=_is_opaque(image))
    )
    if sources:
        plane = new_object_beside(sources[0], mesh, ".decal")
    else:
        plane = bpy.data.objects.new(mesh.name, mesh)
        context.collection.objects.link(plane)
    for obj in context.selected_objects:
        obj.select_set(False)
    plane.select_set(True)
    context.view_layer.objects.active = plane
    return plane


def _set_corners(mesh: bpy.types.Mesh, image: bpy.types.Image) -> None:
    left, low, right, high = image.prefilter_drawn.box
    for vertex, (x, y) in zip(mesh.vertices, _CORNERS, strict=True):
        vertex.co = (right if x else left, high if y else low, 0.0)
    mesh.update()


def _plane_matrix(obj: bpy.types.Object, rotation: Sequence[float]) -> Matrix:
    """Returns the world matrix of the image plane through an object's origin."""
    location, own_rotation, _ = obj.matrix_world.decompose()
    return Matrix.LocRotScale(location, own_rotation @ Quaternion(rotation), None)


def _is_mask(image: bpy.types.Image) -> bool:
    return image.prefilter_drawn.color == "mask"


def _is_opaque(image: bpy.types.Image) -> bool:
    drawn = image.prefilter_drawn
    return not _is_mask(image) and drawn.background == "color" and drawn.background_color[3] == 1.0


def _warnings(image: bpy.types.Image) -> list[str]:
    drawn = image.prefilter_drawn
    if drawn.pixel_type != "byte" or drawn.alpha != "premultiplied" or _is_opaque(image):
        return []
    return [
        f"image '{image.name}' has colors that are multiplied by alpha, which makes its edges "
        "dark: set its Alpha to Automatic under Rasterized Image, and press Update"
    ]
