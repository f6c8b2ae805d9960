# SPDX-License-Identifier: GPL-3.0-or-later

"""An image of shapes on a plane in their place, or over the base color of a material."""

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
from .memory import sources_of

_MARK = "prefilter_decal_of"
"""The property of a plane's mesh that names its image."""
_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


def use_as_decal(
    image: bpy.types.Image, settings: DecalSettings, context: bpy.types.Context
) -> Outcome:
    """Puts an image that Rasterize has made where it is to be seen.

    Raises:
        ValueError: There is no such place.
    """
    if settings.target == "material":
        return _into_material(image, context.active_object)
    return _onto_plane(image, settings, context)


def refit(image: bpy.types.Image) -> None:
    """Gives the planes of an image the size and the place, around their origin, that it has now."""
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
    made = _new_plane(image, sources, context)
    placed = _stand(sources[0], drawn.rotation) if sources else context.scene.cursor.matrix
    made.matrix_world = placed @ Matrix.Translation((0.0, 0.0, settings.offset))
    hidden = [obj for obj in sources if settings.use_hide and obj.visible_get()]
    for obj in hidden:
        obj.hide_set(True)
        obj.hide_render = True
    left, low, right, high = drawn.box
    size = f"{units.length(right - left)} x {units.length(high - low)}"
    done = Sentence("Made '{}', a plane of {} with image '{}'", made.name, size, image.name)
    if hidden:
        done = Sentence("{}; hid {}", done, listed(obj.name for obj in hidden))
    return Outcome(done, objects=[made.name], warnings=_warnings(image))


def _into_material(image: bpy.types.Image, obj: bpy.types.Object | None) -> Outcome:
    if not has_uv_map(obj):
        raise ValueError(tr("Make a mesh with a UV map the active object"))
    material = image_materials.put_over(obj, image, is_mask=_is_mask(image))
    done = Sentence(
        "Put image '{}' over the base color of material '{}'", image.name, material.name
    )
    return Outcome(done, warnings=_warnings(image))


def _new_plane(
    image: bpy.types.Image, sources: Sequence[bpy.types.Object], context: bpy.types.Context
) -> bpy.types.Object:
    """Makes the plane, and selects it."""
    mesh = bpy.data.meshes.new(f"{image.name}.decal")
    mesh.from_pydata([(0.0, 0.0, 0.0)] * len(_CORNERS), [], [range(len(_CORNERS))])
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", [x for one in _CORNERS for x in one])
    mesh[_MARK] = image.name_full
    _set_corners(mesh, image)
    mesh.materials.append(
        image_materials.material_of(image, is_mask=_is_mask(image), is_opaque=_is_opaque(image))
    )
    if sources:
        made = new_object_beside(sources[0], mesh, ".decal")
    else:
        made = bpy.data.objects.new(mesh.name, mesh)
        context.collection.objects.link(made)
    for obj in context.selected_objects:
        obj.select_set(False)
    made.select_set(True)
    context.view_layer.objects.active = made
    return made


def _set_corners(mesh: bpy.types.Mesh, image: bpy.types.Image) -> None:
    left, low, right, high = image.prefilter_drawn.box
    for vertex, (x, y) in zip(mesh.vertices, _CORNERS, strict=True):
        vertex.co = (right if x else left, high if y else low, 0.0)
    mesh.update()


def _stand(obj: bpy.types.Object, rotation: Sequence[float]) -> Matrix:
    """Returns where the plane of an image is, on which an object stands."""
    location, turned, _ = obj.matrix_world.decompose()
    return Matrix.LocRotScale(location, turned @ Quaternion(rotation), None)


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
